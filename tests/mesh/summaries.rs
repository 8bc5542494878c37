//! Every sample beside what meshio and gmsh read in it.

use crate::samples::{all, folder, mesh, near, point, read};
use arcslip::model::mesh::data::mesh_data::MeshData;
use serde_json::Value;
use std::collections::BTreeMap;

/// meshio's names of the kinds of elements with stiffness.
const KINDS: [(&str, &str); 8] = [
    ("triangle", "triangle3"),
    ("triangle6", "triangle6"),
    ("quad", "quadrilateral4"),
    ("quad8", "quadrilateral8"),
    ("tetra", "tetrahedron4"),
    ("tetra10", "tetrahedron10"),
    ("hexahedron", "hexahedron8"),
    ("hexahedron20", "hexahedron20"),
];

fn summaries() -> Value {
    let text = std::fs::read_to_string(folder().join("summaries.json")).expect("summaries");
    serde_json::from_str(&text).expect("JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// For each kind the number of elements, and the squares of coordinates weighed by the place of the node; as the
/// generator has it.
fn places(mesh: &MeshData) -> BTreeMap<&'static str, (u64, [f64; 3])> {
    let mut found: BTreeMap<&'static str, (u64, [f64; 3])> = BTreeMap::new();
    for (shape, nodes) in mesh.elements.shapes.iter().zip(mesh.elements.nodes.iter()) {
        let entry = found.entry(shape.name()).or_default();
        entry.0 += 1;
        for (place, node) in nodes.iter().enumerate() {
            for (sum, coordinate) in entry.1.iter_mut().zip(point(mesh, *node)) {
                *sum += (place + 1) as f64 * (coordinate + 3.0).powi(2);
            }
        }
    }
    found
}

#[test]
fn nodes_and_elements_are_those_of_meshio() {
    let summaries = summaries();
    let mut compared = 0;
    for (name, bytes) in all() {
        // gmsh's files of version 2 have an element again for each further group; turned elements begin elsewhere.
        let is_special = name.starts_with("overlapping_22") || name.starts_with("clockwise");
        let summary = &summaries[&name];
        if summary["points"].is_null() || is_special {
            continue;
        }
        let mesh = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(mesh.coordinates.len() as u64, summary["points"], "{name}");
        for (kind, (count, sums)) in places(&mesh) {
            let (theirs, _) = KINDS.iter().find(|(_, ours)| *ours == kind).expect("a kind of solids");
            let cells = &summary["cells"][theirs];
            assert_eq!(cells["count"], count, "{name}: {kind}");
            assert!(near(&sums, &numbers(&cells["places"]), 1e-6), "{name}: {kind}: {sums:?} {cells}");
            compared += 1;
        }
    }
    assert!(compared >= 42, "{compared}");
}

#[test]
fn groups_have_the_nodes_that_gmsh_gives() {
    let summaries = summaries();
    let mut compared = 0;
    for (name, bytes) in all().into_iter().filter(|(name, _)| name.ends_with(".msh")) {
        let mesh = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        let Some(groups) = summaries[&name]["groups"].as_array() else {
            assert_eq!(name, "cube_41_narrow.msh", "no groups");
            continue;
        };
        for group in groups {
            let dimension = usize::try_from(group["dimension"].as_u64().expect("a dimension")).expect("a dimension");
            let set = match group["name"].as_str().expect("a name") {
                "" => format!("{}_group_{}", ["point", "curve", "surface", "volume"][dimension], group["tag"]),
                named => named.to_owned(),
            };
            let nodes = mesh.node_sets.get(&set).unwrap_or_else(|| panic!("{name}: no set {set}"));
            assert_eq!(nodes.len() as u64, group["nodes"], "{name}: {set}");
            let sums = [0, 1, 2].map(|axis| nodes.iter().map(|node| point(&mesh, *node)[axis]).sum::<f64>());
            assert!(near(&sums, &numbers(&group["sums"]), 1e-7), "{name}: {set}");
            let has_elements = mesh.element_sets.contains_key(&set);
            assert_eq!(has_elements, dimension == mesh.dimension(), "{name}: {set}");
            assert_eq!(mesh.surfaces.contains_key(&set), dimension + 1 == mesh.dimension(), "{name}: {set}");
            compared += 1;
        }
        assert_eq!(mesh.node_sets.len(), groups.len(), "{name}");
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn text_and_binary_of_both_versions_are_the_same_mesh() {
    for (_, kind) in KINDS {
        let one = mesh(&format!("{kind}_41_text.msh"));
        for other in ["41_binary", "22_text", "22_binary"].map(|end| mesh(&format!("{kind}_{end}.msh"))) {
            let sums = places(&one);
            let others = places(&other);
            assert!(near(&sums[kind].1, &others[kind].1, 1e-8), "{kind}");
            assert_eq!(sums[kind].0, others[kind].0);
            assert_eq!(one.node_sets.len(), other.node_sets.len());
            for (name, surface) in &one.surfaces {
                assert_eq!(surface.len(), other.surfaces[name].len(), "{kind}: {name}");
            }
        }
        let deck = mesh(&format!("{kind}.inp"));
        let sums = &places(&deck)[kind];
        assert!(near(&sums.1, &places(&one)[kind].1, 1e-8), "{kind} {sums:?}");
        assert_eq!(sums.0, places(&one)[kind].0);
        for (name, nodes) in &deck.node_sets {
            let named = name.replace('_', " ");
            if let Some(set) = one.node_sets.get(&named) {
                assert_eq!(nodes.len(), set.len(), "{kind}: {name}");
            }
        }
    }
}

#[test]
fn both_orders_of_bytes_are_read() {
    for version in ["22", "41"] {
        let [little, big] = ["little", "big"].map(|order| mesh(&format!("cube_{version}_{order}.msh")));
        assert_eq!(little.coordinates, big.coordinates);
        assert_eq!(little.elements.nodes, big.elements.nodes);
        assert_eq!(little.elements.nodes.get(0), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(little.surfaces, big.surfaces);
        assert_eq!(little.element_sets, big.element_sets);
        let narrow = mesh("cube_41_narrow.msh");
        assert_eq!((&narrow.elements.nodes, &narrow.surfaces), (&big.elements.nodes, &big.surfaces));
        // The file has the face with its normal inwards.
        assert_eq!(big.surfaces["bottom"].get(0), [0, 3, 2, 1]);
    }
}

#[test]
fn what_stands_beside_the_mesh_is_listed() {
    let listed = |name: &str| mesh(name).unread.lines().join("\n");
    assert!(listed("periodic_41_text.msh").contains("section `$Periodic`"));
    assert!(listed("periodic_41_binary.msh").contains("byte "));
    assert!(listed("triangle6.inp").contains("*ELEMENT, TYPE=T3D3"));
    assert_eq!(listed("triangle6_41_text.msh"), "");
}

#[test]
fn an_element_in_two_groups_is_one_element() {
    let [two, four] = ["22", "41"].map(|version| mesh(&format!("overlapping_{version}_text.msh")));
    for mesh in [&two, &four] {
        assert_eq!(mesh.elements.len(), 8);
        assert_eq!(mesh.element_sets["all"], [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!((mesh.element_sets["left"].len(), mesh.element_sets["right"].len()), (4, 4));
        assert_eq!(mesh.surfaces["lower left"].len(), 4);
    }
    assert_eq!(two.remarks[0], "10 elements are there again for a further group: they are read as one each");
}
