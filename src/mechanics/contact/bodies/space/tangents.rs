//! The tangents at a node of a surface.
//!
//! ```text
//! t_1 = (d - n n·d)/|d - n n·d|,      t_2 = n × t_1,      n = N/|N|
//! ```
//!
//! with the sum `N` of the area vectors of the faces at the node and the edge `d` from it: they turn with the surface.

use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};

/// The tangents of a node, with what they depend on: `t_1` is the part of `edge` in the plane across `normal`, a sum of
/// area vectors, and `t_2 = n × t_1`.
pub(super) struct NodalTangents {
    normal: Vector,
    edge: Vector,
    pub tangents: [Vector; 2],
}

impl NodalTangents {
    pub(super) fn new(normal: Vector, edge: Vector) -> Self {
        let along = unit(&normal);
        let first = unit(&add(&edge, -dot(&along, &edge), &along));
        Self { normal, edge, tangents: [first, cross(&along, &first)] }
    }

    /// The changes of both tangents with changes of the normal and of the edge.
    pub(super) fn changes(&self, normal: &Vector, edge: &Vector) -> [Vector; 2] {
        let across = |vector: &Vector, unit: &Vector| add(vector, -dot(unit, vector), unit);
        let along = unit(&self.normal);
        let turned = scaled(&across(normal, &along), 1.0 / size(&self.normal));
        let flat = add(&self.edge, -dot(&along, &self.edge), &along);
        let change = add(edge, -dot(&turned, &self.edge) - dot(&along, edge), &along);
        let change = add(&change, -dot(&along, &self.edge), &turned);
        let first = scaled(&across(&change, &self.tangents[0]), 1.0 / size(&flat));
        [first, add(&cross(&turned, &self.tangents[0]), 1.0, &cross(&along, &first))]
    }
}
