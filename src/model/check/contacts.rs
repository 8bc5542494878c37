//! Checks contacts: their nodes and obstacles, and the gaps at the start.

use std::collections::{HashMap, HashSet};

use crate::model::check::obstacles::{Facing, SoundObstacle};
use crate::model::check::scope::Scope;
use crate::model::check::scope::numbers::{self, dot};
use crate::model::input::limits::MAX_COUPLED_PAIRS;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::{Contact, Model, Obstacle, Polyline, RoundedBox, Side, Stage, Surface, TriangleMesh};
use crate::model::solids::contact_surfaces::ContactSurfaces;
use crate::model::solids::middle_nodes;
use crate::resources::budget;

/// Unit normals whose product is this near -1 are opposed.
const OPPOSED: f64 = 1e-12;

/// A component of a unit normal above this is no rounding error of a curve.
const CLEARLY: f64 = 1e-9;

/// A node before a plane at the start.
struct Gap<'a> {
    obstacle: &'a str,
    gap: f64,
    normal: Vec<f64>,
    tolerance: f64,
}

pub(super) fn contacts(scope: &Scope, obstacles: &[Option<SoundObstacle>], mistakes: &mut Mistakes) {
    let at = scope.at.member("contacts");
    let mut seen = HashSet::new();
    let mut gaps: HashMap<usize, Vec<Gap>> = HashMap::new();
    let pairs = coupled_pairs(scope);
    if pairs > MAX_COUPLED_PAIRS {
        mistakes.add(&at, || {
            format!(
                "contacts of bodies couple {pairs} pairs of nodes; at most {MAX_COUPLED_PAIRS} are taken: name only the faces \
                 that may touch"
            )
        });
        return;
    }
    following_middles(scope, mistakes);
    let surfaces = ContactSurfaces::new(scope.model, 1.0);
    let (mut touching, mut pairs) = (HashSet::new(), HashSet::new());
    for (index, contact) in scope.model.contacts.iter().enumerate() {
        let at = at.index(scope.model.posted_contact(index));
        friction(contact, &at.member("friction"), mistakes);
        let node = scope.node(&contact.node, &at.member("node"), mistakes);
        if contact.against.is_some() {
            if let Some(node) = node {
                between_bodies(scope, &surfaces, contact, node, &at, mistakes);
                if !touching.insert((node, contact.counterpart())) {
                    mistakes.add(&at, || {
                        let (node, surface) = (quoted(&contact.node), quoted(contact.counterpart()));
                        format!("{node} touches {surface} in another contact, too; leave one of them out")
                    });
                }
            }
            if let (Some(own), Some(other)) = (&contact.surface, &contact.against)
                && own != other
                && pairs.insert((own, other))
                && pairs.contains(&(other, own))
            {
                mistakes.add(&at, || {
                    let (own, other) = (quoted(own), quoted(other));
                    format!("{own} touches {other} and {other} {own}: one of them is enough, and both are too many")
                });
            }
            continue;
        }
        let obstacle = scope.obstacle(&contact.obstacle, &at.member("obstacle"), mistakes);
        let (Some(node), Some((number, obstacle))) = (node, obstacle) else { continue };
        if contact.friction > 0.0 && scope.turning.contains_key(contact.obstacle.as_str()) {
            dragged_by_turning(scope, contact, node, &at.member("friction"), mistakes);
        }
        let sound = obstacles.get(number).and_then(Option::as_ref);
        let Some(facing) = sound.and_then(|sound| sound.facing(scope, node)) else { continue };
        if !useful(scope, contact, node, obstacle, &facing, &at, mistakes) {
            continue;
        }
        start(contact, obstacle, &facing, &at, mistakes);
        // A second contact with the same obstacle restricts the node no further.
        if !seen.insert((node, number)) {
            continue;
        }
        if let (Obstacle::Plane { .. }, Some(normal)) = (obstacle, facing.normal) {
            let gap = Gap { obstacle: &contact.obstacle, gap: facing.gap, normal, tolerance: facing.tolerance };
            let others = gaps.entry(node).or_default();
            room(contact, &gap, others, &at, mistakes);
            others.push(gap);
        }
    }
}

/// Notes friction between a supported component and an obstacle that turns: the support would bear a traction that is no
/// unknown of the path.
fn dragged_by_turning(scope: &Scope, contact: &Contact, node: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if (0..scope.model.dimension).all(|component| scope.is_free(node, component)) {
        return;
    }
    mistakes.add(at, || {
        let (node, obstacle) = (quoted(&contact.node), quoted(&contact.obstacle));
        format!(
            "{node} is supported, and {obstacle} turns; friction on such a support is not available: leave its components \
             free and hold it by a spring, or give friction 0"
        )
    });
}

/// The pairs of nodes that contacts of bodies couple: of each the nodes on its own side, three in the plane and some nine in
/// space, with the surface that it touches, and the nodes of such a surface with each other.
fn coupled_pairs(scope: &Scope) -> usize {
    let distinct = |surface: &Surface| surface.faces.iter().flatten().collect::<HashSet<_>>().len();
    let counts: HashMap<&str, usize> =
        scope.model.surfaces.iter().map(|(name, surface)| (name.as_str(), distinct(surface))).collect();
    let nodes = |name: &str| counts.get(name).copied().unwrap_or(0);
    let against: Vec<&str> = scope.model.contacts.iter().filter_map(|contact| contact.against.as_deref()).collect();
    let touched: HashSet<&str> = against.iter().copied().collect();
    let own = if scope.model.dimension == 2 { 3 } else { 9 };
    let by_contacts = against.iter().fold(0_usize, |sum, name| sum.saturating_add(own * nodes(name)));
    touched.into_iter().fold(by_contacts, |sum, name| sum.saturating_add(nodes(name).saturating_mul(nodes(name)) / 2))
}

fn between_bodies(
    scope: &Scope,
    surfaces: &ContactSurfaces,
    contact: &Contact,
    node: usize,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) {
    for (member, name) in [("surface", contact.surface.as_deref()), ("against", contact.against.as_deref())] {
        let Some(name) = name.filter(|name| !scope.model.surfaces.contains_key(*name)) else { continue };
        mistakes.add(&at.member(member), || {
            let known = suggestion(name, scope.model.surfaces.keys().map(String::as_str));
            format!("there is no surface {}{known}", quoted(name))
        });
        return;
    }
    let against = contact.against.as_deref().unwrap_or_default();
    if scope.model.obstacles.contains_key(against) {
        mistakes.add(&at.member("against"), || {
            format!("an obstacle has the name {}, too; increments name what is touched: rename one", quoted(against))
        });
        return;
    }
    match surfaces.contact(contact, node) {
        Ok(body) => {
            let moves = body.kinematics.nodes().iter().any(|node| scope.has_free_component(*node));
            if !moves {
                mistakes.add(at, || "no node of the two surfaces can move freely; leave the contact out");
            }
        }
        Err((member, mistake)) => mistakes.add(&at.member(member), || mistake),
    }
}

fn friction(contact: &Contact, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let friction = contact.friction;
    if numbers::number(friction, at, mistakes) && friction < 0.0 {
        mistakes.add(at, || format!("found {friction:?}; a coefficient of 0 or more is expected"));
    }
}

/// Notes a contact whose reaction acts on no free component of its node.
///
/// The normal of a curved obstacle turns as the node moves, so there it matters only while the two touch, and where the
/// node cannot move freely at all.
fn useful(
    scope: &Scope,
    contact: &Contact,
    node: usize,
    obstacle: &Obstacle,
    facing: &Facing,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> bool {
    let Facing { gap, normal, tolerance } = facing;
    let along = |negligible: f64| {
        let parts = normal.iter().flatten().enumerate();
        normal.is_none() || parts.into_iter().any(|(k, part)| scope.is_free(node, k) && part.abs() > negligible)
    };
    let why = match obstacle {
        _ if !scope.has_free_component(node) => "cannot move freely; leave the contact out",
        Obstacle::Plane { .. } if !along(0.0) => {
            "cannot move freely along the obstacle's normal; leave the contact out"
        }
        Obstacle::Ball { radius, .. } if gap.abs() <= *tolerance && !along(tolerance / radius) => {
            "touches the ball where it cannot move freely along the normal; move it, or leave the contact out"
        }
        Obstacle::Cylinder { radius, .. } if gap.abs() <= *tolerance && !along(tolerance / radius) => {
            "touches the cylinder where it cannot move freely along the normal; move it, or leave the contact out"
        }
        Obstacle::Polyline(_) if gap.abs() <= *tolerance && !along(CLEARLY) => {
            "touches the polyline where it cannot move freely along the normal; move it, or leave the contact out"
        }
        Obstacle::Box(_) | Obstacle::TriangleMesh(_) if gap.abs() <= *tolerance && !along(CLEARLY) => {
            "touches the obstacle where it cannot move freely along the normal; move it, or leave the contact out"
        }
        Obstacle::Plane { .. }
        | Obstacle::Ball { .. }
        | Obstacle::Cylinder { .. }
        | Obstacle::Polyline(_)
        | Obstacle::Box(_)
        | Obstacle::TriangleMesh(_) => return true,
    };
    mistakes.add(&at.member("node"), || format!("the node {} is supported and {why}", quoted(&contact.node)));
    false
}

/// Notes a node on the wrong side of an obstacle, or where the obstacle has no normal.
fn start(contact: &Contact, obstacle: &Obstacle, facing: &Facing, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let names = || (quoted(&contact.node), quoted(&contact.obstacle));
    if facing.gap < -facing.tolerance {
        mistakes.add(at, || {
            let (node, name) = names();
            let side = match obstacle {
                Obstacle::Plane { .. } | Obstacle::Polyline(Polyline { closed: false, .. }) => "behind",
                Obstacle::Polyline(Polyline { side: Some(Side::Inside), .. }) => "outside the polyline",
                Obstacle::Polyline(_) => "inside the polyline",
                Obstacle::Ball { side: Side::Outside, .. } => "inside the ball",
                Obstacle::Ball { side: Side::Inside, .. } => "outside the ball",
                Obstacle::Cylinder { side: Side::Outside, .. } => "inside the cylinder",
                Obstacle::Cylinder { side: Side::Inside, .. } => "outside the cylinder",
                Obstacle::Box(RoundedBox { side: Side::Outside, .. }) => "inside the box",
                Obstacle::Box(_) => "outside the box",
                Obstacle::TriangleMesh(TriangleMesh { side: Side::Outside, .. }) => "inside the triangle mesh",
                Obstacle::TriangleMesh(_) => "outside the triangle mesh",
            };
            let turn = match obstacle {
                Obstacle::Polyline(Polyline { closed: false, .. }) => {
                    " (the free side is to the left of the points' order: turn them round if it is the other)"
                }
                _ => "",
            };
            format!("{node} is {side} {name} at the start, gap {:?}; a gap of 0 or more is expected{turn}", facing.gap)
        });
    } else if facing.normal.is_none() {
        mistakes.add(at, || {
            let (node, name) = names();
            match obstacle {
                Obstacle::Cylinder { .. } => {
                    format!(
                        "{node} is on the axis of the cylinder {name}, where it has no normal; move it off the axis"
                    )
                }
                _ => format!(
                    "{node} is at the centre of the ball {name}, where the ball has no normal; move it off the centre"
                ),
            }
        });
    }
}

/// Notes a second plane that faces an earlier one without a gap between them.
fn room(contact: &Contact, gap: &Gap, others: &[Gap], at: &DocumentPlace, mistakes: &mut Mistakes) {
    budget::spend(others.len());
    let faces = |other: &&Gap| dot(&gap.normal, &other.normal) <= OPPOSED - 1.0;
    for other in others.iter().filter(faces) {
        let room = gap.gap + other.gap;
        if room <= gap.tolerance.max(other.tolerance) {
            mistakes.add(at, || {
                let pair = format!("{} and {}", quoted(other.obstacle), quoted(&contact.obstacle));
                format!("{pair} leave {room:?} between them for {}; a larger gap is expected", quoted(&contact.node))
            });
        }
    }
}

/// Difference of prescribed displacements or coordinates, relative to the largest, up to which they are equal.
const ALIKE: f64 = 1e-12;

/// A middle with the ends of its edge, by names.
struct FollowingMiddle<'a> {
    middle: &'a str,
    ends: [&'a str; 2],
}

impl FollowingMiddle<'_> {
    fn follows(&self) -> String {
        let [a, b] = self.ends.map(quoted);
        format!(
            "{} is the middle of an edge of bodies that touch each other, and follows the ends {a} and {b}",
            quoted(self.middle)
        )
    }

    /// Whether the middle is not where the chord between its ends has its own.
    fn is_off_its_chord(&self, model: &Model) -> bool {
        let place = |node: &str| model.nodes.get(node).map_or(&[][..], Vec::as_slice);
        let [a, b] = self.ends.map(place);
        let largest = a.iter().chain(b).fold(0.0_f64, |most, value| most.max(value.abs()));
        place(self.middle)
            .iter()
            .zip(a.iter().zip(b))
            .any(|(own, (a, b))| (own - middle_nodes::chord_middle(*a, *b)).abs() > ALIKE * largest)
    }

    /// Whether a stage prescribes other displacements of the middle than the mean of its ends.
    fn is_driven_off(&self, stage: &Stage) -> bool {
        let given = |node: &str, axis: usize| {
            stage.displacements.get(node).and_then(|values| values.get(axis)).copied().unwrap_or(0.0)
        };
        stage.displacements.get(self.middle).is_some_and(|values| {
            values.iter().enumerate().any(|(axis, value)| {
                let [a, b] = self.ends.map(|end| given(end, axis));
                (value - 0.5 * (a + b)).abs() > ALIKE * value.abs().max(a.abs()).max(b.abs())
            })
        })
    }
}

/// Checks the middles of edges that follow the ends of these, as quadratic faces do where bodies touch each other: nothing
/// but their solids may ask for them.
fn following_middles(scope: &Scope, mistakes: &mut Mistakes) {
    let model = scope.model;
    let name = |node: usize| model.nodes.get_index(node).map_or("", |(name, _)| name.as_str());
    let following: HashMap<&str, FollowingMiddle> = middle_nodes::following_middles(model)
        .into_iter()
        .map(|(middle, ends)| (name(middle), FollowingMiddle { middle: name(middle), ends: ends.map(name) }))
        .collect();
    if following.is_empty() {
        return;
    }
    let at_contacts = scope.at.member("contacts");
    for (index, contact) in model.contacts.iter().enumerate().filter(|(_, contact)| contact.against.is_none()) {
        let Some(one) = following.get(contact.node.as_str()) else { continue };
        let at = at_contacts.index(model.posted_contact(index));
        mistakes.add(&at.member("node"), || {
            format!("{}; leave its contact with {} out", one.follows(), quoted(&contact.obstacle))
        });
    }
    let at_elements = scope.at.member("elements");
    for (index, element) in model.elements.iter().enumerate() {
        let middles = element.solid().map_or(0, |(kind, _)| kind.edges_with_middle().len());
        let joined = &element.nodes()[..element.nodes().len().saturating_sub(middles)];
        let Some(one) = joined.iter().find_map(|node| following.get(node.as_str())) else { continue };
        let at = at_elements.index(index);
        mistakes.add(&at.member("nodes"), || format!("{}; join the element to one of these", one.follows()));
    }
    let mut in_order: Vec<&FollowingMiddle> = following.values().collect();
    in_order.sort_unstable_by_key(|one| one.middle);
    let (at_supports, at_stages) = (scope.at.member("supports"), scope.at.member("stages"));
    for one in in_order {
        if one.is_off_its_chord(model) {
            mistakes.add(&scope.at.member("nodes").member(one.middle), || {
                format!("{}; on the chord between them is expected, where `expanded` puts it", one.follows())
            });
        }
        if !one.ends.iter().all(|end| middle_nodes::is_held(model, end, one.middle)) {
            mistakes.add(&at_supports.member(one.middle), || {
                format!("{}; hold these in the same components, or leave the support out", one.follows())
            });
        }
    }
    for (index, stage) in model.stages.iter().enumerate() {
        let at = at_stages.index(index);
        let at_displacements = at.member("displacements");
        let driven = stage.displacements.keys().filter_map(|node| following.get(node.as_str()));
        for one in driven.filter(|one| one.is_driven_off(stage)) {
            mistakes.add(&at_displacements.member(one.middle), || {
                format!("{}; the mean of their displacements is expected", one.follows())
            });
        }
        let bound = stage.until.as_ref().and_then(|until| until.displacement.as_ref());
        if let Some(one) = bound.and_then(|bound| following.get(bound.node.as_str())) {
            let at_until = at.member("until");
            let at_bound = at_until.member("displacement");
            mistakes.add(&at_bound.member("node"), || format!("{}; name one of these", one.follows()));
        }
    }
}
