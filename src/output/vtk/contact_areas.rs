//! The areas of bodies that the contacts of nodes stand for.
//!
//! ```text
//! A_a = ∫ N_a dA,      p = r_n/A_a
//! ```
//!
//! with the functions of the [basis](crate::mechanics::structure::basis_transformation) that contacts are solved in.

use crate::mechanics::structure::elements::solid::any::each_traction_force;
use crate::mechanics::structure::elements::solid::shapes::faces::faces_of;
use crate::model::request::Model;
use crate::model::solids::data;
use crate::model::solids::faces::{FaceMatch, SolidFace};
use crate::model::solids::middle_nodes::basis_transformation;
use indexmap::IndexMap;
use itertools::Itertools;
use std::collections::{HashMap, HashSet};

/// For the number of a node and the name of what it touches the undeformed area `∫ N dA` over the faces of solids all of
/// whose nodes touch it (of bodies that touch each other, all corners), by the functions of the basis that contacts are solved in; of bodies of revolution around the
/// axis. A node whose function has no positive integral has none. Linear in the size of the model.
pub(super) fn contact_areas(model: &Model) -> HashMap<(usize, &str), f64> {
    let mut touched: HashMap<usize, HashSet<&str>> = HashMap::new();
    for contact in &model.contacts {
        if let Some(node) = model.nodes.get_index_of(&contact.node) {
            touched.entry(node).or_default().insert(contact.counterpart());
        }
    }
    let basis = basis_transformation(model);
    let mut areas: HashMap<(usize, &str), f64> = HashMap::new();
    for (face, counterparts) in touching_faces(model, &touched, &basis.following().collect()) {
        let Some(face) = data::loaded_face(model, &FaceMatch::Face(face), 1.0) else { continue };
        let mut own = vec![0.0; face.nodes.len()];
        let unit = [1.0, 0.0, 0.0];
        each_traction_force(face.kind, &face.positions, face.idealisation, unit, &mut |place, [area, ..]| {
            own[place] += area;
        });
        basis.edges_among(&face.nodes).iter().for_each(|edge| edge.distribute(&mut own));
        for counterpart in counterparts {
            for (node, area) in face.nodes.iter().zip(&own).filter(|(node, _)| touched.contains_key(node)) {
                *areas.entry((*node, counterpart)).or_default() += area;
            }
        }
    }
    areas.retain(|_, area| *area > 0.0);
    areas
}

/// The faces of one solid each all of whose nodes touch the same, with what they touch.
fn touching_faces<'a>(
    model: &Model,
    touched: &HashMap<usize, HashSet<&'a str>>,
    following: &HashSet<usize>,
) -> impl Iterator<Item = (SolidFace, Vec<&'a str>)> {
    let mut found: IndexMap<Vec<usize>, Option<(SolidFace, Vec<&'a str>)>> = IndexMap::new();
    for (element, (kind, solid)) in
        model.elements.iter().enumerate().filter_map(|(place, element)| Some((place, element.solid()?)))
    {
        let (face_kind, faces) = faces_of(kind);
        let numbers: Vec<Option<usize>> = solid.nodes.iter().map(|node| model.nodes.get_index_of(node)).collect();
        for face in faces {
            let nodes: Option<Vec<usize>> = face.iter().map(|place| *numbers.get(*place)?).collect();
            let Some(nodes) = nodes else { continue };
            // Middles that follow their ends touch through these.
            let mut all = nodes.iter().filter(|node| !following.contains(node)).map(|node| touched.get(node));
            let Some(Some(first)) = all.next() else { continue };
            let Some(others) = all.collect::<Option<Vec<_>>>() else { continue };
            let together = first.iter().filter(|name| others.iter().all(|other| other.contains(*name)));
            let together: Vec<&str> = together.copied().sorted_unstable().collect();
            if together.is_empty() {
                continue;
            }
            let key = nodes.iter().copied().sorted_unstable().collect();
            let face = SolidFace { element, kind: face_kind, nodes };
            // A face of two solids is inside the body.
            found.entry(key).and_modify(|face| *face = None).or_insert(Some((face, together)));
        }
    }
    found.into_values().flatten()
}
