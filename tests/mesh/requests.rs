//! Meshes within requests.

use crate::samples::{all, mesh};
use arcslip::model::JobRequest;
use arcslip::model::decode::decode;
use arcslip::model::mesh::convert::ConvertedModel;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

fn request(mesh: &Value, elements: &Value, dimension: usize) -> Value {
    json!({"model": {"dimension": dimension, "mesh": mesh, "elements": elements,
        "materials": {"matter": {"kind": "neo_hookean", "young": 1, "poisson": 0.3}}, "stages": []}})
}

fn decoded(request: &Value) -> Result<Value, String> {
    let request = decode(request.to_string().as_bytes()).map_err(|errors| errors.to_string())?;
    Ok(serde_json::to_value(request.model).expect("JSON"))
}

/// Every sample, text or binary, becomes the model that `convert` prints, but for the material and the third direction.
#[test]
fn a_mesh_within_a_request_is_the_model_that_convert_prints() {
    let mut compared = 0;
    for (name, bytes) in all() {
        let sample = mesh(&name);
        let Ok(converted) = ConvertedModel::new(&sample, None) else { continue };
        let converted: Value = serde_json::from_str(&converted.json().expect("JSON")).expect("JSON");
        let given = match String::from_utf8(bytes) {
            Ok(text) => json!({"content": text}),
            Err(binary) => json!({"content": STANDARD.encode(binary.as_bytes()), "encoding": "base64"}),
        };
        let dimension = sample.dimension();
        let elements = if dimension == 2 {
            json!([{"kind": "solid", "material": "matter", "plane": "strain"}])
        } else {
            json!([{"kind": "solid", "material": "matter"}])
        };
        let mut model =
            decoded(&request(&given, &elements, dimension)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut expected = converted["model"].clone();
        for element in
            [&mut model, &mut expected].into_iter().flat_map(|model| model["elements"].as_array_mut()).flatten()
        {
            for member in ["material", "plane", "thickness"] {
                element.as_object_mut().map(|element| element.remove(member));
            }
        }
        for member in ["nodes", "elements", "sets"] {
            // A group of faces that are not outer ones is a set of nodes.
            if member == "sets" && model["surfaces"] != expected["surfaces"] {
                continue;
            }
            assert_eq!(model[member], expected[member], "{name}: {member}");
        }
        compared += 1;
    }
    println!("{compared} samples");
    assert!(compared >= 30);
}

const DECK: &str = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n5,2,0\n6,2,1\n*ELEMENT,TYPE=CPE4,ELSET=left\n1,1,2,3,4\n\
    *ELEMENT,TYPE=CPE4,ELSET=right\n2,2,5,6,3\n*NSET,NSET=foot\n1,5\n*SURFACE,NAME=top\nleft,S3\nright,S3\n\
    *MATERIAL,NAME=Rubber\n*HYPERELASTIC,NEO HOOKE\n0.5,2\n*SOLID SECTION,ELSET=left,MATERIAL=RUBBER\n0.5\n";

fn two_groups() -> Value {
    json!({"model": {"dimension": 2, "mesh": {"format": "abaqus", "content": DECK},
        "nodes": {"anchor": [3, 0]},
        "materials": {"steel": {"kind": "linear_elastic", "young": 100, "poisson": 0.3}},
        "elements": [{"kind": "solid", "group": "left"},
            {"kind": "bar", "nodes": ["5", "anchor"], "axial_stiffness": 1.0},
            {"kind": "solid", "group": "right", "material": "steel", "plane": "stress", "thickness": 2}],
        "supports": {"@foot": ["x", "y"], "anchor": ["x", "y"]},
        "surfaces": {"lid": {"group": "top"}},
        "obstacles": {"ceiling": {"kind": "plane", "point": [0, 1.1], "normal": [0, -1]}},
        "contacts": [{"surface": "lid", "obstacle": "ceiling", "friction": 0.2}],
        "stages": [{"name": "pull", "tractions": {"lid": [0, 0.1]}}]}})
}

#[test]
fn groups_sets_and_surfaces_of_the_mesh_are_those_of_the_model() {
    let model = decoded(&two_groups()).expect("a model");
    assert_eq!(
        model["elements"][0],
        json!({"kind": "quadrilateral4", "nodes": ["1", "2", "3", "4"], "name": "e1",
        "material": "Rubber", "plane": "strain", "thickness": 0.5})
    );
    assert_eq!(model["elements"][1]["kind"], "bar");
    assert_eq!(
        model["elements"][2],
        json!({"kind": "quadrilateral4", "nodes": ["2", "5", "6", "3"], "name": "e2",
        "material": "steel", "plane": "stress", "thickness": 2.0})
    );
    assert_eq!(model["materials"]["Rubber"]["kind"], "neo_hookean");
    assert_eq!(model["nodes"].as_object().expect("nodes").len(), 7);
    assert_eq!(model["supports"]["5"], json!(["x", "y"]));
    assert_eq!(model["surfaces"]["lid"], model["surfaces"]["top"]);
    let touching: Vec<&Value> =
        model["contacts"].as_array().expect("contacts").iter().map(|one| &one["node"]).collect();
    assert_eq!(touching, ["3", "4", "6"]);
    let mut request = two_groups();
    request["analysis"] = json!({"record": {"elements": ["@left", 1]}});
    let recorded = decode(request.to_string().as_bytes()).expect("a request").analysis.record.expect("a record");
    assert_eq!(serde_json::to_value(recorded.elements).expect("JSON"), json!(["e1", 1]));
    request["analysis"]["record"]["elements"] = json!(["@foot"]);
    let refused = decode(request.to_string().as_bytes()).expect_err("a mistake").to_string();
    assert!(refused.contains("analysis.record.elements[0]: there is no set of elements `foot`"), "{refused}");
    assert!(model.get("mesh").is_none() && model["contacts"][0].get("surface").is_none());
    arcslip::read(two_groups().to_string().as_bytes()).expect("a sound model");
}

/// A model in code is expanded where its user asks for it, and refused where it is not.
#[test]
fn a_model_in_code_is_expanded_on_demand() {
    let request: JobRequest = serde_json::from_value(two_groups()).expect("a request");
    let refused = arcslip::model::check::check(&request).expect_err("names").to_string();
    for place in ["model.mesh", "model.surfaces.lid.group", "model.contacts[0].surface", "model.elements[0]"] {
        assert!(refused.contains(&format!("{place}: this names a part of a mesh")), "{place} in {refused}");
    }
    let expanded = arcslip::expanded(request).expect("parts");
    assert_eq!(serde_json::to_value(expanded.model).expect("JSON"), decoded(&two_groups()).expect("a model"));
}

#[test]
fn mistakes_in_a_mesh_of_a_request_are_told_at_their_places() {
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut request = two_groups();
        change(&mut request["model"]);
        decoded(&request).expect_err("a mistake")
    };
    type Change = fn(&mut Value);
    let cases: [(&str, Change); 14] = [
        ("model.elements[0].group: the mesh has no group of elements `lefft`", |model| {
            model["elements"][0]["group"] = json!("lefft");
        }),
        ("model.elements[2]: the element e1 of the mesh is in another group", |model| {
            model["elements"][2]["group"] = json!("left");
        }),
        ("model.elements[2]: `material` is missing", |model| {
            model["elements"][2] = json!({"kind": "solid", "group": "right"})
        }),
        ("model.mesh: `content`, the text of a mesh file, is missing", |model| model["mesh"] = json!({})),
        ("model.mesh: files are opened by the command line alone", |model| model["mesh"] = json!({"file": "a.msh"})),
        ("model.mesh.file: `content` is given, too", |model| model["mesh"]["file"] = json!("a.msh")),
        ("model.mesh.content: line 1: expected a section such as `$Nodes`", |model| {
            model["mesh"]["format"] = json!("gmsh")
        }),
        ("model.mesh.content: the content is not in base 64", |model| model["mesh"]["encoding"] = json!("base64")),
        ("model.mesh.format: `abacus` is not a format of meshes", |model| model["mesh"]["format"] = json!("abacus")),
        ("model.surfaces.lid.group: the mesh has no group of faces `tap`", |model| {
            model["surfaces"]["lid"]["group"] = json!("tap");
        }),
        ("model.surfaces.lid: `faces` and `group` are given", |model| {
            model["surfaces"]["lid"]["faces"] = json!([["3", "4"]])
        }),
        ("model.contacts[0]: `node` and `surface` are given", |model| model["contacts"][0]["node"] = json!("1")),
        ("model.contacts[0].surface: there is no set or surface `lad`", |model| {
            model["contacts"][0]["surface"] = json!("lad");
        }),
        ("model.mesh: the mesh has solids of 2 dimensions, the model has 3", |model| model["dimension"] = json!(3)),
    ];
    for (expected, change) in cases {
        let found = changed(&change);
        assert!(found.contains(expected), "expected {expected}, found {found}");
    }
    let without = changed(&|model: &mut Value| {
        model.as_object_mut().map(|model| model.remove("mesh"));
    });
    assert!(without.contains("model.elements[0]: this is a part of a mesh, and the model has none"), "{without}");
    let named = changed(&|model: &mut Value| model["nodes"]["5"] = json!([9, 9]));
    assert!(named.contains("model.nodes[5]: the mesh has a node of this name, too"), "{named}");
    let unused = changed(&|model: &mut Value| model["elements"] = json!([]));
    assert!(unused.contains("model.elements: no element is made of the mesh"), "{unused}");
}
