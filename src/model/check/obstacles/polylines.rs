//! Checks polylines.

use crate::algebra::plane_curve::{CurveMistake, PlaneCurve};
use crate::model::check::obstacles::polyhedra::TOO_FLAT;
use crate::model::check::scope::numbers::{self, PARALLEL, dot, largest, norm, scaled};
use crate::model::input::limits::MAX_POLYLINE_POINTS;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::request::{Obstacle, Polyline};

pub(super) fn fields(polyline: &Polyline, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    check_section(polyline, dimension, at, mistakes);
    let Polyline { points, closed, rounding, side, section: _ } = polyline;
    let at_points = at.member("points");
    if points.len() > MAX_POLYLINE_POINTS {
        let found = points.len();
        return mistakes.add(&at_points, || format!("found {found} points; at most {MAX_POLYLINE_POINTS} are taken"));
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
}

/// The curve of a polyline whose fields are right, or of a box.
pub(super) fn curve(
    polyline: &Polyline,
    obstacle: &Obstacle,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> Option<PlaneCurve> {
    match (polyline.curve(), obstacle) {
        (Ok(curve), _) => Some(curve),
        (Err(_), Obstacle::Box(_)) => {
            mistakes.add(at, || TOO_FLAT);
            None
        }
        (Err(mistake), _) => {
            note(mistake, polyline, at, mistakes);
            None
        }
    }
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
