//! Structures, contacts and sizes that cannot be solved.

use serde_json::{Value, json};

use super::{BadDocument, at, ball_with, elsewhere, raw};

pub fn structure() -> Vec<BadDocument> {
    let unsymmetric = json!([[1, 0.5], [0.4, 2]]);
    vec![
        at("one dimension", "/model/dimension", json!(1), "found 1; 2 or 3"),
        at("many dimensions", "/model/dimension", json!(u64::MAX), "2 or 3 is expected"),
        at("no node at all", "/model/nodes", json!({}), "at least one"),
        at("too many coordinates", "/model/nodes/tip", json!([-1.5, 0, 0]), "found 3 numbers; 2 are expected"),
        at("too few coordinates", "/model/nodes/tip", json!([]), "found 0 numbers"),
        at("huge coordinate", "/model/nodes/tip/0", json!(1e200), "choose other units"),
        at("tiny coordinate", "/model/nodes/tip/0", json!(1e-200), "0, or at least 1e-75"),
        at("empty node name", "/model/nodes/", json!([0, 0]), "the name is empty"),
        at("support of an unknown node", "/model/supports/pn", json!(["x"]), "did you mean `pin`?"),
        at("support of nothing", "/model/supports/pin", json!([]), "no component is named"),
        at("support named twice", "/model/supports/pin/1", json!("x"), "`x` is named twice"),
        at("support out of the plane", "/model/supports/pin/1", json!("z"), "no component `z` in 2 dimensions"),
        at("bar to an unknown node", "/model/elements/0/nodes/1", json!("tap"), "did you mean `tip`?"),
        at("bar to itself", "/model/elements/0/nodes/1", json!("pin"), "stands twice"),
        at("bar of three nodes", "/model/elements/0/nodes", json!(["pin", "tip", "tip"]), "a bar has 2"),
        at("bar of no nodes", "/model/elements/0/nodes", json!([]), "found 0 nodes; a bar has 2"),
        at("bar without stiffness", "/model/elements/0/axial_stiffness", json!(0), "above 0"),
        at("bar of negative stiffness", "/model/elements/0/axial_stiffness", json!(-1), "above 0"),
        at("bar without rest length", "/model/elements/0/rest_length", json!(0.0), "above 0"),
        at("huge prestress", "/model/elements/0/prestress", json!(-1e300), "choose other units"),
        elsewhere(
            "bar of no length",
            &[("/model/nodes/tip", json!([0, 1]))],
            "/model/elements/0/nodes",
            "the same place",
        ),
        at("spring of no nodes", "/model/elements/1/nodes", json!([]), "found 0 nodes; a spring has 1"),
        at("spring of three nodes", "/model/elements/1/nodes", json!(["tip", "pin", "tip"]), "found 3 nodes"),
        at("spring to an unknown node", "/model/elements/1/nodes/0", json!("top"), "did you mean `tip`?"),
        at("spring without symmetry", "/model/elements/1/stiffness", unsymmetric, "symmetric")
            .told("/model/elements/1/stiffness/1/0"),
        at("spring of one row", "/model/elements/1/stiffness", json!([[1, 0]]), "found 1 rows; 2 rows"),
        at("spring with a short row", "/model/elements/1/stiffness/1", json!([1]), "found 1 numbers; 2"),
        at("spring that does nothing", "/model/elements/1/stiffness", json!([[0, 0], [0, 0]]), "the stiffness is zero"),
    ]
}

pub fn mechanisms() -> Vec<BadDocument> {
    let apart = [("/model/nodes/a", json!([5, 5])), ("/model/nodes/b", json!([6, 5]))];
    let joined = json!({"kind": "bar", "nodes": ["a", "b"], "axial_stiffness": 1});
    let floating = [apart.as_slice(), &[("/model/elements/-", joined)]].concat();
    vec![
        at("node that nothing holds", "/model/nodes/lost", json!([5, 5]), "no element holds the node `lost`"),
        elsewhere("element list empty", &[("/model/elements", json!([]))], "/model/nodes/tip", "no element holds"),
        elsewhere("part that floats", &floating, "/model/nodes/a", "hangs on nothing"),
    ]
}

pub fn contacts() -> Vec<BadDocument> {
    let ceiling = json!({"kind": "plane", "point": [0, 0], "normal": [0, -2]});
    let low_ceiling = json!({"kind": "plane", "point": [0, -1], "normal": [0, -1]});
    let against = |obstacle: &str| json!({"node": "tip", "obstacle": obstacle});
    let both = |plane| [("/model/obstacles/ceiling", plane), ("/model/contacts/-", against("ceiling"))];
    let behind = [("/model/nodes/tip", json!([-1.5, -0.25]))];
    let held = [("/model/supports/tip", json!(["y"]))];
    vec![
        at("plane without normal", "/model/obstacles/floor/normal", json!([0, 0]), "the normal is zero"),
        at("plane with a short normal", "/model/obstacles/floor/normal", json!([1]), "found 1 numbers"),
        at("plane with a long point", "/model/obstacles/floor/point", json!([0, 0, 0]), "found 3 numbers"),
        at("contact of an unknown node", "/model/contacts/0/node", json!("tipp"), "did you mean `tip`?"),
        at("contact with an unknown obstacle", "/model/contacts/0/obstacle", json!("flor"), "did you mean `floor`?"),
        at("negative friction", "/model/contacts/0/friction", json!(-0.3), "a coefficient of 0 or more"),
        at("huge friction", "/model/contacts/0/friction", json!(1e100), "at most 1e75"),
        elsewhere(
            "contact of a support",
            &[("/model/contacts/0/node", json!("pin"))],
            "/model/contacts/0/node",
            "cannot move freely; leave",
        ),
        elsewhere("contact across a support", &held, "/model/contacts/0/node", "cannot move freely along"),
        elsewhere("initial penetration", &behind, "/model/contacts/0", "gap -0.25"),
        elsewhere("no room", &both(ceiling), "/model/contacts/1", "`floor` and `ceiling` leave 0.0 between them"),
        elsewhere("less than no room", &both(low_ceiling), "/model/contacts/1", "leave -1.0 between them"),
    ]
}

/// The floor replaced by a ball; the tip is at (-1.5, 0).
pub fn balls() -> Vec<BadDocument> {
    let floor = "/model/obstacles/floor";
    let contact = "/model/contacts/0";
    let node = "/model/contacts/0/node";
    let around_tip = |radius: f64, side: &str| json!({"center": [-1.5, 0], "radius": radius, "side": side});
    let below = json!({"kind": "ball", "center": [-1.5, -1], "radius": 1});
    let sideways = [(floor, below.clone()), ("/model/supports/tip", json!(["y"]))];
    let held = [(floor, below), ("/model/supports/tip", json!(["x", "y"]))];
    vec![
        ball_with("ball with a short center", json!({"center": [0]}), "found 1 numbers; 2 are expected")
            .told("/model/obstacles/floor/center"),
        ball_with("ball with a huge center", json!({"center": [0, 1e90]}), "choose other units")
            .told("/model/obstacles/floor/center/1"),
        ball_with("ball of no radius", json!({"radius": 0}), "above 0").told("/model/obstacles/floor/radius"),
        ball_with("ball of negative radius", json!({"radius": -1}), "above 0").told("/model/obstacles/floor/radius"),
        ball_with("ball of huge radius", json!({"radius": 1e90}), "other units").told("/model/obstacles/floor/radius"),
        ball_with("node inside a ball", json!({"radius": 2}), "inside the ball `floor` at the start, gap -0.5")
            .told(contact),
        ball_with("node outside a ball", json!({"side": "inside"}), "outside the ball `floor` at the start, gap -0.5")
            .told(contact),
        ball_with("node at the centre", around_tip(1.0, "inside"), "move it off the centre").told(contact),
        ball_with("node at the centre of a solid ball", around_tip(1.0, "outside"), "gap -1.0").told(contact),
        ball_with("node at a ball that is a point", around_tip(1e-14, "outside"), "off the centre").told(contact),
        elsewhere("ball against a support", &held, node, "cannot move freely; leave the contact out"),
        elsewhere("ball touched sideways", &sideways, node, "touches the ball where it cannot move freely"),
    ]
}

/// The scene in space with the floor replaced by a cylinder; the tip is at (-1.5, 0, 0).
pub fn cylinders() -> Vec<BadDocument> {
    let floor = "/model/obstacles/floor";
    let cylinder = |members: Value| {
        let mut cylinder = json!({"kind": "cylinder", "point": [-1.5, -2, 0], "axis": [0, 0, 1], "radius": 1});
        if let (Value::Object(cylinder), Value::Object(members)) = (&mut cylinder, members) {
            cylinder.extend(members);
        }
        cylinder
    };
    let in_space = |members: Value| {
        vec![
            ("/model/dimension", json!(3)),
            ("/model/nodes", json!({"pin": [0, 1, 0], "tip": [-1.5, 0, 0]})),
            ("/model/supports/pin", json!(["x", "y", "z"])),
            ("/model/stages/0/forces", json!({"tip": [1, 0, 0]})),
            (floor, cylinder(members)),
        ]
    };
    let wrong = |name, members: Value, pointer, detail| elsewhere(name, &in_space(members), pointer, detail);
    vec![
        elsewhere(
            "cylinder in the plane",
            &[(floor, cylinder(json!({})))],
            "/model/obstacles/floor/kind",
            "in the plane take a ball",
        ),
        wrong(
            "cylinder without an axis",
            json!({"axis": [0, 0, 0]}),
            "/model/obstacles/floor/axis",
            "the axis is zero",
        ),
        wrong("short axis", json!({"axis": [0, 1]}), "/model/obstacles/floor/axis", "found 2 numbers; 3 are expected"),
        wrong("cylinder of no radius", json!({"radius": 0}), "/model/obstacles/floor/radius", "above 0"),
        wrong(
            "node in a cylinder",
            json!({"radius": 3}),
            "/model/contacts/0",
            "inside the cylinder `floor` at the start",
        ),
        wrong("node out of a pipe", json!({"side": "inside"}), "/model/contacts/0", "outside the cylinder `floor`"),
        wrong(
            "node on the axis",
            json!({"point": [-1.5, 0, 7], "side": "inside"}),
            "/model/contacts/0",
            "move it off the axis",
        ),
        wrong("cylinder with a centre", json!({"center": [0, 0, 0]}), "/model/obstacles/floor/center", "unknown"),
    ]
}

pub fn sizes() -> Vec<BadDocument> {
    let named = |count: usize, value: Value| {
        Value::Object((0..count).map(|index| (format!("n{index}"), value.clone())).collect())
    };
    let contact = json!({"node": "tip", "obstacle": "floor"});
    let stage = json!({"name": "s", "forces": {"tip": [1, 0]}});
    let long_name = "n".repeat(201);
    let very_long_name = format!("/model/nodes/{}", "n".repeat(1_000_000));
    vec![
        at("too many nodes", "/model/nodes", named(1_000_001, json!([0, 0])), "at most 1000000"),
        at(
            "too many unknowns",
            "/model/nodes",
            named(750_001, json!([0, 0])),
            "1500002 free displacement components; at most 1500000",
        ),
        at("too many contacts", "/model/contacts", json!(vec![contact; 20_001]), "at most 20000"),
        at("too many stages", "/model/stages", json!(vec![stage; 1_001]), "at most 1000"),
        at("long model name", "/model/name", json!(long_name), "has 201 bytes; at most 200"),
        elsewhere("long node name", &[(&very_long_name, json!([0, 0]))], "/model/nodes", "has 1000000 bytes"),
        raw("long text", vec![b' '; 256 * 1024 * 1024 + 1], "at most 268435456"),
        raw("too many values", format!("[{}0]", "0,".repeat(4_000_000)), "more than 4000000 values"),
    ]
}
