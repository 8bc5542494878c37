//! Conversion of a dimensionless point to a row in the user's units and names.

use crate::branching::directions::feasible_direction::{DirectionChoice, is_worth_listing};
use crate::continuation::path_state::force_rows;
use crate::continuation::path_state::totals::Totals;
use crate::continuation::scene::{Reported, Scene};
use crate::mechanics::contact::vector::{dot, scaled};
use crate::mechanics::contact::{Mode, Reaction, tangents_in_space};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::natural_residual;
use crate::mechanics::problem::node_contact_forces::{self, free_directions};
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use crate::result::increment::{ContactState, Diagnostics, Direction, Energy, Increment, Point, Stability, Status};
use smallvec::smallvec;
use std::sync::Arc;

/// The data of a row besides the path's totals.
pub(crate) struct RowSource<'a> {
    pub stage: usize,
    pub stability: Option<Stability>,
    pub loading: Loading<'a>,
    /// The loading of every contact of the scene.
    pub whole: Loading<'a>,
    /// For each contact of the scene its place among those of the state and modes; a contact without a place is free.
    pub places: &'a [Option<usize>],
    /// The request's contacts that have a row.
    pub rows: &'a [usize],
    pub state: &'a State,
    /// The previous point; the state itself at the start.
    pub before: &'a State,
    /// Modes during the increment.
    pub modes: &'a [Mode],
    pub step: f64,
    pub point: &'a Point,
    pub options: &'a [DirectionChoice],
    pub taken: Option<usize>,
    pub residual: f64,
    pub error_estimate: f64,
    pub elapsed_s: f64,
    pub mode_named: Option<bool>,
}

/// Status of a contact in a mode.
pub(crate) fn status(mode: Mode) -> Status {
    match mode {
        Mode::Free => Status::Free,
        Mode::Stick => Status::Stick,
        Mode::Slip { .. } => Status::Slip,
    }
}

/// The present increment; with its directions where there is a choice.
pub(crate) fn increment(scene: &Scene, totals: &Totals, row: &RowSource<'_>) -> Increment {
    let plan = scene.plan();
    let (length, force) = (plan.displacement_scale, plan.force_scale);
    let energy_unit = length * force;
    let stage = &scene.stages[row.stage];
    let displacements = scene.nodal_motion(&row.loading.structure.turning.totals(&row.state.displacement), length);
    let (contacts, complementarity) = contact_rows(scene, row, totals);
    let directions = is_worth_listing(row.options).then(|| {
        let direction = |(index, option): (usize, &DirectionChoice)| Direction {
            contacts: reported(scene, row)
                .map(|one| row.places[one.contact].map_or(Status::Free, |place| status(option.modes[place])))
                .collect(),
            load_rate: option.rate.load * stage.load_scale,
            dissipation_rate: option.dissipation * energy_unit,
            taken: row.taken == Some(index),
            retrace: option.retrace,
            mechanism: option.mechanism,
        };
        row.options.iter().enumerate().map(direction).collect()
    });
    Increment {
        index: totals.index,
        stage: Arc::clone(&stage.name),
        load_factor: stage.load_factor(row.state.load),
        arc_length: totals.arc_length,
        step: row.step,
        displacements,
        contacts,
        elements: force_rows::element_rows(scene, row),
        supports: force_rows::support_reactions(scene, row),
        applied_forces: force_rows::applied_forces(scene, row),
        point: row.point.clone(),
        directions,
        stability: row.stability,
        other_motion: None,
        energy: Energy {
            external_work: totals.energy.external_work * energy_unit,
            strain: totals.energy.strain * energy_unit,
            dissipated: totals.energy.dissipated * energy_unit,
            released: totals.energy.released * energy_unit,
        },
        diagnostics: Diagnostics {
            elapsed_s: row.elapsed_s,
            residual: row.residual,
            complementarity,
            energy_error: totals.energy_error(scene.structure.largest_rounding(&row.state.displacement)),
            error_estimate: row.error_estimate,
            factorisations: totals.work.factorisations,
            bifurcation_factorisations: totals.work.bifurcation_factorisations,
            newton_iterations: totals.work.newton_iterations,
            qp_solves: totals.work.qp_solves,
            mpec_solves: totals.work.mpec_solves,
            sqp_iterations: totals.work.sqp_iterations,
            certificates: totals.work.certificates,
            mpec_fallbacks: totals.work.mpec_fallbacks,
            last_relaxation: totals.last_relaxation,
            mode_named_by_mpec: row.mode_named,
        },
    }
}

/// The request's contacts that have a row, in the order of the request.
fn reported<'a>(scene: &'a Scene, row: &RowSource<'a>) -> impl Iterator<Item = &'a Reported> {
    row.rows.iter().map(|index| &scene.reported[*index])
}

/// Contact rows in the user's units, and the largest violation of contact and friction (dimensionless).
fn contact_rows(scene: &Scene, row: &RowSource<'_>, totals: &Totals) -> (Vec<ContactState>, f64) {
    let plan = scene.plan();
    let (length, force) = (plan.displacement_scale, plan.force_scale);
    let dimension = scene.structure.dimension;
    let mut rows = Vec::with_capacity(row.rows.len());
    let loading = row.loading;
    for (one, place) in reported(scene, row).zip(row.rows) {
        let frame = row.whole.frame(one.contact, row.state);
        let is_pressed = row.places[one.contact].is_some_and(|index| row.state.reactions[index].normal > 0.0);
        let gap = if is_pressed { frame.gap } else { row.whole.open_gap(one.contact, row.state) };
        let mut contact = ContactState {
            node: Arc::clone(&one.node),
            obstacle: Arc::clone(&one.obstacle),
            status: Status::Free,
            gap: gap * length,
            normal_reaction: 0.0,
            tangential_reaction: smallvec![0.0; dimension - 1],
            reaction: smallvec![0.0; dimension],
            slip: smallvec![0.0; dimension - 1],
            slip_total: totals.slip_of(*place, dimension - 1),
            indeterminate: false,
        };
        if let Some(index) = row.places[one.contact] {
            let reaction = row.state.reactions[index];
            let tangents = if dimension == 2 {
                [[frame.normal[1], -frame.normal[0], 0.0], [0.0; 3]]
            } else {
                tangents_in_space(&frame.normal)
            };
            // A node that moves along an obstacle without reaction slips, whether the equations solved are those of
            // slip or of no contact.
            let touches = |state: &State| loading.gap(index, state) <= CONTACT_TOLERANCE;
            let moved = loading.relative_motion(index, row.before, row.state);
            let grazes = || {
                loading.contacts[index].tangents() > 0
                    && touches(row.before)
                    && touches(row.state)
                    && tangents.iter().any(|tangent| dot(&moved, tangent) != 0.0)
            };
            let mode = row.modes[index];
            let is_active = mode.is_active() || grazes();
            contact.status = if is_active && !mode.is_active() { Status::Slip } else { status(mode) };
            contact.normal_reaction = reaction.normal * one.normal_share * force;
            for (value, tangent) in contact.tangential_reaction.iter_mut().zip(&tangents) {
                *value = dot(&reaction.tangential, tangent) * one.tangential_share * force;
            }
            let shared = Reaction {
                normal: reaction.normal * one.normal_share,
                tangential: scaled(&reaction.tangential, one.tangential_share),
            };
            let in_axes = node_contact_forces::force(&frame, &shared);
            let in_space = contact_jacobian::force_on_own_body(
                &scene.structure,
                &loading.contacts[index],
                &row.state.displacement,
                &in_axes,
            );
            contact.reaction.iter_mut().zip(in_space).for_each(|(value, component)| *value = component * force);
            if is_active {
                for (value, tangent) in contact.slip.iter_mut().zip(&tangents) {
                    *value = dot(&moved, tangent) * length;
                }
                contact.slip_total.iter_mut().zip(&contact.slip).for_each(|(total, slip)| *total += slip);
                contact.indeterminate = one.shared || held_by_too_many(loading, row.modes, index);
            }
        }
        rows.push(contact);
    }
    (rows, natural_residual::violation(loading, row.state, totals.force_scale))
}

/// Whether a contact and others at its node have reactions that equilibrium does not determine.
fn held_by_too_many(loading: Loading<'_>, modes: &[Mode], contact: usize) -> bool {
    loading.corners.iter().filter(|corner| corner.contacts.contains(&contact)).any(|corner| {
        let parts: usize = corner.holding(modes).map(|one| 1 + loading.contacts[one].tangents()).sum();
        parts > free_directions(loading, contact).len() && corner.holding(modes).any(|one| one == contact)
    })
}
