//! Reads obstacles.

use crate::model::decode::reader::{Choices, Fields, Input, boolean, count, number, numbers};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::{Obstacle, Polyline, RoundedBox, Section, Side, TriangleMesh};

const PLANE: Fields = Fields { what: "a plane", known: &["kind", "point", "normal"], later: &[] };

const BALL: Fields = Fields { what: "a ball", known: &["kind", "center", "radius", "side"], later: &[] };

const CYLINDER: Fields = Fields { what: "a cylinder", known: &["kind", "point", "axis", "radius", "side"], later: &[] };

const POLYLINE: Fields =
    Fields { what: "a polyline", known: &["kind", "points", "closed", "rounding", "side", "section"], later: &[] };

const BOX: Fields =
    Fields { what: "a box", known: &["kind", "center", "size", "rounding", "side", "x", "y"], later: &[] };

const TRIANGLE_MESH: Fields =
    Fields { what: "a triangle mesh", known: &["kind", "points", "triangles", "rounding", "side"], later: &[] };

const SECTION: Fields = Fields { what: "a section", known: &["origin", "x", "y"], later: &[] };

#[derive(Debug, Clone, Copy)]
enum ObstacleKind {
    Plane,
    Ball,
    Cylinder,
    Polyline,
    Box,
    TriangleMesh,
}

const OBSTACLE_KIND: Choices<ObstacleKind> = Choices {
    what: "a kind of obstacle",
    known: &[
        ("plane", ObstacleKind::Plane),
        ("ball", ObstacleKind::Ball),
        ("cylinder", ObstacleKind::Cylinder),
        ("polyline", ObstacleKind::Polyline),
        ("box", ObstacleKind::Box),
        ("triangle_mesh", ObstacleKind::TriangleMesh),
    ],
    later: &["segment"],
};

const SIDE: Choices<Side> = Choices {
    what: "a side of a closed obstacle",
    known: &[("outside", Side::Outside), ("inside", Side::Inside)],
    later: &[],
};

pub(super) fn obstacle(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    match input.kind(&OBSTACLE_KIND, mistakes)? {
        ObstacleKind::Plane => plane(input, mistakes),
        ObstacleKind::Ball => ball(input, mistakes),
        ObstacleKind::Cylinder => cylinder(input, mistakes),
        ObstacleKind::Polyline => polyline(input, mistakes),
        ObstacleKind::Box => rounded_box(input, mistakes),
        ObstacleKind::TriangleMesh => triangle_mesh(input, mistakes),
    }
}

fn plane(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    let object = input.object(&PLANE, mistakes)?;
    let point = object.required("point", mistakes, numbers);
    let normal = object.required("normal", mistakes, numbers);
    Some(Obstacle::Plane { point: point?, normal: normal? })
}

fn ball(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    let object = input.object(&BALL, mistakes)?;
    let center = object.required("center", mistakes, numbers);
    let radius = object.required("radius", mistakes, number);
    let side = object.with_default("side", Side::default(), mistakes, side);
    Some(Obstacle::Ball { center: center?, radius: radius?, side: side? })
}

fn cylinder(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    let object = input.object(&CYLINDER, mistakes)?;
    let point = object.required("point", mistakes, numbers);
    let axis = object.required("axis", mistakes, numbers);
    let radius = object.required("radius", mistakes, number);
    let side = object.with_default("side", Side::default(), mistakes, side);
    Some(Obstacle::Cylinder { point: point?, axis: axis?, radius: radius?, side: side? })
}

fn polyline(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    let object = input.object(&POLYLINE, mistakes)?;
    let points = object.required("points", mistakes, |input, mistakes| input.list(mistakes, numbers));
    let closed = object.with_default("closed", false, mistakes, boolean);
    let rounding = object.optional("rounding", mistakes, number);
    let side = object.optional("side", mistakes, side);
    let section = object.optional("section", mistakes, section);
    Some(Obstacle::Polyline(Polyline {
        points: points?,
        closed: closed?,
        rounding: rounding?,
        side: side?,
        section: section?,
    }))
}

fn rounded_box(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    let object = input.object(&BOX, mistakes)?;
    let center = object.required("center", mistakes, numbers);
    let size = object.required("size", mistakes, numbers);
    let rounding = object.optional("rounding", mistakes, number);
    let side = object.with_default("side", Side::default(), mistakes, side);
    let [x, y] = ["x", "y"].map(|name| object.optional(name, mistakes, numbers));
    let (center, size, rounding, side) = (center?, size?, rounding?, side?);
    Some(Obstacle::Box(RoundedBox { center, size, rounding, side, x: x?, y: y? }))
}

fn triangle_mesh(input: &Input, mistakes: &mut Mistakes) -> Option<Obstacle> {
    let object = input.object(&TRIANGLE_MESH, mistakes)?;
    let points = object.required("points", mistakes, |input, mistakes| input.list(mistakes, numbers));
    let triangles = object.required("triangles", mistakes, |input, mistakes| input.list(mistakes, triangle));
    let rounding = object.required("rounding", mistakes, number);
    let side = object.with_default("side", Side::default(), mistakes, side);
    Some(Obstacle::TriangleMesh(TriangleMesh {
        points: points?,
        triangles: triangles?,
        rounding: rounding?,
        side: side?,
    }))
}

fn triangle(input: &Input, mistakes: &mut Mistakes) -> Option<[u32; 3]> {
    let corners = input.list(mistakes, count)?;
    let points: Option<Vec<u32>> = corners.iter().map(|point| u32::try_from(*point).ok()).collect();
    let triangle = points.and_then(|points| points.try_into().ok());
    if triangle.is_some() {
        triangle
    } else {
        input.refuse("an array of the numbers of three points, counted from 0,", mistakes)
    }
}

fn section(input: &Input, mistakes: &mut Mistakes) -> Option<Section> {
    let object = input.object(&SECTION, mistakes)?;
    let [origin, x, y] = ["origin", "x", "y"].map(|name| object.required(name, mistakes, numbers));
    Some(Section { origin: origin?, x: x?, y: y? })
}

fn side(input: &Input, mistakes: &mut Mistakes) -> Option<Side> {
    input.choice(&SIDE, mistakes)
}
