//! Checks the shapes of obstacles, and the positions of nodes relative to them at the start.
//!
//! | module | content |
//! |---|---|
//! | `polylines` | polylines |
//! | `polyhedra` | boxes and triangle meshes |
//! | `facing` | the gap and the normal at a node |

mod facing;
mod polyhedra;
mod polylines;

use crate::algebra::plane_curve::PlaneCurve;
use crate::algebra::rounded_polyhedron::RoundedPolyhedron;
use crate::model::Model;
use crate::model::check::scope::numbers::{self, largest};
use crate::model::check::scope::{Scope, proper_name};
use crate::model::input::limits::{MAX_POINTS_OF_POLYLINES, MAX_TRIANGLES_OF_MESHES};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::request::{Obstacle, PostedShape};
pub(super) use facing::Facing;

/// A well-formed obstacle, in the unit of the model.
pub(super) struct SoundObstacle<'a> {
    shape: PostedShape<'a>,
    /// The curve of a polyline, relative to its origin.
    curve: Option<PlaneCurve>,
    /// The surface of a polyhedron, relative to its origin.
    surface: Option<RoundedPolyhedron>,
}

/// The points of all polylines and the triangles of all meshes are no more than are taken.
pub(super) fn sizes(model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let (mut points, mut triangles) = (0, 0);
    for obstacle in model.obstacles.values() {
        match obstacle {
            Obstacle::Polyline(polyline) => points += polyline.points.len(),
            Obstacle::TriangleMesh(mesh) => triangles += mesh.triangles.len(),
            Obstacle::Plane { .. } | Obstacle::Ball { .. } | Obstacle::Cylinder { .. } | Obstacle::Box(_) => {}
        }
    }
    let found = [
        ("polylines", "points", points, MAX_POINTS_OF_POLYLINES),
        ("triangle meshes", "triangles", triangles, MAX_TRIANGLES_OF_MESHES),
    ];
    for (obstacles, parts, found, limit) in found {
        if found > limit {
            mistakes.add(&at.member("obstacles"), || {
                format!("the {obstacles} have {found} {parts}; at most {limit} are taken: leave some out")
            });
        }
    }
}

/// The obstacles in order; `None` for one that is not well formed.
pub(super) fn obstacles<'a>(scope: &Scope<'a>, mistakes: &mut Mistakes) -> Vec<Option<SoundObstacle<'a>>> {
    let at = scope.at.member("obstacles");
    let dimension = scope.model.dimension;
    let checked = |(name, obstacle): (&String, &'a Obstacle)| {
        let at = at.member(name);
        proper_name(name, &at, mistakes);
        let before = mistakes.count();
        fields(obstacle, dimension, &at, mistakes);
        if mistakes.count() > before {
            return None;
        }
        let shape = obstacle.shape(dimension);
        let curve = match &shape {
            PostedShape::Curve(polyline) => Some(polylines::curve(polyline, obstacle, &at, mistakes)?),
            _ => None,
        };
        let surface = match &shape {
            PostedShape::Polyhedron(mesh) => Some(polyhedra::surface(mesh, obstacle, &at, mistakes)?),
            _ => None,
        };
        Some(SoundObstacle { shape, curve, surface })
    };
    scope.model.obstacles.iter().map(checked).collect()
}

fn fields(obstacle: &Obstacle, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    match obstacle {
        Obstacle::Plane { point, normal } => {
            numbers::vector(point, dimension, &at.member("point"), mistakes);
            let at = at.member("normal");
            if numbers::vector(normal, dimension, &at, mistakes) && largest(normal) == 0.0 {
                mistakes.add(&at, || "the normal is zero; a vector into the free side is expected");
            }
        }
        Obstacle::Cylinder { .. } if dimension != 3 => {
            mistakes.add(&at.member("kind"), || "a cylinder is an obstacle in space; in the plane take a ball");
        }
        Obstacle::Cylinder { point, axis, radius, side: _ } => {
            numbers::vector(point, dimension, &at.member("point"), mistakes);
            numbers::positive(*radius, &at.member("radius"), mistakes);
            let at = at.member("axis");
            if numbers::vector(axis, dimension, &at, mistakes) && largest(axis) == 0.0 {
                mistakes.add(&at, || "the axis is zero; a vector along it is expected");
            }
        }
        Obstacle::Ball { center, radius, side: _ } => {
            numbers::vector(center, dimension, &at.member("center"), mistakes);
            numbers::positive(*radius, &at.member("radius"), mistakes);
        }
        Obstacle::Polyline(polyline) => polylines::fields(polyline, dimension, at, mistakes),
        Obstacle::Box(own) => polyhedra::box_fields(own, dimension, at, mistakes),
        Obstacle::TriangleMesh(mesh) => polyhedra::mesh_fields(mesh, dimension, at, mistakes),
    }
}
