//! A node with its faces in front of an opposite surface: gap, motion and their derivatives, as the equations of the folder
//! have them.

use crate::mechanics::contact::bodies::space::covered_part::{Covered, CoveredPart, NodalMeans};
use crate::mechanics::contact::bodies::space::overlap::Overlap;
use crate::mechanics::contact::bodies::space::own_face::OwnFace;
use crate::mechanics::contact::bodies::space::projection::{MovedPoint, TriangleFrame};
use crate::mechanics::contact::bodies::space::second_derivatives;
use crate::mechanics::contact::bodies::space::surface::{
    FaceInSpace, SurfaceInSpace, SurfacePoint, area_vector, ball_around, distance_from_triangle, distance_of_triangles,
};
use crate::mechanics::contact::bodies::space::tangents::NodalTangents;
use crate::mechanics::contact::bodies::tolerances::{DEEPEST, LAST_COVERED, LEAST_COVERED};
use crate::mechanics::contact::kinematics::{CoupledKinematics, LocalDisplacements};
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};
use smallvec::SmallVec;
use std::f64::consts::SQRT_2;
use std::sync::{Arc, Mutex, PoisonError};

/// A node with its faces, in front of an opposite surface.
#[derive(Debug)]
pub struct MortarNodeInSpace {
    /// The node, the other nodes of its faces, the nodes of the opposite surface.
    nodes: Vec<usize>,
    faces: Vec<OwnFace>,
    /// Undeformed positions of the node and of the other nodes of its faces.
    places: Vec<Vector>,
    opposite: Arc<SurfaceInSpace>,
    /// Gap without displacements.
    start: f64,
    /// The last states that were asked for. A state depends on its displacements alone.
    recent: Mutex<RecentStates>,
}

/// The last states of a node, each with its displacements.
#[derive(Debug, Default)]
struct RecentStates {
    states: Vec<(Vec<f64>, Arc<NodeState>)>,
    /// The place of the next one.
    next: usize,
}

/// How many states are kept: the anchor of an increment, the iterate, and those beside.
const KEPT_STATES: usize = 4;

/// A state of the node.
#[derive(Debug)]
struct NodeState {
    /// The mean gap; where nothing is opposite, the distance of the node from the surface.
    gap: f64,
    /// The share of the faces that is covered.
    covered: f64,
    /// The nodes that move the contact, with the columns of their three displacements; none where nothing is opposite.
    columns: Vec<(usize, [Vector; 3])>,
    /// Tangents and normal.
    frame: [Vector; 3],
}

impl MortarNodeInSpace {
    /// The kinematics of the node `own` of `surface` (an index into its nodes) in front of an opposite surface; `is_held` says
    /// of a node of the structure whether it is supported.
    pub fn new(
        own: usize,
        surface: &SurfaceInSpace,
        opposite: Arc<SurfaceInSpace>,
        is_held: impl Fn(usize) -> bool,
    ) -> Self {
        let (mut local, mut faces) = (vec![own], Vec::new());
        for face in surface.faces_at(own) {
            let first = face.nodes.iter().position(|node| *node == own).unwrap_or(0);
            let rotated = face.nodes.iter().cycle().skip(first).take(face.nodes.len());
            let nodes = rotated.map(|node| {
                local.iter().position(|met| met == node).unwrap_or_else(|| {
                    local.push(*node);
                    local.len() - 1
                })
            });
            let nodes: SmallVec<[usize; 4]> = nodes.collect();
            let ends = nodes.iter().map(|_| false).collect();
            faces.push(FaceInSpace { nodes, ends, part: 0 });
        }
        let places: Vec<Vector> = local.iter().map(|node| surface.places[*node]).collect();
        let faces = faces.into_iter().map(|face| {
            let is_held = face.nodes.iter().any(|node| is_held(surface.nodes[local[*node]]));
            OwnFace::new(face, &places, is_held)
        });
        let faces = faces.collect();
        let nodes = local.iter().map(|node| surface.nodes[*node]).chain(opposite.nodes.iter().copied()).collect();
        let mut node = Self { nodes, faces, places, opposite, start: 0.0, recent: Mutex::new(RecentStates::default()) };
        node.start = node.state(&|_| 0.0).gap;
        node
    }

    /// The gap without displacements.
    pub fn initial_gap(&self) -> f64 {
        self.start
    }

    /// The number of nodes of the own surface.
    pub(super) fn own(&self) -> usize {
        self.places.len()
    }

    /// The present position of one of the own nodes.
    fn position(&self, displacement: LocalDisplacements<'_>, node: usize) -> Vector {
        let place = &self.places[node];
        [0, 1, 2].map(|k| place[k] + displacement(3 * node + k))
    }

    fn corners(&self, displacement: LocalDisplacements<'_>, face: &FaceInSpace) -> SmallVec<[Vector; 4]> {
        face.nodes.iter().map(|node| self.position(displacement, *node)).collect()
    }

    /// The distance of the node from the opposite surface, and the connected part that is nearest.
    fn nearest(&self, displacement: LocalDisplacements<'_>) -> (f64, usize) {
        let own = self.position(displacement, 0);
        let mut best = (f64::INFINITY, 0);
        for face in &self.opposite.faces {
            let places = self.opposite.present(face, self.places.len(), displacement);
            let (center, radius) = ball_around(&places);
            if size(&add(&own, -1.0, &center)) - radius >= best.0 {
                continue;
            }
            for triangle in face.triangles(&places, 0) {
                let distance = distance_from_triangle(&own, &triangle.points.map(|point| point.place));
                best = if distance < best.0 { (distance, face.part) } else { best };
            }
        }
        best
    }

    /// The parts of the node's faces that the opposite surface covers; none where they are next to nothing.
    pub(super) fn covered(&self, displacement: LocalDisplacements<'_>) -> Covered<'_> {
        let first = self.places.len();
        let several = self.opposite.faces.iter().any(|face| face.part > 0);
        let part = if several { self.nearest(displacement).1 } else { 0 };
        let opposite: Vec<_> = (self.opposite.faces.iter().filter(|face| face.part == part))
            .map(|face| {
                let places = self.opposite.present(face, first, displacement);
                let (center, radius) = ball_around(&places);
                (face, places, center, radius)
            })
            .collect();
        let mut parts = Vec::with_capacity(64);
        let mut faces = SmallVec::new();
        let (mut covered, mut whole) = (0.0, 0.0);
        for (number, own_face) in self.faces.iter().enumerate() {
            let corners = self.corners(displacement, &own_face.face);
            let (center, radius) = ball_around(&corners);
            let normal = unit(&area_vector(&corners));
            let size_of_face = size(&area_vector(&corners)).sqrt();
            let beside = opposite.iter().filter(|(_, _, other, reach)| {
                let from = add(other, -1.0, &center);
                let height = dot(&from, &normal);
                // The triangles of a warped face have normals of their own: they turn by less than this.
                size(&add(&from, -height, &normal)) <= radius + reach + 0.5 * height.abs()
                    && height + reach >= -DEEPEST * size_of_face
            });
            let beside: SmallVec<[_; 16]> = beside.collect();
            let begin = parts.len();
            let triangles = own_face.face.triangles(&corners, 0);
            for ((own, scale), functions) in triangles.into_iter().zip(&own_face.areas).zip(&own_face.functions) {
                let Some(frame) = TriangleFrame::new(&own.points.map(|point| point.place)) else { continue };
                let own_points = own.points.map(|point| self.moved_point(displacement, &point));
                whole += scale * functions[0].iter().sum::<f64>() / 6.0;
                for (other, places, ..) in &beside {
                    for opposite in other.triangles(places, first) {
                        let mut projected = opposite.points.map(|point| frame.project(&point.place));
                        let highest = projected.iter().map(|point| point.height).fold(f64::NEG_INFINITY, f64::max);
                        if highest < -DEEPEST * size_of_face {
                            continue;
                        }
                        let Some(overlap) = Overlap::new(projected.map(|point| point.xi)) else { continue };
                        for (at, point) in projected.iter_mut().zip(&opposite.points) {
                            at.height = frame.height(&own_points, &self.moved_point(displacement, point));
                        }
                        parts.push(CoveredPart {
                            own,
                            frame,
                            opposite,
                            projected,
                            overlap,
                            slip: overlap,
                            scale: *scale,
                            face: number,
                            functions: *functions,
                            slips_by_shape: own_face.is_held,
                        });
                    }
                }
            }
            let of_face = &mut parts[begin..];
            let cover = own_face.cover(of_face.iter().map(|part| part.area()).sum());
            for part in of_face {
                let by_shape = part.overlap.weighted(part.functions[0]);
                part.overlap = by_shape;
                covered += part.area();
                part.overlap = part.overlap.weighted(cover.blended(&part.functions));
                part.slip = if part.slips_by_shape { by_shape } else { part.overlap };
            }
            faces.push(cover);
        }
        let share = covered / whole;
        let parts = if share > LEAST_COVERED { parts } else { Vec::new() };
        Covered { parts, faces, share }
    }

    /// The undeformed place of one of the contact's nodes.
    fn place_of(&self, node: usize) -> Vector {
        let own = self.places.len();
        if node < own { self.places[node] } else { self.opposite.places[node - own] }
    }

    /// The change of the way from the node to another one of the contact's.
    fn change_of_way(&self, displacement: LocalDisplacements<'_>, node: usize) -> Vector {
        [0, 1, 2].map(|k| displacement(3 * node + k) - displacement(k))
    }

    /// A point of the surfaces, its displacement apart from its place.
    fn moved_point(&self, displacement: LocalDisplacements<'_>, point: &SurfacePoint<'_>) -> MovedPoint {
        let mut moved = MovedPoint { place: [0.0; 3], moved: [0.0; 3] };
        for (node, share) in point.shares() {
            moved.place = add(&moved.place, share, &self.place_of(node));
            (0..3).for_each(|k| moved.moved[k] += share * displacement(3 * node + k));
        }
        moved
    }

    /// The state at displacements, kept or computed.
    fn state(&self, displacement: LocalDisplacements<'_>) -> Arc<NodeState> {
        let values: Vec<f64> = (0..3 * self.nodes.len()).map(displacement).collect();
        let same = |kept: &[f64]| kept.iter().zip(&values).all(|(one, other)| one.to_bits() == other.to_bits());
        {
            let recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some((_, state)) = recent.states.iter().find(|(kept, _)| same(kept)) {
                return Arc::clone(state);
            }
        }
        let state = Arc::new(self.computed(displacement));
        let mut recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        let next = recent.next;
        let entry = (values, Arc::clone(&state));
        match recent.states.get_mut(next) {
            Some(kept) => *kept = entry,
            None => recent.states.push(entry),
        }
        recent.next = (next + 1) % KEPT_STATES;
        state
    }

    fn computed(&self, displacement: LocalDisplacements<'_>) -> NodeState {
        let covered = self.covered(displacement);
        let tangents = self.tangents(displacement).tangents;
        let frame = [tangents[0], tangents[1], cross(&tangents[0], &tangents[1])];
        let Some(means) = NodalMeans::new(&covered.parts) else {
            return NodeState { gap: self.nearest(displacement).0, covered: covered.share, columns: Vec::new(), frame };
        };
        let mut columns: Vec<(usize, [Vector; 3])> = Vec::new();
        let mut add_row = |part: &CoveredPart<'_>, row: usize, gradient: &[Vector; 6], factor: f64| {
            part.each_node(gradient, &mut |node, vector| {
                let at = columns.iter().position(|(met, _)| *met == node).unwrap_or_else(|| {
                    columns.push((node, [[0.0; 3]; 3]));
                    columns.len() - 1
                });
                (0..3).for_each(|k| columns[at].1[k][row] += factor * vector[k]);
            });
        };
        let inverse = 1.0 / means.area;
        for part in &covered.parts {
            let [first, second] = part.along(&means, &tangents);
            add_row(part, 0, &first, 1.0 / means.slip_area);
            add_row(part, 1, &second, 1.0 / means.slip_area);
            add_row(part, 2, &part.gradient(&part.heights_from(means.gap)), inverse);
        }
        for (face, cover) in covered.faces.iter().enumerate().filter(|(_, cover)| cover.slopes[0] != 0.0) {
            let by_dual = covered.by_dual(face, means.gap);
            for part in covered.of_face(face) {
                add_row(part, 2, &part.plain().gradient_of_area(), inverse * by_dual * cover.slopes[0]);
            }
        }
        NodeState { gap: means.gap, covered: covered.share, columns, frame }
    }

    pub(super) fn tangents(&self, displacement: LocalDisplacements<'_>) -> NodalTangents {
        let vectors = self.faces.iter().map(|own| area_vector(&self.corners(displacement, &own.face)));
        let normal = vectors.fold([0.0; 3], |sum, vector| add(&sum, 1.0, &vector));
        let end = self.faces.first().map_or(0, |own| own.face.nodes[1]);
        let edge = add(&self.position(displacement, end), -1.0, &self.position(displacement, 0));
        NodalTangents::new(normal, edge)
    }

    /// Calls `each` with the degrees of freedom of the own nodes and the changes of the tangents with them.
    pub(super) fn each_change_of_tangents(
        &self,
        displacement: LocalDisplacements<'_>,
        each: &mut dyn FnMut(usize, [Vector; 2]),
    ) {
        let tangents = self.tangents(displacement);
        let end = self.faces.first().map_or(0, |own| own.face.nodes[1]);
        let mut normals = vec![[[0.0; 3]; 3]; self.places.len()];
        for OwnFace { face, .. } in &self.faces {
            let (corners, count) = (self.corners(displacement, face), face.nodes.len());
            for (k, node) in face.nodes.iter().enumerate() {
                // The area vector is half the sum of the products of each place with the next.
                let chord = add(&corners[(k + 1) % count], -1.0, &corners[(k + count - 1) % count]);
                for (axis, change) in normals[*node].iter_mut().enumerate() {
                    let mut moved = [0.0; 3];
                    moved[axis] = 0.5;
                    *change = add(change, 1.0, &cross(&moved, &chord));
                }
            }
        }
        for (node, changes) in normals.iter().enumerate() {
            for (axis, normal) in changes.iter().enumerate() {
                let mut edge = [0.0; 3];
                edge[axis] = f64::from(u8::from(node == end)) - f64::from(u8::from(node == 0));
                each(3 * node + axis, tangents.changes(normal, &edge));
            }
        }
    }

    /// The distance of the node's faces from the opposite surface.
    fn distance(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let first = self.places.len();
        let mut least = f64::INFINITY;
        let own: SmallVec<[_; 8]> = self.faces.iter().map(|own| self.corners(displacement, &own.face)).collect();
        for other in &self.opposite.faces {
            let places = self.opposite.present(other, first, displacement);
            let (center, radius) = ball_around(&places);
            for (OwnFace { face, .. }, corners) in self.faces.iter().zip(&own) {
                let (own_center, own_radius) = ball_around(corners);
                if size(&add(&center, -1.0, &own_center)) - radius - own_radius >= least {
                    continue;
                }
                for one in face.triangles(corners, 0) {
                    for two in other.triangles(&places, 0) {
                        let corners = [one, two].map(|triangle| triangle.points.map(|point| point.place));
                        least = least.min(distance_of_triangles(&corners[0], &corners[1]));
                    }
                }
            }
        }
        least
    }
}

/// The change of a vector that turns as one frame does into another:
///
/// ```text
/// (R - I) v = s × v + s × (s × v)/(1 + cos θ),     s = sin θ a = ½ Σ_k e_k × R e_k,     1 + 2 cos θ = Σ_k e_k·R e_k
/// ```
///
/// What rounding leaves in the frames turns the vector, and no more: the rows of a contact do not see that.
fn change_by_turn(from: &[Vector; 3], to: &[Vector; 3], vector: &Vector) -> Vector {
    let pairs = || from.iter().zip(to);
    let sum = pairs().fold([0.0; 3], |sum, (axis, turned)| add(&sum, 1.0, &cross(axis, turned)));
    let (sine, cosine) =
        (scaled(&sum, 0.5), 0.5 * (pairs().map(|(axis, turned)| dot(axis, turned)).sum::<f64>() - 1.0));
    let across = cross(&sine, vector);
    add(&across, 1.0 / (1.0 + cosine), &cross(&sine, &across))
}

impl CoupledKinematics for MortarNodeInSpace {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn own_nodes(&self) -> usize {
        self.places.len()
    }

    /// The gap alone: there are no coordinates along a surface in space.
    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector {
        [0.0, 0.0, self.state(displacement).gap - self.start]
    }

    /// The chord in axes that turn with the node, times the mean of the rows before and after: of second order, and zero
    /// for a common rigid motion.
    fn motion(&self, from: LocalDisplacements<'_>, to: LocalDisplacements<'_>) -> Vector {
        let (before, after) = (self.state(from), self.state(to));
        let mut motion = [0.0, 0.0, after.gap - before.gap];
        if before.columns.is_empty() || after.columns.is_empty() {
            return motion;
        }
        for (own, other, sign) in [(&before, &after, -1.0), (&after, &before, 1.0)] {
            for (node, columns) in &own.columns {
                let (start, end) = (self.change_of_way(from, *node), self.change_of_way(to, *node));
                let (here, there) = if sign < 0.0 { (start, end) } else { (end, start) };
                let way = add(&add(&self.place_of(*node), -1.0, &self.places[0]), 1.0, &there);
                let turned = change_by_turn(&other.frame, &own.frame, &way);
                let chord = add(&add(&here, -1.0, &there), -1.0, &turned);
                for (column, part) in columns.iter().zip(chord) {
                    (0..2).for_each(|row| motion[row] += 0.5 * sign * part * column[row]);
                }
            }
        }
        motion
    }

    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector)) {
        for (node, columns) in &self.state(displacement).columns {
            columns.iter().enumerate().for_each(|(k, column)| each(3 * node + k, column));
        }
    }

    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        second_derivatives::each(self, displacement, force, add);
    }

    fn rounding(&self) -> f64 {
        let lengths = self.places.iter().map(|place| size(&add(place, -1.0, &self.places[0])));
        f64::EPSILON * lengths.fold(0.0, f64::max)
    }

    fn distance_to_end(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let whole: f64 = self.faces.iter().flat_map(|face| &face.areas).sum();
        (self.state(displacement).covered - LAST_COVERED) * whole.sqrt()
    }

    fn clearance(&self, displacement: LocalDisplacements<'_>) -> Option<(f64, f64)> {
        // Points of faces move no farther than their nodes, and the two surfaces together by √2 at most.
        Some((self.distance(displacement), SQRT_2))
    }
}
