//! Surfaces of triangles and quadrilaterals in space.

use crate::mechanics::contact::bodies::tolerances::SAME_DISTANCE;
use crate::mechanics::contact::kinematics::LocalDisplacements;
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size};
use smallvec::SmallVec;
use std::collections::HashMap;

/// A surface whose normals point to its free side: the nodes of a face run counter-clockwise as seen from there.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceInSpace {
    /// Numbers of the nodes, each once.
    pub nodes: Vec<usize>,
    /// Undeformed positions of the nodes.
    pub places: Vec<Vector>,
    pub faces: Vec<FaceInSpace>,
}

/// A triangle or a quadrilateral.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceInSpace {
    /// The nodes, as indices into those of the surface.
    pub nodes: SmallVec<[usize; 4]>,
    /// For each edge, from a node to the next, whether the surface ends there.
    pub ends: SmallVec<[bool; 4]>,
    /// Number of the connected part of the surface.
    pub part: usize,
}

/// Why faces make no surface; indices are numbers of the structure's nodes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SurfaceInSpaceError {
    #[error("more than two faces share an edge, or two that face opposite sides")]
    Branches([usize; 2]),
    #[error("a face has no area")]
    NoArea(Vec<usize>),
}

/// A point that moves with nodes: a corner of a face, or the centre of a quadrilateral.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfacePoint<'a> {
    /// The nodes, each with the same share; indices of the surface's, from `first` on.
    nodes: &'a [usize],
    first: usize,
    pub place: Vector,
}

/// A triangle of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceTriangle<'a> {
    pub points: [SurfacePoint<'a>; 3],
    /// Whether the surface ends at the edge from each point to the next.
    pub ends: [bool; 3],
}

impl<'a> SurfacePoint<'a> {
    /// The nodes of the point, and the share of each.
    pub fn shares(&self) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        let (share, first) = (1.0 / self.nodes.len() as f64, self.first);
        self.nodes.iter().map(move |node| (first + node, share))
    }
}

impl FaceInSpace {
    /// The triangles of a face with nodes at `places`; `first` is the index of the surface's first node among those of the
    /// contact.
    pub(super) fn triangles<'a>(&'a self, places: &[Vector], first: usize) -> SmallVec<[FaceTriangle<'a>; 4]> {
        let corner = |at: usize| SurfacePoint { nodes: &self.nodes[at..=at], first, place: places[at] };
        if let [first, second, third] = self.ends[..] {
            return SmallVec::from_iter([FaceTriangle {
                points: [corner(0), corner(1), corner(2)],
                ends: [first, second, third],
            }]);
        }
        let count = self.nodes.len();
        let sum = places.iter().fold([0.0; 3], |sum, place| add(&sum, 1.0, place));
        let center = SurfacePoint { nodes: &self.nodes, first, place: scaled(&sum, 1.0 / count as f64) };
        let around = (0..count).map(|at| FaceTriangle {
            points: [corner(at), corner((at + 1) % count), center],
            ends: [self.ends[at], false, false],
        });
        around.collect()
    }
}

/// The sum of the area vectors of a face's triangles.
pub(super) fn area_vector(places: &[Vector]) -> Vector {
    let Some(first) = places.first() else { return [0.0; 3] };
    let from = |place: &Vector| add(place, -1.0, first);
    let parts = places.windows(2).map(|two| scaled(&cross(&from(&two[0]), &from(&two[1])), 0.5));
    parts.fold([0.0; 3], |sum, part| add(&sum, 1.0, &part))
}

impl SurfaceInSpace {
    /// The surface of faces, each given by the numbers of its nodes in order; `place` gives undeformed positions.
    ///
    /// # Errors
    /// Where an edge has more than two faces or two of opposite sides, or a face has no area.
    pub fn new(faces: &[SmallVec<[usize; 4]>], place: impl Fn(usize) -> Vector) -> Result<Self, SurfaceInSpaceError> {
        let mut by_edge: HashMap<[usize; 2], usize> = HashMap::new();
        let edges = |face: &SmallVec<[usize; 4]>| {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).map(|(one, other)| [*one, *other]).collect::<SmallVec<[[usize; 2]; 4]>>()
        };
        for (index, face) in faces.iter().enumerate() {
            let places: SmallVec<[Vector; 4]> = face.iter().map(|node| place(*node)).collect();
            if size(&area_vector(&places)) <= 0.0 {
                return Err(SurfaceInSpaceError::NoArea(face.to_vec()));
            }
            for edge in edges(face) {
                if by_edge.insert(edge, index).is_some() {
                    return Err(SurfaceInSpaceError::Branches(edge));
                }
            }
        }
        let mut surface = Self { nodes: Vec::new(), places: Vec::new(), faces: Vec::new() };
        let mut index_of: HashMap<usize, usize> = HashMap::new();
        for face in faces {
            let nodes = face.iter().map(|node| {
                *index_of.entry(*node).or_insert_with(|| {
                    surface.nodes.push(*node);
                    surface.places.push(place(*node));
                    surface.nodes.len() - 1
                })
            });
            let nodes = nodes.collect();
            let ends = edges(face).iter().map(|[one, other]| !by_edge.contains_key(&[*other, *one])).collect();
            surface.faces.push(FaceInSpace { nodes, ends, part: usize::MAX });
        }
        // Parts, from the first face of each over its edges.
        let mut parts = 0;
        for start in 0..faces.len() {
            let mut waiting = if surface.faces[start].part == usize::MAX { vec![start] } else { Vec::new() };
            parts += waiting.len();
            while let Some(face) = waiting.pop() {
                surface.faces[face].part = parts - 1;
                let beside = edges(&faces[face]).into_iter().filter_map(|[one, other]| by_edge.get(&[other, one]));
                waiting.extend(beside.filter(|beside| surface.faces[**beside].part == usize::MAX));
            }
        }
        Ok(surface)
    }

    /// The faces at a node (an index into `nodes`).
    pub fn faces_at(&self, node: usize) -> impl Iterator<Item = &FaceInSpace> {
        self.faces.iter().filter(move |face| face.nodes.contains(&node))
    }

    /// The present places of a face's nodes; `first` is the index of the surface's first node among those of the contact.
    pub(super) fn present(
        &self,
        face: &FaceInSpace,
        first: usize,
        displacement: LocalDisplacements<'_>,
    ) -> SmallVec<[Vector; 4]> {
        let moved = |node: &usize| {
            let freedom = 3 * (first + node);
            let place = &self.places[*node];
            [
                place[0] + displacement(freedom),
                place[1] + displacement(freedom + 1),
                place[2] + displacement(freedom + 2),
            ]
        };
        face.nodes.iter().map(moved).collect()
    }

    /// Whether a point is on the free side of the undeformed surface, or beyond an end of it.
    pub fn is_free(&self, point: Vector) -> bool {
        // At an edge several triangles are nearest; the one that the point is more across decides.
        let mut best = (f64::INFINITY, 0.0);
        for face in &self.faces {
            let places = self.present(face, 0, &|_| 0.0);
            for triangle in face.triangles(&places, 0) {
                let corners = triangle.points.map(|point| point.place);
                let normal = cross(&add(&corners[1], -1.0, &corners[0]), &add(&corners[2], -1.0, &corners[0]));
                let across = if is_beyond(&point, &corners, triangle.ends) {
                    f64::INFINITY
                } else {
                    dot(&normal, &add(&point, -1.0, &corners[0])) / size(&normal)
                };
                let distance = distance_from_triangle(&point, &corners);
                let is_as_near = (distance - best.0).abs() <= SAME_DISTANCE * distance;
                if (is_as_near && across.abs() > f64::abs(best.1)) || (!is_as_near && distance < best.0) {
                    best = (distance, across);
                }
            }
        }
        best.1 > 0.0
    }
}

/// The distance of a point from a segment.
fn distance_from_segment(point: &Vector, [first, last]: [&Vector; 2]) -> f64 {
    let (along, from) = (add(last, -1.0, first), add(point, -1.0, first));
    let square = dot(&along, &along);
    let share = if square > 0.0 { (dot(&along, &from) / square).clamp(0.0, 1.0) } else { 0.0 };
    size(&add(&from, -share, &along))
}

/// Whether a point is beyond an edge of a triangle at which the surface ends.
fn is_beyond(point: &Vector, corners: &[Vector; 3], ends: [bool; 3]) -> bool {
    let normal = cross(&add(&corners[1], -1.0, &corners[0]), &add(&corners[2], -1.0, &corners[0]));
    (0..3).filter(|k| ends[*k]).any(|k| {
        let edge = add(&corners[(k + 1) % 3], -1.0, &corners[k]);
        let inward = cross(&normal, &edge);
        dot(&inward, &add(point, -1.0, &corners[k])) < -SAME_DISTANCE * size(&inward) * size(&edge)
    })
}

/// The distance of a point from a triangle.
pub(super) fn distance_from_triangle(point: &Vector, corners: &[Vector; 3]) -> f64 {
    let normal = cross(&add(&corners[1], -1.0, &corners[0]), &add(&corners[2], -1.0, &corners[0]));
    let is_above = (0..3).all(|k| {
        let edge = add(&corners[(k + 1) % 3], -1.0, &corners[k]);
        dot(&cross(&normal, &edge), &add(point, -1.0, &corners[k])) >= 0.0
    });
    let length = size(&normal);
    if is_above && length > 0.0 {
        return (dot(&normal, &add(point, -1.0, &corners[0])) / length).abs();
    }
    let edges = (0..3).map(|k| distance_from_segment(point, [&corners[k], &corners[(k + 1) % 3]]));
    edges.fold(f64::INFINITY, f64::min)
}

/// The distance of two segments.
fn distance_of_segments(one: [&Vector; 2], other: [&Vector; 2]) -> f64 {
    let (d, e) = (add(one[1], -1.0, one[0]), add(other[1], -1.0, other[0]));
    let from = add(one[0], -1.0, other[0]);
    let (dd, de, ee) = (dot(&d, &d), dot(&d, &e), dot(&e, &e));
    let determinant = dd * ee - de * de;
    if determinant > 0.0 {
        let s = (de * dot(&e, &from) - ee * dot(&d, &from)) / determinant;
        let t = (dd * dot(&e, &from) - de * dot(&d, &from)) / determinant;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return size(&add(&add(&from, s, &d), -t, &e));
        }
    }
    let points = one.map(|point| distance_from_segment(point, other));
    let others = other.map(|point| distance_from_segment(point, one));
    points.into_iter().chain(others).fold(f64::INFINITY, f64::min)
}

/// The distance of two triangles; 0 where they cross.
pub(super) fn distance_of_triangles(one: &[Vector; 3], other: &[Vector; 3]) -> f64 {
    if crosses(one, other) || crosses(other, one) {
        return 0.0;
    }
    let corners = one.iter().map(|point| distance_from_triangle(point, other));
    let others = other.iter().map(|point| distance_from_triangle(point, one));
    let edge = |corners: &'_ [Vector; 3], k: usize| [corners[k], corners[(k + 1) % 3]];
    let edges = (0..9).map(|k| {
        let (a, b) = (edge(one, k / 3), edge(other, k % 3));
        distance_of_segments([&a[0], &a[1]], [&b[0], &b[1]])
    });
    corners.chain(others).chain(edges).fold(f64::INFINITY, f64::min)
}

/// Whether an edge of one triangle goes through the other.
fn crosses(one: &[Vector; 3], other: &[Vector; 3]) -> bool {
    let volume = |a: &Vector, b: &Vector, c: &Vector, d: &Vector| {
        dot(&cross(&add(b, -1.0, a), &add(c, -1.0, a)), &add(d, -1.0, a))
    };
    let [a, b, c] = other;
    (0..3).any(|k| {
        let (start, end) = (&one[k], &one[(k + 1) % 3]);
        if volume(a, b, c, start) * volume(a, b, c, end) >= 0.0 {
            return false;
        }
        let sides = [volume(start, end, a, b), volume(start, end, b, c), volume(start, end, c, a)];
        sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
    })
}

/// The centre of a face and the radius around it.
pub(super) fn ball_around(places: &[Vector]) -> (Vector, f64) {
    let sum = places.iter().fold([0.0; 3], |sum, place| add(&sum, 1.0, place));
    let center = scaled(&sum, 1.0 / places.len() as f64);
    (center, places.iter().map(|place| size(&add(place, -1.0, &center))).fold(0.0, f64::max))
}
