//! Boxes and triangle meshes.

use serde_json::{Value, json};

use super::{BadDocument, at, elsewhere};

const FLOOR: &str = "/model/obstacles/floor";
const TRIANGLES: &str = "/model/obstacles/floor/triangles";

fn with_members(mut obstacle: Value, members: Value) -> Value {
    if let (Value::Object(obstacle), Value::Object(members)) = (&mut obstacle, members) {
        obstacle.extend(members);
    }
    obstacle
}

/// The good request in space, its floor replaced.
fn in_space(floor: Value) -> Vec<(&'static str, Value)> {
    vec![
        ("/model/dimension", json!(3)),
        ("/model/nodes", json!({"pin": [0, 1, 0], "tip": [-1.5, 0, 0]})),
        ("/model/supports/pin", json!(["x", "y", "z"])),
        ("/model/stages/0/forces", json!({"tip": [1, 0, 0]})),
        (FLOOR, floor),
    ]
}

pub fn boxes() -> Vec<BadDocument> {
    let flat = |members: Value| with_members(json!({"kind": "box", "center": [-1.5, -1], "size": [4, 1]}), members);
    let in_plane = |name, members: Value, pointer, detail| elsewhere(name, &[(FLOOR, flat(members))], pointer, detail);
    let deep =
        |members: Value| with_members(json!({"kind": "box", "center": [-1.5, -1, 0], "size": [4, 1, 4]}), members);
    let solid = |name, members: Value, pointer, detail| elsewhere(name, &in_space(deep(members)), pointer, detail);
    vec![
        at("box alone", "/model/obstacles/floor/kind", json!("box"), "unknown field `point` of a box")
            .told("/model/obstacles/floor/point"),
        in_plane("flat side", json!({"size": [4, 0]}), "/model/obstacles/floor/size/1", "a number above 0"),
        in_plane("box with three sides", json!({"size": [4, 1, 1]}), "/model/obstacles/floor/size", "found 3 numbers"),
        in_plane(
            "rounding beyond half",
            json!({"rounding": 0.6}),
            "/model/obstacles/floor/rounding",
            "half of the shortest",
        ),
        in_plane("box in the plane with y", json!({"y": [0, 1]}), "/model/obstacles/floor/y", "`x` is enough"),
        in_plane("box of zero direction", json!({"x": [0, 0]}), "/model/obstacles/floor/x", "the direction is zero"),
        in_plane(
            "node in a box",
            json!({"center": [-1.5, 0]}),
            "/model/contacts/0",
            "inside the box `floor` at the start",
        ),
        solid("box with x alone", json!({"x": [1, 0, 0]}), FLOOR, "`y` is missing"),
        solid("box with y along x", json!({"x": [1, 1, 0], "y": [2, 2, 0]}), "/model/obstacles/floor/y", "along `x`"),
        solid("node out of a box", json!({"side": "inside"}), "/model/contacts/0", "outside the box `floor`"),
    ]
}

pub fn triangle_meshes() -> Vec<BadDocument> {
    let tetrahedron = || {
        json!({"kind": "triangle_mesh", "rounding": 0.1, "points": [[-2, -2, 0], [-1, -2, 0], [-2, -1, 0], [-2, -2, 1]],
            "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]})
    };
    let wrong = |name, members: Value, pointer, detail| {
        elsewhere(name, &in_space(with_members(tetrahedron(), members)), pointer, detail)
    };
    let faces = |first: [i64; 3]| json!({"triangles": [first, [0, 1, 3], [1, 2, 3], [2, 0, 3]]});
    vec![
        elsewhere(
            "triangle mesh in the plane",
            &[(FLOOR, tetrahedron())],
            "/model/obstacles/floor/kind",
            "in the plane take a closed polyline",
        ),
        wrong("mesh of no rounding", json!({"rounding": 0}), "/model/obstacles/floor/rounding", "above 0"),
        wrong("wide rounding", json!({"rounding": 5}), "/model/obstacles/floor/rounding", "thinner than the rounding"),
        wrong("three triangles", json!({"triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3]]}), TRIANGLES, "four or more"),
        wrong("no points", json!({"points": []}), "/model/obstacles/floor/points", "there are no points"),
        wrong("point of a plane", json!({"points": [[0, 0]]}), "/model/obstacles/floor/points/0", "found 2 numbers"),
        wrong("no such point", faces([0, 2, 4]), "/model/obstacles/floor/triangles/0/2", "there is no point 4"),
        wrong("triangle of a corner", faces([0, 2, 2]), "/model/obstacles/floor/triangles/0", "on one line"),
        wrong("turned triangle", faces([0, 1, 2]), TRIANGLES, "in the same sense"),
        wrong(
            "open mesh",
            json!({"triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 4]],
                "points": [[-2, -2, 0], [-1, -2, 0], [-2, -1, 0], [-2, -2, 1], [-2, -2, 2]]}),
            TRIANGLES,
            "a closed surface is expected",
        ),
        wrong(
            "quadrilateral",
            json!({"triangles": [[0, 2, 1, 3]]}),
            "/model/obstacles/floor/triangles/0",
            "an array of the numbers of three points",
        ),
        wrong(
            "half a point",
            json!({"triangles": [[0, 0.5, 1]]}),
            "/model/obstacles/floor/triangles/0/1",
            "a whole number",
        ),
        wrong(
            "flat mesh",
            json!({"points": [[-2, -2, 0], [-1, -2, 0], [-2, -1, 0], [-1, -1, 0]]}),
            TRIANGLES,
            "enclose no volume",
        ),
    ]
}
