//! Solids by formulas of the measure's own: undeformed constants once, then energy, nodal forces and stress of a state.
//!
//! ```text
//! f_a = Σ_q V_q P(h_q) ḡ_a            no mend
//! F̂ = (J̄/J)^a F, a = ⅓ (1 - √(G/κ))   mean dilatation: P^ = P(F̂),  f from m P^ - a m (P^:F) F⁻ᵀ + p cof F,
//!                                      m = (J̄/J)^a,  p = a Σ V m (P^:F) / (J̄ Σ V)
//! V W(F̄) + ½ z·H z                    mean gradient: see `hourglass`
//! ```

mod hourglass;
mod loads;
mod material;
mod shapes;
#[cfg(test)]
mod tests;

pub(super) use loads::{MeasuredFace, SolidShares, pressed_surfaces};

use crate::model::request::{LockingMend, Model, PlaneCondition, Solid, SolidKind};
use hourglass::MeanConstants;
use material::{MeasuredMaterial, volume_change};
use nalgebra::{DVector, Matrix3, Vector3};
use std::f64::consts::TAU;

/// Roundings of a nodal force: many terms of size stiffness times displacement.
const ROUNDINGS: f64 = 64.0;

/// Poisson's ratio above which quadratic elements have a mean dilatation unless they are told otherwise.
const NEARLY_INCOMPRESSIBLE: f64 = 0.45 + 1e-12;

/// A vector of two or three components; a missing one is 0.
fn padded(values: &[f64]) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| values.get(axis).copied().unwrap_or(0.0))
}

/// What holds in the third direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneOf {
    Strain,
    Stress,
    Revolution,
    Space,
}

/// A quadrature point: its volume and the gradients of the shape functions, in a body of revolution also `N_a/R`.
#[derive(Debug, Clone)]
pub struct SolidPoint {
    pub volume: f64,
    pub gradients: Vec<Vector3<f64>>,
    pub hoop: Vec<f64>,
}

impl SolidPoint {
    /// The displacement gradient.
    fn gradient(&self, displacements: &[Vector3<f64>]) -> Matrix3<f64> {
        let mut gradient = Matrix3::zeros();
        for ((displacement, own), hoop) in displacements.iter().zip(&self.gradients).zip(&self.hoop) {
            gradient += displacement * own.transpose();
            gradient[(2, 2)] += displacement.x * hoop;
        }
        gradient
    }

    /// Adds the nodal forces of a stress.
    fn add_forces(&self, stress: &Matrix3<f64>, forces: &mut [Vector3<f64>]) {
        for ((force, own), hoop) in forces.iter_mut().zip(&self.gradients).zip(&self.hoop) {
            *force += stress * own * self.volume;
            force.x += self.volume * stress[(2, 2)] * hoop;
        }
    }
}

/// `∂X_i/∂ξ_j`, with a 1 for a third axis that is not there.
fn jacobian(slopes: &[[f64; 3]], places: &[Vector3<f64>], dimension: usize) -> Matrix3<f64> {
    let mut jacobian = Matrix3::zeros();
    for (slope, place) in slopes.iter().zip(places) {
        jacobian += (place - places[0]) * Vector3::from(*slope).transpose();
    }
    if dimension == 2 {
        jacobian[(2, 2)] = 1.0;
    }
    jacobian
}

#[derive(Debug, Clone)]
enum Mend {
    None,
    MeanDilatation { exponent: f64 },
    MeanGradient(MeanConstants),
}

/// A solid with its nodes numbered.
#[derive(Debug, Clone)]
pub(super) struct MeasuredSolid {
    pub nodes: Vec<usize>,
    dimension: usize,
    plane: PlaneOf,
    material: MeasuredMaterial,
    points: Vec<SolidPoint>,
    mend: Mend,
    /// About the largest force by a displacement of 1.
    stiffness: f64,
    /// Undeformed volume over size.
    pub area: f64,
}

/// What a solid does to its nodes.
#[derive(Debug, Clone)]
pub(super) struct SolidResponse {
    pub nodes: Vec<usize>,
    pub forces: Vec<Vector3<f64>>,
    pub energy: f64,
    /// Rounding error of a nodal force.
    pub rounding: f64,
    /// Whether strains count as small, so that the forces do not follow rotation.
    pub is_small: bool,
    /// Mean Cauchy stress.
    pub stress: Matrix3<f64>,
    pub area: f64,
}

/// Numbers and places of a solid's nodes: from the first one, radii kept in a body of revolution.
#[derive(Debug, Clone)]
struct PlacedSolid {
    origin: Vector3<f64>,
    nodes: Vec<usize>,
    places: Vec<Vector3<f64>>,
    plane: PlaneOf,
    thickness: f64,
}

impl PlacedSolid {
    fn new(model: &Model, solid: &Solid) -> Option<Self> {
        let nodes: Option<Vec<usize>> = solid.nodes.iter().map(|name| model.nodes.get_index_of(name)).collect();
        let nodes = nodes?;
        let plane = match solid.plane {
            _ if model.dimension == 3 => PlaneOf::Space,
            Some(PlaneCondition::Axisymmetric) => PlaneOf::Revolution,
            Some(PlaneCondition::Stress) => PlaneOf::Stress,
            Some(PlaneCondition::Strain) | None => PlaneOf::Strain,
        };
        let mut origin = padded(&model.nodes[*nodes.first()?]);
        if plane == PlaneOf::Revolution {
            origin.x = 0.0;
        }
        let places = nodes.iter().map(|node| padded(&model.nodes[*node]) - origin).collect();
        let is_plane = matches!(plane, PlaneOf::Strain | PlaneOf::Stress);
        let thickness = if is_plane { solid.thickness.unwrap_or(1.0) } else { 1.0 };
        Some(Self { origin, nodes, places, plane, thickness })
    }

    /// The thickness, or the circumference, where the shape functions have these values.
    fn around(&self, values: &[f64]) -> f64 {
        match self.plane {
            PlaneOf::Revolution => {
                TAU * values.iter().zip(&self.places).map(|(value, place)| value * place.x).sum::<f64>()
            }
            PlaneOf::Strain | PlaneOf::Stress | PlaneOf::Space => self.thickness,
        }
    }
}

impl MeasuredSolid {
    /// `None` if a name is unknown.
    pub fn new(model: &Model, kind: SolidKind, solid: &Solid) -> Option<Self> {
        let placed = PlacedSolid::new(model, solid)?;
        let (places, plane) = (&placed.places, placed.plane);
        let material = MeasuredMaterial::new(model.materials.get(&solid.material)?);
        let (dimension, _) = shapes::form(kind);
        let revolved = plane == PlaneOf::Revolution;
        let shape = shapes::Shape::of(kind);
        let mut points = Vec::new();
        for (place, weight) in shapes::rule(kind, revolved) {
            let here = shape.at(place);
            let jacobian = jacobian(&here.slopes, places, dimension);
            let inverse = jacobian.try_inverse()?;
            let gradients = here.slopes.iter().map(|slope| inverse.transpose() * Vector3::from(*slope)).collect();
            let around = placed.around(&here.values);
            let radius = around / TAU;
            let hoop = here.values.iter().map(|value| if revolved { value / radius } else { 0.0 }).collect();
            points.push(SolidPoint { volume: weight * jacobian.determinant() * around, gradients, hoop });
        }
        let (shear, lame) = material.moduli();
        let poisson = 0.5 * lame / (lame + shear);
        let usual = match kind {
            SolidKind::Triangle3 | SolidKind::Tetrahedron4 => LockingMend::None,
            SolidKind::Quadrilateral4 | SolidKind::Hexahedron8 => LockingMend::MeanGradient,
            _ if poisson > NEARLY_INCOMPRESSIBLE && plane != PlaneOf::Stress => LockingMend::MeanDilatation,
            _ => LockingMend::None,
        };
        let bulk = lame + 2.0 / 3.0 * shear;
        let mend = match solid.locking.unwrap_or(usual) {
            LockingMend::None => Mend::None,
            LockingMend::MeanDilatation => {
                Mend::MeanDilatation { exponent: ((1.0 - (shear / bulk).sqrt()) / 3.0).max(0.0) }
            }
            LockingMend::MeanGradient => {
                Mend::MeanGradient(MeanConstants::new(kind, places, &points, plane, (shear, lame)))
            }
        };
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        let reach = places.iter().map(|place| (place - places[0]).norm()).fold(0.0, f64::max);
        let of_point = |point: &SolidPoint| {
            let sizes = || point.gradients.iter().zip(&point.hoop).map(|(own, hoop)| own.norm() + hoop.abs());
            point.volume * (lame.abs() + 2.0 * shear) * sizes().fold(0.0, f64::max) * sizes().sum::<f64>()
        };
        let stiffness = points.iter().map(of_point).sum();
        let area = volume / reach;
        Some(Self { nodes: placed.nodes, dimension, plane, material, points, mend, stiffness, area })
    }

    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The displacement gradient with the strain out of the plane.
    fn gradient(&self, point: &SolidPoint, displacements: &[Vector3<f64>]) -> Matrix3<f64> {
        let mut gradient = point.gradient(displacements);
        if self.plane == PlaneOf::Stress {
            gradient[(2, 2)] = self.material.thickness_change(&gradient);
        }
        gradient
    }

    /// The response to the displacements of all nodes of the model.
    pub fn response(&self, u: &[Vector3<f64>]) -> SolidResponse {
        let displacements: Vec<Vector3<f64>> = self.nodes.iter().map(|node| u[*node]).collect();
        let mut forces = vec![Vector3::zeros(); self.nodes.len()];
        let mut stresses = MeanStress::default();
        let energy = match &self.mend {
            Mend::None => self.pointwise(&displacements, &mut forces, &mut stresses),
            Mend::MeanDilatation { exponent } => {
                self.mean_dilatation(*exponent, &displacements, &mut forces, &mut stresses)
            }
            Mend::MeanGradient(constants) => self.mean_gradient(constants, &displacements, &mut forces, &mut stresses),
        };
        let moved = displacements.iter().map(Vector3::amax).fold(0.0, f64::max);
        SolidResponse {
            nodes: self.nodes.clone(),
            forces,
            energy,
            rounding: ROUNDINGS * f64::EPSILON * self.stiffness * moved,
            is_small: self.material.is_small(),
            stress: stresses.mean(),
            area: self.area,
        }
    }

    fn pointwise(&self, displacements: &[Vector3<f64>], forces: &mut [Vector3<f64>], stresses: &mut MeanStress) -> f64 {
        let mut energy = 0.0;
        for point in &self.points {
            let gradient = self.gradient(point, displacements);
            let stress = self.material.stress(&gradient);
            point.add_forces(&stress, forces);
            energy += point.volume * self.material.energy(&gradient);
            stresses.add(self.material.is_small(), point.volume, &gradient, &stress);
        }
        energy
    }

    fn mean_dilatation(
        &self,
        exponent: f64,
        displacements: &[Vector3<f64>],
        forces: &mut [Vector3<f64>],
        stresses: &mut MeanStress,
    ) -> f64 {
        let is_small = self.material.is_small();
        let gradients: Vec<Matrix3<f64>> =
            self.points.iter().map(|point| self.gradient(point, displacements)).collect();
        let change_of = |gradient: &Matrix3<f64>| if is_small { gradient.trace() } else { volume_change(gradient) };
        let volume: f64 = self.points.iter().map(|point| point.volume).sum();
        let of_mean = self.points.iter().zip(&gradients).map(|(point, gradient)| point.volume * change_of(gradient));
        let mean = of_mean.sum::<f64>() / volume;
        let one = Matrix3::identity();
        // Of each point the mended gradient, the stress there, and its product with `F`.
        let mended: Vec<(Matrix3<f64>, f64, Matrix3<f64>, f64)> = gradients
            .iter()
            .map(|gradient| {
                let (mended, factor) = if is_small {
                    (gradient + one * (exponent * (mean - gradient.trace())), 1.0)
                } else {
                    let grown = (exponent * (mean.ln_1p() - change_of(gradient).ln_1p())).exp_m1();
                    (gradient * (1.0 + grown) + one * grown, 1.0 + grown)
                };
                let stress = self.material.stress(&mended);
                let along = if is_small { stress.trace() } else { stress.dot(&(one + gradient)) };
                (mended, factor, stress, along)
            })
            .collect();
        let of_pressure =
            self.points.iter().zip(&mended).map(|(point, (_, factor, _, along))| point.volume * factor * along);
        let pressure = exponent * of_pressure.sum::<f64>() / volume / if is_small { 1.0 } else { 1.0 + mean };
        let mut energy = 0.0;
        for ((point, gradient), (mended, factor, stress, along)) in self.points.iter().zip(&gradients).zip(&mended) {
            let whole = if is_small {
                stress + one * (pressure - exponent * along)
            } else {
                let ratio = 1.0 + volume_change(gradient);
                let inverse = (one + gradient).try_inverse().unwrap_or_else(|| Matrix3::from_element(f64::NAN));
                stress * *factor + inverse.transpose() * (pressure * ratio - exponent * factor * along)
            };
            point.add_forces(&whole, forces);
            energy += point.volume * self.material.energy(mended);
            stresses.add(is_small, point.volume, gradient, &whole);
        }
        energy
    }

    fn mean_gradient(
        &self,
        constants: &MeanConstants,
        displacements: &[Vector3<f64>],
        forces: &mut [Vector3<f64>],
        stresses: &mut MeanStress,
    ) -> f64 {
        let gradient = self.gradient(&constants.mean, displacements);
        let stress = self.material.stress(&gradient);
        let volume = constants.mean.volume;
        constants.mean.add_forces(&stress, forces);
        stresses.add(self.material.is_small(), volume, &gradient, &stress);
        let mut deformation = Matrix3::identity();
        if !self.material.is_small() {
            deformation += gradient;
            if self.dimension == 2 {
                deformation[(2, 2)] = 1.0;
            }
        }
        let inverse = deformation.try_inverse().unwrap_or_else(|| Matrix3::from_element(f64::NAN));
        let dimension = self.dimension;
        let mut strains = Vec::with_capacity(constants.stiffness.nrows());
        for mode in &constants.modes {
            let vector: Vector3<f64> = mode.iter().zip(displacements).map(|(weight, own)| own * *weight).sum();
            strains.extend((inverse * vector).iter().take(dimension).copied());
        }
        if constants.hoop_length > 0.0 {
            let plain = constants.mean.gradient(displacements);
            strains.push(constants.hoop_length * (plain[(0, 0)] - plain[(2, 2)]));
            strains.push(constants.hoop_length * plain[(0, 1)]);
        }
        let strains = DVector::from_vec(strains);
        let own = &constants.stiffness * &strains;
        let in_space = |values: &DVector<f64>, mode: usize| {
            Vector3::from_fn(|axis, _| if axis < dimension { values[mode * dimension + axis] } else { 0.0 })
        };
        for (place, mode) in constants.modes.iter().enumerate() {
            let vector = inverse.transpose() * in_space(&own, place);
            let strain = in_space(&strains, place);
            for ((force, weight), mean) in forces.iter_mut().zip(mode).zip(&constants.mean.gradients) {
                let beyond = if self.material.is_small() { 0.0 } else { mean.dot(&strain) };
                *force += vector * (weight - beyond);
            }
        }
        if constants.hoop_length > 0.0 {
            let first = dimension * constants.modes.len();
            let means = constants.mean.gradients.iter().zip(&constants.mean.hoop);
            for (force, (mean, hoop)) in forces.iter_mut().zip(means) {
                force.x += constants.hoop_length * (own[first] * (mean.x - hoop) + own[first + 1] * mean.y);
            }
        }
        volume * self.material.energy(&gradient) + 0.5 * strains.dot(&own)
    }
}

/// The mean of a stress over the deformed volume.
#[derive(Debug, Clone, Default)]
struct MeanStress {
    volume: f64,
    sum: Matrix3<f64>,
}

impl MeanStress {
    fn add(&mut self, is_small: bool, volume: f64, gradient: &Matrix3<f64>, stress: &Matrix3<f64>) {
        let (ratio, deformation) = if is_small {
            (1.0, Matrix3::identity())
        } else {
            (1.0 + volume_change(gradient), Matrix3::identity() + gradient)
        };
        self.volume += volume * ratio;
        self.sum += stress * deformation.transpose() * volume;
    }

    fn mean(&self) -> Matrix3<f64> {
        self.sum / self.volume
    }
}
