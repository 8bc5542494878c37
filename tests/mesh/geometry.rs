//! Nodes between corners, the sense of elements and of faces, on the straight-sided samples.

use crate::samples::{all, mean, mesh, near, point, read};
use arcslip::model::mesh::data::mesh_data::MeshData;

fn less(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| one[axis] - other[axis])
}

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    (0..3).map(|axis| one[axis] * other[axis]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn points(mesh: &MeshData, nodes: &[u32]) -> Vec<[f64; 3]> {
    nodes.iter().map(|node| point(mesh, *node)).collect()
}

#[test]
fn nodes_between_corners_lie_in_the_middle_of_their_edges() {
    let mut edges = 0;
    for (name, bytes) in all() {
        let mesh = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        for (shape, nodes) in mesh.elements.shapes.iter().zip(mesh.elements.nodes.iter()) {
            assert_eq!(nodes.len(), shape.nodes(), "{name}");
            let at = points(&mesh, nodes);
            if shape.is_quadratic() {
                for (place, [one, other]) in shape.edges().iter().enumerate() {
                    let middle = mean(&[at[*one], at[*other]]);
                    assert!(near(&at[shape.corners() + place], &middle, 1e-9), "{name}: edge {place}");
                    edges += 1;
                }
            }
        }
    }
    assert!(edges >= 672, "{edges}");
}

#[test]
fn elements_have_positive_areas_and_volumes() {
    for (name, bytes) in all() {
        let mesh = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        for (shape, nodes) in mesh.elements.shapes.iter().zip(mesh.elements.nodes.iter()) {
            let at = points(&mesh, nodes);
            let third = if shape.corners() == 8 { 3 } else { 2 };
            let [first, second] = [less(at[1], at[0]), less(at[third], at[0])];
            let size = match (shape.dimension(), shape.corners()) {
                (2, 4) => cross(first, less(at[3], at[0]))[2],
                (2, _) => cross(first, second)[2],
                (_, 8) => dot(cross(first, second), less(at[4], at[0])),
                _ => dot(cross(first, second), less(at[3], at[0])),
            };
            assert!(size > 1e-6, "{name}: {shape:?} {size}");
        }
    }
    let turned = mesh("clockwise_41_text.msh");
    assert_eq!(turned.remarks, ["4 clockwise elements are turned over"]);
}

#[test]
fn faces_look_out_of_their_elements() {
    let mut faces = 0;
    for (name, bytes) in all() {
        let mesh = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        let lists: Vec<&[u32]> = mesh.elements.nodes.iter().collect();
        for face in mesh.surfaces.values().flat_map(|surface| surface.iter()) {
            let owners = lists.iter().filter(|list| face.iter().all(|node| list.contains(node)));
            let owner = owners.clone().next().unwrap_or_else(|| panic!("{name}: a face of no element"));
            let at = points(&mesh, face);
            let out = less(mean(&at), mean(&points(&mesh, owner)));
            let along = less(at[1], at[0]);
            let normal =
                if mesh.dimension() == 2 { [along[1], -along[0], 0.0] } else { cross(along, less(at[2], at[0])) };
            if owners.count() == 1 {
                assert!(dot(normal, out) > 0.0, "{name}: {face:?}");
            }
            // The nodes between corners follow them in order.
            let corners = match (mesh.dimension(), face.len()) {
                (2, _) => 2,
                (_, 6) => 3,
                (_, 8) => 4,
                (_, length) => length,
            };
            for place in corners..face.len() {
                let ends = mean(&[at[place - corners], at[(place - corners + 1) % corners]]);
                assert!(near(&at[place], &ends, 1e-9), "{name}: {face:?}");
            }
            faces += 1;
        }
    }
    assert!(faces > 200, "{faces}");
}
