//! Checks what a stage multiplies by its load factor: forces, displacements of supports, motions of obstacles.

use crate::model::check::scope::Scope;
use crate::model::check::scope::numbers::{self, dot, largest, norm};
use crate::model::check::solids;
use crate::model::check::structure::COMPONENT_NAMES;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::quoted;
use crate::model::request::{Contact, Obstacle, ObstaclePivot, Stage};
use std::collections::HashSet;

/// A motion whose component along the normal is at most this part of its length is parallel to the plane.
const ALONG: f64 = 8.0 * f64::EPSILON;

/// The parts of the model on which moving supports and obstacles act, computed once for all stages.
pub(super) struct Surroundings {
    /// For each node, whether an element or a contact of bodies joins it to a free component.
    driving: Vec<bool>,
    /// For each obstacle, its contacts.
    used: Vec<Use>,
}

/// The contacts of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Use {
    None,
    Frictionless,
    Frictional,
}

impl Surroundings {
    pub fn new(scope: &Scope) -> Self {
        Self { driving: driving(scope), used: used(scope) }
    }
}

fn driving(scope: &Scope) -> Vec<bool> {
    let mut driving = vec![false; scope.model.nodes.len()];
    for element in &scope.model.elements {
        let numbers = element.nodes().iter().filter_map(|name| scope.model.nodes.get_index_of(name));
        if numbers.clone().any(|node| scope.has_free_component(node)) {
            numbers.for_each(|node| driving[node] = true);
        }
    }
    for (own, opposite) in touching(scope) {
        let both = own.iter().chain(&opposite);
        if both.clone().any(|node| scope.has_free_component(*node)) {
            both.for_each(|node| driving[*node] = true);
        }
    }
    driving
}

/// The nodes of the surfaces, or of the nodes and the surfaces, that touch each other.
fn touching(scope: &Scope) -> Vec<(Vec<usize>, Vec<usize>)> {
    let number = |name: &String| scope.model.nodes.get_index_of(name);
    let of_surface = |name: &str| -> Vec<usize> {
        let faces = scope.model.surfaces.get(name).into_iter().flat_map(|surface| &surface.faces);
        faces.flatten().filter_map(number).collect()
    };
    let mut seen = HashSet::new();
    let bodies = scope.model.contacts.iter().filter_map(|contact| Some((contact, contact.against.as_deref()?)));
    let own = |contact: &Contact| match contact.surface.as_deref() {
        Some(surface) => of_surface(surface),
        None => number(&contact.node).into_iter().collect(),
    };
    let mut pairs = Vec::new();
    for (contact, against) in bodies {
        let name = contact.surface.as_deref().unwrap_or(&contact.node);
        if seen.insert((contact.surface.is_some(), name, against)) {
            pairs.push((own(contact), of_surface(against)));
        }
    }
    pairs
}

fn used(scope: &Scope) -> Vec<Use> {
    let mut used = vec![Use::None; scope.model.obstacles.len()];
    for contact in scope.model.contacts.iter().filter(|contact| contact.against.is_none()) {
        let found = if contact.friction > 0.0 { Use::Frictional } else { Use::Frictionless };
        match scope.model.obstacles.get_index_of(&contact.obstacle) {
            Some(obstacle) => used[obstacle] = used[obstacle].max(found),
            // A misspelt name, which has been reported, may mean any of them.
            None => return vec![Use::Frictional; used.len()],
        }
    }
    used
}

pub(super) fn loads(scope: &Scope, around: &Surroundings, stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let before = mistakes.count();
    let forces_at = at.member("forces");
    let mut loaded = forces(scope, stage, &forces_at, mistakes);
    loaded |= moments(scope, stage, &at.member("moments"), mistakes);
    loaded |= displacements(scope, around, stage, &at.member("displacements"), mistakes);
    loaded |= solids::loads(scope, stage, at, mistakes);
    loaded |= motions(scope, around, stage, &at.member("obstacle_motion"), mistakes);
    loaded |= rotations(scope, around, stage, &at.member("obstacle_rotation"), mistakes);
    if !loaded && mistakes.count() == before {
        let only_forces = stage.moments.is_empty()
            && stage.displacements.is_empty()
            && stage.obstacle_motion.is_empty()
            && stage.obstacle_rotation.is_empty();
        let at = if only_forces && !stage.forces.is_empty() { &forces_at } else { at };
        mistakes.add(at, || {
            "the stage has no load; a force, a body force, a traction or a pressure that is not zero on a free component, a moment on a rotation that is free, a \
             displacement of a support that an element or a contact of bodies joins to a free component, or a motion or rotation of an obstacle \
             against a contact (along itself only with friction) is expected"
        });
    }
}

/// A force on a supported component is carried by the support. A stage whose forces are all carried by supports moves nothing.
fn forces(scope: &Scope, stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let mut loaded = false;
    for (name, force) in &stage.forces {
        let at = at.member(name);
        let node = scope.node(name, &at, mistakes);
        if numbers::vector(force, scope.model.dimension, &at, mistakes) {
            let moves = |node| force.iter().enumerate().any(|(index, &part)| part != 0.0 && scope.is_free(node, index));
            loaded |= node.is_some_and(moves);
        }
    }
    loaded
}

/// Notes a node without a rotation where one is named; `at`: the place that names it.
pub(super) fn rotation(scope: &Scope, node: usize, name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let has = scope.has_rotation(node);
    if !has {
        mistakes.add(at, || {
            format!(
                "the node {} has no rotation; one to which a beam is joined without a release, or on which a rotational \
                 spring acts, is expected",
                quoted(name)
            )
        });
    }
    has
}

fn moments(scope: &Scope, stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let mut loaded = false;
    for (name, &moment) in &stage.moments {
        let at = at.member(name);
        if scope.model.dimension != 2 {
            mistakes.add(&at, || {
                "moments in space are not taken; `displacements` of a supported rotation, or a pair of forces, would do"
                    .to_owned()
            });
            continue;
        }
        let node = scope.node(name, &at, mistakes);
        let sane = numbers::number(moment, &at, mistakes);
        let Some(node) = node else { continue };
        loaded |= rotation(scope, node, name, &at, mistakes) && sane && moment != 0.0 && scope.turns_freely(node);
    }
    loaded
}

fn displacements(
    scope: &Scope,
    around: &Surroundings,
    stage: &Stage,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> bool {
    let mut loaded = false;
    for (name, displacement) in &stage.displacements {
        let at = at.member(name);
        let node = scope.node(name, &at, mistakes);
        let dimension = scope.model.dimension;
        // The rotations may follow where the node has any.
        let with_rotations = dimension + scope.model.rotations();
        let turns = displacement.len() == with_rotations && node.is_some_and(|node| scope.has_rotation(node));
        let may_turn = with_rotations > dimension && node.is_some_and(|node| scope.has_rotation(node));
        if may_turn && !turns && displacement.len() != dimension {
            mistakes.add(&at, || {
                format!(
                    "found {} numbers; {dimension} are expected, or {with_rotations} with the rotations of the node",
                    displacement.len()
                )
            });
            continue;
        }
        if !numbers::vector(displacement, if turns { with_rotations } else { dimension }, &at, mistakes) {
            continue;
        }
        let Some(node) = node else { continue };
        for (place, &part) in displacement.iter().enumerate().filter(|(_, part)| **part != 0.0) {
            let (is_turn, index) = (place >= dimension, scope.component_at(place));
            if if is_turn { scope.turns_freely_by(node, index) } else { scope.is_free(node, index) } {
                mistakes.add(&at.index(place), || {
                    let component = COMPONENT_NAMES[index];
                    let name = quoted(name);
                    format!(
                        "found {part:?}, but the component {component} of {name} is free; support it, or leave this 0"
                    )
                });
            } else {
                loaded |= around.driving[node];
            }
        }
    }
    loaded
}

fn motions(scope: &Scope, around: &Surroundings, stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let mut loaded = false;
    for (name, motion) in &stage.obstacle_motion {
        let at = at.member(name);
        let found = scope.obstacle(name, &at, mistakes);
        let sane = numbers::vector(motion, scope.model.dimension, &at, mistakes);
        let Some((number, obstacle)) = found else { continue };
        if !sane || largest(motion) == 0.0 {
            continue;
        }
        loaded |= acts(around.used[number], name, &at, mistakes, || !slides_along(obstacle, motion));
    }
    loaded
}

/// Whether a motion of an obstacle has an effect; `changes_shape` tells whether it is not mapped onto itself.
fn acts(
    used: Use,
    name: &str,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
    changes_shape: impl FnOnce() -> bool,
) -> bool {
    match used {
        Use::None => {
            mistakes.add(at, || {
                let name = quoted(name);
                format!(
                    "no node has a contact with {name}, so its motion does nothing; add one, or leave the motion out"
                )
            });
            false
        }
        Use::Frictionless => changes_shape(),
        Use::Frictional => true,
    }
}

fn rotations(scope: &Scope, around: &Surroundings, stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let mut loaded = false;
    let dimension = scope.model.dimension;
    for (name, rotation) in &stage.obstacle_rotation {
        let at = at.member(name);
        let found = scope.obstacle(name, &at, mistakes);
        let before = mistakes.count();
        numbers::number(rotation.angle, &at.member("angle"), mistakes);
        if let Some(about) = &rotation.about {
            numbers::vector(about, dimension, &at.member("about"), mistakes);
        }
        if let Some(axis) = &rotation.axis {
            let at = at.member("axis");
            if dimension == 2 {
                mistakes.add(&at, || "in the plane obstacles turn about a point; leave the axis out");
            } else if numbers::vector(axis, dimension, &at, mistakes) && largest(axis) == 0.0 {
                mistakes.add(&at, || "the axis is zero; a vector along it is expected");
            }
        }
        let Some((number, obstacle)) = found else { continue };
        let has_no_point = matches!(obstacle, Obstacle::Polyline(_) | Obstacle::TriangleMesh(_));
        if rotation.about.is_none() && has_no_point {
            mistakes.add(&at, || "polylines and triangle meshes turn about a point that is given; `about` is expected");
        }
        let has_axis = rotation.axis.is_some() || matches!(obstacle, Obstacle::Cylinder { .. });
        if dimension == 3 && !has_axis {
            mistakes.add(&at, || "in space an obstacle turns about an axis; `axis` is expected");
        }
        if mistakes.count() > before {
            continue;
        }
        let pivot = rotation.pivot(obstacle, dimension);
        if scope.turning.get(name.as_str()).is_some_and(|first| Some(*first) != pivot) {
            mistakes.add(&at, || {
                let name = quoted(name);
                format!(
                    "{name} turns about another point or axis in an earlier stage; the same `about` and direction of `axis` are \
                     expected in all"
                )
            });
            continue;
        }
        if rotation.angle != 0.0 {
            let turns = || pivot.is_none_or(|pivot| !turns_onto_itself(obstacle, &pivot));
            loaded |= acts(around.used[number], name, &at, mistakes, turns);
        }
    }
    loaded
}

/// Whether a rotation maps the obstacle onto itself: it then has no effect without friction.
fn turns_onto_itself(obstacle: &Obstacle, pivot: &ObstaclePivot) -> bool {
    let away = |from: &[f64]| {
        let mut way = pivot.place.map(|part| -part);
        way.iter_mut().zip(from).for_each(|(way, part)| *way += part);
        let along = dot(&way, &pivot.axis);
        let off: Vec<f64> = way.iter().zip(&pivot.axis).map(|(way, axis)| way - along * axis).collect();
        norm(&off)
    };
    let is_along = |direction: &[f64]| {
        let along = dot(direction, &pivot.axis) / norm(direction);
        1.0 - along.abs() <= ALONG
    };
    match obstacle {
        Obstacle::Ball { center, .. } => away(center) == 0.0,
        Obstacle::Cylinder { point, axis, .. } => is_along(axis) && away(point) == 0.0,
        Obstacle::Plane { normal, .. } => normal.len() == 3 && is_along(normal),
        Obstacle::Polyline(_) | Obstacle::Box(_) | Obstacle::TriangleMesh(_) => false,
    }
}

/// Whether the motion maps the obstacle onto itself: a plane that moves along itself and a cylinder along its axis have no
/// effect without friction.
fn slides_along(obstacle: &Obstacle, motion: &[f64]) -> bool {
    match obstacle {
        Obstacle::Plane { normal, .. } => dot(normal, motion).abs() <= ALONG * norm(normal) * norm(motion),
        Obstacle::Cylinder { axis, .. } => {
            let length = norm(axis);
            let along = dot(axis, motion) / length;
            let off = |(motion, axis): (&f64, &f64)| motion - along * (axis / length);
            norm(&motion.iter().zip(axis).map(off).collect::<Vec<f64>>()) <= ALONG * norm(motion)
        }
        Obstacle::Ball { .. } | Obstacle::Polyline(_) | Obstacle::Box(_) | Obstacle::TriangleMesh(_) => false,
    }
}
