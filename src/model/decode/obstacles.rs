//! Reads obstacles.

use crate::model::decode::reader::{Choices, Fields, Input, boolean, number, numbers};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::{Obstacle, Polyline, Section, Side};

const PLANE: Fields = Fields { what: "a plane", known: &["kind", "point", "normal"], later: &[] };

const BALL: Fields = Fields { what: "a ball", known: &["kind", "center", "radius", "side"], later: &[] };

const CYLINDER: Fields = Fields { what: "a cylinder", known: &["kind", "point", "axis", "radius", "side"], later: &[] };

const POLYLINE: Fields =
    Fields { what: "a polyline", known: &["kind", "points", "closed", "rounding", "side", "section"], later: &[] };

const SECTION: Fields = Fields { what: "a section", known: &["origin", "x", "y"], later: &[] };

#[derive(Debug, Clone, Copy)]
enum ObstacleKind {
    Plane,
    Ball,
    Cylinder,
    Polyline,
}

const OBSTACLE_KIND: Choices<ObstacleKind> = Choices {
    what: "a kind of obstacle",
    known: &[
        ("plane", ObstacleKind::Plane),
        ("ball", ObstacleKind::Ball),
        ("cylinder", ObstacleKind::Cylinder),
        ("polyline", ObstacleKind::Polyline),
    ],
    later: &["segment", "box"],
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

fn section(input: &Input, mistakes: &mut Mistakes) -> Option<Section> {
    let object = input.object(&SECTION, mistakes)?;
    let [origin, x, y] = ["origin", "x", "y"].map(|name| object.required(name, mistakes, numbers));
    Some(Section { origin: origin?, x: x?, y: y? })
}

fn side(input: &Input, mistakes: &mut Mistakes) -> Option<Side> {
    input.choice(&SIDE, mistakes)
}
