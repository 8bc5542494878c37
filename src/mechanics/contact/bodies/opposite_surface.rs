//! The surface that a node of another body is in front of, in the plane.

use crate::mechanics::contact::bodies::tolerances::SAME_DISTANCE;
use crate::mechanics::contact::bodies::{PlaneVector, difference, product, turned_left};
use std::collections::HashMap;

/// A surface of straight faces, free to the left of the order of their nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct OppositeSurface {
    /// Numbers of the nodes, each once.
    pub nodes: Vec<usize>,
    /// Undeformed positions of the nodes.
    pub places: Vec<PlaneVector>,
    /// The faces, chain by chain, each with its two nodes as indices into `nodes`.
    pub faces: Vec<SurfaceFace>,
    /// The chains of faces, one after the other.
    pub chains: Vec<FaceChain>,
    /// Whether it is that of a body of revolution, the first coordinate being the distance from the axis.
    pub is_revolved: bool,
}

/// A straight face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceFace {
    pub nodes: [usize; 2],
    /// Coordinates of the nodes along the undeformed chain.
    pub along: [f64; 2],
    /// Index of the chain.
    pub chain: usize,
    /// Whether the chain ends at the first and at the last node.
    pub ends: [bool; 2],
}

/// Faces that follow one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceChain {
    /// Index of the first face.
    pub first: usize,
    /// Number of faces.
    pub count: usize,
    /// Length of the undeformed chain, if its end is its beginning.
    pub period: Option<f64>,
}

/// Why faces make no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SurfaceError {
    /// Index of the node, by number of the structure.
    #[error("more than one face begins, or ends, at a node")]
    Branches(usize),
    /// Numbers of the two nodes of a face.
    #[error("a face has no length")]
    NoLength([usize; 2]),
}

impl OppositeSurface {
    /// The surface of faces, each given by the numbers of its two nodes in order; `place` gives undeformed positions.
    /// Chains are in the order of their first faces.
    ///
    /// # Errors
    /// Where two faces begin or two end at one node, or a face has no length.
    pub fn new(faces: &[[usize; 2]], place: impl Fn(usize) -> PlaneVector) -> Result<Self, SurfaceError> {
        let mut beginning: HashMap<usize, usize> = HashMap::new();
        let mut ending: HashMap<usize, usize> = HashMap::new();
        for (index, [first, last]) in faces.iter().enumerate() {
            if beginning.insert(*first, index).is_some() {
                return Err(SurfaceError::Branches(*first));
            }
            if ending.insert(*last, index).is_some() {
                return Err(SurfaceError::Branches(*last));
            }
        }
        let mut surface =
            Self { nodes: Vec::new(), places: Vec::new(), faces: Vec::new(), chains: Vec::new(), is_revolved: false };
        let mut index_of: HashMap<usize, usize> = HashMap::new();
        let mut taken = vec![false; faces.len()];
        for given in 0..faces.len() {
            if taken[given] {
                continue;
            }
            // Back to the beginning of the chain, or around to the same face.
            let mut first = given;
            while let Some(before) = ending.get(&faces[first][0]).copied().filter(|before| *before != given) {
                first = before;
            }
            let chain = FaceChain { first: surface.faces.len(), count: 0, period: None };
            let (mut face, mut along) = (first, 0.0);
            let period = loop {
                taken[face] = true;
                let nodes = faces[face].map(|node| {
                    *index_of.entry(node).or_insert_with(|| {
                        surface.nodes.push(node);
                        surface.places.push(place(node));
                        surface.nodes.len() - 1
                    })
                });
                let vector = difference(surface.places[nodes[1]], surface.places[nodes[0]]);
                let end = along + product(vector, vector).sqrt();
                if end <= along {
                    return Err(SurfaceError::NoLength(faces[face]));
                }
                surface.faces.push(SurfaceFace {
                    nodes,
                    along: [along, end],
                    chain: surface.chains.len(),
                    ends: [false; 2],
                });
                along = end;
                match beginning.get(&faces[face][1]) {
                    Some(next) if *next == first => break Some(along),
                    Some(next) => face = *next,
                    None => break None,
                }
            };
            if period.is_none() {
                surface.faces[chain.first].ends[0] = true;
                if let Some(last) = surface.faces.last_mut() {
                    last.ends[1] = true;
                }
            }
            surface.chains.push(FaceChain { count: surface.faces.len() - chain.first, period, ..chain });
        }
        Ok(surface)
    }

    /// The undeformed length of all faces.
    pub fn length(&self) -> f64 {
        self.faces.iter().map(|face| face.along[1] - face.along[0]).sum()
    }

    /// The difference of two coordinates of one chain, the shorter way round a closed one.
    pub fn way(&self, chain: usize, from: f64, to: f64) -> f64 {
        match self.chains[chain].period {
            Some(period) => (to - from) - period * ((to - from) / period).round(),
            None => to - from,
        }
    }

    /// Whether a point is on the free side of the undeformed surface, or beyond an end of it.
    pub fn is_free(&self, point: PlaneVector) -> bool {
        // At a corner two faces are nearest; the one that the point is more across decides.
        let mut best = (f64::INFINITY, 0.0);
        for face in &self.faces {
            let ends = face.nodes.map(|node| self.places[node]);
            let (edge, from) = (difference(ends[1], ends[0]), difference(point, ends[0]));
            let square = product(edge, edge);
            let share = product(edge, from) / square;
            let is_beyond = (face.ends[0] && share < -SAME_DISTANCE) || (face.ends[1] && share > 1.0 + SAME_DISTANCE);
            let across = if is_beyond { f64::INFINITY } else { product(turned_left(edge), from) / square.sqrt() };
            let distance = distance_from_segment(point, ends);
            let is_as_near = (distance - best.0).abs() <= SAME_DISTANCE * distance;
            if (is_as_near && across.abs() > f64::abs(best.1)) || (!is_as_near && distance < best.0) {
                best = (distance, across);
            }
        }
        best.1 > 0.0
    }

    /// Whether another undeformed surface ends in front of this one, away from its own ends: that surface's faces run the
    /// other way there.
    pub fn has_end_of(&self, other: &Self) -> [bool; 2] {
        let ends_here = |end: usize, face: &SurfaceFace| {
            let places = face.nodes.map(|node| other.places[node]);
            face.ends[end] && self.is_before_inner_part(places[end], difference(places[1], places[0]))
        };
        [0, 1].map(|end| other.faces.iter().any(|face| ends_here(end, face)))
    }

    /// Whether the nearest point of the surface is none of its ends and belongs to a face that runs against `along`.
    fn is_before_inner_part(&self, point: PlaneVector, along: PlaneVector) -> bool {
        let ends_of = |face: &SurfaceFace| face.nodes.map(|node| self.places[node]);
        let by_distance = |face: &SurfaceFace| distance_from_segment(point, ends_of(face));
        let Some(nearest) = self.faces.iter().min_by(|a, b| by_distance(a).total_cmp(&by_distance(b))) else {
            return false;
        };
        let [first, last] = ends_of(nearest);
        let (edge, from) = (difference(last, first), difference(point, first));
        let share = product(edge, from) / product(edge, edge);
        let is_inner = |end: bool, way: f64| !end || way > SAME_DISTANCE;
        is_inner(nearest.ends[0], share) && is_inner(nearest.ends[1], 1.0 - share) && product(edge, along) < 0.0
    }

    /// The face before and the face after a node (an index into `nodes`).
    pub fn faces_at(&self, node: usize) -> [Option<usize>; 2] {
        let find = |end: usize| self.faces.iter().position(|face| face.nodes[end] == node);
        [find(1), find(0)]
    }
}

/// The distance of a point from a segment.
pub(super) fn distance_from_segment(point: PlaneVector, [first, last]: [PlaneVector; 2]) -> f64 {
    let (along, from) = (difference(last, first), difference(point, first));
    let square = product(along, along);
    let share = if square > 0.0 { (product(along, from) / square).clamp(0.0, 1.0) } else { 0.0 };
    let rest = difference(from, along.map(|part| share * part));
    product(rest, rest).sqrt()
}

/// The distance of two segments; 0 where they cross.
pub(super) fn distance_of_segments(one: [PlaneVector; 2], other: [PlaneVector; 2]) -> f64 {
    let side = |[first, last]: [PlaneVector; 2], point: PlaneVector| {
        let (a, b) = (difference(last, first), difference(point, first));
        a[0] * b[1] - a[1] * b[0]
    };
    let parts = |line: [PlaneVector; 2], ends: [PlaneVector; 2]| side(line, ends[0]) * side(line, ends[1]) < 0.0;
    if parts(one, other) && parts(other, one) {
        return 0.0;
    }
    let ends = one.map(|point| distance_from_segment(point, other));
    let others = other.map(|point| distance_from_segment(point, one));
    ends.into_iter().chain(others).fold(f64::INFINITY, f64::min)
}
