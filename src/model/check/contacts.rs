//! Obstacles, contacts and the gaps between them at the start.

use std::collections::{HashMap, HashSet};

use super::numbers::{self, difference, dot, largest, norm};
use super::{Scope, proper_name};
use crate::model::mistakes::{Mistakes, Place};
use crate::model::names::{quoted, suggestion};
use crate::model::request::{Contact, Obstacle};

/// Unit normals whose product is this near -1 are opposed.
const OPPOSED: f64 = 1e-12;

pub(super) fn obstacles(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("obstacles");
    for (name, obstacle) in &scope.model.obstacles {
        let at = at.member(name);
        proper_name(name, &at, mistakes);
        match obstacle {
            Obstacle::Plane { point, normal } => {
                numbers::vector(point, scope.model.dimension, &at.member("point"), mistakes);
                let at = at.member("normal");
                if numbers::vector(normal, scope.model.dimension, &at, mistakes) && largest(normal) == 0.0 {
                    mistakes.add(&at, || "the normal is zero; a vector into the free side is expected");
                }
            }
            Obstacle::Ball { .. } => {}
        }
    }
}

/// A node's distance from a plane at the start.
struct Gap {
    contact: usize,
    gap: f64,
    normal: Vec<f64>,
    tolerance: f64,
}

pub(super) fn contacts(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("contacts");
    let mut seen = HashSet::new();
    let mut gaps: HashMap<usize, Vec<Gap>> = HashMap::new();
    for (index, contact) in scope.model.contacts.iter().enumerate() {
        let at = at.index(index);
        friction(scope, contact, &at.member("friction"), mistakes);
        let node = scope.node(&contact.node, &at.member("node"), mistakes);
        let obstacle = obstacle(scope, &contact.obstacle, &at.member("obstacle"), mistakes);
        let (Some(node), Some((number, obstacle))) = (node, obstacle) else { continue };
        if !seen.insert((node, number)) {
            mistakes.add(&at, || {
                let pair = format!("{} against {}", quoted(&contact.node), quoted(&contact.obstacle));
                format!("the contact of {pair} stands twice, which this version does not take; once would do")
            });
            continue;
        }
        let Some(gap) = gap(scope, index, node, obstacle) else { continue };
        if useful(scope, contact, node, &gap, &at, mistakes) {
            penetration(contact, &gap, &at, mistakes);
            let others = gaps.entry(node).or_default();
            room(scope, contact, &gap, others, &at, mistakes);
            others.push(gap);
        }
    }
}

fn friction(scope: &Scope, contact: &Contact, at: &Place, mistakes: &mut Mistakes) {
    let friction = contact.friction;
    if !numbers::number(friction, at, mistakes) {
        return;
    }
    if friction < 0.0 {
        mistakes.add(at, || format!("found {friction:?}; a coefficient of 0 or more is expected"));
    }
}

fn obstacle<'a>(scope: &Scope<'a>, name: &str, at: &Place, mistakes: &mut Mistakes) -> Option<(usize, &'a Obstacle)> {
    let found = scope.model.obstacles.get_full(name);
    if found.is_none() {
        let known = || suggestion(name, scope.model.obstacles.keys().map(String::as_str));
        mistakes.add(at, || format!("there is no obstacle {}{}", quoted(name), known()));
    }
    found.map(|(number, _, obstacle)| (number, obstacle))
}

fn gap(scope: &Scope, contact: usize, node: usize, obstacle: &Obstacle) -> Option<Gap> {
    let Obstacle::Plane { point, normal } = obstacle else { return None };
    let dimension = scope.model.dimension;
    let well_formed = numbers::well_formed(point, dimension) && numbers::well_formed(normal, dimension);
    if !well_formed || largest(normal) == 0.0 {
        return None;
    }
    let position = scope.position(node)?;
    let length = norm(normal);
    let normal: Vec<f64> = normal.iter().map(|component| component / length).collect();
    let gap = dot(&difference(position, point), &normal);
    let tolerance = scope.penetration_tolerance(largest(position).max(largest(point)));
    Some(Gap { contact, gap, normal, tolerance })
}

/// Notes a contact that can neither open nor close, because no free component of its node has a part along the normal.
fn useful(scope: &Scope, contact: &Contact, node: usize, gap: &Gap, at: &Place, mistakes: &mut Mistakes) -> bool {
    let moves = |(component, &along): (usize, &f64)| scope.is_free(node, component) && along != 0.0;
    let useful = gap.normal.iter().enumerate().any(moves);
    if !useful {
        mistakes.add(&at.member("node"), || {
            let why =
                if scope.has_free_component(node) { "cannot move along the obstacle's normal" } else { "cannot move" };
            format!("the node {} is supported and {why}; leave the contact out", quoted(&contact.node))
        });
    }
    useful
}

fn penetration(contact: &Contact, gap: &Gap, at: &Place, mistakes: &mut Mistakes) {
    if gap.gap < -gap.tolerance {
        mistakes.add(at, || {
            let pair = format!("{} is behind {}", quoted(&contact.node), quoted(&contact.obstacle));
            format!("{pair} at the start, gap {:?}; a gap of 0 or more is expected", gap.gap)
        });
    }
}

/// Notes a second plane that faces one before it with no room between.
fn room(scope: &Scope, contact: &Contact, gap: &Gap, others: &[Gap], at: &Place, mistakes: &mut Mistakes) {
    let faces = |other: &&Gap| dot(&gap.normal, &other.normal) <= OPPOSED - 1.0;
    for other in others.iter().filter(faces) {
        let room = gap.gap + other.gap;
        if room <= gap.tolerance.max(other.tolerance) {
            mistakes.add(at, || {
                let opposite = scope.model.contacts.get(other.contact).map_or("", |contact| &contact.obstacle);
                let pair = format!("{} and {}", quoted(opposite), quoted(&contact.obstacle));
                format!("{pair} leave {room:?} between them for {}; room is expected", quoted(&contact.node))
            });
        }
    }
}
