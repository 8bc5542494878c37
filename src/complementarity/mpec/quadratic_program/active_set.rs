//! Solution of a quadratic program by the linear system of a guessed working set.
//!
//! With the rows `J` of the equalities and of the inequalities and bounds that are guessed to be active,
//!
//! ```text
//! [ H  Jᵀ ] [  d ]   [ -q ]
//! [ J  0  ] [ -λ ] = [ -c ]
//! ```
//!
//! Its solution is the program's when the other constraints hold at `d` and the multipliers of the inequalities are
//! nonnegative (a Karush-Kuhn-Tucker point of a convex program is a solution). Otherwise violated rows enter the set
//! and rows with a negative multiplier leave it, a bounded number of times: the primal-dual active set method of M.
//! Hintermüller, K. Ito and K. Kunisch, SIAM J. Optim. 13 (2002), doi:10.1137/S1052623401383558. Second-order cones are
//! included (`quadratic_program::active_cones`). The method may fail, and the interior-point method then takes over; a
//! solution that it does return is exact to round-off and takes microseconds.

use crate::complementarity::mpec::quadratic_program::tolerances::{MULTIPLIER_BLOCK, OPTIMALITY_TOLERANCE};
use nalgebra::DVector;

use crate::complementarity::mpec::quadratic_program::active_cones::{CORRECTIONS, ConeState, Expansions};
use crate::complementarity::mpec::quadratic_program::interior_point::{QuadraticProgram, QuadraticSolution};
use crate::complementarity::mpec::quadratic_program::linear_solve::{SquareMatrixFactors, product};

/// The inequalities and bounds assumed to be active, and the assumed states of the cones.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WorkingSet {
    pub inequality: Vec<bool>,
    pub lower: Vec<bool>,
    pub upper: Vec<bool>,
    pub cones: Vec<ConeState>,
}

impl WorkingSet {
    /// The constraints within `margin` of active at zero step.
    pub fn at_rest(program: &QuadraticProgram, margin: f64) -> Self {
        Self {
            inequality: program.inequality_values.iter().map(|value| *value <= margin).collect(),
            lower: program.lower.iter().map(|bound| -*bound <= margin).collect(),
            upper: program.upper.iter().map(|bound| *bound <= margin).collect(),
            cones: program.cones.iter().map(|cone| ConeState::at_rest(cone.values.as_slice(), margin)).collect(),
        }
    }

    /// The constraints that a solution of limited accuracy suggests: those with a multiplier larger than the slack.
    pub fn of_solution(program: &QuadraticProgram, solution: &QuadraticSolution) -> Self {
        let slack = &program.inequality_values + &program.inequality * &solution.step;
        let step = &solution.step;
        let indices = 0..step.len();
        Self {
            inequality: slack.iter().zip(solution.inequality_multipliers.iter()).map(|(s, λ)| λ > s).collect(),
            lower: indices.clone().map(|j| solution.lower_multipliers[j] > step[j] - program.lower[j]).collect(),
            upper: indices.map(|j| solution.upper_multipliers[j] > program.upper[j] - step[j]).collect(),
            cones: program
                .cones
                .iter()
                .zip(&solution.cone_multipliers)
                .map(|(cone, multiplier)| ConeState::of_solution(&cone.at(step), multiplier))
                .collect(),
        }
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        ![&self.inequality, &self.lower, &self.upper].into_iter().flatten().any(|active| *active)
            && self.cones.iter().all(|state| *state == ConeState::Inside)
    }

    fn fits(&self, program: &QuadraticProgram) -> bool {
        self.inequality.len() == program.inequality_values.len()
            && self.lower.len() == program.gradient.len()
            && self.cones.len() == program.cones.len()
    }
}

/// Solves `program` from the working set `guess`, changing the set at most `changes` times. `None`, with `guess`
/// unchanged, where this does not lead to a solution. On success `guess` is the solution's working set.
pub fn solve(program: &QuadraticProgram, guess: &mut WorkingSet, changes: usize) -> Option<QuadraticSolution> {
    if !guess.fits(program) || !program.is_well_formed() {
        return None;
    }
    let mut set = guess.clone();
    let mut expansions = Expansions::new(program);
    let solves = changes + if program.cones.is_empty() { 0 } else { CORRECTIONS };
    let force = OPTIMALITY_TOLERANCE * (1.0 + program.gradient.amax());
    for _ in 0..=solves {
        let mut solution = solve_equalities(program, &set, &expansions)?;
        let length = OPTIMALITY_TOLERANCE * (1.0 + solution.step.amax());
        let changed = revise(program, &solution, &mut set, force, length);
        if !expansions.revise(program, &mut solution, &mut set.cones, force, length) && !changed {
            *guess = set;
            return Some(clipped(solution));
        }
    }
    None
}

/// Solves the linear system of the working set.
fn solve_equalities(
    program: &QuadraticProgram,
    set: &WorkingSet,
    expansions: &Expansions,
) -> Option<QuadraticSolution> {
    let variables = program.gradient.len();
    let equalities = program.equality_values.len();
    let members = |flags: &[bool]| -> Vec<usize> { (0..flags.len()).filter(|&i| flags[i]).collect() };
    let (rows, below, above) = (members(&set.inequality), members(&set.lower), members(&set.upper));
    let on_cones = expansions.rows(program, &set.cones);
    let active = equalities + rows.len() + below.len() + above.len() + on_cones.len();
    if active > 2 * variables {
        return None;
    }
    let mut entries: Vec<(usize, usize, f64)> = program.hessian.entries().collect();
    let mut right = DVector::zeros(variables + active);
    right.rows_mut(0, variables).copy_from(&-&program.gradient);
    expansions.add_curvature(program, &set.cones, &mut entries, &mut right);
    let mut place = variables;
    let mut put_row = |row: &[(usize, f64)], value: f64| {
        for &(column, entry) in row {
            entries.push((place, column, entry));
            entries.push((column, place, entry));
        }
        right[place] = -value;
        place += 1;
    };
    for i in 0..equalities {
        put_row(program.equality.row(i), program.equality_values[i]);
    }
    for &i in &rows {
        put_row(program.inequality.row(i), program.inequality_values[i]);
    }
    for &k in &below {
        put_row(&[(k, 1.0)], -program.lower[k]);
    }
    for &k in &above {
        put_row(&[(k, -1.0)], program.upper[k]);
    }
    for (row, value) in &on_cones {
        let entries: Vec<_> = row.iter().copied().enumerate().filter(|(_, entry)| *entry != 0.0).collect();
        put_row(&entries, *value);
    }
    let unknowns = solve_refined(&entries, &[], &right, 1).or_else(|| {
        // Redundant rows make the system singular but not contradictory. A small negative block for the multipliers
        // makes the system regular, and refinement with the true matrix removes the effect of the block.
        let weight = MULTIPLIER_BLOCK * (1.0 + program.hessian.amax());
        let block: Vec<_> = (variables..variables + active).map(|place| (place, place, -weight)).collect();
        solve_refined(&entries, &block, &right, 4)
    })?;
    let mut solution = QuadraticSolution {
        step: unknowns.rows(0, variables).into_owned(),
        equality_multipliers: -unknowns.rows(variables, equalities).into_owned(),
        inequality_multipliers: DVector::zeros(program.inequality_values.len()),
        lower_multipliers: DVector::zeros(variables),
        upper_multipliers: DVector::zeros(variables),
        cone_multipliers: Vec::new(),
    };
    let mut multipliers = unknowns.iter().skip(variables + equalities).map(|value| -value);
    let mut scatter = |places: &[usize], target: &mut DVector<f64>| {
        for (&i, value) in places.iter().zip(multipliers.by_ref()) {
            target[i] = value;
        }
    };
    scatter(&rows, &mut solution.inequality_multipliers);
    scatter(&below, &mut solution.lower_multipliers);
    scatter(&above, &mut solution.upper_multipliers);
    solution.cone_multipliers = expansions.multipliers(program, &set.cones, multipliers);
    Some(solution)
}

/// Solves with the factors of the matrix plus `added`, refined with the matrix itself; `None` where a residual remains.
/// The residual is measured against the right-hand side alone, since a nearly singular system has huge unknowns.
fn solve_refined(
    matrix: &[(usize, usize, f64)],
    added: &[(usize, usize, f64)],
    right: &DVector<f64>,
    refinements: usize,
) -> Option<DVector<f64>> {
    let factors = if added.is_empty() {
        SquareMatrixFactors::new(right.len(), matrix, None)?
    } else {
        SquareMatrixFactors::new(right.len(), &[matrix, added].concat(), None)?
    };
    let mut unknowns = factors.solve(right)?;
    for _ in 0..refinements {
        let residual = right - product(matrix, &unknowns);
        unknowns += factors.solve(&residual)?;
    }
    let residual = (right - product(matrix, &unknowns)).amax();
    let is_solved =
        unknowns.iter().all(|value| value.is_finite()) && residual <= OPTIMALITY_TOLERANCE * (1.0 + right.amax());
    is_solved.then_some(unknowns)
}

/// Adds violated rows and removes rows with negative multipliers; returns whether the set changed.
fn revise(
    program: &QuadraticProgram,
    solution: &QuadraticSolution,
    set: &mut WorkingSet,
    force: f64,
    length: f64,
) -> bool {
    let step = &solution.step;
    let slack = &program.inequality_values + &program.inequality * step;
    let mut changed = false;
    let mut update = |flag: &mut bool, slack: f64, multiplier: f64, length: f64| {
        let wanted = if *flag { multiplier >= -force } else { slack < -length };
        changed |= wanted != *flag;
        *flag = wanted;
    };
    for i in 0..slack.len() {
        let row_length = length.max(OPTIMALITY_TOLERANCE * program.inequality_values[i].abs());
        update(&mut set.inequality[i], slack[i], solution.inequality_multipliers[i], row_length);
    }
    for j in 0..step.len() {
        update(&mut set.lower[j], step[j] - program.lower[j], solution.lower_multipliers[j], length);
        update(&mut set.upper[j], program.upper[j] - step[j], solution.upper_multipliers[j], length);
    }
    changed
}

/// Sets multipliers below zero, which are round-off, to zero.
fn clipped(mut solution: QuadraticSolution) -> QuadraticSolution {
    for multipliers in
        [&mut solution.inequality_multipliers, &mut solution.lower_multipliers, &mut solution.upper_multipliers]
    {
        multipliers.apply(|value| *value = value.max(0.0));
    }
    solution
}
