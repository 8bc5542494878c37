//! Contacts of bodies that make none, each refused with its place.

use super::{Sheet, pair, support};
use serde_json::{Value, json};

fn whole() -> Value {
    let lower = Sheet::new("l", [3, 1], |x, y| [x, y]);
    let upper = Sheet::new("u", [2, 1], |x, y| [x, 1.0 + y]);
    let mut model = pair(&lower, &upper, &json!({"kind": "linear_elastic", "young": 1, "poisson": 0.3}), 0.3, false);
    support(&mut model, &lower.lowest(), &["x", "y"]);
    support(&mut model, &upper.highest(), &["x"]);
    model["stages"] = json!([{"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 0.01}}]);
    json!({"model": model})
}

fn refused(change: impl FnOnce(&mut Value), pointer: &str, words: &[&str]) {
    let mut posted = whole();
    change(&mut posted["model"]);
    let text = posted.to_string();
    let errors = match arcslip::model::decode::decode(text.as_bytes()) {
        Err(errors) => errors,
        Ok(request) => arcslip::continuation::scene::Scene::new(&request).map(|_| ()).expect_err(pointer),
    };
    let found = errors.0.iter().find(|error| error.pointer.starts_with(pointer));
    let found = found.unwrap_or_else(|| panic!("nothing at {pointer}: {errors}"));
    for word in words {
        assert!(found.detail.contains(word), "{}", found.detail);
    }
}

#[test]
fn what_makes_no_contact_of_bodies_is_refused_with_its_place() {
    assert!(arcslip::model::decode::decode(whole().to_string().as_bytes()).is_ok());
    let contact = "/model/contacts/0";
    refused(|model| model["contacts"][0]["against"] = json!("belov"), &format!("{contact}/against"), &["below"]);
    refused(|model| model["contacts"][0]["surface"] = json!("abov"), &format!("{contact}/surface"), &["above"]);
    refused(|model| model["contacts"][0]["obstacle"] = json!("below"), contact, &["`obstacle` and `against`"]);
    refused(
        |model| model["contacts"][0]["discretisation"] = json!("penalty"),
        &format!("{contact}/discretisation"),
        &["mortar", "node_to_surface"],
    );
    refused(
        |model| {
            model["obstacles"] = json!({"below": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}});
        },
        &format!("{contact}/against"),
        &["obstacle has the name"],
    );
    refused(
        |model| {
            model["contacts"][0]["against"] = json!("above");
            model["contacts"][0]["discretisation"] = json!("node_to_surface");
        },
        &format!("{contact}/discretisation"),
        &["itself", "mortar"],
    );
    refused(|model| model["surfaces"]["above"]["faces"] = json!([]), &format!("{contact}/surface"), &["no faces"]);
    // A contact of all nodes of a surface before it does not shift the place of another.
    let another = json!({"surface": "above", "against": "belov", "friction": 0.1});
    refused(
        |model| model["contacts"].as_array_mut().expect("contacts").push(another),
        "/model/contacts/1/against",
        &["belov"],
    );
    // The upper block begins inside the lower one.
    refused(
        |model| {
            for row in 0..2 {
                for column in 0..3 {
                    model["nodes"][format!("u{column}_{row}")][1] = json!(0.7 + f64::from(row));
                }
            }
        },
        &format!("{contact}/node"),
        &["behind", "gap -0.3"],
    );
    refused(
        |model| {
            let more = json!(["l1_1", "l1_0"]);
            model["surfaces"]["below"]["faces"].as_array_mut().expect("faces").push(more);
        },
        "/model/surfaces/below/faces/3",
        &["inside the body"],
    );
    // Two nodes at one place.
    refused(
        |model| model["nodes"]["u1_0"] = json!([0.0, 1.0]),
        &format!("{contact}/surface"),
        &["no length", "`u1_0`"],
    );
    refused(
        |model| {
            model["contacts"][0] = json!({"node": "u1_0", "against": "below"});
        },
        &format!("{contact}/node"),
        &["node_to_surface"],
    );
    refused(
        |model| {
            model["contacts"][0] = json!({"node": "u1_1", "surface": "above", "against": "below"});
        },
        &format!("{contact}/node"),
        &["no node of"],
    );
    // The traction on a node that is held along the surface while that is driven would be none of the path's unknowns.
    refused(
        |model| {
            for node in ["l0_0", "l1_0", "l2_0", "l3_0", "l0_1", "l1_1", "l2_1", "l3_1"] {
                model["supports"][node] = json!(["x", "y"]);
                model["stages"][0]["displacements"][node] = json!([0.1, 0]);
            }
            model["supports"]["u0_0"] = json!(["x"]);
        },
        &format!("{contact}/friction"),
        &["u0_0", "driven against each other", "hold it by a spring"],
    );
    refused(
        |model| {
            for element in model["elements"].as_array_mut().expect("elements") {
                element["plane"] = json!("axisymmetric");
            }
            model["nodes"]["a"] = json!([0.2, 1]);
            model["nodes"]["b"] = json!([0.8, 1]);
            model["elements"].as_array_mut().expect("elements").push(json!({
                "kind": "bar", "nodes": ["a", "b"], "axial_stiffness": 1,
            }));
            model["surfaces"]["below"]["faces"] = json!([["a", "b"]]);
        },
        contact,
        &["sides of bars", "revolution", "axisymmetric solids"],
    );
    refused(
        |model| {
            let again = model["contacts"][0].clone();
            model["contacts"].as_array_mut().expect("contacts").push(again);
        },
        "/model/contacts/",
        &["leave one of them out"],
    );
    refused(
        |model| {
            let turned = json!({"surface": "below", "against": "above"});
            model["contacts"].as_array_mut().expect("contacts").push(turned);
        },
        "/model/contacts/",
        &["both are too many"],
    );
    refused(|model| model["contacts"][0]["friction"] = json!(-0.1), &format!("{contact}/friction"), &["0 or more"]);
    refused(
        |model| model["stages"][0]["pressures"] = json!({"belov": 1}),
        "/model/stages/0/pressures/belov",
        &["below"],
    );
}

/// Two strings of bars over each other, of so many nodes that their contacts would couple millions of pairs of nodes: refused
/// before anything of that size is made.
#[test]
fn contacts_of_very_many_nodes_are_refused_at_once() {
    let count = 3_000;
    let (mut nodes, mut elements) = (serde_json::Map::new(), Vec::new());
    let mut surfaces = json!({});
    for (string, height) in [("low", 0.0), ("high", 1.0)] {
        let names: Vec<String> = (0..count).map(|k| format!("{string}{k}")).collect();
        for (k, name) in names.iter().enumerate() {
            nodes.insert(name.clone(), json!([k, height]));
        }
        let bars = names.windows(2).map(|ends| json!({"kind": "bar", "nodes": ends, "axial_stiffness": 1}));
        elements.extend(bars);
        // The free side of the upper string is below it.
        let ends = names
            .windows(2)
            .map(|ends| if string == "low" { vec![&ends[0], &ends[1]] } else { vec![&ends[1], &ends[0]] });
        surfaces[string] = json!({"faces": ends.collect::<Vec<_>>()});
    }
    let supports: serde_json::Map<String, Value> = nodes.keys().map(|name| (name.clone(), json!(["y"]))).collect();
    let posted = json!({"model": {
        "dimension": 2, "nodes": nodes, "elements": elements, "supports": supports, "surfaces": surfaces,
        "contacts": [{"surface": "high", "against": "low"}],
        "stages": [{"name": "pull", "forces": {"low5": [1, 0]}}]
    }});
    let errors = match arcslip::model::decode::decode(posted.to_string().as_bytes()) {
        Err(errors) => errors,
        Ok(request) => arcslip::continuation::scene::Scene::new(&request).map(|_| ()).expect_err("too many"),
    };
    let found = errors.0.iter().find(|error| error.pointer == "/model/contacts").expect("a mistake of contacts");
    assert!(found.detail.contains("at most 2000000 are taken"), "{}", found.detail);
}
