//! Admissibility of scenes: scenes that cannot be traced are refused, with the changes that would make them admissible.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::Bordered;
use crate::algebra::{Factorisation, null_space};
use crate::continuation::scene::Scene;
use crate::continuation::scene::build;
use crate::continuation::scene::stage_load::StageLoad;
use crate::continuation::scene::tolerances::{ACCEPTED_IMBALANCE, CLOSED_GAP, DRAGGED};
use crate::mechanics::contact::ContactPair;
use crate::mechanics::contact::frame::Sliding;
use crate::mechanics::contact::vector::dot;
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::structure::Structure;
use crate::model::request::Model;
use crate::model::{InputError, InputErrors};
use itertools::Itertools;
use nalgebra::{DMatrix, DVector};

/// Refuses friction between a supported component and an obstacle, or another body, that are driven against each other: the
/// support would bear a traction that is no unknown of the path.
pub(super) fn refuse_dragged_supports(scene: &Scene, model: &Model) -> Result<(), InputErrors> {
    let structure = &scene.structure;
    let dimension = structure.dimension;
    for (index, one) in scene.reported.iter().enumerate() {
        let contact = &scene.contacts[one.contact];
        let of_node = contact.kinematics.node();
        let driven = |node: usize, component: usize| {
            let freedom = structure.translations_of(node).start + component;
            let moves = |stage: &StageLoad| {
                let support = stage.pattern.supports.get(freedom).copied().unwrap_or(0.0);
                support != stage.pattern.shifts[one.contact][component]
            };
            let normal = contact.frame(&[0.0; 3]).normal;
            structure.unknown_of[freedom].is_none() && normal[component].abs() < 1.0 && scene.stages.iter().any(moves)
        };
        let is_dragged = || match of_node {
            Some(node) => (0..dimension).any(|component| driven(node, component)),
            None => is_dragged_on_body(scene, contact),
        };
        if model.contacts.get(index).is_some_and(|posted| posted.friction > 0.0) && is_dragged() {
            return Err(InputErrors(vec![InputError::new(
                format!("/model/contacts/{}/friction", model.posted_contact(index)),
                format!(
                    "\"{}\" is supported in a component in which it and \"{}\" are driven against each other; friction \
                     on such a support is not available: leave the component free and hold it by a spring, or give \
                     friction 0",
                    one.node, one.obstacle
                ),
            )]));
        }
    }
    Ok(())
}

/// Whether supports drive a node and the surface that it touches along each other in a direction in which the supports leave
/// none of the two a motion of its own.
fn is_dragged_on_body(scene: &Scene, contact: &ContactPair) -> bool {
    let structure = &scene.structure;
    let moves_freely = match contact.sliding {
        Sliding::None => false,
        Sliding::Line { .. } => structure.dimension == 2,
        Sliding::Plane => true,
    };
    if moves_freely {
        return false;
    }
    let still = vec![0.0; structure.freedoms()];
    let mut driving =
        scene.stages.iter().filter(|stage| stage.pattern.supports.iter().any(|part| *part != 0.0)).peekable();
    if driving.peek().is_none() {
        return false;
    }
    let products = build::products_of_free_motions(structure, contact);
    driving.any(|stage| {
        let (mut moved, mut size) = ([0.0; 3], 0.0_f64);
        contact_jacobian::each_column(structure, contact, &still, |freedom, column| {
            let support = stage.pattern.supports.get(freedom).copied().unwrap_or(0.0);
            moved.iter_mut().zip(column).for_each(|(sum, part)| *sum += support * part);
            size = column.iter().fold(size, |most, part| most.max((support * part).abs()));
        });
        let along = match contact.sliding {
            Sliding::None if structure.dimension == 2 => {
                // What of the motion across is taken up by the one that is left moves the surfaces along each other, too.
                let [along, across, _] = moved;
                let [both, square] = [products[0][1], products[1][1]];
                if square > 0.0 { (along - both / square * across).abs() } else { along.abs() }
            }
            Sliding::None => moved[0].hypot(moved[1]),
            Sliding::Line { across } => dot(&across, &moved).abs(),
            Sliding::Plane => 0.0,
        };
        along > DRAGGED * size
    })
}

/// Refuses prestress and rest lengths that do not balance in the undeformed structure: a path starts at rest.
pub(super) fn refuse_imbalance(scene: &Scene) -> Result<(), InputErrors> {
    let structure = &scene.structure;
    let mut force = vec![0.0; structure.freedoms()];
    let largest = structure.internal_force(&vec![0.0; structure.freedoms()], &mut force);
    let unbalanced = structure.freedom_of.iter().map(|freedom| (*freedom, force[*freedom].abs()));
    let Some((freedom, worst)) = unbalanced.max_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(()) };
    if worst <= ACCEPTED_IMBALANCE * largest {
        return Ok(());
    }
    let name = scene.node_name(structure.numbering.node_of(freedom).0);
    Err(InputErrors(vec![InputError::new(
        pointer_to_node(name),
        format!(
            "prestress and rest lengths leave a force of {:e} on \"{name}\" at the start; a path starts from a state \
             at rest: give prestress that balances at every free node, or bring it on as a stage's forces",
            worst * scene.plan.force_scale
        ),
    )]))
}

/// Motions at rest, with all closed contacts constrained, that hardly any force resists; `None` where there are none.
fn unresisted_motions(scene: &Scene, still: &[f64]) -> Option<Vec<DVector<f64>>> {
    let structure = &scene.structure;
    let unknowns = structure.unknowns();
    if let Some(layout) = structure.layout() {
        let mut matrix = Bordered::new(layout.pattern.clone(), 0);
        let (mut places, mut stiffness) = (layout.places(), 0.0_f64);
        structure.each_stiffness(still, &mut |_, _, value| {
            if let Some(place) = places.next().flatten() {
                matrix.add_at(place, value);
                stiffness = stiffness.max(value.abs());
            }
        });
        hold_closed_contacts(scene, stiffness, &mut matrix);
        return matrix.null_vectors(1e-9).filter(|motions| !motions.is_empty());
    }
    let mut matrix = DMatrix::zeros(unknowns, unknowns);
    structure.add_tangent(still, &mut matrix);
    let stiffness = matrix.amax();
    hold_closed_contacts(scene, stiffness, &mut matrix);
    if unknowns == 0 || Factorisation::new(matrix.clone()).is_some() {
        return None;
    }
    null_space(&matrix, 1e-12).map(|basis| basis.column_iter().map(|column| column.into_owned()).collect())
}

/// Adds a stiffness in every direction in which a closed contact constrains its node.
fn hold_closed_contacts(scene: &Scene, stiffness: f64, matrix: &mut impl Sink) {
    let structure = &scene.structure;
    let still = vec![0.0; structure.freedoms()];
    for contact in &scene.contacts {
        let frame = contact.frame(&[0.0; 3]);
        if frame.gap > CLOSED_GAP {
            continue;
        }
        let held = 1 + contact.tangents();
        for vector in [frame.normal, frame.tangents[0], frame.tangents[1]].iter().take(held) {
            let mut own: Vec<(usize, f64)> = Vec::with_capacity(structure.dimension);
            contact_jacobian::each_column(structure, contact, &still, |freedom, column| {
                own.extend(structure.unknown_of[freedom].map(|unknown| (unknown, dot(vector, column))));
            });
            for ((row, first), (column, second)) in own.iter().cartesian_product(&own) {
                matrix.add(*row, *column, stiffness * first * second);
            }
        }
    }
}

/// Refuses a structure that has a motion without resistance even with all closed contacts constrained.
pub(super) fn refuse_mechanism(scene: &Scene, model: &Model) -> Result<(), InputErrors> {
    let structure = &scene.structure;
    let still = vec![0.0; structure.freedoms()];
    let Some(motions) = unresisted_motions(scene, &still) else { return Ok(()) };
    for motion in &motions {
        let mut rate = still.clone();
        for (unknown, value) in motion.iter().enumerate() {
            rate[structure.freedom_of[unknown]] = *value;
        }
        if structure.resistance(&still, &rate) < 1e-10 {
            return Err(InputErrors(vec![mechanism(scene, model, structure.freedom_of[motion.iamax()])]));
        }
    }
    Ok(())
}

/// The mistake of a structure that moves without resistance, most along this degree of freedom.
fn mechanism(scene: &Scene, model: &Model, freedom: usize) -> InputError {
    let structure = &scene.structure;
    let (node, which) = structure.numbering.node_of(freedom);
    let name = scene.node_name(node);
    let resisting = "with no element, support or closed contact resisting";
    if let Some(element) = released_at(structure, model, node, which) {
        let text = format!(
            "the structure is a mechanism: the end of this beam that is released at \"{name}\" can turn {resisting}; \
             leave the release out, or hold the beam elsewhere"
        );
        return InputError::new(format!("/model/elements/{element}"), text);
    }
    let motion = structure.numbering.motion_of(which);
    let text = format!(
        "the structure is a mechanism: \"{name}\" can {motion} {resisting}; support it, or connect it by elements \
         that resist the motion"
    );
    InputError::new(pointer_to_node(name), text)
}

/// The element whose released end has the degree of freedom `which` of a node, by its place in the input.
fn released_at(structure: &Structure, model: &Model, node: usize, which: usize) -> Option<usize> {
    let rotation = which.checked_sub(structure.dimension)?;
    let (name, _) = model.nodes.get_index(node)?;
    structure.elements().zip(&model.elements).position(|(at, element)| {
        let place = element.nodes().iter().position(|own| own == name).filter(|_| !element.turns_with(name));
        place.is_some_and(|place| at.element.first_rotation_at(place) == rotation && at.element.rotations() > 0)
    })
}

fn pointer_to_node(name: &str) -> String {
    format!("/model/nodes/{}", name.replace('~', "~0").replace('/', "~1"))
}
