//! Solves the increment's program without using the end point found by path following: the products are relaxed to `ε`,
//! which decreases to its last value. Each relaxed program is solved by sequential quadratic programming, each quadratic program by the
//! interior-point method.

use crate::complementarity::mpec::{self, Finish, Settings, SolveStatus, SolverIterate};
use crate::mechanics::contact::Mode;
use crate::mechanics::problem::state::State;
use crate::resources::cancel::CancelFlag;
use crate::step::increment_mpec::solution_extraction;
use crate::step::increment_mpec::tolerances::{
    FIRST_RELAXATION, LARGEST_MOTION, LAST_RELAXATION, LOOSEST_TOLERANCE, RELAXATION_FACTOR,
};
use crate::step::increment_mpec::{InReach, IncrementProgram, ProgramCounts};
use nalgebra::DVector;

/// Largest number of iterations of one sequence.
const MOST_ITERATIONS: usize = 40;
/// Largest number of biactive pairs whose branches are enumerated.
const ENUMERATED: usize = 6;

/// The end of an increment that the search found.
#[derive(Debug, Clone)]
pub struct ProgramEnd {
    /// The contact modes at the end of the increment.
    pub modes: Vec<Mode>,
    /// The state at the end, as exact as the program is.
    pub state: State,
    /// The variables at the end, from which the next search may start.
    pub variables: DVector<f64>,
    /// The arc length over the prescribed one.
    pub size: f64,
}

/// The result of one search.
pub struct Searched {
    /// The end found; `None` where no stationary point was found.
    pub end: Option<ProgramEnd>,
    pub counts: ProgramCounts,
    /// The iterates, if they are kept.
    pub iterates: Vec<SolverIterate>,
}

/// One contact at an iterate, dimensionless.
#[derive(Debug, Clone, Copy)]
pub struct ContactAt {
    pub contact: usize,
    pub gap: f64,
    pub normal: f64,
    /// The margin `μ r_n - |r_t|`.
    pub within_cone: f64,
    /// The size `|Δu_t|`.
    pub slip: f64,
}

/// Bounds the motion: searches do not go to distant solutions, whose arc length cannot be adapted to the prescribed
/// one.
pub fn stay_near(program: &mut IncrementProgram<'_>) {
    program.most_motion = LARGEST_MOTION;
}

/// The contacts in reach, and the state, at variables of the program.
pub fn contacts_at(program: &IncrementProgram<'_>, variables: &DVector<f64>) -> (State, Vec<ContactAt>) {
    let state = solution_extraction::end_state(program, variables);
    let of = |entry: &InReach| {
        let reaction = state.reactions[entry.contact];
        let slip = match entry.tangents {
            0 => 0.0,
            1 => entry.parts().map(|(part, side)| side * variables[part]).iter().sum::<f64>().abs(),
            _ => variables[entry.slip(0)].hypot(variables[entry.slip(1)]),
        };
        ContactAt {
            contact: entry.contact,
            gap: program.loading.gap(entry.contact, &state),
            normal: reaction.normal,
            within_cone: entry.friction.margin(&reaction),
            slip: program.step * slip,
        }
    };
    let contacts = program.reach.iter().map(of).collect();
    (state, contacts)
}

/// The arc length at variables of the program over the prescribed one.
pub fn arc_length_ratio(program: &IncrementProgram<'_>, variables: &DVector<f64>) -> f64 {
    variables.rows(0, program.loading.structure.unknowns() + 1).norm()
}

/// The first bound on the products. A bound `ε` lets a contact within its cone slip by about `ε` over its distance from
/// the cone, with a spurious dissipation: this has to be small compared with the gain of the objective along the path.
pub fn first_relaxation(program: &IncrementProgram<'_>) -> f64 {
    let tractions = program.reach.iter().flat_map(|entry| &entry.traction[..entry.tangents]);
    let largest = tractions.fold(0.0_f64, |largest, traction| largest.max(traction.abs()));
    (FIRST_RELAXATION * (program.arc_weight / largest).min(1.0)).max(LAST_RELAXATION)
}

/// Solves from a start with the present `γ1` and `γ2`; `present` decides where a pair is biactive.
pub fn search_from(
    program: &IncrementProgram<'_>,
    start: &DVector<f64>,
    first_relaxation: f64,
    present: &[Mode],
    keep_iterates: bool,
    cancel: &CancelFlag,
) -> Searched {
    let default = Settings::default();
    let settings = Settings {
        first_relaxation,
        relaxation_factor: RELAXATION_FACTOR,
        last_relaxation: LAST_RELAXATION,
        tolerance: default.tolerance.max(program.rounding(start)).min(LOOSEST_TOLERANCE),
        iteration_limit: MOST_ITERATIONS,
        finish: Finish::PatternSettled,
        restarts: 0,
        enumeration_limit: ENUMERATED,
        looks_beyond: false,
        whole_sequence: true,
        interior_only: true,
        keep_iterates,
        ..default
    };
    let Ok(solution) = mpec::solve(program, start, &settings, cancel) else {
        return Searched { end: None, counts: ProgramCounts::default(), iterates: Vec::new() };
    };
    let mut counts = ProgramCounts::default();
    counts.add(&solution);
    let iterates = solution.iterates.clone();
    let is_found = matches!(solution.status, SolveStatus::Solved | SolveStatus::PatternSettled | SolveStatus::Feasible);
    let end = is_found.then(|| {
        let variables = solution.x.clone();
        let size = arc_length_ratio(program, &variables);
        let state = solution_extraction::end_state(program, &variables);
        let modes = solution_extraction::named_modes(program, solution, present, cancel).modes;
        ProgramEnd { modes, state, variables, size }
    });
    Searched { end, counts, iterates }
}

/// The next smaller first bound; `None` past the last.
pub fn tighter(relaxation: f64) -> Option<f64> {
    (relaxation > LAST_RELAXATION).then(|| (RELAXATION_FACTOR * relaxation).max(LAST_RELAXATION))
}

/// Adapts `γ1` to a solution whose arc length is not the prescribed one: along a straight direction the arc length is
/// inversely proportional to `γ1`.
pub fn adapt_arc_weight(program: &mut IncrementProgram<'_>, size: f64) {
    program.arc_weight *= size.clamp(0.02, 50.0);
}
