//! The sense of plane elements and of faces.
//!
//! Programs that make meshes write the faces of a group in any sense, and plane elements clockwise where a surface is
//! seen from behind. A pressure needs one sense: plane elements are counterclockwise, normals of faces point outwards.

use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::mesh_data::MeshElements;
use crate::model::mesh::data::node_lists::NodeLists;
use indexmap::IndexMap;
use std::collections::HashMap;

/// Corners of a face in ascending order; unused places hold the largest number.
type FaceKey = [u32; 4];

/// Faces that are not those of exactly one element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UnusualFaces {
    /// Between two elements: they have the sense of the first one.
    pub inner: usize,
    /// Of no element: they keep the sense of the file.
    pub loose: usize,
}

/// Turns over the plane elements whose corners run clockwise as seen from the end of the axis z, and counts them.
pub fn turn_clockwise_elements(elements: &mut MeshElements, coordinates: &[[f64; 3]]) -> usize {
    let mut turned = 0;
    for (place, shape) in elements.shapes.iter().enumerate() {
        let nodes = elements.nodes.get_mut(place);
        if shape.dimension() == 2 && doubled_area(nodes.iter().take(shape.corners()), coordinates) < 0.0 {
            let mut before = [0_u32; ElementShape::MOST_NODES];
            before.iter_mut().zip(nodes.iter()).for_each(|(to, from)| *to = *from);
            for (node, from) in nodes.iter_mut().zip(shape.turned_over()) {
                *node = before.get(*from).copied().unwrap_or_default();
            }
            turned += 1;
        }
    }
    turned
}

/// Twice the area of a polygon in the plane x, y; negative where it runs clockwise.
fn doubled_area<'a>(corners: impl Iterator<Item = &'a u32> + Clone, coordinates: &[[f64; 3]]) -> f64 {
    let points = corners.filter_map(|node| coordinates.get(*node as usize));
    let Some([x0, y0, _]) = points.clone().next() else { return 0.0 };
    let legs = points.map(|[x, y, _]| [x - x0, y - y0]);
    legs.clone().zip(legs.skip(1)).map(|([x1, y1], [x2, y2])| x1 * y2 - x2 * y1).sum()
}

/// Gives the faces of surfaces the order of nodes in which their normals point out of their element.
///
/// `nodes` is the number of nodes, `dimension` that of the elements.
pub fn orient_faces(
    surfaces: &mut IndexMap<String, NodeLists>,
    elements: &MeshElements,
    nodes: usize,
    dimension: usize,
) -> UnusualFaces {
    let mut marked = vec![false; nodes];
    let mut owners: HashMap<FaceKey, (Option<(u32, usize)>, usize)> = HashMap::new();
    for face in surfaces.values().flat_map(NodeLists::iter) {
        for mark in face.iter().filter_map(|node| usize::try_from(*node).ok()) {
            if let Some(mark) = marked.get_mut(mark) {
                *mark = true;
            }
        }
        owners.insert(key(corners(face, dimension)), (None, 0));
    }
    if owners.is_empty() {
        return UnusualFaces::default();
    }
    for (place, (shape, list)) in (0_u32..).zip(elements.shapes.iter().zip(elements.nodes.iter())) {
        for (number, face) in shape.faces().iter().enumerate() {
            let corners = face_corners(*shape, face).iter().filter_map(|local| list.get(*local).copied());
            // Most faces are in no surface, and few of them have all their corners on one.
            if corners.clone().all(|node| marked.get(node as usize).copied().unwrap_or(false))
                && let Some((owner, count)) = owners.get_mut(&key_of(corners))
            {
                owner.get_or_insert((place, number));
                *count += 1;
            }
        }
    }
    let mut unusual = UnusualFaces::default();
    for surface in surfaces.values_mut() {
        for place in 0..surface.len() {
            let face = surface.get_mut(place);
            let found = owners.get(&key(corners(face, dimension))).copied();
            match found {
                Some((Some((element, number)), count)) => {
                    unusual.inner += usize::from(count > 1);
                    take_order(face, elements, element as usize, number);
                }
                _ => unusual.loose += 1,
            }
        }
    }
    unusual
}

/// Writes a face in the order of nodes of its element.
fn take_order(face: &mut [u32], elements: &MeshElements, element: usize, number: usize) {
    let list = elements.nodes.get(element);
    let locals = elements.shapes.get(element).and_then(|shape| shape.faces().get(number));
    if let Some(locals) = locals.filter(|locals| locals.len() == face.len()) {
        for (node, local) in face.iter_mut().zip(locals.iter()) {
            *node = list.get(*local).copied().unwrap_or(*node);
        }
    }
}

/// The corners of a face of an element.
fn face_corners(shape: ElementShape, face: &'static [usize]) -> &'static [usize] {
    let corners = match (shape.dimension(), shape.is_quadratic()) {
        (2, _) => 2,
        (_, true) => face.len() / 2,
        (_, false) => face.len(),
    };
    face.get(..corners).unwrap_or(face)
}

/// The corners of a face of an element of this dimension.
fn corners(face: &[u32], dimension: usize) -> &[u32] {
    let corners = match (dimension, face.len()) {
        (2, _) => 2,
        (_, 6) => 3,
        (_, 8) => 4,
        (_, length) => length,
    };
    face.get(..corners).unwrap_or(face)
}

fn key(corners: &[u32]) -> FaceKey {
    key_of(corners.iter().copied())
}

fn key_of(corners: impl Iterator<Item = u32>) -> FaceKey {
    let mut key = [u32::MAX; 4];
    key.iter_mut().zip(corners).for_each(|(to, from)| *to = from);
    key.sort_unstable();
    key
}
