//! Contacts between bodies as posted, in terms of their own: mean gaps by quadrature, nearest points by sampling, derivatives by
//! dual numbers.

mod itself;
mod plane;
mod space;
pub(super) mod surface;

use crate::check::measure::bodies::plane::MeasuredBodyInPlane;
use crate::check::measure::bodies::space::MeasuredBodyInSpace;
use crate::check::measure::bodies::surface::TouchedSurfaces;
use crate::check::measure::numbers::MeasuredVector;
use crate::model::request::{Contact, Model};
use nalgebra::Matrix3;

/// Parts of faces that are covered over less than this part of them count as not covered.
const COVERED: f64 = 1e-8;
/// Faces that are behind by more than this part of the own face belong to the far side of a body.
const FAR_BEHIND: f64 = 0.5;
/// Faces in the plane that are steeper than this over the own face belong to another side of a corner.
const STEEP: f64 = 4.0;
/// Roundings of coordinates in a gap.
const ROUNDINGS: f64 = 64.0;

/// A contact of a node with a surface.
#[derive(Debug, Clone)]
pub(super) enum MeasuredBody {
    Plane(MeasuredBodyInPlane),
    Space(MeasuredBodyInSpace),
}

/// The contact at a state.
#[derive(Debug, Clone)]
pub(super) struct BodyState {
    gap: f64,
    place: BodyPlace,
    /// For each node that the contact acts on, the forces on it per unit of normal and of both tangential reactions, and
    /// whether it belongs to the node's own surface.
    rows: Vec<(usize, [MeasuredVector; 3], bool)>,
}

/// What a node is in front of.
#[derive(Debug, Clone)]
enum BodyPlace {
    /// Position along the opposite surface, its stretch, and the length of a closed surface.
    Along { place: f64, stretch: f64, period: Option<f64> },
    /// All nodes as seen from the node, and the axes at the node: tangents and normal.
    Around { from_node: Vec<MeasuredVector>, axes: Matrix3<f64> },
}

/// A coordinate moved by whole turns to near another one.
fn near(period: Option<f64>, from: f64, to: f64) -> f64 {
    period.map_or(to, |period| to - period * ((to - from) / period).round())
}

impl MeasuredBody {
    /// The contact of a checked model; `None` where it is none of bodies.
    pub fn new(model: &Model, contact: &Contact, surfaces: &TouchedSurfaces) -> Option<Self> {
        let against = contact.against.as_deref()?;
        let node = model.nodes.get_index_of(&contact.node)?;
        if model.dimension == 2 {
            return MeasuredBodyInPlane::new(contact, (node, against), surfaces).map(Self::Plane);
        }
        MeasuredBodyInSpace::new(contact, (node, against), surfaces).map(Self::Space)
    }

    /// The contact at displacements.
    pub fn state(&self, displacements: &[MeasuredVector]) -> BodyState {
        match self {
            Self::Plane(body) => body.state(displacements),
            Self::Space(body) => body.state(displacements),
        }
    }

    /// The gap at displacements.
    pub fn gap(&self, displacements: &[MeasuredVector]) -> f64 {
        match self {
            Self::Plane(body) => body.gap(displacements),
            Self::Space(body) => body.gap(displacements),
        }
    }

    /// The gap of a contact without reaction: of a node beyond the end of a smoothed surface it is the distance.
    pub fn open_gap(&self, displacements: &[MeasuredVector]) -> f64 {
        match self {
            Self::Plane(body) => body.open_gap(displacements),
            Self::Space(body) => body.gap(displacements),
        }
    }

    /// Rounding error of the gap due to the coordinates.
    pub fn rounding(&self, displacements: &[MeasuredVector]) -> f64 {
        match self {
            Self::Plane(body) => body.rounding(displacements),
            Self::Space(body) => body.rounding(displacements),
        }
    }

    /// The smallest distance between the faces and the opposite surface.
    pub fn distance(&self, displacements: &[MeasuredVector]) -> f64 {
        match self {
            Self::Plane(body) => body.distance(displacements),
            Self::Space(body) => body.distance(displacements),
        }
    }
}

impl BodyState {
    /// The motion since another state, along and across the surfaces.
    pub fn motion_since(&self, before: &Self) -> MeasuredVector {
        let across = self.gap - before.gap;
        match (&self.place, &before.place) {
            (BodyPlace::Along { place, stretch, period }, BodyPlace::Along { place: from, stretch: last, .. }) => {
                let way = near(*period, *from, *place) - from;
                MeasuredVector::new(0.5 * (stretch + last) * way, across, 0.0)
            }
            (BodyPlace::Around { from_node: here, axes }, BodyPlace::Around { from_node: there, axes: turned }) => {
                let mut motion = MeasuredVector::new(0.0, 0.0, across);
                if self.rows.is_empty() || before.rows.is_empty() {
                    return motion;
                }
                // Turned back into the axes before, the nodes move as the surfaces do against each other.
                let rotation = axes * turned.transpose();
                for (node, row, _) in &self.rows {
                    let way = here[*node] - rotation * there[*node];
                    (0..2).for_each(|axis| motion[axis] += 0.5 * row[1 + axis].dot(&way));
                }
                for (node, row, _) in &before.rows {
                    let way = rotation.transpose() * here[*node] - there[*node];
                    (0..2).for_each(|axis| motion[axis] += 0.5 * row[1 + axis].dot(&way));
                }
                motion
            }
            // Both states are of one contact.
            _ => MeasuredVector::repeat(f64::NAN),
        }
    }

    /// The forces on the nodes, and their sum over the node's own surface.
    pub fn forces(&self, normal: f64, tangential: &[f64]) -> (Vec<(usize, MeasuredVector)>, MeasuredVector) {
        let along = |k: usize| tangential.get(k).copied().unwrap_or(0.0);
        let force = |row: &[MeasuredVector; 3]| row[0] * normal + row[1] * along(0) + row[2] * along(1);
        let all = self.rows.iter().map(|(node, row, _)| (*node, force(row))).collect();
        let own = self.rows.iter().filter(|(_, _, own)| *own).map(|(_, row, _)| force(row)).sum();
        (all, own)
    }
}
