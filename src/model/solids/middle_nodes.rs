//! The middles of solids' edges whose unknowns contacts transform.

use crate::mechanics::structure::basis_transformation::{BasisTransformation, MiddleUnknown, TransformedEdge};
use crate::model::request::{Element, Model};
use crate::model::solids::faces::{FaceMatch, SolidFace, surface_faces};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The transformation of the unknowns at the middles of edges: of quadratic faces where bodies touch each other, which follow
/// the ends of their edges, and of edges in space that touch an obstacle.
///
/// Of the latter a middle is transformed if both ends of its edge touch the obstacles that it touches and are held wherever it is, and
/// if nothing but quadratic solids asks for its displacement: no other element, no surface of a contact of bodies and no end
/// of a stage. Linear in the size of the model.
pub(crate) fn basis_transformation(model: &Model) -> BasisTransformation {
    let has_middles = |element: &Element| element.solid().is_some_and(|(kind, _)| !kind.edges_with_middle().is_empty());
    if model.contacts.is_empty() || !model.elements.iter().any(has_middles) {
        return BasisTransformation::default();
    }
    let follows = |ends: [usize; 2]| TransformedEdge { ends, unknown: MiddleUnknown::OffTheChord };
    let mut edges: BTreeMap<usize, TransformedEdge> =
        following_middles(model).into_iter().map(|(node, ends)| (node, follows(ends))).collect();
    let touches = |ends: [usize; 2]| TransformedEdge { ends, unknown: MiddleUnknown::Extrapolated };
    for (node, ends) in extrapolated_middles(model) {
        edges.entry(node).or_insert(touches(ends));
    }
    BasisTransformation::new(edges)
}

/// The middles of quadratic faces of surfaces that touch other bodies, with the ends of their edges.
pub(crate) fn following_middles(model: &Model) -> BTreeMap<usize, [usize; 2]> {
    let bodies = model.contacts.iter().filter(|contact| contact.against.is_some());
    let named: HashSet<&str> =
        bodies.flat_map(|contact| [&contact.surface, &contact.against]).flatten().map(String::as_str).collect();
    let mut found = BTreeMap::new();
    if named.is_empty() {
        return found;
    }
    let all = model.surfaces.keys().zip(surface_faces(model));
    for face in all.filter(|(name, _)| named.contains(name.as_str())).flat_map(|(_, faces)| faces) {
        let FaceMatch::Face(SolidFace { kind, nodes, .. }) = face else { continue };
        for (middle, ends) in nodes[kind.corners()..].iter().zip(kind.edges_with_middle()) {
            let [one, other] = ends.map(|end| nodes[end]);
            found.insert(*middle, [one.min(other), one.max(other)]);
        }
    }
    found
}

/// Puts the middles that follow the ends of their edges onto the chords between these: a body that turns then has them there
/// without strain.
pub(crate) fn straighten(model: &mut Model) {
    for (middle, ends) in following_middles(model) {
        let [a, b] = ends.map(|end| model.nodes.get_index(end).map(|(_, place)| place.clone()).unwrap_or_default());
        if let Some((_, place)) = model.nodes.get_index_mut(middle) {
            place.iter_mut().zip(a.iter().zip(&b)).for_each(|(own, (a, b))| *own = chord_middle(*a, *b));
        }
    }
}

/// The middle between two coordinates, without overflow.
pub(crate) fn chord_middle(a: f64, b: f64) -> f64 {
    0.5 * a + 0.5 * b
}

/// The middles in space that touch an obstacle past themselves, with the ends of their edges.
fn extrapolated_middles(model: &Model) -> BTreeMap<usize, [usize; 2]> {
    if model.dimension != 3 {
        return BTreeMap::new();
    }
    let mut touched: HashMap<&str, HashSet<&str>> = HashMap::new();
    for contact in model.contacts.iter().filter(|contact| contact.against.is_none()) {
        touched.entry(&contact.node).or_default().insert(&contact.obstacle);
    }
    let asked_for = asked_for(model);
    let mut ends: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
    let mut refused: HashSet<&str> = HashSet::new();
    for element in &model.elements {
        let edges = element.solid().map_or(&[][..], |(kind, _)| kind.edges_with_middle());
        let nodes = element.nodes();
        let (corners, middles) = nodes.split_at(nodes.len() - edges.len().min(nodes.len()));
        refused.extend(corners.iter().map(String::as_str));
        for (middle, [a, b]) in middles.iter().zip(edges) {
            let Some(obstacles) = touched.get(middle.as_str()) else { continue };
            let ([Some(a), Some(b)], false) = ([corners.get(*a), corners.get(*b)], asked_for.contains(middle.as_str()))
            else {
                continue;
            };
            let is_with_it = |end: &String| {
                touched.get(end.as_str()).is_some_and(|of_end| obstacles.is_subset(of_end))
                    && is_held(model, end, middle)
            };
            let numbers = [middle, a, b].map(|node| model.nodes.get_index_of(node));
            if let ([Some(number), Some(first), Some(second)], true) = (numbers, is_with_it(a) && is_with_it(b)) {
                ends.insert(number, [first.min(second), first.max(second)]);
            }
        }
    }
    ends.retain(|node, _| model.nodes.get_index(*node).is_some_and(|(name, _)| !refused.contains(name.as_str())));
    ends
}

/// Whether an end of an edge is held wherever its middle is.
pub(crate) fn is_held(model: &Model, end: &str, middle: &str) -> bool {
    let Some(of_middle) = model.supports.get(middle) else { return true };
    let of_end = model.supports.get(end);
    of_middle.iter().all(|component| of_end.is_some_and(|of_end| of_end.contains(component)))
}

/// The nodes whose displacements are asked for by themselves: by contacts of bodies and by the ends of stages.
fn asked_for(model: &Model) -> HashSet<&str> {
    let of_bodies = model.contacts.iter().filter(|contact| contact.against.is_some());
    let surfaces = of_bodies.clone().flat_map(|contact| [&contact.surface, &contact.against]).flatten();
    let of_surfaces =
        surfaces.filter_map(|name| model.surfaces.get(name)).flat_map(|surface| surface.faces.iter().flatten());
    let bounds = model.stages.iter().filter_map(|stage| stage.until.as_ref()?.displacement.as_ref());
    let named = of_bodies.map(|contact| &contact.node).chain(of_surfaces).chain(bounds.map(|bound| &bound.node));
    named.map(String::as_str).collect()
}
