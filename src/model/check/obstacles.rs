//! Checks the shapes of obstacles, and the positions of nodes relative to them at the start.

use crate::model::check::numbers::{self, difference, dot, largest, norm};
use crate::model::check::scope::{Scope, proper_name};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::{Obstacle, Side};

pub(super) fn obstacles(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("obstacles");
    let dimension = scope.model.dimension;
    for (name, obstacle) in &scope.model.obstacles {
        let at = at.member(name);
        proper_name(name, &at, mistakes);
        match obstacle {
            Obstacle::Plane { point, normal } => {
                numbers::vector(point, dimension, &at.member("point"), mistakes);
                let at = at.member("normal");
                if numbers::vector(normal, dimension, &at, mistakes) && largest(normal) == 0.0 {
                    mistakes.add(&at, || "the normal is zero; a vector into the free side is expected");
                }
            }
            Obstacle::Ball { center, radius, side: _ } => {
                numbers::vector(center, dimension, &at.member("center"), mistakes);
                numbers::positive(*radius, &at.member("radius"), mistakes);
            }
        }
    }
}

/// The position of a node relative to an obstacle at the start.
#[derive(Debug)]
pub(super) struct Facing {
    /// Distance into the free side (length).
    pub gap: f64,
    /// Unit normal into the free side; `None` at the centre of a ball, where the normal is undefined.
    pub normal: Option<Vec<f64>>,
    /// Rounding error of the gap due to the coordinates and the radius (length).
    pub tolerance: f64,
}

/// `None` if the node or the obstacle is malformed, which is reported elsewhere.
pub(super) fn facing(scope: &Scope, node: usize, obstacle: &Obstacle) -> Option<Facing> {
    let position = scope.position(node)?;
    match obstacle {
        Obstacle::Plane { point, normal } => facing_plane(scope, position, point, normal),
        Obstacle::Ball { center, radius, side } => facing_ball(scope, position, center, *radius, *side),
    }
}

fn facing_plane(scope: &Scope, position: &[f64], point: &[f64], normal: &[f64]) -> Option<Facing> {
    let dimension = scope.model.dimension;
    let well_formed = numbers::well_formed(point, dimension) && numbers::well_formed(normal, dimension);
    if !well_formed || largest(normal) == 0.0 {
        return None;
    }
    let unit = scaled(normal, norm(normal));
    let gap = dot(&difference(position, point), &unit);
    let tolerance = scope.penetration_tolerance(largest(position).max(largest(point)));
    Some(Facing { gap, normal: Some(unit), tolerance })
}

fn facing_ball(scope: &Scope, position: &[f64], center: &[f64], radius: f64, side: Side) -> Option<Facing> {
    if !numbers::well_formed(center, scope.model.dimension) || !numbers::well_formed(&[radius], 1) || radius <= 0.0 {
        return None;
    }
    let outward = difference(position, center);
    let distance = norm(&outward);
    let tolerance = scope.penetration_tolerance(largest(position).max(largest(center)).max(radius));
    let (gap, length) = match side {
        Side::Outside => (distance - radius, distance),
        Side::Inside => (radius - distance, -distance),
    };
    let normal = (distance > tolerance).then(|| scaled(&outward, length));
    Some(Facing { gap, normal, tolerance })
}

fn scaled(vector: &[f64], length: f64) -> Vec<f64> {
    vector.iter().map(|component| component / length).collect()
}
