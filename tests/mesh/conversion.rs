//! Models made of meshes.

use crate::samples::{mesh, read};
use arcslip::model::mesh::convert::ConvertedModel;
use arcslip::model::mesh::data::mesh_data::{MeshData, PlaneState};
use serde_json::{Value, json};

fn model(mesh: &MeshData, plane: Option<PlaneState>) -> (Value, Vec<String>) {
    let converted = ConvertedModel::new(mesh, plane).unwrap_or_else(|error| panic!("{error}"));
    let request: Value = serde_json::from_str(&converted.json().expect("JSON")).expect("JSON");
    assert_eq!(request.as_object().expect("an object").len(), 1);
    (request["model"].clone(), converted.summary())
}

#[test]
fn a_deck_becomes_a_model() {
    let text = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n9,5,5\n*ELEMENT,TYPE=CPE4,ELSET=body\n12,1,2,3,4\n\
                *NSET,NSET=low\n1,2,9\n*SURFACE,NAME=top\nbody,S3\n*MATERIAL,NAME=Rubber\n*HYPERELASTIC,NEO HOOKE\n\
                0.5,2\n*DENSITY\n3\n*SOLID SECTION,ELSET=body,MATERIAL=RUBBER\n0.5\n*STEP\n";
    let (model, summary) = model(&read(text.as_bytes()).expect("a mesh"), Some(PlaneState::Stress));
    // Shear and bulk modulus 1: E = 9/4, ν = 1/8.
    let expected = json!({
        "dimension": 2,
        "nodes": {"1": [0.0, 0.0], "2": [1.0, 0.0], "3": [1.0, 1.0], "4": [0.0, 1.0]},
        "materials": {"Rubber": {"kind": "neo_hookean", "young": 2.25, "poisson": 0.125, "density": 3.0}},
        "elements": [{
            "kind": "quadrilateral4", "name": "e12", "nodes": ["1", "2", "3", "4"], "material": "Rubber",
            "plane": "strain", "thickness": 0.5
        }],
        "surfaces": {"top": {"faces": [["3", "4"]]}},
        "sets": {"low": {"nodes": ["1", "2"]}, "body": {"elements": ["e12"]}},
        "stages": [{"name": "loads"}]
    });
    assert_eq!(model, expected);
    let lines = [
        "4 nodes, 1 quadrilateral4; 2 sets, 1 surfaces, 1 materials",
        "1 nodes have no element and are left out",
        "line 20: not read: *STEP with all that it holds",
        "NEO HOOKE is neo_hookean with the same moduli in small strains",
    ];
    assert_eq!(summary, lines);
}

#[test]
fn groups_of_gmsh_name_materials() {
    let (plane, summary) = model(&mesh("quadrilateral8_41_text.msh"), None);
    assert_eq!(plane["elements"].as_array().expect("elements").len(), 8);
    assert_eq!(plane["elements"][0]["material"], "left");
    assert_eq!(plane["elements"][7]["material"], "right");
    assert_eq!(plane["elements"][0]["nodes"].as_array().expect("nodes").len(), 8);
    assert!(plane["elements"][0].get("plane").is_none());
    assert_eq!(plane["sets"]["pin"], json!({"nodes": ["1"]}));
    assert_eq!(plane["surfaces"]["lower edge"]["faces"].as_array().expect("faces").len(), 4);
    assert!(summary.contains(&"add to `materials`: `left`, `right`".to_owned()), "{summary:?}");
    assert!(summary.iter().any(|line| line.contains("--plane")));
    let (plane, summary) = model(&mesh("quadrilateral8_41_text.msh"), Some(PlaneState::Axisymmetric));
    assert_eq!(plane["elements"][0]["plane"], "axisymmetric");
    assert!(!summary.iter().any(|line| line.contains("--plane")));
    let (space, _) = model(&mesh("tetrahedron10_22_binary.msh"), Some(PlaneState::Strain));
    assert_eq!((&space["dimension"], &space["elements"][0]["material"]), (&json!(3), &json!("body")));
    assert!(space["elements"][0].get("plane").is_none());
}

#[test]
fn labels_beyond_32_bits_stay_names() {
    let (model, _) = model(&mesh("sparse_41_binary.msh"), None);
    let nodes = model["nodes"].as_object().expect("nodes");
    assert_eq!(nodes.len(), 15);
    assert!(nodes.contains_key("3375010125"), "{nodes:?}");
}

#[test]
fn coordinates_read_back_to_the_same_bits() {
    let mesh = mesh("hexahedron20_41_binary.msh");
    let (model, _) = model(&mesh, None);
    for (label, point) in mesh.node_labels.iter().zip(&mesh.coordinates) {
        let written = &model["nodes"][label.to_string()];
        for (axis, coordinate) in point.iter().enumerate() {
            assert_eq!(written[axis].as_f64().expect("a number").to_bits(), coordinate.to_bits());
        }
    }
}

#[test]
fn members_stand_in_lines_of_their_own() {
    let text = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT,TYPE=CAX3\n7,1,2,3\n";
    let mesh = read(text.as_bytes()).expect("a mesh");
    let json = ConvertedModel::new(&mesh, None).expect("a model").json().expect("JSON");
    let nodes = r#""nodes": ["1", "2", "3"]"#;
    let rest = r#""material": "material", "plane": "axisymmetric""#;
    let element = format!(r#"{{"kind": "triangle3", "name": "e7", {nodes}, {rest}}}"#);
    let expected = format!(
        "{{\n \"model\": {{\n  \"dimension\": 2,\n  \"nodes\": {{\n   \"1\": [0.0, 0.0],\n   \"2\": [1.0, 0.0],\n   \
         \"3\": [0.0, 1.0]\n  }},\n  \"elements\": [\n   {element}\n  ],\n  \"stages\": [\n   \
         {{\"name\": \"loads\"}}\n  ]\n }}\n}}\n"
    );
    assert_eq!(json, expected);
}

#[test]
fn what_has_no_stiffness_is_no_model() {
    let line = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n$Elements\n1\n\
                1 1 2 0 0 1 2\n$EndElements\n";
    let mesh = read(line.as_bytes()).expect("a mesh of a line");
    let error = ConvertedModel::new(&mesh, None).expect_err("no solids").to_string();
    assert_eq!(error, "the file: expected triangles, quadrilaterals, tetrahedra or hexahedra, found none");
    let bent = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,1\n*ELEMENT,TYPE=CPS3\n1,1,2,3\n";
    let mesh = read(bent.as_bytes()).expect("a mesh");
    let error = ConvertedModel::new(&mesh, None).expect_err("not plane").to_string();
    assert_eq!(
        error,
        "the file: plane elements have to lie in one plane of constant z; node 3 has z = 1, another one 0"
    );
}
