//! A node of a surface against an opposite surface by the mortar method with dual multipliers, in the plane.
//!
//! ```text
//! g_j = Σ_e D_je H_je / Σ_e D_je,      D_je = ∫ φ_j ds,      H_je = ∫ ψ_j h ds / D_je
//! ```
//!
//! over the faces `e` at the node, with the distance `h` of the opposite surface along the normal of the face. The normal
//! row of `B` is the gradient of `g_j`, so that no energy is lost in a closed contact, and the tangential row is the
//! gradient of the position along the opposite surface times its stretch. The method is that of A. Popp, M. Gitterle, M.
//! W. Gee and W. A. Wall (A dual mortar approach for 3D finite deformation contact, Int. J. Numer. Meth. Engng 83, 2010;
//! frictional: M. Gitterle and others, 84, 2010), with the projection along the normals of faces, as M. A. Puso and T. A.
//! Laursen have it (A mortar segment-to-segment contact method, Comput. Meth. Appl. Mech. Engng 193, 2004), in place of
//! averaged normals: all integrals have closed forms.
//!
//! Of bodies of revolution `ds` is `r ds`, with the present distance `r` from the axis: a constant pressure on the deformed
//! surface then has its forces exactly, as in the plane.

use crate::mechanics::contact::bodies::covered_face::{
    CoveredFace, CoveringPiece, MetNodes, each_gradient, nodal_gradients,
};
use crate::mechanics::contact::bodies::face_moments::{
    FaceAtNode, IN_PLANE, MeanAtNode, OF_FACE, REVOLVED, nodal_values,
};
use crate::mechanics::contact::bodies::opposite_surface::{
    OppositeSurface, SurfaceFace, distance_from_segment, distance_of_segments,
};
use crate::mechanics::contact::bodies::second_derivatives;
use crate::mechanics::contact::bodies::self_contact::{OwnSurface, faces_of_node};
use crate::mechanics::contact::bodies::tolerances::{DEEPEST, LAST_COVERED, LEAST_COVERED, STEEPEST};
use crate::mechanics::contact::bodies::{MovedNode, PlaneVector, difference, product, turned_left};
use crate::mechanics::contact::kinematics::{CoupledKinematics, LocalDisplacements};
use crate::mechanics::contact::vector::Vector;
use smallvec::SmallVec;
use std::f64::consts::SQRT_2;
use std::ops::Range;
use std::sync::Arc;

/// A node with its faces, in front of an opposite surface.
#[derive(Debug, Clone)]
pub struct MortarNode {
    /// The node, its neighbours on its own surface, the nodes of the opposite surface.
    nodes: Vec<usize>,
    faces: SmallVec<[FaceOfNode; 2]>,
    /// Undeformed positions of the node and its neighbours.
    places: SmallVec<[PlaneVector; 3]>,
    opposite: Arc<OppositeSurface>,
    /// Where the surface touches itself: what the node sees of it.
    itself: Option<OwnSurface>,
    /// Gap and position along the opposite surface without displacements; positions are counted from there.
    start: (f64, f64),
}

/// A face at the node.
#[derive(Debug, Clone, Copy)]
struct FaceOfNode {
    /// Its first and last node, as indices into those of the contact.
    nodes: [usize; 2],
    /// Whether the node is the only one of the face with a multiplier.
    is_alone: bool,
}

impl MortarNode {
    /// The kinematics of the node `own` of a surface; `before` and `after` are its neighbours there, of which there is at
    /// least one. `place` gives undeformed positions.
    pub fn new(
        own: usize,
        [before, after]: [Option<usize>; 2],
        opposite: Arc<OppositeSurface>,
        place: impl Fn(usize) -> PlaneVector,
    ) -> Self {
        let (mut nodes, mut faces) = (vec![own], SmallVec::new());
        if let Some(before) = before {
            faces.push(FaceOfNode { nodes: [nodes.len(), 0], is_alone: false });
            nodes.push(before);
        }
        if let Some(after) = after {
            faces.push(FaceOfNode { nodes: [0, nodes.len()], is_alone: false });
            nodes.push(after);
        }
        let places = nodes.iter().map(|node| place(*node)).collect();
        nodes.extend(&opposite.nodes);
        Self { nodes, faces, places, opposite, itself: None, start: (0.0, 0.0) }.started()
    }

    /// The kinematics of a node (an index into those of the surface) of a surface that touches itself.
    pub fn in_itself(node: usize, surface: Arc<OppositeSurface>) -> Self {
        let at_node = faces_of_node(&surface, node);
        let mut met: SmallVec<[usize; 3]> = SmallVec::from_slice(&[node]);
        let faces = at_node
            .iter()
            .map(|face| {
                let nodes = surface.faces[face.index].nodes.map(|one| {
                    met.iter().position(|other| *other == one).unwrap_or_else(|| {
                        met.push(one);
                        met.len() - 1
                    })
                });
                FaceOfNode { nodes, is_alone: face.is_alone }
            })
            .collect();
        let places = met.iter().map(|node| surface.places[*node]).collect();
        let others = (0..surface.nodes.len()).filter(|other| !met.contains(other));
        let order: Vec<usize> = met.iter().copied().chain(others).collect();
        let itself = Some(OwnSurface::new(&surface, &at_node, &order));
        let nodes = order.iter().map(|node| surface.nodes[*node]).collect();
        Self { nodes, faces, places, opposite: surface, itself, start: (0.0, 0.0) }.started()
    }

    /// With gap and position without displacements.
    fn started(mut self) -> Self {
        let (gap, place, _) = self.values(&|_| 0.0);
        self.start = (gap, place);
        self
    }

    /// The gap without displacements.
    pub fn initial_gap(&self) -> f64 {
        self.start.0
    }

    /// The index among the contact's nodes of a node of the opposite surface.
    fn local(&self, node: usize) -> usize {
        self.itself.as_ref().map_or(self.places.len() + node, |itself| itself.local(node))
    }

    /// One of the own nodes.
    fn moved(&self, displacement: LocalDisplacements<'_>, node: usize) -> MovedNode {
        MovedNode { place: self.places[node], moved: [displacement(2 * node), displacement(2 * node + 1)] }
    }

    /// The present position of one of the own nodes.
    fn position(&self, displacement: LocalDisplacements<'_>, node: usize) -> PlaneVector {
        self.moved(displacement, node).position()
    }

    /// The present positions of the ends of an opposite face.
    fn ends(&self, displacement: LocalDisplacements<'_>, face: &SurfaceFace) -> [PlaneVector; 2] {
        face.nodes.map(|node| self.end(displacement, node).position())
    }

    /// A node of the opposite surface.
    fn end(&self, displacement: LocalDisplacements<'_>, node: usize) -> MovedNode {
        let local = self.local(node);
        MovedNode { place: self.opposite.places[node], moved: [displacement(2 * local), displacement(2 * local + 1)] }
    }

    /// The ends of consecutive opposite faces, each node read once.
    fn ends_of(&self, displacement: LocalDisplacements<'_>, faces: Range<usize>) -> SmallVec<[[MovedNode; 2]; 64]> {
        let mut all: SmallVec<[[MovedNode; 2]; 64]> = SmallVec::with_capacity(faces.len());
        let mut before: Option<usize> = None;
        for face in &self.opposite.faces[faces] {
            let shared = all.last().filter(|_| before == Some(face.nodes[0])).map(|ends| ends[1]);
            let [first, last] = face.nodes;
            let first = shared.unwrap_or_else(|| self.end(displacement, first));
            all.push([first, self.end(displacement, last)]);
            before = Some(last);
        }
        all
    }

    /// The part of the opposite surface that the node may be in front of: the chain that is nearest to it, or the layer.
    fn in_front(&self, displacement: LocalDisplacements<'_>) -> Range<usize> {
        let place = self.position(displacement, 0);
        if let Some(itself) = &self.itself {
            let direction = |face: &FaceOfNode| {
                let [first, last] = face.nodes.map(|node| self.position(displacement, node));
                let edge = difference(last, first);
                edge.map(|part| part / product(edge, edge).sqrt())
            };
            let along =
                self.faces.iter().map(direction).fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
            return itself.layer(&self.opposite, place, along, |face| self.ends(displacement, face));
        }
        let chain = if self.opposite.chains.len() == 1 {
            0
        } else {
            let distance = |face: &SurfaceFace| distance_from_segment(place, self.ends(displacement, face));
            let nearest = self.opposite.faces.iter().map(|face| (distance(face), face.chain));
            nearest.fold((f64::INFINITY, 0), |best, other| if other.0 < best.0 { other } else { best }).1
        };
        let chain = self.opposite.chains[chain];
        chain.first..chain.first + chain.count
    }

    /// Whether a face at the node looks at an opposite face.
    fn looks_at(&self, own: usize, face: usize) -> bool {
        self.itself.as_ref().is_none_or(|itself| itself.looks_at(own, face))
    }

    /// The faces with what is opposite; none where no part of any is covered.
    fn covered<const N: usize>(&self, displacement: LocalDisplacements<'_>) -> SmallVec<[CoveredFace<N>; 2]> {
        let in_front = self.in_front(displacement);
        let faces = self.ends_of(displacement, in_front.clone());
        let mut reference: Option<f64> = None;
        let mut is_covered = false;
        let mut all = SmallVec::new();
        for (which, own) in self.faces.iter().enumerate() {
            let own_ends = own.nodes.map(|node| self.moved(displacement, node));
            let [first, last] = own_ends.map(|end| end.position());
            let vector = difference(last, first);
            let length = product(vector, vector).sqrt();
            let along = vector.map(|part| part / length);
            let at_rest = difference(own_ends[1].place, own_ends[0].place);
            let length_at_rest = product(at_rest, at_rest).sqrt();
            let mut pieces: SmallVec<[CoveringPiece<N>; 4]> = SmallVec::new();
            let (mut area, mut centre) = (0.0, 0.0);
            for (index, ends) in in_front.clone().zip(&faces).filter(|(index, _)| self.looks_at(which, *index)) {
                let face = &self.opposite.faces[index];
                let [s_first, s_last] = ends.map(|end| product(along, difference(end.position(), first)));
                let [h_first, h_last] = ends.map(|end| end.height_over(own_ends.each_ref(), length));
                if !is_in_front([s_first, s_last], [h_first, h_last], length) {
                    continue;
                }
                is_covered |= s_first.min(length) - s_last.max(0.0) > LEAST_COVERED * length;
                let goes_on = self.goes_on(index);
                let high = if goes_on[0] { length } else { s_first.min(length) };
                let low = if goes_on[1] { 0.0 } else { s_last.max(0.0) };
                let width = high - low;
                if width <= LEAST_COVERED * length {
                    continue;
                }
                // Around a closed surface coordinates jump; all are counted from the first.
                let from = *reference.get_or_insert(face.along[0]);
                let shift = from + self.opposite.way(face.chain, from, face.along[0]) - face.along[0] - self.start.1;
                let place = face.along.map(|place| place + shift);
                let is_fitted = !self.faces.iter().any(|face| face.is_alone);
                // Coordinates of the own face count from the node.
                let slipped = |end: usize| {
                    let [at_rest, moved] = ends[end].along_undeformed(own_ends.each_ref());
                    place[end] + at_rest - if own.nodes[1] == 0 { length_at_rest } else { 0.0 } + moved
                };
                area += width;
                centre += width * 0.5 * (high + low);
                let values = [length, s_first, h_first, s_last, h_last, first[0], last[0]];
                pieces.push(CoveringPiece {
                    nodes: face.nodes.map(|node| self.local(node)),
                    values: std::array::from_fn(|k| values[k]),
                    along: place,
                    slipped: if is_fitted { [slipped(0), slipped(1)] } else { place },
                    goes_on,
                });
            }
            if !pieces.is_empty() {
                let at = FaceAtNode { is_last: own.nodes[1] == 0, from: centre / area, is_alone: own.is_alone };
                all.push(CoveredFace { nodes: own.nodes, at, length, along, pieces });
            }
        }
        if is_covered { all } else { SmallVec::new() }
    }

    /// Whether an opposite face goes on straight beyond its first and its last node: where its chain ends, or where the two
    /// sides of a surface that touches itself change parts.
    fn goes_on(&self, face: usize) -> [bool; 2] {
        let SurfaceFace { ends, chain, .. } = self.opposite.faces[face];
        [ends[0] || (self.itself.is_some() && face == self.opposite.chains[chain].first), ends[1]]
    }

    /// The opposite faces that the node may touch.
    fn touchable(&self) -> impl Iterator<Item = &SurfaceFace> {
        let is_touchable = |face: usize| self.itself.as_ref().is_none_or(|itself| itself.is_touchable(face));
        self.opposite.faces.iter().enumerate().filter(move |(index, _)| is_touchable(*index)).map(|(_, face)| face)
    }

    /// Gap, position along the opposite surface, from that without displacements, and stretch. Where nothing is opposite, the gap is the distance of the node
    /// from the surface.
    fn values(&self, displacement: LocalDisplacements<'_>) -> (f64, f64, f64) {
        if self.opposite.is_revolved {
            self.values_of::<REVOLVED>(displacement)
        } else {
            self.values_of::<IN_PLANE>(displacement)
        }
    }

    fn values_of<const N: usize>(&self, displacement: LocalDisplacements<'_>) -> (f64, f64, f64) {
        let covered = self.covered::<N>(displacement);
        if covered.is_empty() {
            return (self.distance_of_node(displacement), 0.0, 1.0);
        }
        let faces: SmallVec<[(FaceAtNode, [f64; OF_FACE]); 2]> =
            covered.iter().map(|face| (face.at, face.moments_of_slip())).collect();
        let MeanAtNode { gap, place, stretch } = nodal_values(&faces);
        (gap, place, stretch)
    }

    fn each_column_of<const N: usize>(
        &self,
        displacement: LocalDisplacements<'_>,
        each: &mut dyn FnMut(usize, &Vector),
    ) {
        let covered = self.covered::<N>(displacement);
        if covered.is_empty() {
            return;
        }
        let [gap, place, stretch] = nodal_gradients(&covered);
        let mut met = MetNodes::default();
        let mut columns: SmallVec<[[PlaneVector; 2]; 12]> = SmallVec::new();
        for (row, (weights, factor)) in [(&place, stretch.value), (&gap, 1.0)].into_iter().enumerate() {
            each_gradient(&covered, &weights.gradient, |node, gradient| {
                let at = met.place(node);
                if at == columns.len() {
                    columns.push([[0.0; 2]; 2]);
                }
                columns[at][row][0] += factor * gradient[0];
                columns[at][row][1] += factor * gradient[1];
            });
        }
        for (node, [along, across]) in met.nodes.iter().zip(&columns) {
            (0..2).for_each(|k| each(2 * node + k, &[along[k], across[k], 0.0]));
        }
    }

    /// The distance of the node from the opposite surface.
    fn distance_of_node(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let place = self.position(displacement, 0);
        let distances = self.touchable().map(|face| distance_from_segment(place, self.ends(displacement, face)));
        distances.fold(self.farthest(), f64::min)
    }

    /// More than any distance that matters; finite at a node of a surface that touches itself, which may look at nothing.
    fn farthest(&self) -> f64 {
        if self.itself.is_some() { self.opposite.length() } else { f64::INFINITY }
    }

    /// The distance of the node's faces from the opposite surface.
    fn distance(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let opposite: Vec<[PlaneVector; 2]> =
            self.opposite.faces.iter().map(|face| self.ends(displacement, face)).collect();
        let of_face = |(which, own): (usize, &FaceOfNode)| {
            let face = own.nodes.map(|node| self.position(displacement, node));
            let seen = opposite.iter().enumerate().filter(|(other, _)| self.looks_at(which, *other));
            seen.map(|(_, other)| distance_of_segments(face, *other)).fold(f64::INFINITY, f64::min)
        };
        self.faces.iter().enumerate().map(of_face).fold(self.farthest(), f64::min)
    }
}

/// Whether a face is in front of one of a length, in whose frame its ends are: it runs the other way, and belongs neither to
/// another side of a corner nor to the far side of a body.
fn is_in_front([s_first, s_last]: [f64; 2], [h_first, h_last]: [f64; 2], length: f64) -> bool {
    let advance = s_first - s_last;
    advance > 0.0 && (h_first - h_last).abs() <= STEEPEST * advance && h_first.max(h_last) >= -DEEPEST * length
}

impl CoupledKinematics for MortarNode {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn own_nodes(&self) -> usize {
        self.places.len()
    }

    fn touched_nodes(&self) -> &[usize] {
        &self.opposite.nodes
    }

    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector {
        let (gap, place, _) = self.values(displacement);
        [place, gap - self.start.0, 0.0]
    }

    fn motion(&self, from: LocalDisplacements<'_>, to: LocalDisplacements<'_>) -> Vector {
        let ((gap, place, stretch), (last_gap, last_place, last_stretch)) = (self.values(from), self.values(to));
        let chain = self.opposite.faces.get(self.in_front(to).start).map_or(0, |face| face.chain);
        let way = self.opposite.way(chain, place, last_place);
        [0.5 * (stretch + last_stretch) * way, last_gap - gap, 0.0]
    }

    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector)) {
        if self.opposite.is_revolved {
            self.each_column_of::<REVOLVED>(displacement, each);
        } else {
            self.each_column_of::<IN_PLANE>(displacement, each);
        }
    }

    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let force = [force[0], force[1]];
        if self.opposite.is_revolved {
            second_derivatives::each(&self.covered::<REVOLVED>(displacement), force, add);
        } else {
            second_derivatives::each(&self.covered::<IN_PLANE>(displacement), force, add);
        }
    }

    fn rounding(&self) -> f64 {
        let lengths = self.faces.iter().map(|face| {
            let [first, last] = face.nodes.map(|node| self.places[node]);
            (last[0] - first[0]).hypot(last[1] - first[1])
        });
        f64::EPSILON * lengths.fold(0.0, f64::max)
    }

    fn distance_to_end(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let in_front = self.in_front(displacement);
        let mut most = f64::NEG_INFINITY;
        for (which, own) in self.faces.iter().enumerate() {
            let [first, last] = own.nodes.map(|node| self.position(displacement, node));
            let vector = difference(last, first);
            let length = product(vector, vector).sqrt();
            for index in in_front.clone().filter(|index| self.looks_at(which, *index)) {
                let ends = self.ends(displacement, &self.opposite.faces[index]).map(|end| difference(end, first));
                let [s_first, s_last] = ends.map(|end| product(vector, end) / length);
                if is_in_front([s_first, s_last], ends.map(|end| product(turned_left(vector), end) / length), length) {
                    most = most.max(s_first.min(length) - s_last.max(0.0) - LAST_COVERED * length);
                }
            }
        }
        most
    }

    fn clearance(&self, displacement: LocalDisplacements<'_>) -> Option<(f64, f64)> {
        // Points of faces move no farther than their nodes, and the two surfaces together by √2 at most.
        Some((self.distance(displacement), SQRT_2))
    }
}
