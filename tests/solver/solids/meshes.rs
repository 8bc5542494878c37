//! Meshes of bodies for scenes: a rectangle or a box of cells, mapped to the body.

use indexmap::IndexMap;
use serde_json::{Map, Value, json};

/// Where a node stands: the cell corners have even numbers, the middles of edges odd ones.
type Place = [usize; 3];

/// A mesh of one kind of solids.
pub struct Mesh {
    kind: &'static str,
    nodes: IndexMap<Place, Vec<f64>>,
    elements: Vec<Vec<Place>>,
    ends: Place,
}

pub const IN_PLANE: [&str; 4] = ["triangle3", "triangle6", "quadrilateral4", "quadrilateral8"];
pub const IN_SPACE: [&str; 4] = ["tetrahedron4", "tetrahedron10", "hexahedron8", "hexahedron20"];

/// Corners of the solids in a cell; in the plane of the lower face alone.
fn solids_of_cell(kind: &str) -> Vec<Vec<Place>> {
    let square = vec![[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]];
    match kind {
        "triangle3" | "triangle6" => {
            vec![vec![[0, 0, 0], [2, 0, 0], [2, 2, 0]], vec![[0, 0, 0], [2, 2, 0], [0, 2, 0]]]
        }
        "quadrilateral4" | "quadrilateral8" => vec![square],
        "hexahedron8" | "hexahedron20" => {
            let above = square.iter().map(|[x, y, _]| [*x, *y, 2]);
            vec![square.iter().copied().chain(above).collect()]
        }
        // Kuhn's division: a tetrahedron along the edges to the far corner, for each order of the axes.
        _ => [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]]
            .iter()
            .enumerate()
            .map(|(place, axes)| {
                let mut corners = vec![[0; 3]];
                for axis in axes {
                    let mut next = corners[corners.len() - 1];
                    next[*axis] = 2;
                    corners.push(next);
                }
                // Odd orders are mirror images.
                if place >= 3 {
                    corners.swap(1, 2);
                }
                corners
            })
            .collect(),
    }
}

/// The edges with nodes in their middle, in the order of VTK's format.
fn edges(kind: &str) -> &'static [[usize; 2]] {
    match kind {
        "triangle6" => &[[0, 1], [1, 2], [2, 0]],
        "quadrilateral8" => &[[0, 1], [1, 2], [2, 3], [3, 0]],
        "tetrahedron10" => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
        "hexahedron20" => {
            &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
        }
        _ => &[],
    }
}

/// Number of nodes of a face.
fn face_nodes(kind: &str) -> usize {
    match kind {
        "triangle3" | "quadrilateral4" => 2,
        "triangle6" | "quadrilateral8" | "tetrahedron4" => 3,
        "hexahedron8" => 4,
        "tetrahedron10" => 6,
        _ => 8,
    }
}

pub fn name(place: &Place) -> String {
    format!("n{}_{}_{}", place[0], place[1], place[2])
}

impl Mesh {
    /// A mesh of so many cells along each axis (in the plane of two), whose nodes are where `map` puts points of the unit
    /// square or cube.
    pub fn new(kind: &'static str, cells: &[usize], map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let dimension = cells.len();
        let ends: Place = std::array::from_fn(|axis| 2 * cells.get(axis).copied().unwrap_or(0));
        let mut mesh = Self { kind, nodes: IndexMap::new(), elements: Vec::new(), ends };
        let layers = cells.get(2).copied().unwrap_or(1);
        for (z, y, x) in
            (0..layers).flat_map(|z| (0..cells[1]).flat_map(move |y| (0..cells[0]).map(move |x| (z, y, x))))
        {
            for corners in solids_of_cell(kind) {
                let mut nodes: Vec<Place> = corners.iter().map(|[i, j, k]| [2 * x + i, 2 * y + j, 2 * z + k]).collect();
                for [a, b] in edges(kind) {
                    nodes.push(std::array::from_fn(|axis| (nodes[*a][axis] + nodes[*b][axis]) / 2));
                }
                for node in &nodes {
                    let unit = |axis: usize| if ends[axis] == 0 { 0.0 } else { node[axis] as f64 / ends[axis] as f64 };
                    let position = map([unit(0), unit(1), unit(2)]);
                    mesh.nodes.entry(*node).or_insert_with(|| position[..dimension].to_vec());
                }
                mesh.elements.push(nodes);
            }
        }
        mesh
    }

    pub fn dimension(&self) -> usize {
        if self.ends[2] == 0 { 2 } else { 3 }
    }

    /// Moves the nodes inside by a pseudo-random part of the given length, the same in every run.
    pub fn distorted(mut self, length: f64) -> Self {
        let ends = self.ends;
        let is_inside =
            |place: &Place| (0..3).all(|axis| ends[axis] == 0 || (place[axis] > 0 && place[axis] < ends[axis]));
        let is_corner = |place: &Place| place.iter().all(|number| number % 2 == 0);
        let mut seed = 1_u64;
        for (_, position) in self.nodes.iter_mut().filter(|(place, _)| is_inside(place) && is_corner(place)) {
            for coordinate in position.iter_mut() {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                *coordinate += length * ((seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5);
            }
        }
        // Edges stay straight.
        for element in self.elements.clone() {
            for (edge, middle) in edges(self.kind).iter().zip(&element[element.len() - edges(self.kind).len()..]) {
                let [one, other] = edge.map(|corner| self.nodes[&element[corner]].clone());
                self.nodes[middle] = one.iter().zip(&other).map(|(a, b)| 0.5 * (a + b)).collect();
            }
        }
        self
    }

    /// The nodes at one end of an axis, in order.
    pub fn side(&self, axis: usize, at_end: bool) -> Vec<String> {
        let at = if at_end { self.ends[axis] } else { 0 };
        let mut nodes: Vec<&Place> = self.nodes.keys().filter(|place| place[axis] == at).collect();
        nodes.sort();
        nodes.into_iter().map(name).collect()
    }

    /// The faces at one end of an axis.
    pub fn faces(&self, axis: usize, at_end: bool) -> Value {
        let at = if at_end { self.ends[axis] } else { 0 };
        let of_element = |nodes: &Vec<Place>| {
            let face: Vec<String> = nodes.iter().filter(|place| place[axis] == at).map(name).collect();
            (face.len() == face_nodes(self.kind)).then_some(face)
        };
        self.elements.iter().filter_map(of_element).collect::<Vec<_>>().into()
    }

    pub fn positions(&self) -> impl Iterator<Item = (String, &Vec<f64>)> {
        self.nodes.iter().map(|(place, position)| (name(place), position))
    }

    /// A model of the mesh without supports and loads; `data`: what each solid has beside kind, nodes and material.
    pub fn model(&self, material: Value, data: &Value) -> Value {
        let nodes: Map<String, Value> = self.positions().map(|(name, position)| (name, json!(position))).collect();
        let element = |nodes: &Vec<Place>| {
            let nodes: Vec<String> = nodes.iter().map(name).collect();
            let mut element = json!({"kind": self.kind, "nodes": nodes, "material": "matter"});
            for (member, value) in data.as_object().into_iter().flatten() {
                element[member] = value.clone();
            }
            element
        };
        let elements: Vec<Value> = self.elements.iter().map(element).collect();
        json!({
            "dimension": self.dimension(), "nodes": nodes, "materials": {"matter": material}, "elements": elements,
            "supports": {}, "surfaces": {}, "stages": [{}]
        })
    }
}

/// Adds held components to nodes.
pub fn hold(model: &mut Value, nodes: &[String], components: &[&str]) {
    for node in nodes {
        let held = &mut model["supports"][node];
        let mut all: Vec<Value> = held.as_array().cloned().unwrap_or_default();
        for component in components {
            if !all.iter().any(|known| known == component) {
                all.push(json!(component));
            }
        }
        *held = all.into();
    }
}
