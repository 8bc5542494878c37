//! A surface that touches itself, in the plane: which of its faces a face may touch.
//!
//! Faces are numbered along the surface. A face `e` looks at
//!
//! ```text
//! { f < e : f has no node of e, and f is not the other side of a wall at e },
//! ```
//!
//! so that each pair of faces is looked at once, from the later one: two multipliers for one pair would not be determined.
//! The gap at a node is then that of [`mortar`](super::mortar) over what its faces look at; in a roll the nearest layer
//! counts. That single pass over a surface that touches itself is B. Yang and T. A. Laursen's (A large deformation mortar
//! formulation of self contact with finite sliding, Comput. Meth. Appl. Mech. Engng 197, 2008); here the order of the faces
//! says which of two carries the multipliers.

use crate::mechanics::contact::bodies::opposite_surface::{OppositeSurface, SurfaceFace, distance_from_segment};
use crate::mechanics::contact::bodies::tolerances::{BEHIND_A_WALL, CROSSING};
use crate::mechanics::contact::bodies::{PlaneVector, difference, product, turned_left};
use smallvec::SmallVec;
use std::ops::Range;

/// What a node of a surface that touches itself sees of this surface.
#[derive(Debug, Clone)]
pub(super) struct OwnSurface {
    /// For each face at the node and each of the surface, whether they may touch.
    touchable: SmallVec<[Vec<bool>; 2]>,
    /// For each node of the surface its index among those of the contact.
    local: Vec<usize>,
}

/// A face at a node of a surface that touches itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FaceOfItself {
    /// Index of the face.
    pub(super) index: usize,
    /// Whether the node is its only one with a multiplier.
    pub(super) is_alone: bool,
}

/// The faces at a node (an index into those of the surface). A closed chain begins and ends at one node, beyond which the two
/// sides of a contact change parts: this node has no multiplier, and the node before it has that of the whole last face,
/// as where several mortar interfaces meet.
pub(super) fn faces_of_node(surface: &OppositeSurface, node: usize) -> SmallVec<[FaceOfItself; 2]> {
    let [before, after] = surface.faces_at(node);
    let closes = |face: usize| {
        let chain = surface.chains[surface.faces[face].chain];
        chain.period.is_some() && face + 1 == chain.first + chain.count
    };
    let before = before.filter(|face| !closes(*face)).map(|index| FaceOfItself { index, is_alone: false });
    let after = after.map(|index| FaceOfItself { index, is_alone: closes(index) });
    before.into_iter().chain(after).collect()
}

impl OwnSurface {
    /// `faces`: those at the node; `order`: the nodes of the surface, as indices into its own, in the order of the contact.
    pub(super) fn new(surface: &OppositeSurface, faces: &[FaceOfItself], order: &[usize]) -> Self {
        let of_face = |own: usize| (0..surface.faces.len()).map(|other| may_touch(surface, own, other)).collect();
        let touchable = faces.iter().map(|face| of_face(face.index)).collect();
        let mut local = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, node)| local[*node] = place);
        Self { touchable, local }
    }

    /// The index among the contact's nodes of a node of the surface.
    pub(super) fn local(&self, node: usize) -> usize {
        self.local[node]
    }

    /// Whether a face of the surface may be touched.
    pub(super) fn is_touchable(&self, face: usize) -> bool {
        self.touchable.iter().any(|touchable| touchable[face])
    }

    /// Whether a face at the node looks at a face of the surface.
    pub(super) fn looks_at(&self, own: usize, other: usize) -> bool {
        self.touchable[own][other]
    }

    /// The layer in front of the node: the nearest of the runs of faces that run against `along`, the direction of the
    /// surface at the node.
    pub(super) fn layer(
        &self,
        surface: &OppositeSurface,
        node: PlaneVector,
        along: PlaneVector,
        ends: impl Fn(&SurfaceFace) -> [PlaneVector; 2],
    ) -> Range<usize> {
        let ends = |face: usize| ends(&surface.faces[face]);
        let faces_node = |face: &usize| {
            let [first, last] = ends(*face);
            product(difference(last, first), along) < 0.0 && self.is_touchable(*face)
        };
        let facing: Vec<usize> = (0..surface.faces.len()).filter(faces_node).collect();
        let follows =
            |one: &usize, next: &usize| *next == one + 1 && surface.faces[*next].chain == surface.faces[*one].chain;
        let layers = facing.chunk_by(follows).map(|layer| {
            let distances = layer.iter().map(|face| distance_from_segment(node, ends(*face)));
            (distances.fold(f64::INFINITY, f64::min), layer[0]..layer[0] + layer.len())
        });
        layers.fold((f64::INFINITY, 0..0), |best, layer| if layer.0 < best.0 { layer } else { best }).1
    }
}

/// Whether a face looks at another one of the same surface, by their undeformed positions.
fn may_touch(surface: &OppositeSurface, own: usize, other: usize) -> bool {
    let [face, opposite] = [own, other].map(|face| &surface.faces[face]);
    if other >= own || face.nodes.iter().any(|node| opposite.nodes.contains(node)) {
        return false;
    }
    let [from, to] = face.nodes.map(|node| surface.places[node]);
    let edge = difference(to, from);
    let length = product(edge, edge).sqrt();
    let ends = opposite.nodes.map(|node| difference(surface.places[node], from));
    let along = ends.map(|end| product(edge, end) / length);
    let across = ends.map(|end| product(turned_left(edge), end) / length);
    // Sides that coincide, or overlap as meshes do, are those of a slit that is closed.
    let is_other_side = along[1] < along[0] && across[0].max(across[1]) < -CROSSING * length;
    let reach = BEHIND_A_WALL * (length - across[0].min(across[1]));
    !(is_other_side && along[0] > -reach && along[1] < length + reach)
}

/// The first face of the undeformed surface that a face crosses, by more than a mesh may.
pub fn crossed(surface: &OppositeSurface, own: usize) -> Option<usize> {
    let ends = |face: usize| surface.faces[face].nodes.map(|node| surface.places[node]);
    let one = ends(own);
    let crosses = |other: &usize| {
        let shares = surface.faces[*other].nodes.iter().any(|node| surface.faces[own].nodes.contains(node));
        !shares && cross(one, ends(*other))
    };
    (0..surface.faces.len()).find(crosses)
}

/// Whether two segments cross, each with its ends on both sides of the other, and one of them by more than [`CROSSING`] of
/// the shorter one's length.
fn cross(one: [PlaneVector; 2], other: [PlaneVector; 2]) -> bool {
    let length = |[first, last]: [PlaneVector; 2]| {
        let edge = difference(last, first);
        product(edge, edge).sqrt()
    };
    let heights = |line: [PlaneVector; 2], points: [PlaneVector; 2]| {
        let edge = difference(line[1], line[0]);
        points.map(|point| product(turned_left(edge), difference(point, line[0])) / length(line))
    };
    let [[a, b], [c, d]] = [heights(one, other), heights(other, one)];
    let depth = a.abs().min(b.abs()).max(c.abs().min(d.abs()));
    a * b < 0.0 && c * d < 0.0 && depth > CROSSING * length(one).min(length(other))
}
