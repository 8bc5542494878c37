//! Text that is not JSON or does not have the form of a request.

use serde_json::json;

use super::{BadDocument, at, ball_with, good_request, raw, without};

pub fn broken_text() -> Vec<BadDocument> {
    let good = serde_json::to_string(&good_request()).expect("JSON");
    let huge = good.replace("-1.5", "1e999");
    let not_a_number = good.replace("-1.5", "NaN");
    let twice = good.replace("\"dimension\":2", "\"dimension\":2,\"dimension\":2");
    let node_twice = good.replace("\"tip\":[-1.5,0]", "\"tip\":[-1.5,0],\"tip\":[-1,0]");
    let no_utf8: Vec<u8> = good.bytes().map(|byte| if byte == b'f' { 0xff } else { byte }).collect();
    vec![
        raw("empty", "", "empty"),
        raw("white space only", " \n\t", "empty"),
        raw("not JSON", "model: {}", "line 1 column 1"),
        raw("truncated", good.split_at(good.len() / 2).0, "EOF while parsing"),
        raw("text after the document", format!("{good} {good}"), "trailing characters"),
        raw("trailing comma", "{\"model\": {},\n}", "line 2 column 1"),
        raw("not UTF-8", no_utf8, "not UTF-8 at line 1"),
        raw("byte order mark", format!("\u{feff}{good}"), "byte order mark"),
        raw("number out of range", huge, "number out of range"),
        raw("not a number", not_a_number, "line 1"),
        raw("deep arrays", "[".repeat(200_000), "recursion limit exceeded"),
        raw("deep objects", "{\"model\":".repeat(200_000), "recursion limit exceeded"),
        raw("lone surrogate", "{\"\\ud800\": 1}", "unexpected end of hex escape"),
        raw("an array", "[]", "found an array of 0; a job request, an object, is expected"),
        raw("a string", "\"model\"", "found the string `model`"),
        raw("null", "null", "found null"),
        BadDocument {
            name: "duplicate field",
            text: twice.into(),
            pointer: "/model/dimension",
            detail: "stands twice",
        },
        BadDocument {
            name: "duplicate node",
            text: node_twice.into(),
            pointer: "/model/nodes/tip",
            detail: "stands twice",
        },
    ]
}

pub fn wrong_form() -> Vec<BadDocument> {
    let ball = "/model/obstacles/floor";
    let missing = |name, removed, pointer, detail| BadDocument { name, text: without(removed), pointer, detail };
    vec![
        raw("a model alone", good_request()["model"].to_string(), "put them into it, `{\"model\": {...}}`"),
        at("a largest arc length of 0", "/analysis/arc_length/max", json!(0), "found 0.0; a number above 0"),
        missing("no model", "/model", "", "the field `model` is missing"),
        missing("no dimension", "/model/dimension", "/model", "the field `dimension` is missing"),
        missing("no nodes", "/model/nodes", "/model", "the field `nodes` is missing"),
        missing("no elements", "/model/elements", "/model", "the field `elements` is missing"),
        missing("no stages", "/model/stages", "/model", "the field `stages` is missing"),
        missing("no element kind", "/model/elements/0/kind", "/model/elements/0", "`kind` is missing"),
        missing(
            "no stiffness",
            "/model/elements/0/axial_stiffness",
            "/model/elements/0",
            "`axial_stiffness` is missing",
        ),
        missing("no obstacle named", "/model/contacts/0/obstacle", "/model/contacts/0", "`obstacle` is missing"),
        at("unknown field", "/modell", json!({}), "did you mean `model`?"),
        at("unknown field of a model", "/model/node", json!({}), "did you mean `nodes`?"),
        at("unknown field of a bar", "/model/elements/0/stiffness", json!(1), "did you mean `axial_stiffness`?"),
        at("unknown field of a contact", "/model/contacts/0/mu", json!(1), "did you mean `friction`? Known: `node`"),
        at("unknown field of an analysis", "/analysis/max_increment", json!(1), "did you mean `max_increments`?"),
        at("unknown end", "/model/stages/0/until/load", json!(1), "unknown field `load`"),
        at("unknown element", "/model/elements/0/kind", json!("cable"), "is not a kind of element"),
        at("unknown obstacle kind", "/model/obstacles/floor/kind", json!("plain"), "did you mean `plane`?"),
        at("unknown strain", "/model/elements/0/strain", json!("greene"), "did you mean `green`?"),
        at("unknown component", "/model/supports/pin/0", json!("u"), "known: `x`, `y`, `z`"),
        at("unknown method", "/analysis/method", json!("Auto"), "did you mean `auto`?"),
        at(
            "nodes as an array",
            "/model/nodes",
            json!([[0, 1]]),
            "found an array of 1; an object, `{...}`, is expected",
        ),
        at("elements as an object", "/model/elements", json!({}), "found an object; an array, `[...]`, is expected"),
        at("coordinate as a string", "/model/nodes/tip/0", json!("-1.5"), "found the string `-1.5`; a number"),
        at("coordinate null", "/model/nodes/tip/0", json!(null), "found null; a number"),
        at("coordinates as a number", "/model/nodes/tip", json!(1), "found the number `1`; an array"),
        at("node name as a number", "/model/elements/0/nodes/1", json!(7), "found the number `7`; a string"),
        at(
            "kind as a number",
            "/model/elements/0/kind",
            json!(7),
            "a kind of element (`bar`, `spring`, `beam`, `rotational_spring`, `triangle3`, `triangle6`, `quadrilateral4`, \
             `quadrilateral8`, `tetrahedron4`, `tetrahedron10`, `hexahedron8`, `hexahedron20` and 1 more) is expected",
        ),
        at("fractional count", "/analysis/max_increments", json!(1.5), "found the number `1.5`; a whole number"),
        at("negative count", "/analysis/max_increments", json!(-1), "found the number `-1`; a whole number"),
        at("boolean friction", "/model/contacts/0/friction", json!(true), "found the boolean `true`; a number"),
        at("friction null", "/model/contacts/0/friction", json!(null), "found null; a number"),
        at("ball without center", ball, json!({"kind": "ball", "radius": 1}), "the field `center` is missing"),
        at("ball without radius", ball, json!({"kind": "ball", "center": [0, 0]}), "the field `radius` is missing"),
        ball_with(
            "ball with a point",
            json!({"point": [0, 0]}),
            "unknown field `point` of a ball; known: `kind`, `center`",
        )
        .told("/model/obstacles/floor/point"),
        ball_with(
            "unknown side",
            json!({"side": "inner"}),
            "not a side of a closed obstacle; known: `outside`, `inside`",
        )
        .told("/model/obstacles/floor/side"),
        ball_with("radius as a string", json!({"radius": "1"}), "found the string `1`; a number")
            .told("/model/obstacles/floor/radius"),
        ball_with("center as an object", json!({"center": {}}), "found an object; an array")
            .told("/model/obstacles/floor/center"),
        at("displacements as an array", "/model/stages/0/displacements", json!([]), "an object, `{...}`, is expected"),
        at(
            "motion as a number",
            "/model/stages/0/obstacle_motion",
            json!({"floor": 1}),
            "an array of numbers, as `[0, 1]`, is expected",
        )
        .told("/model/stages/0/obstacle_motion/floor"),
        at("unknown field of a stage", "/model/stages/0/displacement", json!({}), "did you mean `displacements`?"),
        at("unknown selection", "/analysis/selection", json!("max_potential_energy"), "did you mean `min_potential"),
        at("explore as a flag", "/analysis/explore", json!(true), "an exploration, an object, is expected"),
        at("explore without depth", "/analysis/explore", json!({"max_jobs": 1}), "the field `depth` is missing"),
        at("explore without bound", "/analysis/explore", json!({"depth": 1}), "the field `max_jobs` is missing"),
        at("explore by fractions", "/analysis/explore", json!({"depth": 0.5, "max_jobs": 1}), "a whole number")
            .told("/analysis/explore/depth"),
        at("unknown field of explore", "/analysis/explore", json!({"depht": 1}), "did you mean `depth`?")
            .told("/analysis/explore/depht"),
        at("analysis as a string", "/analysis", json!("mpec"), "an analysis, an object, is expected"),
    ]
}

pub fn not_available() -> Vec<BadDocument> {
    vec![at(
        "segment",
        "/model/obstacles/floor/kind",
        json!("segment"),
        "`plane`, `ball`, `cylinder`, `polyline`, `box`, `triangle_mesh` would do",
    )]
}
