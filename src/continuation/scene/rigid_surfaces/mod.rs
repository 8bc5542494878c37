//! The surfaces of a model's obstacles, as contacts see them; dimensionless.

use crate::algebra::plane_curve::PlaneCurve;
use crate::algebra::rounded_polyhedron::RoundedPolyhedron;
use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::vector::{add, cross, dot, size, unit_of};
use crate::model::input::limits::PENETRATION_TOLERANCE;
use crate::model::request::{Model, PostedShape};
use std::collections::HashMap;
use std::sync::Arc;

/// The obstacles of a model that was checked, by name.
pub(super) struct RigidSurfaces<'a> {
    shapes: HashMap<&'a str, PostedShape<'a>>,
    /// Of each curve relative to its origin, and of each polyhedron: one for all contacts.
    curves: HashMap<&'a str, Arc<PlaneCurve>>,
    polyhedra: HashMap<&'a str, RoundedPolyhedron>,
    dimension: usize,
    /// The unit of length.
    length: f64,
}

impl<'a> RigidSurfaces<'a> {
    pub fn of(model: &'a Model, length: f64) -> Self {
        let dimension = model.dimension;
        let mut found =
            Self { shapes: HashMap::new(), curves: HashMap::new(), polyhedra: HashMap::new(), dimension, length };
        for (name, obstacle) in &model.obstacles {
            let shape = obstacle.shape(dimension);
            // A model that was checked has them all.
            match &shape {
                PostedShape::Curve(polyline) => {
                    let curve = polyline.curve().ok().map(|curve| (name.as_str(), Arc::new(curve.in_units_of(length))));
                    found.curves.extend(curve);
                }
                PostedShape::Polyhedron(mesh) => {
                    let surface = mesh.surface().ok().map(|surface| (name.as_str(), surface.in_units_of(length)));
                    found.polyhedra.extend(surface);
                }
                PostedShape::Plane { .. } | PostedShape::Ball { .. } | PostedShape::Cylinder { .. } => {}
            }
            found.shapes.insert(name, shape);
        }
        found
    }

    /// The surface of an obstacle relative to a place, and the gap there.
    pub fn at(&self, obstacle: &str, place: &[f64]) -> (RigidSurface, f64) {
        let Self { dimension, length, .. } = *self;
        // A gap within the round-off of the coordinates is closed.
        let snapped = |gap: f64, reach: f64| {
            let reach = reach.max(largest(place));
            let closed = gap.abs() <= PENETRATION_TOLERANCE * length + 4.0 * f64::EPSILON * reach;
            if closed { 0.0 } else { gap / length }
        };
        let relative = |origin: &[f64]| {
            let mut offset = [0.0; 3];
            (0..dimension).for_each(|k| offset[k] = (place[k] - origin[k]) / length);
            offset
        };
        match &self.shapes[obstacle] {
            PostedShape::Ball { center, radius, side } => {
                let (offset, side) = (relative(center), side.sign());
                let gap = side * (size(&offset) * length - radius);
                (RigidSurface::Ball { offset, side }, snapped(gap, largest(center).max(*radius)))
            }
            PostedShape::Cylinder { point, axis, radius, side } => {
                let (axis, side, from) = (unit_of(axis), side.sign(), relative(point));
                let offset = add(&from, -dot(&from, &axis), &axis);
                let gap = side * (size(&offset) * length - radius);
                (RigidSurface::Cylinder { axis, offset, side }, snapped(gap, largest(point).max(*radius)))
            }
            PostedShape::Plane { point, normal } => {
                let unit = unit_of(normal);
                let gap: f64 = (0..dimension).map(|k| (place[k] - point[k]) * unit[k]).sum();
                (RigidSurface::Plane { normal: unit }, snapped(gap, largest(point)))
            }
            PostedShape::Curve(polyline) => {
                let (origin, side, [x, y]) = (polyline.origin(), polyline.free_side(), polyline.axes());
                let at = polyline.coordinates(place);
                let offset = [(at[0] - origin[0]) / length, (at[1] - origin[1]) / length, 0.0];
                let section = [x, y, cross(&x, &y)];
                let curve = Arc::clone(&self.curves[obstacle]);
                let before = side * curve.closest([offset[0], offset[1]]).distance;
                let gap = snapped(before * length, polyline.reach());
                (RigidSurface::Curve { curve, section, offset, side, before }, gap)
            }
            PostedShape::Polyhedron(mesh) => {
                let (offset, side) = (relative(&mesh.origin()), mesh.side.sign());
                let surface = self.polyhedra[obstacle].clone();
                let before = side * surface.closest(offset).distance;
                let gap = snapped(before * length, mesh.reach());
                (RigidSurface::Polyhedron { surface, offset, side, before }, gap)
            }
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}
