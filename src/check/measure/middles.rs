//! Where a contact of a node with an obstacle is measured, and the middles of edges that follow their ends.
//!
//! Mostly at the node. At the middle `m` of the edge from `a` to `b` of quadratic solids in space, whose ends touch the same
//! obstacles and are held wherever the middle is, it is measured at a point past the middle,
//!
//! ```text
//! x = (5 x_m - x_a - x_b)/3,      forces: 5/3 of that of the contact on m, -1/3 on a and on b
//! gap = gap(x) - gap(X) + max(0, (5 gap(X_m) - gap(X_a) - gap(X_b))/3),     X: undeformed
//! ```
//!
//! so that an even pressure is a sum of pushing contacts. A middle at which anything else joins, or whose displacement ends a
//! stage, touches by itself.

use crate::check::measure::numbers::{MeasuredVector, padded};
use crate::model::request::{Contact, Model, SolidKind};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The nodes that a contact is measured by, each with its share.
#[derive(Debug, Clone)]
pub(super) struct ContactPoint {
    pub shares: Vec<(usize, f64)>,
    /// The undeformed point.
    pub place: MeasuredVector,
    /// To add to the gap at the point.
    pub offset: f64,
}

impl ContactPoint {
    /// The node by itself.
    pub fn at_node(node: usize, place: MeasuredVector) -> Self {
        Self { shares: vec![(node, 1.0)], place, offset: 0.0 }
    }

    /// A point past the middle of an edge; `gap_at`: the gap at an undeformed place.
    pub fn past_middle(nodes: [usize; 3], model: &Model, gap_at: impl Fn(&MeasuredVector) -> f64) -> Self {
        let places = nodes.map(|node| padded(&model.nodes[node]));
        let past = |[m, a, b]: [f64; 3]| (5.0 * m - a - b) / 3.0;
        let place = MeasuredVector::from_fn(|k, _| past(places.map(|place| place[k])));
        let own = past(places.map(|place| gap_at(&place))).max(0.0);
        let shares = nodes.into_iter().zip([5.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0]).collect();
        Self { shares, place, offset: own - gap_at(&place) }
    }

    pub fn displacement(&self, displacements: &[MeasuredVector]) -> MeasuredVector {
        self.shares.iter().map(|(node, share)| displacements[*node] * *share).sum()
    }
}

/// The middles that follow the ends of their edges, `u_m = (u_a + u_b)/2`: of quadratic faces where bodies touch each other.
/// Half of the force on each goes to either end.
pub(super) fn following(model: &Model) -> Vec<[usize; 3]> {
    let bodies = model.contacts.iter().filter(|contact| contact.against.is_some());
    let surfaces: HashSet<&String> =
        bodies.flat_map(|contact| contact.surface.iter().chain(&contact.against)).collect();
    if surfaces.is_empty() {
        return Vec::new();
    }
    let edges = edges_with_middle(model);
    let faces =
        model.surfaces.iter().filter(|(name, _)| surfaces.contains(name)).flat_map(|(_, surface)| &surface.faces);
    let of_face = |face: &Vec<String>| {
        let on_face = |node: &&str| face.iter().any(|one| one == node);
        let middles = face.iter().filter_map(|node| *edges.get(node.as_str())?);
        let nodes = middles.filter(|edge| edge.iter().all(&on_face));
        let number = |node: &str| model.nodes.get_index_of(node);
        nodes.filter_map(|[m, a, b]| Some([number(m)?, number(a)?, number(b)?])).collect::<Vec<_>>()
    };
    let all: BTreeMap<usize, [usize; 3]> = faces.flat_map(of_face).map(|edge| (edge[0], edge)).collect();
    all.into_values().collect()
}

/// Each middle of an edge of quadratic solids as `[m, a, b]`; none at which another element joins.
fn edges_with_middle(model: &Model) -> HashMap<&str, Option<[&str; 3]>> {
    let mut found: HashMap<&str, Option<[&str; 3]>> = HashMap::new();
    for element in &model.elements {
        let first = match element.solid() {
            Some((SolidKind::Triangle6, _)) => 3,
            Some((SolidKind::Quadrilateral8 | SolidKind::Tetrahedron10, _)) => 4,
            Some((SolidKind::Hexahedron20, _)) => 8,
            _ => element.nodes().len(),
        };
        for (place, node) in element.nodes().iter().enumerate() {
            let Some(edge) = place.checked_sub(first) else {
                found.insert(node, None);
                continue;
            };
            let [a, b] = match (first, element.nodes().len()) {
                (3, _) => [edge, (edge + 1) % 3],
                (4, 10) => [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]][edge],
                _ if edge < 8 => {
                    let (layer, around) = (4 * (edge / 4), edge % 4);
                    [layer + around, layer + (around + 1) % 4]
                }
                _ => [edge - 8, edge - 4],
            };
            let (Some(a), Some(b)) = (element.nodes().get(a), element.nodes().get(b)) else { continue };
            found.entry(node).or_insert(Some([node, a, b]));
        }
    }
    found
}

/// The middles whose contacts with obstacles are measured past them: `[m, a, b]` by the name of `m`.
pub(super) fn middles(model: &Model) -> HashMap<&str, [usize; 3]> {
    if model.dimension != 3 || model.contacts.iter().all(|contact| contact.against.is_some()) {
        return HashMap::new();
    }
    let found = edges_with_middle(model);
    let (touch, asked_for) = (touching(model), asked_for(model));
    let is_measured_past = |nodes: &[&str; 3]| {
        let [of_middle, of_a, of_b] = nodes.map(|node| touch.get(node));
        let (Some(of_middle), Some(of_a), Some(of_b)) = (of_middle, of_a, of_b) else { return false };
        let held = |node: &str| model.supports.get(node).map_or(&[][..], Vec::as_slice);
        let ends_hold = |component| nodes[1..].iter().all(|end| held(end).contains(component));
        of_middle.iter().all(|obstacle| of_a.contains(obstacle) && of_b.contains(obstacle))
            && held(nodes[0]).iter().all(ends_hold)
            && !asked_for.contains(nodes[0])
    };
    let past =
        found.into_iter().filter_map(|(name, nodes)| Some((name, nodes.filter(|nodes| is_measured_past(nodes))?)));
    let number = |node: &str| model.nodes.get_index_of(node);
    past.filter_map(|(name, [m, a, b])| Some((name, [number(m)?, number(a)?, number(b)?]))).collect()
}

/// The obstacles that each node touches.
fn touching(model: &Model) -> HashMap<&str, HashSet<&str>> {
    let mut touching: HashMap<&str, HashSet<&str>> = HashMap::new();
    for Contact { node, obstacle, .. } in model.contacts.iter().filter(|contact| contact.against.is_none()) {
        touching.entry(node).or_default().insert(obstacle);
    }
    touching
}

/// The nodes of bodies that touch each other, and those whose displacement ends a stage.
fn asked_for(model: &Model) -> HashSet<&str> {
    let mut all = HashSet::new();
    for contact in model.contacts.iter().filter(|contact| contact.against.is_some()) {
        all.insert(contact.node.as_str());
        for name in contact.surface.iter().chain(&contact.against) {
            let faces = model.surfaces.get(name).into_iter().flat_map(|surface| &surface.faces);
            all.extend(faces.flatten().map(String::as_str));
        }
    }
    let ends =
        model.stages.iter().filter_map(|stage| stage.until.as_ref()).filter_map(|until| until.displacement.as_ref());
    all.extend(ends.map(|end| end.node.as_str()));
    all
}
