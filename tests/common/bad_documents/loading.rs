//! Stages, their ends, and the analysis.

use serde_json::{Value, json};

use super::{BadDocument, at, elsewhere};

pub fn stages() -> Vec<BadDocument> {
    let again = json!({"name": "push", "forces": {"tip": [1, 0]}});
    vec![
        at("no stage at all", "/model/stages", json!([]), "at least one"),
        at("empty stage name", "/model/stages/0/name", json!(""), "the name is empty"),
        at("stage name of two lines", "/model/stages/0/name", json!("a\nb"), "control character"),
        at("stage name twice", "/model/stages/-", again, "stands twice").told("/model/stages/1/name"),
        at("force on an unknown node", "/model/stages/0/forces/pit", json!([1, 0]), "did you mean `pin`?"),
        at("force with a short vector", "/model/stages/0/forces/tip", json!([1]), "found 1 numbers"),
        at("no load: zero", "/model/stages/0/forces/tip", json!([0, 0]), "no load").told("/model/stages/0/forces"),
        at("no load: none", "/model/stages/0/forces", json!({}), "no load").told("/model/stages/0"),
        at("no load: on a support", "/model/stages/0/forces", json!({"pin": [1, 1]}), "no load"),
    ]
}

pub fn motions() -> Vec<BadDocument> {
    let stage = "/model/stages/0";
    let forces = "/model/stages/0/forces";
    let displacements = "/model/stages/0/displacements";
    let motion = "/model/stages/0/obstacle_motion";
    let block = json!({"kind": "plane", "point": [5, 0], "normal": [-1, 0]});
    let none = (forces, json!({}));
    let post = [none.clone(), ("/model/nodes/post", json!([9, 9])), ("/model/supports/post", json!(["x", "y"]))];
    let alone = [post.as_slice(), &[(displacements, json!({"post": [1, 0]}))]].concat();
    let along = [none.clone(), ("/model/contacts/0/friction", json!(0)), (motion, json!({"floor": [1, 0]}))];
    let still = [none, (displacements, json!({"pin": [0, 0]})), (motion, json!({"floor": [0, 0]}))];
    let unused = [("/model/obstacles/block", block), (motion, json!({"block": [-1, 0]}))];
    let rotation = "/model/stages/0/obstacle_rotation";
    let idle = [unused[0].clone(), (rotation, json!({"block": {"angle": 1}}))];
    let points = json!({"kind": "polyline", "points": [[0, -9], [1, -9]]});
    let curve = [
        ("/model/obstacles/curve", points),
        ("/model/contacts/-", json!({"node": "tip", "obstacle": "curve"})),
        (rotation, json!({"curve": {"angle": 1}})),
    ];
    let tilt = |about: Value| json!({"floor": {"angle": 0.1, "about": about}});
    let pivots = [
        (rotation, tilt(json!([0, 0]))),
        ("/model/stages/-", json!({"name": "tilt", "obstacle_rotation": tilt(json!([0, 1]))})),
    ];
    let dragged = [(rotation, tilt(json!([0, 0]))), ("/model/supports/tip", json!(["x"]))];
    vec![
        at("displacement of an unknown node", displacements, json!({"pit": [1, 0]}), "did you mean `pin`?")
            .told("/model/stages/0/displacements/pit"),
        at("displacement with a long vector", displacements, json!({"pin": [1, 0, 0]}), "found 3 numbers")
            .told("/model/stages/0/displacements/pin"),
        at("huge displacement", displacements, json!({"pin": [1e80, 0]}), "choose other units")
            .told("/model/stages/0/displacements/pin/0"),
        at(
            "displacement of a free node",
            displacements,
            json!({"tip": [0, 1]}),
            "`y` of `tip` is free; support it, or",
        )
        .told("/model/stages/0/displacements/tip/1"),
        at("motion of an unknown obstacle", motion, json!({"flor": [1, 0]}), "did you mean `floor`?")
            .told("/model/stages/0/obstacle_motion/flor"),
        at("motion with a short vector", motion, json!({"floor": [1]}), "found 1 numbers")
            .told("/model/stages/0/obstacle_motion/floor"),
        at("huge motion", motion, json!({"floor": [0, -1e80]}), "choose other units")
            .told("/model/stages/0/obstacle_motion/floor/1"),
        elsewhere("motion without contact", &unused, "/model/stages/0/obstacle_motion/block", "does nothing; add one"),
        at("rotation of an unknown obstacle", rotation, json!({"flor": {"angle": 1}}), "did you mean `floor`?")
            .told("/model/stages/0/obstacle_rotation/flor"),
        at("rotation without an angle", rotation, json!({"floor": {"about": [0, 0]}}), "angle")
            .told("/model/stages/0/obstacle_rotation/floor"),
        at("rotation as a number", rotation, json!({"floor": 1}), "a rotation of an obstacle, an object")
            .told("/model/stages/0/obstacle_rotation/floor"),
        at("rotation about a short vector", rotation, json!({"floor": {"angle": 1, "about": [1]}}), "found 1 numbers")
            .told("/model/stages/0/obstacle_rotation/floor/about"),
        at("axis in the plane", rotation, json!({"floor": {"angle": 1, "axis": [0, 0, 1]}}), "leave the axis out")
            .told("/model/stages/0/obstacle_rotation/floor/axis"),
        elsewhere(
            "rotation without contact",
            &idle,
            "/model/stages/0/obstacle_rotation/block",
            "does nothing; add one",
        ),
        elsewhere("polyline about nothing", &curve, "/model/stages/0/obstacle_rotation/curve", "`about` is expected"),
        elsewhere("another pivot", &pivots, "/model/stages/1/obstacle_rotation/floor", "about another point or axis"),
        elsewhere("friction on a support", &dragged, "/model/contacts/0/friction", "hold it by a spring"),
        elsewhere("no load: a support apart", &alone, stage, "no load"),
        elsewhere("no load: a plane along itself", &along, stage, "no load"),
        elsewhere("no load: nothing moves", &still, stage, "no load"),
    ]
}

pub fn ends() -> Vec<BadDocument> {
    let until = "/model/stages/0/until";
    let bound = |members: Value| {
        let mut bound = json!({"node": "tip", "component": "x"});
        if let (Value::Object(bound), Value::Object(members)) = (&mut bound, members) {
            bound.extend(members);
        }
        vec![("/model/stages/0/until/displacement", bound)]
    };
    let place = "/model/stages/0/until/displacement";
    let unknown = bound(json!({"node": "tio", "above": 1}));
    vec![
        at("no end in until", until, json!({}), "no end is given"),
        at("until as a number", until, json!(1), "an end of a stage, an object, is expected"),
        at("load bound at the start", "/model/stages/0/until/load_above", json!(0), "above 0 is expected"),
        at("load bound behind the start", "/model/stages/0/until/load_below", json!(0.5), "below 0 is expected"),
        at("no limit point", "/model/stages/0/until/limit_points", json!(0), "1 or more"),
        at("no contact change", "/model/stages/0/until/contact_change", json!(0), "1 or more"),
        at("no increment", "/model/stages/0/until/increments", json!(0), "1 or more"),
        elsewhere("bound without a side", &bound(json!({})), place, "exactly one of"),
        elsewhere("bound with both sides", &bound(json!({"above": 1, "below": -1})), place, "exactly one of"),
        elsewhere(
            "bound at the start",
            &bound(json!({"above": 0})),
            "/model/stages/0/until/displacement/above",
            "start at 0",
        ),
        elsewhere(
            "bound on an unknown node",
            &unknown,
            "/model/stages/0/until/displacement/node",
            "did you mean `tip`?",
        ),
        elsewhere(
            "bound on a support",
            &bound(json!({"node": "pin", "above": 1})),
            "/model/stages/0/until/displacement/component",
            "never moves",
        ),
        elsewhere(
            "bound on the other component of a moving support",
            &[
                bound(json!({"node": "pin", "above": 1})).as_slice(),
                &[("/model/stages/0/displacements", json!({"pin": [0, 1]}))],
            ]
            .concat(),
            "/model/stages/0/until/displacement/component",
            "`displacements` move",
        ),
        elsewhere(
            "bound out of the plane",
            &bound(json!({"component": "z", "above": 1})),
            "/model/stages/0/until/displacement/component",
            "no component `z`",
        ),
    ]
}

pub fn analysis() -> Vec<BadDocument> {
    vec![
        at("no arc length", "/analysis/arc_length/min", json!(0), "above 0"),
        at("negative arc length", "/analysis/arc_length/initial", json!(-0.1), "above 0"),
        at("arc length too short", "/analysis/arc_length/initial", json!(1e-7), "between `min`"),
        at("arc length too long", "/analysis/arc_length/initial", json!(7), "between `min`"),
        at("arc lengths crossed", "/analysis/arc_length/max", json!(1e-9), "at least `min`"),
        at("no displacement scale", "/analysis/arc_length/displacement_scale", json!(0), "above 0"),
        at("negative load scale", "/analysis/arc_length/load_scale", json!(-1), "above 0"),
        at("no increments", "/analysis/max_increments", json!(0), "1 or more"),
        at("absurd increments", "/analysis/max_increments", json!(u64::MAX), "at most 10000000"),
        at("explore no depth", "/analysis/explore", json!({"depth": 0, "max_jobs": 9}), "1 or more")
            .told("/analysis/explore/depth"),
        at("explore too deep", "/analysis/explore", json!({"depth": 101, "max_jobs": 9}), "at most 100")
            .told("/analysis/explore/depth"),
        at("explore no jobs", "/analysis/explore", json!({"depth": 9, "max_jobs": 0}), "1 or more")
            .told("/analysis/explore/max_jobs"),
        at("explore many jobs", "/analysis/explore", json!({"depth": 9, "max_jobs": 10_001}), "at most 10000")
            .told("/analysis/explore/max_jobs"),
        at("no modes", "/analysis/max_modes", json!(0), "1 or more"),
    ]
}
