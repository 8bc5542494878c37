//! Checks boxes and triangle meshes.

use crate::algebra::rounded_polyhedron::make::{MOST_FACES_IN_BALL, MOST_PARTS};
use crate::algebra::rounded_polyhedron::{PolyhedronMistake, RoundedPolyhedron};
use crate::model::check::scope::numbers::{self, PARALLEL, dot, largest, norm, scaled};
use crate::model::input::limits::MAX_MESH_TRIANGLES;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::request::{Obstacle, RoundedBox, TriangleMesh};

/// A box whose sides the coordinates do not resolve.
pub(super) const TOO_FLAT: &str = "a side of the box is lost in the rounding of the coordinates, beside the others or beside \
                                   the distance from the origin; make it longer, or move the box";

pub(super) fn box_fields(own: &RoundedBox, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    numbers::vector(&own.center, dimension, &at.member("center"), mistakes);
    let at_size = at.member("size");
    let mut is_sound = numbers::vector(&own.size, dimension, &at_size, mistakes);
    for (k, side) in own.size.iter().enumerate() {
        is_sound &= numbers::positive(*side, &at_size.index(k), mistakes);
    }
    if let Some(rounding) = own.rounding {
        let at = at.member("rounding");
        let most = 0.5 * own.size.iter().copied().fold(f64::INFINITY, f64::min);
        if numbers::positive(rounding, &at, mistakes) && is_sound && rounding > most {
            mistakes.add(&at, || {
                format!(
                    "found {rounding:?}; half of the shortest side, {most:?}, is the most that the box has room for"
                )
            });
        }
    }
    let mut directions = Vec::new();
    for (name, direction) in [("x", &own.x), ("y", &own.y)] {
        let Some(direction) = direction else { continue };
        let at = at.member(name);
        if name == "y" && dimension == 2 {
            mistakes.add(&at, || "in the plane `x` is enough; leave `y` out");
        } else if numbers::vector(direction, dimension, &at, mistakes) {
            if largest(direction) == 0.0 {
                mistakes.add(&at, || "the direction is zero; a vector along a side of the box is expected");
            } else {
                directions.push((name, scaled(direction, norm(direction))));
            }
        }
    }
    if dimension == 3 && own.x.is_some() != own.y.is_some() {
        let missing = if own.x.is_some() { "y" } else { "x" };
        return mistakes.add(at, || format!("in space a box is turned by `x` and `y`; `{missing}` is missing"));
    }
    if let [(_, x), (name, y)] = &directions[..]
        && 1.0 - dot(x, y).abs() <= PARALLEL
    {
        mistakes.add(&at.member(name), || "`y` is along `x`; another direction is expected");
    }
}

pub(super) fn mesh_fields(mesh: &TriangleMesh, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if dimension != 3 {
        return mistakes.add(
            &at.member("kind"),
            || "a triangle mesh is an obstacle in space; in the plane take a closed polyline",
        );
    }
    let TriangleMesh { points, triangles, rounding, side: _ } = mesh;
    numbers::positive(*rounding, &at.member("rounding"), mistakes);
    let at_triangles = at.member("triangles");
    if triangles.len() > MAX_MESH_TRIANGLES {
        let found = triangles.len();
        return mistakes
            .add(&at_triangles, || format!("found {found} triangles; at most {MAX_MESH_TRIANGLES} are taken"));
    }
    let at_points = at.member("points");
    if points.len() > 3 * MAX_MESH_TRIANGLES {
        let (found, most) = (points.len(), 3 * MAX_MESH_TRIANGLES);
        return mistakes.add(&at_points, || format!("found {found} points; at most {most} are taken"));
    }
    if points.is_empty() {
        return mistakes.add(&at_points, || "there are no points; the corners of the triangles are expected");
    }
    for (number, point) in points.iter().enumerate() {
        numbers::vector(point, 3, &at_points.index(number), mistakes);
    }
    for (number, triangle) in triangles.iter().enumerate() {
        for (corner, point) in triangle.iter().enumerate() {
            if *point as usize >= points.len() {
                let count = points.len();
                mistakes.add(&at_triangles.index(number).index(corner), || {
                    format!("there is no point {point}; the {count} points are counted from 0")
                });
            }
        }
    }
}

/// The surface of a mesh whose fields are right, or of a box.
pub(super) fn surface(
    mesh: &TriangleMesh,
    obstacle: &Obstacle,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> Option<RoundedPolyhedron> {
    let checked = |surface: RoundedPolyhedron| surface.check_rounding().map(|()| surface);
    match mesh.surface().and_then(checked) {
        Ok(surface) => return Some(surface),
        Err(_) if matches!(obstacle, Obstacle::Box(_)) => mistakes.add(at, || TOO_FLAT),
        Err(mistake) => note(mistake, mesh, at, mistakes),
    }
    None
}

fn note(mistake: PolyhedronMistake, mesh: &TriangleMesh, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let triangles = at.member("triangles");
    let edge = |[from, to]: [usize; 2]| format!("the edge between the points {from} and {to}");
    match mistake {
        PolyhedronMistake::TooFew => mistakes.add(&triangles, || {
            let found = mesh.triangles.len();
            format!("found {found} triangles; four or more enclose a volume")
        }),
        PolyhedronMistake::NoArea { triangle } => mistakes.add(&triangles.index(triangle), || {
            "the corners of the triangle are on one line; leave it out, and join its neighbours"
        }),
        PolyhedronMistake::Open { ends } => mistakes.add(&triangles, || {
            format!(
                "{} belongs to one triangle alone; a closed surface is expected, in which points at one place are one point",
                edge(ends)
            )
        }),
        PolyhedronMistake::Shared { ends } => mistakes.add(&triangles, || {
            format!("{} belongs to more than two triangles; a closed surface has two at each edge", edge(ends))
        }),
        PolyhedronMistake::Turned { ends } => mistakes.add(&triangles, || {
            format!(
                "both triangles at {} go along it in the same sense; turn one of them round: all are counter-clockwise as \
                 seen from outside, or all clockwise",
                edge(ends)
            )
        }),
        PolyhedronMistake::NoVolume => {
            mistakes.add(&triangles, || "the triangles enclose no volume; a closed surface around one is expected");
        }
        PolyhedronMistake::Nested { triangle } => mistakes.add(&triangles.index(triangle), || {
            "the part of the surface to which the triangle belongs is turned against its place: bodies side by side are \
             turned alike, a cavity in a body the other way round; exchange two corners of each of its triangles"
        }),
        PolyhedronMistake::ManyParts { found } => mistakes.add(&triangles, || {
            format!("the surface has {found} parts that do not hang together; at most {MOST_PARTS} are taken: make several obstacles")
        }),
        PolyhedronMistake::Crowded => mistakes.add(&triangles, || {
            "too many triangles reach past each other to look for crossings; take fewer, or cut long ones into shorter ones"
        }),
        PolyhedronMistake::Crosses { triangles: [one, other] } => mistakes.add(&triangles, || {
            format!("the triangles {one} and {other} cross; a surface that does not cross itself is expected")
        }),
        PolyhedronMistake::WideRounding { point } => mistakes.add(&at.member("rounding"), || {
            format!(
                "within the rounding around point {point} there are more than {MOST_FACES_IN_BALL} faces; give a smaller \
                 rounding or a coarser mesh"
            )
        }),
        PolyhedronMistake::Thin { point } => mistakes.add(&at.member("rounding"), || {
            format!(
                "around point {point} the body is thinner than the rounding leaves, or two parts of it touch; give a smaller \
                 rounding, or join the parts"
            )
        }),
    }
}
