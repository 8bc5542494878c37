//! The constants of the element of the mean deformation gradient: the inhomogeneous strains and the matrix `H` of their
//! energy `½ z·H z`; see the element's own description. Computed once, on the undeformed element.
//!
//! ```text
//! z = (F̄⁻¹ Σ_a Γ_ia u_a, ℓ (h̄_11 - h̄_33), ℓ h̄_12),     Γ_ia = c_ia - ḡ_a·D_i,     D_i = Σ_a c_ia X_a
//! ```
//!
//! `c_ia` is the product of a node's natural coordinates over the number of nodes, `ḡ_a` the mean gradients. `H` is the
//! Schur complement in the Gram matrix, in the stiffness of small strains, of the strains that motions of one `z` have
//! beside their mean, and of strains without a mean that the element bears on its own.

use crate::check::measure::solids::shapes::{self, NaturalPlace, Shape};
use crate::check::measure::solids::{PlaneOf, SolidPoint, jacobian};
use crate::model::request::SolidKind;
use nalgebra::{DMatrix, Matrix3, Vector3};
use std::f64::consts::TAU;

#[derive(Debug, Clone)]
pub struct MeanConstants {
    /// Mean gradients `ḡ_a`, and the mean of `N_a/R`.
    pub mean: SolidPoint,
    /// `Γ_i`.
    pub modes: Vec<Vec<f64>>,
    /// `ℓ`; 0 but in a body of revolution.
    pub hoop_length: f64,
    pub stiffness: DMatrix<f64>,
}

/// Natural coordinates whose products the strains that the element bears on its own go with, and the axes of each.
fn own_strains(dimension: usize, revolved: bool) -> Vec<(Vec<usize>, Option<[usize; 2]>)> {
    let mut strains: Vec<(Vec<usize>, Option<[usize; 2]>)> = Vec::new();
    for axis in 0..dimension {
        strains.push((vec![axis], Some([axis, axis])));
    }
    for (one, other) in [(0, 1), (1, 2), (0, 2)].into_iter().filter(|(_, other)| *other < dimension) {
        strains.push((vec![one], Some([one, other])));
        strains.push((vec![other], Some([one, other])));
    }
    if dimension == 3 {
        strains.extend([[0, 1], [1, 2], [0, 2]].map(|axes| (axes.to_vec(), None)));
    }
    if revolved {
        strains.push((vec![0, 1], Some([2, 2])));
    }
    strains
}

impl MeanConstants {
    pub fn new(
        kind: SolidKind,
        places: &[Vector3<f64>],
        points: &[SolidPoint],
        plane: PlaneOf,
        (shear, lame): (f64, f64),
    ) -> Self {
        let (dimension, _) = shapes::form(kind);
        let revolved = plane == PlaneOf::Revolution;
        let count = places.len();
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        let mean_of = |node: usize| {
            let weighted = points.iter().map(|point| point.gradients[node] * (point.volume / volume));
            weighted.sum::<Vector3<f64>>()
        };
        let hoop_of = |node: usize| points.iter().map(|point| point.hoop[node] * point.volume / volume).sum::<f64>();
        let mean = SolidPoint {
            volume,
            gradients: (0..count).map(mean_of).collect(),
            hoop: (0..count).map(hoop_of).collect(),
        };
        let natural = shapes::nodes(kind);
        let products: &[&[usize]] = if dimension == 2 { &[&[0, 1]] } else { &[&[1, 2], &[0, 2], &[0, 1], &[0, 1, 2]] };
        let mode = |axes: &&[usize]| {
            let parts: Vec<f64> = natural
                .iter()
                .map(|node| axes.iter().map(|axis| node[*axis]).product::<f64>() / count as f64)
                .collect();
            let own: Vector3<f64> = parts.iter().zip(places).map(|(part, place)| (place - places[0]) * *part).sum();
            (0..count).map(|node| parts[node] - mean.gradients[node].dot(&own)).collect()
        };
        let modes: Vec<Vec<f64>> = products.iter().map(mode).collect();
        let shape = Shape::of(kind);
        let area: f64 = shapes::rule(kind, revolved)
            .into_iter()
            .map(|(place, weight)| weight * jacobian(&shape.at(place).slopes, places, dimension).determinant())
            .sum();
        let hoop_length = if revolved { area.sqrt() } else { 0.0 };
        let mut constants = Self { mean, modes, hoop_length, stiffness: DMatrix::zeros(0, 0) };
        let lame = if plane == PlaneOf::Stress { 2.0 * lame * shear / (lame + 2.0 * shear) } else { lame };
        constants.stiffness = constants.matrix(kind, places, points, revolved, (shear, lame));
        constants
    }

    /// The derivative of `z` by the displacement of each node at rest: a row for each strain.
    pub fn slopes(&self, dimension: usize) -> DMatrix<f64> {
        let count = self.mean.gradients.len();
        let hoops = if self.hoop_length > 0.0 { 2 } else { 0 };
        let first_hoop = dimension * self.modes.len();
        DMatrix::from_fn(first_hoop + hoops, dimension * count, |row, column| {
            let (node, axis) = (column / dimension, column % dimension);
            if row < first_hoop {
                return if row % dimension == axis { self.modes[row / dimension][node] } else { 0.0 };
            }
            let gradient = self.mean.gradients[node];
            let of_radius = if row == first_hoop { gradient.x - self.mean.hoop[node] } else { gradient.y };
            if axis == 0 { self.hoop_length * of_radius } else { 0.0 }
        })
    }

    fn matrix(
        &self,
        kind: SolidKind,
        places: &[Vector3<f64>],
        points: &[SolidPoint],
        revolved: bool,
        (shear, lame): (f64, f64),
    ) -> DMatrix<f64> {
        let (dimension, _) = shapes::form(kind);
        let slopes = self.slopes(dimension);
        let failed = DMatrix::from_element(slopes.nrows(), slopes.nrows(), f64::NAN);
        let Some(inverse) = (&slopes * slopes.transpose()).try_inverse() else { return failed };
        let motions = slopes.transpose() * inverse;
        let shape = Shape::of(kind);
        let around = |values: &[f64]| {
            let radius: f64 = values.iter().zip(places).map(|(value, place)| value * place.x).sum();
            if revolved { TAU * radius } else { 1.0 }
        };
        let centre = shape.at([0.0; 3]);
        let frame = jacobian(&centre.slopes, places, dimension);
        let of_centre = frame.determinant() * around(&centre.values);
        let Some(natural_axes) = frame.try_inverse() else { return failed };
        let own = own_strains(dimension, revolved);
        let (compatible, all) = (slopes.nrows(), slopes.nrows() + own.len());
        let mut gram: DMatrix<f64> = DMatrix::zeros(all, all);
        for (point, (place, _)) in points.iter().zip(shapes::rule(kind, revolved)) {
            let here = shape.at(place);
            let density = jacobian(&here.slopes, places, dimension).determinant() * around(&here.values);
            let mut strains: Vec<Matrix3<f64>> = (0..compatible)
                .map(|column| {
                    let motion: Vec<Vector3<f64>> = (0..places.len())
                        .map(|node| {
                            Vector3::from_fn(|axis, _| {
                                if axis < dimension { motions[(node * dimension + axis, column)] } else { 0.0 }
                            })
                        })
                        .collect();
                    let beyond = point.gradient(&motion) - self.mean.gradient(&motion);
                    (beyond + beyond.transpose()) * 0.5
                })
                .collect();
            strains.extend(own.iter().map(|strain| own_strain(strain, &natural_axes, &place) * (of_centre / density)));
            let trace: Vec<f64> = strains.iter().map(Matrix3::trace).collect();
            for row in 0..all {
                for column in 0..=row {
                    let product = strains[row].dot(&strains[column]);
                    let value = point.volume * (2.0 * shear * product + lame * trace[row] * trace[column]);
                    gram[(row, column)] += value;
                    if row != column {
                        gram[(column, row)] += value;
                    }
                }
            }
        }
        let of_own = gram.view((compatible, compatible), (own.len(), own.len())).into_owned();
        let across = gram.view((compatible, 0), (own.len(), compatible)).into_owned();
        let Some(solved) = of_own.lu().solve(&across) else { return failed };
        gram.view((0, 0), (compatible, compatible)).into_owned() - across.transpose() * solved
    }
}

/// A strain of the element's own in the axes of the structure.
fn own_strain(
    (along, axes): &(Vec<usize>, Option<[usize; 2]>),
    natural_axes: &Matrix3<f64>,
    place: &NaturalPlace,
) -> Matrix3<f64> {
    let size: f64 = along.iter().map(|axis| place[*axis]).product();
    let Some([one, other]) = *axes else { return Matrix3::identity() * size };
    let (first, second) = (natural_axes.row(one).transpose(), natural_axes.row(other).transpose());
    (first * second.transpose() + second * first.transpose()) * (0.5 * size)
}
