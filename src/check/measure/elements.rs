//! Forces and strain energy of the posted elements, for the measure only.

use crate::check::measure::beams::{BeamResponse, MeasuredBeam};
use crate::check::measure::numbers::{MeasuredVector, largest, padded};
use crate::check::measure::solids::{MeasuredSolid, SolidResponse};
use crate::check::measure::space_beams::MeasuredSpaceBeam;
use crate::model::request::{Element as Posted, Model, Strain};

/// An element with its nodes numbered; beams are in `beams`.
#[derive(Debug, Clone)]
pub(super) enum MeasuredElement {
    Bar {
        ends: [usize; 2],
        /// From the first end to the second in the initial configuration.
        reference: MeasuredVector,
        /// The length of `reference`.
        before: f64,
        rest: f64,
        stiffness: f64,
        prestress: f64,
        strain: Strain,
    },
    Spring {
        node: usize,
        /// `None` is the ground.
        other: Option<usize>,
        /// The rows of the stiffness matrix.
        stiffness: [MeasuredVector; 3],
    },
    Beam(MeasuredBeam),
    SpaceBeam(MeasuredSpaceBeam),
    RotationalSpring {
        node: usize,
        /// `None` is the ground.
        other: Option<usize>,
        /// Moment per angle.
        stiffness: f64,
    },
    Solid(Box<MeasuredSolid>),
}

/// What an element does to its nodes.
#[derive(Debug, Clone)]
pub(super) enum MeasuredResponse {
    /// Of a bar or a spring.
    Forces(ElementResponse),
    Beam(Box<BeamResponse>),
    /// Of a rotational spring: the moment of its first node on it, with its rounding error.
    Moment {
        node: usize,
        other: Option<usize>,
        moment: MeasuredVector,
        rounding: f64,
        energy: f64,
    },
    Solid(Box<SolidResponse>),
}

impl MeasuredResponse {
    pub fn energy(&self) -> f64 {
        match self {
            Self::Forces(response) => response.energy,
            Self::Beam(response) => response.energy,
            Self::Moment { energy, .. } => *energy,
            Self::Solid(response) => response.energy,
        }
    }
}

/// The nodal forces on an element, opposite at the two nodes, and the energy of the element.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementResponse {
    pub first: Option<usize>,
    pub second: usize,
    /// The force at the second node.
    pub force: MeasuredVector,
    /// Of a bar: force along the deformed axis, tension positive.
    pub axial: Option<f64>,
    pub energy: f64,
    /// Rounding error of the force due to the displacements.
    pub rounding: f64,
}

/// Error of a difference of two rounded numbers that were computed from rounded numbers, in units of the machine
/// epsilon.
const ROUNDINGS: f64 = 16.0;

impl MeasuredElement {
    /// `None` if a node is unknown.
    pub fn new(model: &Model, posted: &Posted) -> Option<Self> {
        let index = |name: &String| model.nodes.get_index_of(name);
        match posted {
            Posted::Bar { nodes, axial_stiffness, rest_length, prestress, strain, name: _ } => {
                let ends = [index(nodes.first()?)?, index(nodes.get(1)?)?];
                let reference = padded(&model.nodes[ends[1]]) - padded(&model.nodes[ends[0]]);
                let before = reference.norm();
                let rest = rest_length.unwrap_or(before);
                let (stiffness, prestress, strain) = (*axial_stiffness, *prestress, *strain);
                Some(Self::Bar { ends, reference, before, rest, stiffness, prestress, strain })
            }
            Posted::Beam { .. } if model.dimension == 3 => {
                Some(Self::SpaceBeam(MeasuredSpaceBeam::new(model, posted)?))
            }
            Posted::Beam { .. } => Some(Self::Beam(MeasuredBeam::new(model, posted)?)),
            Posted::RotationalSpring { nodes, stiffness, name: _ } => {
                let other = nodes.get(1).map(|name| index(name).ok_or(())).transpose().ok()?;
                Some(Self::RotationalSpring { node: index(nodes.first()?)?, other, stiffness: *stiffness })
            }
            Posted::Spring { nodes, stiffness, name: _ } => {
                let row = |k: usize| stiffness.get(k).map_or_else(MeasuredVector::zeros, |row| padded(row));
                let other = nodes.get(1).map(|name| index(name).ok_or(())).transpose().ok()?;
                Some(Self::Spring { node: index(nodes.first()?)?, other, stiffness: [row(0), row(1), row(2)] })
            }
            _ => {
                let (kind, solid) = posted.solid()?;
                Some(Self::Solid(Box::new(MeasuredSolid::new(model, kind, solid)?)))
            }
        }
    }

    /// Approximately the largest stiffness in any direction, in the undeformed state.
    pub fn stiffness(&self) -> f64 {
        match self {
            Self::Bar { rest, stiffness, .. } => stiffness / rest,
            Self::Spring { stiffness, .. } => stiffness.iter().map(MeasuredVector::norm).fold(0.0, f64::max),
            Self::Beam(beam) => beam.stiffness(),
            Self::SpaceBeam(beam) => beam.stiffness(),
            Self::RotationalSpring { .. } => 0.0,
            Self::Solid(solid) => solid.stiffness(),
        }
    }

    /// The response to the given displacements and rotations of the nodes.
    pub fn response(&self, u: &[MeasuredVector], rotations: &[MeasuredVector]) -> MeasuredResponse {
        MeasuredResponse::Forces(match self {
            Self::Beam(beam) => return MeasuredResponse::Beam(Box::new(beam.response(u, rotations))),
            Self::SpaceBeam(beam) => return MeasuredResponse::Beam(Box::new(beam.response(u, rotations))),
            Self::Solid(solid) => return MeasuredResponse::Solid(Box::new(solid.response(u))),
            Self::RotationalSpring { node, other, stiffness } => {
                let turn = rotations[*node].z - other.map_or(0.0, |other| rotations[other].z);
                let turned = rotations[*node].z.abs().max(other.map_or(0.0, |other| rotations[other].z.abs()));
                let (moment, rounding) = (stiffness * turn, ROUNDINGS * f64::EPSILON * stiffness * turned);
                let (node, other, energy) = (*node, *other, 0.5 * moment * turn);
                let moment = MeasuredVector::z() * moment;
                return MeasuredResponse::Moment { node, other, moment, rounding, energy };
            }
            Self::Bar { ends, reference, before, rest, stiffness, prestress, strain } => {
                let change = u[ends[1]] - u[ends[0]];
                let deformed = reference + change;
                let length = deformed.norm();
                // `L - L0` and `(L - L0)/L0` without cancellation.
                let grown = change.dot(&(reference * 2.0 + change)) / (length + before);
                let elongation = grown + (before - rest);
                let linear = elongation / rest;
                let stretch = length / rest;
                // The strain measure, and the axial force over EA.
                let (measure, elastic) = match strain {
                    Strain::Engineering => (linear, linear),
                    Strain::Green => {
                        let green = linear * (1.0 + 0.5 * linear);
                        (green, green * stretch)
                    }
                    Strain::Log => {
                        let logarithmic = linear.ln_1p();
                        (logarithmic, logarithmic / stretch)
                    }
                };
                let axial = stiffness * elastic + prestress;
                let force = deformed * (axial / length);
                let energy = 0.5 * stiffness * rest * measure * measure + prestress * elongation;
                // The tangent stiffness for Green strain grows with the square of the stretch.
                let tangent = stiffness / rest * stretch.max(1.0).powi(2);
                let moved = largest(&u[ends[0]]).max(largest(&u[ends[1]]));
                let rounding = ROUNDINGS * f64::EPSILON * tangent * moved;
                ElementResponse { first: Some(ends[0]), second: ends[1], force, axial: Some(axial), energy, rounding }
            }
            Self::Spring { node, other, stiffness } => {
                let relative = match other {
                    Some(other) => u[*node] - u[*other],
                    None => u[*node],
                };
                let force = MeasuredVector::from(stiffness.map(|row| row.dot(&relative)));
                let row = |row: &MeasuredVector| row.iter().map(|value| value.abs()).sum::<f64>();
                let most = stiffness.iter().map(row).fold(0.0, f64::max);
                let moved = largest(&u[*node]).max(other.map_or(0.0, |other| largest(&u[other])));
                let rounding = ROUNDINGS * f64::EPSILON * most * moved;
                let energy = 0.5 * force.dot(&relative);
                ElementResponse { first: *other, second: *node, force, axial: None, energy, rounding }
            }
        })
    }
}
