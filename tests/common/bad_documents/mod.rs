//! Documents that must be refused, each with the place and a fragment of the detail of one mistake that must be named.
//!
//! They are read by the library, posted over HTTP and given to the command line, so that every edge refuses the same.

mod form;
mod loading;
mod model;
mod obstacles;
mod record;
mod regularised;

use serde_json::{Value, json};

/// A document that is not an acceptable job request.
#[derive(Debug, Clone)]
pub struct BadDocument {
    /// What is wrong with it; unique.
    pub name: &'static str,
    pub text: Vec<u8>,
    /// JSON pointer of one of the mistakes.
    pub pointer: &'static str,
    /// A part of that mistake's detail.
    pub detail: &'static str,
}

impl BadDocument {
    /// The mistake is there instead.
    fn told(mut self, pointer: &'static str) -> Self {
        self.pointer = pointer;
        self
    }
}

/// Every bad document.
pub fn bad_documents() -> Vec<BadDocument> {
    [
        form::broken_text(),
        form::wrong_form(),
        form::not_available(),
        model::structure(),
        model::mechanisms(),
        model::contacts(),
        model::balls(),
        model::cylinders(),
        obstacles::boxes(),
        obstacles::triangle_meshes(),
        loading::stages(),
        loading::motions(),
        loading::ends(),
        loading::analysis(),
        record::record(),
        regularised::regularised(),
        model::sizes(),
    ]
    .concat()
}

/// The request that the others spoil: it is accepted.
pub fn good_request() -> Value {
    json!({
        "model": {
            "dimension": 2,
            "nodes": {"pin": [0, 1], "tip": [-1.5, 0]},
            "supports": {"pin": ["x", "y"]},
            "elements": [
                {"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1},
                {"kind": "spring", "nodes": ["tip"], "stiffness": [[1, 0.5], [0.5, 2]]},
            ],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "tip", "obstacle": "floor", "friction": 0.3}],
            "stages": [{"name": "push", "forces": {"tip": [1, 0]}, "until": {"load_above": 1}}],
        },
        "analysis": {"arc_length": {"initial": 0.05, "min": 1e-6, "max": 0.2}, "max_increments": 500},
    })
}

/// A request with every feature that the good one lacks: it is accepted too.
pub fn full_request() -> Value {
    json!({
        "model": {
            "name": "full",
            "dimension": 3,
            "nodes": {"pin": [0, 0, 1], "tip": [-1.5, 0, 0], "ring": [3, 0, 0]},
            "supports": {"pin": ["x", "y", "z"], "ring": ["x"]},
            "elements": [
                {"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1, "rest_length": 2, "strain": "log"},
                {"kind": "spring", "nodes": ["tip", "ring"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
            ],
            "obstacles": {
                "floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
                "drum": {"kind": "ball", "center": [-1.5, 0, -2], "radius": 2},
                "bowl": {"kind": "ball", "center": [3, 0, 0], "radius": 0.5, "side": "inside"},
                "block": {"kind": "box", "center": [5, 0, 0], "size": [1, 2, 3], "rounding": 0.1, "x": [1, 1, 0], "y": [0, 1, 0]},
                "wedge": {"kind": "triangle_mesh", "points": [[6, 0, 0], [7, 0, 0], [6, 1, 0], [6, 0, 1]],
                    "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], "rounding": 0.1},
            },
            "contacts": [
                {"node": "tip", "obstacle": "floor", "friction": 0.3},
                {"node": "tip", "obstacle": "floor", "friction": 0.2},
                {"node": "tip", "obstacle": "drum", "friction": 0.3},
            ],
            "stages": [
                {"name": "sink", "displacements": {"pin": [0, 0, -0.1], "ring": [0.1, 0, 0]},
                 "until": {"displacement": {"node": "ring", "component": "x", "above": 0.05}}},
                {"name": "drag", "obstacle_motion": {"floor": [1, 0, 0], "drum": [1, 0, 0], "bowl": [0, 0, 0]},
                 "obstacle_rotation": {"drum": {"angle": 0.1, "about": [0, 0, 0], "axis": [0, 1, 0]}},
                 "forces": {"tip": [1, 0, 0]}, "until": {"load_above": 1}},
            ],
        },
        "analysis": {
            "selection": "min_potential_energy",
            "explore": {"depth": 2, "max_jobs": 10},
            "max_increments": 500,
        },
    })
}

/// The good request with values put in: a pointer whose last part is a new member adds it, `-` appends to an array.
fn with(changes: &[(&str, Value)]) -> Vec<u8> {
    let mut request = good_request();
    for (pointer, value) in changes {
        let (parent, last) = pointer.rsplit_once('/').expect("a pointer");
        match request.pointer_mut(parent).expect("a place in the good request") {
            Value::Object(members) => {
                members.insert(last.to_owned(), value.clone());
            }
            Value::Array(items) if last == "-" => items.push(value.clone()),
            Value::Array(items) => items[last.parse::<usize>().expect("an index")] = value.clone(),
            other => panic!("{pointer} leads into {other}"),
        }
    }
    serde_json::to_vec(&request).expect("JSON")
}

fn without(pointer: &str) -> Vec<u8> {
    let mut request = good_request();
    let (parent, last) = pointer.rsplit_once('/').expect("a pointer");
    let members = request.pointer_mut(parent).and_then(Value::as_object_mut).expect("an object");
    members.remove(last).expect("a member of the good request");
    serde_json::to_vec(&request).expect("JSON")
}

fn raw(name: &'static str, text: impl Into<Vec<u8>>, detail: &'static str) -> BadDocument {
    BadDocument { name, text: text.into(), pointer: "", detail }
}

/// One value put in, and the mistake at that very place.
fn at(name: &'static str, pointer: &'static str, value: Value, detail: &'static str) -> BadDocument {
    BadDocument { name, text: with(&[(pointer, value)]), pointer, detail }
}

/// The floor replaced by a ball around the origin, of radius 1, with these members put in.
fn ball_with(name: &'static str, members: Value, detail: &'static str) -> BadDocument {
    let mut ball = json!({"kind": "ball", "center": [0, 0], "radius": 1});
    if let (Value::Object(ball), Value::Object(members)) = (&mut ball, members) {
        ball.extend(members);
    }
    at(name, "/model/obstacles/floor", ball, detail)
}

/// One value put in, and the mistake somewhere else.
fn elsewhere(
    name: &'static str,
    changes: &[(&str, Value)],
    pointer: &'static str,
    detail: &'static str,
) -> BadDocument {
    BadDocument { name, text: with(changes), pointer, detail }
}
