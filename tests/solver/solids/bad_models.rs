//! What is wrong with a model of solids is told: where, what, and what would do.

use serde_json::{Value, json};

/// Two squares side by side on a floor.
fn model() -> Value {
    json!({
        "dimension": 2,
        "nodes": {"a": [0, 0], "b": [1, 0], "c": [2, 0], "d": [0, 1], "e": [1, 1], "f": [2, 1]},
        "materials": {"rubber": {"kind": "neo_hookean", "young": 2, "poisson": 0.3}},
        "elements": [
            {"kind": "quadrilateral4", "nodes": ["a", "b", "e", "d"], "material": "rubber", "plane": "strain", "name": "left"},
            {"kind": "quadrilateral4", "nodes": ["b", "c", "f", "e"], "material": "rubber", "plane": "strain"}
        ],
        "surfaces": {"top": {"faces": [["d", "e"], ["f", "e"]]}},
        "sets": {"foot": {"nodes": ["a", "b", "c"]}, "part": {"elements": ["left"]}, "none": {}},
        "supports": {"@foot": ["x", "y"]},
        "stages": [{"name": "press", "tractions": {"top": [0, -0.1]}, "until": {"load_above": 1}}]
    })
}

/// The mistakes of a changed model, as pointer and text.
fn mistakes(change: impl Fn(&mut Value)) -> Vec<(String, String)> {
    let mut model = model();
    change(&mut model);
    match arcslip::read(json!({"model": model}).to_string().as_bytes()) {
        Ok(_) => Vec::new(),
        Err(errors) => errors.0.into_iter().map(|error| (error.pointer, error.detail)).collect(),
    }
}

#[track_caller]
fn is_told(pointer: &str, words: &str, change: impl Fn(&mut Value)) {
    let found = mistakes(change);
    let told = found.iter().any(|(at, detail)| at == pointer && detail.contains(words));
    assert!(told, "`{words}` at {pointer} is not in {found:#?}");
}

#[test]
fn mistakes_in_solids_are_told() {
    assert_eq!(mistakes(|_| {}), []);
    let element = "/model/elements/0";
    is_told(&format!("{element}/nodes"), "counter-clockwise", |model| {
        model["elements"][0]["nodes"] = json!(["a", "d", "e", "b"]);
    });
    is_told(&format!("{element}/nodes"), "has 4", |model| model["elements"][0]["nodes"] = json!(["a", "b", "e"]));
    is_told(&format!("{element}/material"), "did you mean `rubber`", |model| {
        model["elements"][0]["material"] = json!("ruber");
    });
    is_told(element, "`plane` is missing", |model| {
        model["elements"][0].as_object_mut().expect("an object").remove("plane");
    });
    is_told(&format!("{element}/kind"), "3 dimensions", |model| {
        model["elements"][0]["kind"] = json!("tetrahedron4");
        model["elements"][0].as_object_mut().expect("an object").remove("plane");
    });
    is_told(&format!("{element}/thickness"), "above 0", |model| model["elements"][0]["thickness"] = json!(0));
    is_told("/model/elements/1/plane", "bodies of revolution", |model| {
        model["elements"][0]["plane"] = json!("axisymmetric");
    });
    is_told(&format!("{element}/locking"), "leave `locking` out", |model| {
        model["elements"][0]["kind"] = json!("triangle3");
        model["elements"][0]["nodes"] = json!(["a", "b", "e"]);
        model["elements"][0]["locking"] = json!("mean_gradient");
    });
    is_told("/model/materials/rubber/poisson", "below 0.5", |model| {
        model["materials"]["rubber"]["poisson"] = json!(0.5);
    });
    is_told("/model/materials/rubber", "none below 0", |model| {
        model["materials"]["rubber"] = json!({"kind": "mooney_rivlin", "c10": 0, "bulk_modulus": 1});
    });
}

#[test]
fn mistakes_in_surfaces_and_loads_are_told() {
    let face = "/model/surfaces/top/faces/0";
    is_told(face, "no solid has a face", |model| model["surfaces"]["top"]["faces"][0] = json!(["a", "e"]));
    is_told("/model/surfaces/top/faces/1", "in the list already, at 0", |model| {
        let mut turned = model["surfaces"]["top"]["faces"][0].as_array().expect("a face").clone();
        turned.reverse();
        model["surfaces"]["top"]["faces"] = json!([model["surfaces"]["top"]["faces"][0], turned]);
    });
    is_told(face, "inside the body", |model| model["surfaces"]["top"]["faces"][0] = json!(["b", "e"]));
    is_told(&format!("{face}/1"), "no node", |model| model["surfaces"]["top"]["faces"][0] = json!(["d", "z"]));
    is_told("/model/stages/0/tractions/tip", "no surface", |model| {
        model["stages"][0]["tractions"] = json!({"tip": [0, 1]});
    });
    is_told("/model/stages/0/body_forces/steel", "no material", |model| {
        model["stages"][0]["body_forces"] = json!({"steel": [0, 1]});
    });
    is_told("/model/stages/0/pressures/tip", "no surface", |model| model["stages"][0]["pressures"] = json!({"tip": 1}));
    is_told("/model/stages/0/pressures/top", "a number is expected", |model| {
        model["stages"][0]["pressures"] = json!({"top": [0, 1]});
    });
    is_told("/model/stages/0", "no load", |model| model["stages"][0]["tractions"] = json!({"top": [0, 0]}));
}

#[test]
fn mistakes_in_sets_are_told() {
    is_told("/model/supports/@feet", "did you mean `foot`", |model| model["supports"] = json!({"@feet": ["x"]}));
    is_told("/model/supports/@none", "no nodes", |model| model["supports"]["@none"] = json!(["x"]));
    is_told("/model/stages/0/forces/@top", "another value", |model| {
        model["stages"][0]["forces"] = json!({"d": [1, 0], "@top": [2, 0]});
    });
    is_told("/model/stages/200/forces/@many", "altogether", |model| {
        let many: Vec<String> = (0..5000).map(|place| format!("n{place}")).collect();
        model["sets"]["many"]["nodes"] = json!(many);
        model["stages"] =
            (0..1000).map(|stage| json!({"name": format!("{stage}"), "forces": {"@many": [0, 1]}})).collect();
    });
    // Of elements their nodes, and components of several entries are united.
    let mut model = model();
    model["supports"] = json!({"@part": ["x"], "a": ["y"], "@foot": ["y"]});
    let request = arcslip::read(json!({"model": model}).to_string().as_bytes()).expect("a request");
    let held: Vec<(&str, usize)> =
        request.model.supports.iter().map(|(node, held)| (node.as_str(), held.len())).collect();
    assert_eq!(held, [("a", 2), ("b", 2), ("e", 1), ("d", 1), ("c", 1)]);
}
