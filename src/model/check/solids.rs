//! Checks solids: materials, elements, surfaces, and the loads on them.

use crate::mechanics::structure::elements::solid::SolidElementError;
use crate::mechanics::structure::elements::solid::any::{AnySolid, SolidData};
use crate::mechanics::structure::elements::solid::shapes::kind::SolidKind;
use crate::model::check::scope::numbers;
use crate::model::check::scope::{Scope, proper_name};
use crate::model::check::structure::distinct_nodes;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::{ElasticConstants, Element, Material, PlaneCondition, Solid, Stage, Surface};
use crate::model::solids::data;
use crate::model::solids::faces::{FaceMatch, surface_faces};
use itertools::Itertools;
use std::collections::HashMap;

pub(super) fn materials(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("materials");
    for (name, material) in &scope.model.materials {
        let at = at.member(name);
        proper_name(name, &at, mistakes);
        match material {
            Material::LinearElastic(constants)
            | Material::SaintVenantKirchhoff(constants)
            | Material::NeoHookean(constants) => elastic(constants, &at, mistakes),
            Material::MooneyRivlin { c10, c01, bulk_modulus, density } => {
                numbers::number(*c10, &at.member("c10"), mistakes);
                numbers::number(*c01, &at.member("c01"), mistakes);
                numbers::positive(*bulk_modulus, &at.member("bulk_modulus"), mistakes);
                if !(*c10 >= 0.0 && *c01 >= 0.0 && c10 + c01 > 0.0) {
                    let detail = || {
                        format!("found `c10` {c10:?} and `c01` {c01:?}; none below 0, and a sum above 0, are expected")
                    };
                    mistakes.add(&at, detail);
                }
                mass(*density, &at, mistakes);
            }
        }
    }
}

fn elastic(constants: &ElasticConstants, at: &DocumentPlace, mistakes: &mut Mistakes) {
    numbers::positive(constants.young, &at.member("young"), mistakes);
    let at_poisson = at.member("poisson");
    if numbers::number(constants.poisson, &at_poisson, mistakes)
        && !(-1.0 < constants.poisson && constants.poisson < 0.5)
    {
        mistakes.add(&at_poisson, || {
            let found = constants.poisson;
            format!("found {found:?}; above -1 and below 0.5 is expected: 0.4999 is nearly incompressible")
        });
    }
    mass(constants.density, at, mistakes);
}

fn mass(density: Option<f64>, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if let Some(density) = density {
        numbers::positive(density, &at.member("density"), mistakes);
    }
}

pub(super) fn solid(scope: &Scope, kind: SolidKind, solid: &Solid, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let before = mistakes.count();
    let dimension = scope.model.dimension;
    if kind.dimension() != dimension {
        mistakes.add(&at.member("kind"), || {
            let other = kind.dimension();
            format!("found a solid of {other} dimensions in a model of {dimension}; one of {dimension} is expected")
        });
    }
    if solid.nodes.len() != kind.nodes() {
        let (found, expected) = (solid.nodes.len(), kind.nodes());
        mistakes.add(&at.member("nodes"), || format!("found {found} nodes; a solid of this kind has {expected}"));
    }
    let nodes = distinct_nodes(scope, &solid.nodes, kind.nodes(), at, mistakes);
    third_direction(solid, dimension, at, mistakes);
    let material = scope.model.materials.get(&solid.material);
    if material.is_none() {
        mistakes.add(&at.member("material"), || {
            let known = suggestion(&solid.material, scope.model.materials.keys().map(String::as_str));
            format!("there is no material {}{known}", quoted(&solid.material))
        });
    }
    let (Some(nodes), Some(material), true) = (nodes, material, mistakes.count() == before) else { return };
    let positions: Option<Vec<&[f64]>> = nodes.iter().map(|node| scope.position(*node)).collect();
    let Some(positions) = positions else { return };
    // Constants that make no material have been reported.
    let Ok(material) = data::material(material, 1.0) else { return };
    let idealisation = data::idealisation(solid, dimension, 1.0);
    let positions = data::positions(&positions, idealisation, 1.0);
    let data = SolidData { kind, idealisation, material, mend: solid.locking };
    if let Err(error) = AnySolid::new(&data, &nodes, &positions) {
        let at = match error {
            SolidElementError::Mend(..) => at.member("locking"),
            SolidElementError::Thickness(_) => at.member("thickness"),
            _ => at.member("nodes"),
        };
        mistakes.add(&at, || refused(&error));
    }
}

/// What is wrong with an element, and what would do.
fn refused(error: &SolidElementError) -> String {
    match error {
        SolidElementError::Jacobian { .. } => format!(
            "{error}; corners counter-clockwise (in space: the first face seen from inside), then the middles of edges, as \
             in VTK's file format, are expected"
        ),
        SolidElementError::Mend(..) => format!("{error}; leave `locking` out for the usual one"),
        other => other.to_string(),
    }
}

fn third_direction(solid: &Solid, dimension: usize, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if let Some(thickness) = solid.thickness {
        numbers::positive(thickness, &at.member("thickness"), mistakes);
    }
    match (dimension, solid.plane, solid.thickness) {
        (2, None, _) => mistakes.add(at, || "`plane` is missing; it is `strain`, `stress` or `axisymmetric`"),
        (2, Some(PlaneCondition::Axisymmetric), Some(_)) => {
            mistakes.add(&at.member("thickness"), || "a body of revolution has no thickness; leave it out");
        }
        (3, Some(_), _) => mistakes.add(&at.member("plane"), || "a solid in space has no `plane`; leave it out"),
        (3, None, Some(_)) => {
            mistakes.add(&at.member("thickness"), || "a solid in space has no `thickness`; leave it out");
        }
        _ => {}
    }
}

/// Bodies of revolution and others in one model have forces of different meaning.
pub(super) fn one_meaning_of_forces(scope: &Scope, mistakes: &mut Mistakes) {
    let is_revolved =
        |element: &Element| element.solid().map(|(_, solid)| solid.plane == Some(PlaneCondition::Axisymmetric));
    let mut kinds = scope.model.elements.iter().map(is_revolved).enumerate();
    let Some((_, Some(first))) = kinds.find(|(_, kind)| kind.is_some()) else { return };
    if let Some((place, _)) = kinds.find(|(_, kind)| kind.is_some_and(|kind| kind != first)) {
        mistakes.add(&scope.at.member("elements").index(place).member("plane"), || {
            "bodies of revolution, whose forces are those of the whole revolution, and other solids are in one model; one \
             kind is expected"
        });
    }
}

pub(super) fn surfaces(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("surfaces");
    for ((name, surface), faces) in scope.model.surfaces.iter().zip(surface_faces(scope.model)) {
        let at = at.member(name);
        proper_name(name, &at, mistakes);
        if scope.model.sets.contains_key(name) {
            mistakes.add(&at, || format!("a set has the name {}, too; `@` has to tell them apart", quoted(name)));
        }
        let at = at.member("faces");
        if surface.faces.is_empty() {
            mistakes.add(&at, || "the surface has no face; one or more are expected");
        }
        let mut seen = HashMap::new();
        for (index, (nodes, face)) in surface.faces.iter().zip(faces).enumerate() {
            let at = at.index(index);
            let sorted: Vec<&String> = nodes.iter().sorted_unstable().collect();
            if let Some(first) = seen.insert(sorted, index) {
                mistakes.add(&at, || format!("the face is in the list already, at {first}; each is expected once"));
            }
            let before = mistakes.count();
            for (place, node) in nodes.iter().enumerate() {
                scope.node(node, &at.index(place), mistakes);
            }
            if mistakes.count() > before {
                continue;
            }
            match face {
                FaceMatch::Face(_) | FaceMatch::Side(_) => {}
                FaceMatch::None => mistakes.add(&at, || {
                    let listed: Vec<String> = nodes.iter().map(|node| quoted(node).to_string()).collect();
                    let listed = listed.join(", ");
                    if scope.model.dimension == 3 {
                        return format!("no solid has a face of the nodes {listed}; all nodes of one face are expected");
                    }
                    format!(
                        "no solid has a face of the nodes {listed}, and no bar or beam of two nodes joins them; all nodes of one face \
                         are expected (beams of three nodes have no sides: divide each into two)"
                    )
                }),
                FaceMatch::Inside => {
                    mistakes.add(&at, || "two solids share this face: it is inside the body; an outer one is expected");
                }
            }
        }
    }
}

/// Checks the body forces, tractions and pressures of a stage; returns whether they load a free component.
pub(super) fn loads(scope: &Scope, stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let dimension = scope.model.dimension;
    let moves = |nodes: &[String], force: &[f64]| {
        let free = |node: &String| {
            let Some(node) = scope.model.nodes.get_index_of(node) else { return false };
            force.iter().enumerate().any(|(component, part)| *part != 0.0 && scope.is_free(node, component))
        };
        nodes.iter().any(free)
    };
    let mut loaded = false;
    let at_body = at.member("body_forces");
    for (name, force) in &stage.body_forces {
        let at = at_body.member(name);
        if !scope.model.materials.contains_key(name) {
            mistakes.add(&at, || {
                let known = suggestion(name, scope.model.materials.keys().map(String::as_str));
                format!("there is no material {}{known}", quoted(name))
            });
        }
        if numbers::vector(force, dimension, &at, mistakes) {
            let solids = scope.model.elements.iter().filter_map(Element::solid);
            loaded |= solids.filter(|(_, solid)| solid.material == *name).any(|(_, solid)| moves(&solid.nodes, force));
        }
    }
    let at_tractions = at.member("tractions");
    for (name, traction) in &stage.tractions {
        let at = at_tractions.member(name);
        let surface = known_surface(scope, name, &at, mistakes);
        let sane = numbers::vector(traction, dimension, &at, mistakes);
        loaded |= sane && surface.is_some_and(|surface| surface.faces.iter().any(|face| moves(face, traction)));
    }
    let at_pressures = at.member("pressures");
    for (name, pressure) in &stage.pressures {
        let at = at_pressures.member(name);
        let surface = known_surface(scope, name, &at, mistakes);
        let sane = numbers::number(*pressure, &at, mistakes);
        // The surface may turn: it presses along every axis.
        let pressed = vec![*pressure; dimension];
        loaded |= sane && surface.is_some_and(|surface| surface.faces.iter().any(|face| moves(face, &pressed)));
    }
    loaded
}

fn known_surface<'a>(
    scope: &Scope<'a>,
    name: &str,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> Option<&'a Surface> {
    let surface = scope.model.surfaces.get(name);
    if surface.is_none() {
        mistakes.add(at, || {
            let known = suggestion(name, scope.model.surfaces.keys().map(String::as_str));
            format!("there is no surface {}{known}", quoted(name))
        });
    }
    surface
}
