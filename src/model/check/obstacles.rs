//! Checks the shapes of obstacles, and the positions of nodes relative to them at the start.

use crate::algebra::plane_curve::{CurveMistake, PlaneCurve};
use crate::model::Model;
use crate::model::check::numbers::{self, difference, dot, largest, norm};
use crate::model::check::scope::{Scope, proper_name};
use crate::model::input::limits::MAX_POLYLINE_POINTS;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::request::{Obstacle, Polyline, Side};

/// Directions whose cosine differs from 1 by no more than this are parallel: an angle of some 1e-6.
const PARALLEL: f64 = 1e-12;

/// The curves of the polylines, in the unit of the model; `None` for other obstacles and for malformed polylines.
pub(super) type Curves = Vec<Option<PlaneCurve>>;

pub(super) fn points_of_polylines(model: &Model) -> usize {
    let points = |obstacle: &Obstacle| match obstacle {
        Obstacle::Polyline(polyline) => polyline.points.len(),
        Obstacle::Plane { .. } | Obstacle::Ball { .. } | Obstacle::Cylinder { .. } => 0,
    };
    model.obstacles.values().map(points).sum()
}

pub(super) fn obstacles(scope: &Scope, mistakes: &mut Mistakes) -> Curves {
    let at = scope.at.member("obstacles");
    let dimension = scope.model.dimension;
    let mut curves = vec![None; scope.model.obstacles.len()];
    for ((name, obstacle), curve) in scope.model.obstacles.iter().zip(&mut curves) {
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
            Obstacle::Polyline(polyline) => *curve = curve_of(polyline, dimension, &at, mistakes),
        }
    }
    curves
}

fn curve_of(polyline: &Polyline, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) -> Option<PlaneCurve> {
    let before = mistakes.count();
    check_section(polyline, dimension, at, mistakes);
    let Polyline { points, closed, rounding, side, section: _ } = polyline;
    let at_points = at.member("points");
    if points.len() > MAX_POLYLINE_POINTS {
        let found = points.len();
        mistakes.add(&at_points, || format!("found {found} points; at most {MAX_POLYLINE_POINTS} are taken"));
        return None;
    }
    for (number, point) in points.iter().enumerate() {
        numbers::vector(point, 2, &at_points.index(number), mistakes);
    }
    if let Some(rounding) = rounding {
        numbers::positive(*rounding, &at.member("rounding"), mistakes);
    }
    if side.is_some() && !closed {
        mistakes.add(&at.member("side"), || {
            "an open polyline has no inside; its free side is to the left of its direction: leave this out, and turn the \
             points round where the other side is free"
        });
    }
    if mistakes.count() != before {
        return None;
    }
    polyline.curve().map_err(|mistake| note(mistake, polyline, at, mistakes)).ok()
}

/// The plane of the points in space.
fn check_section(polyline: &Polyline, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let at_section = at.member("section");
    let section = match (&polyline.section, dimension) {
        (Some(section), 3) => section,
        (Some(_), _) => {
            return mistakes.add(&at_section, || "a polyline in the plane has no section; leave it out");
        }
        (None, 3) => {
            return mistakes.add(at, || {
                "in space the `section` is missing, the plane of the points: `{\"origin\": [0, 0, 0], \"x\": [1, 0, 0], \"y\": \
                 [0, 0, 1]}`; the obstacle is straight across it"
            });
        }
        (None, _) => return,
    };
    numbers::vector(&section.origin, dimension, &at_section.member("origin"), mistakes);
    let mut is_right = true;
    for (name, direction) in [("x", &section.x), ("y", &section.y)] {
        let at = at_section.member(name);
        let sane = numbers::vector(direction, dimension, &at, mistakes);
        if sane && largest(direction) == 0.0 {
            mistakes.add(&at, || "the direction is zero; a vector in the plane of the points is expected");
        }
        is_right &= sane && largest(direction) > 0.0;
    }
    if is_right {
        let (x, y) = (scaled(&section.x, norm(&section.x)), scaled(&section.y, norm(&section.y)));
        if 1.0 - dot(&x, &y).abs() <= PARALLEL {
            mistakes.add(
                &at_section.member("y"),
                || "`y` is along `x`; another direction in the plane of the points is expected",
            );
        }
    }
}

fn note(mistake: CurveMistake, polyline: &Polyline, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let points = at.member("points");
    match mistake {
        CurveMistake::TooFew { needed } => mistakes.add(&points, || {
            let (found, kind) = (polyline.points.len(), if polyline.closed { "a closed" } else { "an open" });
            format!("found {found} points; {kind} polyline has {needed} or more")
        }),
        CurveMistake::Coincident { point } => mistakes.add(&points.index(point), || {
            "the point coincides with the one before it; leave one out (a closed polyline does not repeat its first point)"
        }),
        CurveMistake::TurnsBack { point } => mistakes.add(&points.index(point), || {
            "the polyline turns back here, by more than 170 degrees; put two corners in place of this one"
        }),
        CurveMistake::NoRoom { point, most } => mistakes.add(&at.member("rounding"), || {
            format!("the edges at point {point} leave room for a rounding of at most {most:?}")
        }),
        CurveMistake::Crosses { near } => mistakes.add(&points, || {
            let origin = polyline.origin();
            let [x, y] = [near[0] + origin[0], near[1] + origin[1]];
            let ends = if polyline.closed { "" } else { ", with the straight continuation of its ends," };
            format!("the curve{ends} crosses itself near [{x:.6}, {y:.6}], so that it has no free side; change the points")
        }),
    }
}

/// The position of a node relative to an obstacle at the start.
#[derive(Debug)]
pub(super) struct Facing {
    /// Distance into the free side (length).
    pub gap: f64,
    /// Unit normal into the free side; `None` at the centre of a ball and on the axis of a cylinder, where there is
    /// none.
    pub normal: Option<Vec<f64>>,
    /// Rounding error of the gap due to the coordinates and the radius (length).
    pub tolerance: f64,
}

/// `None` if the node or the obstacle is malformed, which is reported elsewhere.
pub(super) fn facing(scope: &Scope, node: usize, obstacle: &Obstacle, curve: Option<&PlaneCurve>) -> Option<Facing> {
    let position = scope.position(node)?;
    match obstacle {
        Obstacle::Polyline(polyline) => Some(facing_curve(scope, position, polyline, curve?)),
        Obstacle::Plane { point, normal } => facing_plane(scope, position, point, normal),
        Obstacle::Ball { center, radius, side } => facing_ball(scope, position, center, *radius, *side),
        Obstacle::Cylinder { point, axis, radius, side } => {
            facing_cylinder(scope, position, (point, axis), *radius, *side)
        }
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
    let tolerance = scope.penetration_tolerance(largest(position).max(largest(center)).max(radius));
    Some(facing_round(&difference(position, center), radius, side, tolerance))
}

/// `None` outside space, which is reported elsewhere.
fn facing_cylinder(
    scope: &Scope,
    position: &[f64],
    (point, axis): (&[f64], &[f64]),
    radius: f64,
    side: Side,
) -> Option<Facing> {
    let well_formed = numbers::well_formed(point, 3) && numbers::well_formed(axis, 3) && largest(axis) > 0.0;
    if scope.model.dimension != 3 || !well_formed || !numbers::well_formed(&[radius], 1) || radius <= 0.0 {
        return None;
    }
    let axis = scaled(axis, norm(axis));
    let mut outward = difference(position, point);
    let along = dot(&outward, &axis);
    outward.iter_mut().zip(&axis).for_each(|(component, axis)| *component -= along * axis);
    let tolerance = scope.penetration_tolerance(largest(position).max(largest(point)).max(radius));
    Some(facing_round(&outward, radius, side, tolerance))
}

/// The position at a vector from the centre, or from the axis and perpendicular to it.
fn facing_round(outward: &[f64], radius: f64, side: Side, tolerance: f64) -> Facing {
    let distance = norm(outward);
    let (gap, length) = match side {
        Side::Outside => (distance - radius, distance),
        Side::Inside => (radius - distance, -distance),
    };
    let normal = (distance > tolerance).then(|| scaled(outward, length));
    Facing { gap, normal, tolerance }
}

fn facing_curve(scope: &Scope, position: &[f64], polyline: &Polyline, curve: &PlaneCurve) -> Facing {
    let (origin, side, axes) = (polyline.origin(), polyline.free_side(), polyline.axes());
    let [x, y] = polyline.coordinates(position);
    let closest = curve.closest([x - origin[0], y - origin[1]]);
    let far = polyline.section.as_ref().map_or(0.0, |section| largest(&section.origin));
    let reach = polyline.points.iter().map(|point| largest(point)).fold(largest(position).max(far), f64::max);
    let component = |k: usize| side * (closest.normal[0] * axes[0][k] + closest.normal[1] * axes[1][k]);
    Facing {
        gap: side * closest.distance,
        normal: Some((0..scope.model.dimension).map(component).collect()),
        tolerance: scope.penetration_tolerance(reach),
    }
}

fn scaled(vector: &[f64], length: f64) -> Vec<f64> {
    vector.iter().map(|component| component / length).collect()
}
