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

use crate::mechanics::contact::bodies::covered_face::{
    CoveredFace, CoveringPiece, MetNodes, each_gradient, nodal_gradients,
};
use crate::mechanics::contact::bodies::face_moments::{FaceAtNode, MeanAtNode, OF_FACE, nodal_values};
use crate::mechanics::contact::bodies::opposite_surface::{
    OppositeSurface, SurfaceFace, distance_from_segment, distance_of_segments,
};
use crate::mechanics::contact::bodies::second_derivatives;
use crate::mechanics::contact::bodies::tolerances::{DEEPEST, LAST_COVERED, LEAST_COVERED};
use crate::mechanics::contact::bodies::{PlaneVector, difference, product, turned_left};
use crate::mechanics::contact::kinematics::{CoupledKinematics, LocalDisplacements};
use crate::mechanics::contact::vector::Vector;
use smallvec::SmallVec;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// A node with its faces, in front of an opposite surface.
#[derive(Debug, Clone)]
pub struct MortarNode {
    /// The node, its neighbours on its own surface, the nodes of the opposite surface.
    nodes: Vec<usize>,
    /// The faces at the node, each with its first and last node as indices into `nodes`.
    faces: SmallVec<[[usize; 2]; 2]>,
    /// Undeformed positions of the node and its neighbours.
    places: SmallVec<[PlaneVector; 3]>,
    opposite: Arc<OppositeSurface>,
    /// Gap and position along the opposite surface without displacements.
    start: (f64, f64),
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
            faces.push([nodes.len(), 0]);
            nodes.push(before);
        }
        if let Some(after) = after {
            faces.push([0, nodes.len()]);
            nodes.push(after);
        }
        let places = nodes.iter().map(|node| place(*node)).collect();
        nodes.extend(&opposite.nodes);
        let mut node = Self { nodes, faces, places, opposite, start: (0.0, 0.0) };
        let (gap, place, _) = node.values(&|_| 0.0);
        node.start = (gap, place);
        node
    }

    /// The gap without displacements.
    pub fn initial_gap(&self) -> f64 {
        self.start.0
    }

    /// The present position of a node by its index into `nodes`.
    fn position(&self, displacement: LocalDisplacements<'_>, node: usize) -> PlaneVector {
        let own = self.places.len();
        let place = if node < own { self.places[node] } else { self.opposite.places[node - own] };
        [place[0] + displacement(2 * node), place[1] + displacement(2 * node + 1)]
    }

    /// The chain of the opposite surface that is nearest to the node.
    fn chain(&self, displacement: LocalDisplacements<'_>) -> usize {
        if self.opposite.chains.len() == 1 {
            return 0;
        }
        let (own, place) = (self.places.len(), self.position(displacement, 0));
        let distance = |face: &SurfaceFace| {
            distance_from_segment(place, face.nodes.map(|node| self.position(displacement, own + node)))
        };
        let nearest = self.opposite.faces.iter().map(|face| (distance(face), face.chain));
        nearest.fold((f64::INFINITY, 0), |best, other| if other.0 < best.0 { other } else { best }).1
    }

    /// The faces with what is opposite; none where no part of any is covered.
    fn covered(&self, displacement: LocalDisplacements<'_>) -> SmallVec<[CoveredFace; 2]> {
        let own = self.places.len();
        let chain = self.chain(displacement);
        let mut reference: Option<f64> = None;
        let mut is_covered = false;
        let mut all = SmallVec::new();
        for nodes in &self.faces {
            let [first, last] = nodes.map(|node| self.position(displacement, node));
            let vector = difference(last, first);
            let length = product(vector, vector).sqrt();
            let along = vector.map(|part| part / length);
            let normal = turned_left(along);
            let mut pieces: SmallVec<[CoveringPiece; 4]> = SmallVec::new();
            let (mut area, mut centre) = (0.0, 0.0);
            for face in self.opposite.faces.iter().filter(|face| face.chain == chain) {
                let ends = face.nodes.map(|node| difference(self.position(displacement, own + node), first));
                let [s_first, s_last] = ends.map(|end| product(along, end));
                // Faces that look the other way run the other way; those far behind belong to the far side of a body.
                let [h_first, h_last] = ends.map(|end| product(normal, end));
                if s_last >= s_first || h_first.max(h_last) < -DEEPEST * length {
                    continue;
                }
                is_covered |= s_first.min(length) - s_last.max(0.0) > LEAST_COVERED * length;
                let high = if face.ends[0] { length } else { s_first.min(length) };
                let low = if face.ends[1] { 0.0 } else { s_last.max(0.0) };
                let width = high - low;
                if width <= LEAST_COVERED * length {
                    continue;
                }
                // Around a closed surface coordinates jump; all are counted from the first.
                let from = *reference.get_or_insert(face.along[0]);
                let shift = from + self.opposite.way(chain, from, face.along[0]) - face.along[0];
                area += width;
                centre += width * 0.5 * (high + low);
                pieces.push(CoveringPiece {
                    nodes: face.nodes.map(|node| own + node),
                    values: [length, s_first, h_first, s_last, h_last],
                    along: face.along.map(|place| place + shift),
                    goes_on: face.ends,
                });
            }
            if !pieces.is_empty() {
                let at = FaceAtNode { is_last: nodes[1] == 0, from: centre / area };
                all.push(CoveredFace { nodes: *nodes, at, length, along, pieces });
            }
        }
        if is_covered { all } else { SmallVec::new() }
    }

    /// Gap, position along the opposite surface and stretch. Where nothing is opposite, the gap is the distance of the node
    /// from the surface.
    fn values(&self, displacement: LocalDisplacements<'_>) -> (f64, f64, f64) {
        let covered = self.covered(displacement);
        if covered.is_empty() {
            return (self.distance_of_node(displacement), self.start.1, 1.0);
        }
        let faces: SmallVec<[(FaceAtNode, [f64; OF_FACE]); 2]> =
            covered.iter().map(|face| (face.at, face.moments())).collect();
        let MeanAtNode { gap, place, stretch } = nodal_values(&faces);
        (gap, place, stretch)
    }

    /// The distance of the node from the opposite surface.
    fn distance_of_node(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let (own, place) = (self.places.len(), self.position(displacement, 0));
        let ends = |face: &SurfaceFace| face.nodes.map(|node| self.position(displacement, own + node));
        let distances = self.opposite.faces.iter().map(|face| distance_from_segment(place, ends(face)));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The distance of the node's faces from the opposite surface.
    fn distance(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let own = self.places.len();
        let faces = self.faces.iter().map(|nodes| nodes.map(|node| self.position(displacement, node)));
        let opposite: Vec<[PlaneVector; 2]> = self
            .opposite
            .faces
            .iter()
            .map(|face| face.nodes.map(|node| self.position(displacement, own + node)))
            .collect();
        let between = |face: [PlaneVector; 2]| opposite.iter().map(move |other| distance_of_segments(face, *other));
        faces.flat_map(between).fold(f64::INFINITY, f64::min)
    }
}

impl CoupledKinematics for MortarNode {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn own_nodes(&self) -> usize {
        self.places.len()
    }

    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector {
        let (gap, place, _) = self.values(displacement);
        [place - self.start.1, gap - self.start.0, 0.0]
    }

    fn motion(&self, from: LocalDisplacements<'_>, to: LocalDisplacements<'_>) -> Vector {
        let ((gap, place, stretch), (last_gap, last_place, last_stretch)) = (self.values(from), self.values(to));
        let way = self.opposite.way(self.chain(to), place, last_place);
        [0.5 * (stretch + last_stretch) * way, last_gap - gap, 0.0]
    }

    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector)) {
        let covered = self.covered(displacement);
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

    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let covered = self.covered(displacement);
        if !covered.is_empty() {
            second_derivatives::each(&covered, [force[0], force[1]], add);
        }
    }

    fn distance_to_end(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let (own, chain) = (self.places.len(), self.chain(displacement));
        let mut most = f64::NEG_INFINITY;
        for nodes in &self.faces {
            let [first, last] = nodes.map(|node| self.position(displacement, node));
            let vector = difference(last, first);
            let length = product(vector, vector).sqrt();
            for face in self.opposite.faces.iter().filter(|face| face.chain == chain) {
                let ends = face.nodes.map(|node| difference(self.position(displacement, own + node), first));
                let [s_first, s_last] = ends.map(|end| product(vector, end) / length);
                if s_last < s_first {
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
