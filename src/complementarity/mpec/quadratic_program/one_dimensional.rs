//! The quadratic program of a branch, reduced to the line that its equalities leave.
//!
//! With one equality fewer than variables, as in the branch of an increment (equilibrium, slips and one zero member per
//! pair, for displacements, load and contacts), every `d` with `e + E d = 0` is `d₀ + z t`. Both vectors follow from
//! one factorisation of `E` without the column of the variable chosen as the parameter `t`. The reduced program,
//!
//! ```text
//! min ½ (zᵀHz) t² + z·(q + H d₀) t    s.t.   (c + C d₀) + (C z) t >= 0,   lower <= d₀ + z t <= upper
//! ```
//!
//! has the same solution and is solved by one pass over its rows. The multipliers `λ` of the equalities follow from the
//! transposed system.

use crate::complementarity::mpec::quadratic_program::tolerances::{
    OPTIMALITY_TOLERANCE, PARAMETER_CHANGE_RATIO, SMALLEST_SLOPE,
};
use nalgebra::DVector;

use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::complementarity::mpec::quadratic_program::interior_point::{QuadraticProgram, QuadraticSolution};
use crate::complementarity::mpec::quadratic_program::linear_solve::SquareMatrixFactors;

/// The constraint that is active at the solution on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Binding {
    Inequality(usize),
    Lower(usize),
    Upper(usize),
}

/// The outcome for a program.
pub enum OneDimensionalOutcome {
    Solved(QuadraticSolution, Option<Binding>),
    /// No point of the line meets every row.
    Contradictory,
    /// The program is not of this kind, or its line was not found.
    Declined,
}

/// A solver of such programs, which reuses the data that depend on the pattern alone.
#[derive(Default)]
pub struct LineSolver {
    parameter: usize,
    factors: Option<SquareMatrixFactors>,
}

/// A constraint along the line: `value + slope t >= -margin`.
struct Constraint {
    binding: Binding,
    value: f64,
    slope: f64,
    margin: f64,
}

impl LineSolver {
    /// Chooses as parameter the variable that changes most in a step from the origin to `x`, among the variables with
    /// curvature of the objective.
    pub fn head_for(&mut self, hessian: &SparseRows, x: &DVector<f64>) {
        self.parameter = most_moved(hessian, x);
    }

    pub fn solve(&mut self, program: &QuadraticProgram) -> OneDimensionalOutcome {
        let variables = program.gradient.len();
        if program.equality.nrows() + 1 != variables || self.parameter >= variables {
            return OneDimensionalOutcome::Declined;
        }
        let Some((factors, start, direction)) = self.line(program) else { return OneDimensionalOutcome::Declined };
        let outcome = minimise(program, &factors, self.parameter, &start, &direction);
        self.factors = Some(factors);
        let bends = most_moved(&program.hessian, &direction);
        if direction[bends].abs() > PARAMETER_CHANGE_RATIO {
            self.parameter = bends;
        }
        outcome
    }

    /// The factors of `E` without the parameter's column, `d₀` and `z`.
    fn line(&self, program: &QuadraticProgram) -> Option<(SquareMatrixFactors, DVector<f64>, DVector<f64>)> {
        let parameter = self.parameter;
        let size = program.equality.nrows();
        let mut along = DVector::zeros(size);
        let mut entries = Vec::with_capacity(8 * size);
        for (row, column, value) in program.equality.entries() {
            if column == parameter {
                along[row] -= value;
            } else {
                entries.push((row, column - usize::from(column > parameter), value));
            }
        }
        let factors = SquareMatrixFactors::new(size, &entries, self.factors.as_ref())?;
        let solve = |right: &DVector<f64>, at: f64| {
            let mut vector = factors.solve(right)?.insert_row(parameter, at);
            let residual = |vector: &DVector<f64>| {
                let mut miss = &program.equality * vector;
                if at == 0.0 {
                    miss -= right;
                }
                miss
            };
            vector -= factors.solve(&residual(&vector))?.insert_row(parameter, 0.0);
            let is_solved = largest(&residual(&vector)) <= OPTIMALITY_TOLERANCE * (1.0 + largest(right));
            (is_solved && vector.iter().all(|value| value.is_finite())).then_some(vector)
        };
        let start = solve(&-&program.equality_values, 0.0)?;
        let direction = solve(&along, 1.0)?;
        Some((factors, start, direction))
    }
}

/// The minimiser on the line that satisfies every row.
fn minimise(
    program: &QuadraticProgram,
    factors: &SquareMatrixFactors,
    parameter: usize,
    start: &DVector<f64>,
    direction: &DVector<f64>,
) -> OneDimensionalOutcome {
    let curvature = direction.dot(&(&program.hessian * direction));
    let slope = direction.dot(&(&program.gradient + &program.hessian * start));
    let minimum = -slope / curvature;
    if !minimum.is_finite() || curvature <= 0.0 {
        return OneDimensionalOutcome::Declined;
    }
    let constraints = constraints(program, start, direction, minimum);
    let (mut from, mut to) = ((f64::NEG_INFINITY, None), (f64::INFINITY, None));
    for constraint in constraints.iter().filter(|constraint| constraint.is_violated(minimum)) {
        if constraint.slope.abs() <= SMALLEST_SLOPE {
            return OneDimensionalOutcome::Contradictory;
        }
        let place = -constraint.value / constraint.slope;
        if constraint.slope > 0.0 && place > from.0 {
            from = (place, Some(constraint));
        } else if constraint.slope < 0.0 && place < to.0 {
            to = (place, Some(constraint));
        }
    }
    let (place, binding) = match (from.1, to.1) {
        (Some(_), Some(_)) => return OneDimensionalOutcome::Contradictory,
        (Some(constraint), None) => (from.0, Some(constraint)),
        (None, Some(constraint)) => (to.0, Some(constraint)),
        (None, None) => (minimum, None),
    };
    if binding.is_some() && constraints.iter().any(|constraint| constraint.is_violated(place)) {
        return OneDimensionalOutcome::Contradictory;
    }
    let step = start + direction * place;
    let length = OPTIMALITY_TOLERANCE * (1.0 + largest(&step));
    if program.cones.iter().any(|cone| cone::slack(cone.at(&step).as_slice()) < -length) {
        return OneDimensionalOutcome::Declined;
    }
    let mut solution = QuadraticSolution {
        equality_multipliers: DVector::zeros(0),
        inequality_multipliers: DVector::zeros(program.inequality.nrows()),
        lower_multipliers: DVector::zeros(step.len()),
        upper_multipliers: DVector::zeros(step.len()),
        cone_multipliers: program.cones.iter().map(|cone| DVector::zeros(cone.values.len())).collect(),
        step,
    };
    let mut force = &program.hessian * &solution.step + &program.gradient;
    if let Some(constraint) = binding {
        let multiplier = ((curvature * place + slope) / constraint.slope).max(0.0);
        match constraint.binding {
            Binding::Inequality(i) => {
                solution.inequality_multipliers[i] = multiplier;
                program.inequality.row(i).iter().for_each(|&(column, value)| force[column] -= multiplier * value);
            }
            Binding::Lower(j) => {
                solution.lower_multipliers[j] = multiplier;
                force[j] -= multiplier;
            }
            Binding::Upper(j) => {
                solution.upper_multipliers[j] = multiplier;
                force[j] += multiplier;
            }
        }
    }
    let Some(multipliers) = factors.solve_transposed(&force.remove_row(parameter)) else {
        return OneDimensionalOutcome::Declined;
    };
    solution.equality_multipliers = multipliers;
    OneDimensionalOutcome::Solved(solution, binding.map(|constraint| constraint.binding))
}

impl Constraint {
    fn is_violated(&self, place: f64) -> bool {
        self.value + self.slope * place < -self.margin
    }
}

/// Every inequality and bound along the line.
fn constraints(
    program: &QuadraticProgram,
    start: &DVector<f64>,
    direction: &DVector<f64>,
    minimum: f64,
) -> Vec<Constraint> {
    let length = OPTIMALITY_TOLERANCE * (1.0 + largest(start).max(minimum.abs() * largest(direction)));
    let rows = (0..program.inequality.nrows()).map(|i| {
        let constant = program.inequality_values[i];
        Constraint {
            binding: Binding::Inequality(i),
            value: constant + program.inequality.dot(i, start),
            slope: program.inequality.dot(i, direction),
            margin: length.max(OPTIMALITY_TOLERANCE * constant.abs()),
        }
    });
    let lower = (0..start.len()).filter(|&j| program.lower[j].is_finite()).map(|j| Constraint {
        binding: Binding::Lower(j),
        value: start[j] - program.lower[j],
        slope: direction[j],
        margin: length,
    });
    let upper = (0..start.len()).filter(|&j| program.upper[j].is_finite()).map(|j| Constraint {
        binding: Binding::Upper(j),
        value: program.upper[j] - start[j],
        slope: -direction[j],
        margin: length,
    });
    rows.chain(lower).chain(upper).collect()
}

/// The variable that changes most, among the variables with curvature of the objective.
fn most_moved(hessian: &SparseRows, change: &DVector<f64>) -> usize {
    let bends = |j: &usize| hessian[(*j, *j)];
    let most = (0..change.len()).map(|j| bends(&j)).fold(0.0, f64::max);
    (0..change.len())
        .filter(|j| bends(j) >= 1e-3 * most)
        .max_by(|a, b| change[*a].abs().total_cmp(&change[*b].abs()).then(b.cmp(a)))
        .unwrap_or(0)
}

fn largest(values: &DVector<f64>) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complementarity::mpec::quadratic_program::interior_point::solve_interior;
    use crate::resources::cancel::CancelFlag;
    use nalgebra::DMatrix;

    /// A program with one equality fewer than variables, and inequalities that hold at zero with the slack `free`.
    fn program(variables: usize, free: f64) -> QuadraticProgram {
        let wave = |i: usize, j: usize| (1.7 * i as f64 + 2.3 * j as f64 + 0.4).sin();
        let equality = DMatrix::from_fn(variables - 1, variables, |i, j| {
            if i.abs_diff(j) <= 1 { wave(i, j) + if i == j { 3.0 } else { 0.0 } } else { 0.0 }
        });
        let inequality = DMatrix::from_fn(3, variables, |i, j| if (j + i) % 3 == 0 { wave(j, i) } else { 0.0 });
        QuadraticProgram {
            hessian: SparseRows::from(&DMatrix::from_diagonal(&DVector::from_fn(variables, |j, _| {
                1.0 + wave(j, 0).abs()
            }))),
            gradient: DVector::from_fn(variables, |j, _| wave(j, 1)),
            equality: SparseRows::from(&equality),
            equality_values: DVector::from_fn(variables - 1, |i, _| 0.3 * wave(i, 2)),
            inequality: SparseRows::from(&inequality),
            inequality_values: DVector::repeat(3, free),
            lower: DVector::repeat(variables, -1.5),
            upper: DVector::repeat(variables, 1.5),
            cones: Vec::new(),
        }
    }

    /// Dense and sparse systems, with and without an active row: the Karush-Kuhn-Tucker conditions, and agreement with
    /// the interior-point method.
    #[test]
    fn the_line_has_the_solution_of_the_whole_program() {
        let mut bound = 0;
        for variables in [5, 90] {
            for free in [2.0, 0.05, 0.02] {
                let program = program(variables, free);
                let mut solver = LineSolver::default();
                let OneDimensionalOutcome::Solved(solution, binding) = solver.solve(&program) else { continue };
                bound += usize::from(binding.is_some());
                let expected = solve_interior(&program, &CancelFlag::default()).expect("a convex program");
                assert!((&solution.step - &expected.step).amax() < 1e-7, "{variables} {free}");
                let rest = &program.hessian * &solution.step + &program.gradient
                    - program.equality.tr_mul(&solution.equality_multipliers)
                    - program.inequality.tr_mul(&solution.inequality_multipliers)
                    - &solution.lower_multipliers
                    + &solution.upper_multipliers;
                assert!(rest.amax() < 1e-11, "{variables} {free}: {:e}", rest.amax());
                assert!((&program.equality * &solution.step + &program.equality_values).amax() < 1e-11);
                assert!(solution.inequality_multipliers.min() >= 0.0);
            }
        }
        assert!(bound >= 2, "{bound} programs had a row that binds");
    }

    #[test]
    fn rows_that_no_point_meets_are_told() {
        let mut program = program(5, 2.0);
        program.lower = DVector::repeat(5, 3.0);
        program.upper = DVector::repeat(5, 4.0);
        assert!(matches!(LineSolver::default().solve(&program), OneDimensionalOutcome::Contradictory));
        program.equality = SparseRows::zeros(2, 5);
        program.equality_values = DVector::zeros(2);
        assert!(matches!(LineSolver::default().solve(&program), OneDimensionalOutcome::Declined));
    }
}
