//! Polyhedra: flat faces and edges.

use crate::algebra::rounded_polyhedron::triangles::TriangleTree;
use nalgebra::Vector3;

/// A polyhedron, its lengths in multiples of the rounding.
#[derive(Debug)]
pub(super) struct Polyhedron {
    pub triangles: TriangleTree,
    pub faces: Vec<FlatFace>,
    pub edges: Vec<PolyhedronEdge>,
}

/// Triangles in one plane that hang together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FlatFace {
    /// Unit normal, outwards.
    pub normal: Vector3<f64>,
    pub boundary: Vec<BoundaryEdge>,
}

/// An edge between two flat faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PolyhedronEdge {
    pub ends: [Vector3<f64>; 2],
    /// Unit vector from the first end to the second.
    pub direction: Vector3<f64>,
}

/// An edge as part of the boundary of a flat face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BoundaryEdge {
    pub edge: usize,
    /// 1 where the face is to the left of the edge's direction as seen from outside, otherwise -1.
    pub sense: f64,
    /// Unit vector in the plane of the face, across the edge, out of the face.
    pub outwards: Vector3<f64>,
}

/// The same faces and edges; the tree follows from the same triangles.
impl PartialEq for Polyhedron {
    fn eq(&self, other: &Self) -> bool {
        self.faces == other.faces && self.edges == other.edges
    }
}
