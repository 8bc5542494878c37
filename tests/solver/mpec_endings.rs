//! How a solve ends when there is no solution, no pair, no number or no patience; and random programs held against
//! the enumeration of their branches.

use std::cell::Cell;

use arcslip::complementarity::mpec::quadratic_program::interior_point::{QuadraticProgram, solve_interior};
use arcslip::complementarity::mpec::{
    self, PairActivity, Problem, ProgramInputError, Quantity, Settings, SolveStatus, SparseRows, StationarityKind,
};
use arcslip::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector};

/// `min ½ xᵀQx + c·x` s.t. `A x + a0 ⊥ B x + b0`, `E x + e = 0`; optionally raises a flag or returns NaN on the way.
#[derive(Clone)]
struct Quadratic {
    q: DMatrix<f64>,
    c: DVector<f64>,
    first: (DMatrix<f64>, DVector<f64>),
    second: (DMatrix<f64>, DVector<f64>),
    equality: (DMatrix<f64>, DVector<f64>),
    nan_in_gradient: bool,
    cancel_after: Option<(Cell<usize>, CancelFlag)>,
}

impl Quadratic {
    fn new(q: DMatrix<f64>, c: &[f64]) -> Self {
        let n = c.len();
        let empty = || (DMatrix::zeros(0, n), DVector::zeros(0));
        Self {
            q,
            c: DVector::from_column_slice(c),
            first: empty(),
            second: empty(),
            equality: empty(),
            nan_in_gradient: false,
            cancel_after: None,
        }
    }

    /// Pairs of variables (first, second).
    fn with_pairs(mut self, pairs: &[(usize, usize)]) -> Self {
        let n = self.c.len();
        let members = |member: &dyn Fn(&(usize, usize)) -> usize| {
            let rows = DMatrix::from_fn(pairs.len(), n, |i, j| if member(&pairs[i]) == j { 1.0 } else { 0.0 });
            (rows, DVector::zeros(pairs.len()))
        };
        self.first = members(&|pair| pair.0);
        self.second = members(&|pair| pair.1);
        self
    }
}

impl Problem for Quadratic {
    fn variables(&self) -> usize {
        self.c.len()
    }
    fn equalities(&self) -> usize {
        self.equality.1.len()
    }
    fn inequalities(&self) -> usize {
        0
    }
    fn pairs(&self) -> usize {
        self.first.1.len()
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let n = self.c.len();
        (DVector::from_element(n, f64::NEG_INFINITY), DVector::from_element(n, f64::INFINITY))
    }
    fn objective(&self, x: &DVector<f64>) -> f64 {
        if let Some((left, flag)) = &self.cancel_after {
            left.set(left.get().saturating_sub(1));
            if left.get() == 0 {
                flag.cancel();
            }
        }
        0.5 * x.dot(&(&self.q * x)) + self.c.dot(x)
    }
    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
        gradient.copy_from(&(&self.q * x + &self.c));
        if self.nan_in_gradient {
            gradient[0] = f64::NAN;
        }
    }
    fn equality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        values.copy_from(&(&self.equality.0 * x + &self.equality.1));
    }
    fn equality_jacobian(&self, _x: &DVector<f64>, jacobian: &mut SparseRows) {
        jacobian.copy_from(&self.equality.0);
    }
    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        first.copy_from(&(&self.first.0 * x + &self.first.1));
        second.copy_from(&(&self.second.0 * x + &self.second.1));
    }
    fn pair_jacobians(&self, _x: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        first.copy_from(&self.first.0);
        second.copy_from(&self.second.0);
    }
}

fn solve(problem: &Quadratic, start: &[f64], settings: &Settings) -> mpec::ProgramSolution {
    let start = DVector::from_column_slice(start);
    mpec::solve(problem, &start, settings, &CancelFlag::default()).expect("valid input")
}

#[test]
fn without_pairs_it_is_a_plain_program() {
    let mut problem = Quadratic::new(DMatrix::identity(2, 2), &[-1.0, -3.0]);
    problem.equality = (DMatrix::from_row_slice(1, 2, &[1.0, 1.0]), DVector::from_element(1, -2.0));
    let solution = solve(&problem, &[5.0, 5.0], &Settings::default());
    assert_eq!((solution.status, solution.stationarity), (SolveStatus::Solved, StationarityKind::Strong));
    assert!((solution.x[0] - 0.0).abs() < 1e-9 && (solution.x[1] - 2.0).abs() < 1e-9);
    assert_eq!(solution.counts.relaxation_levels, 0);
    // ∇f = λ ∇h: (x0 - 1, x1 - 3) = -1 (1, 1).
    assert!((solution.multipliers.equality[0] + 1.0).abs() < 1e-7);
}

#[test]
fn contradictory_pairs_are_reported_infeasible() {
    // x0 + x1 = -1 with both nonnegative.
    let mut problem = Quadratic::new(DMatrix::identity(2, 2), &[0.0, 0.0]).with_pairs(&[(0, 1)]);
    problem.equality = (DMatrix::from_row_slice(1, 2, &[1.0, 1.0]), DVector::from_element(1, 1.0));
    let solution = solve(&problem, &[1.0, 1.0], &Settings::default());
    assert_eq!(solution.status, SolveStatus::Infeasible, "{solution:?}");
    assert!(solution.largest_violation > 0.1);
    assert_eq!(solution.stationarity, StationarityKind::Unknown);
}

#[test]
fn a_fall_without_bound_is_named() {
    let problem = Quadratic::new(DMatrix::zeros(2, 2), &[-1.0, 0.0]).with_pairs(&[(0, 1)]);
    let solution = solve(&problem, &[1.0, 1.0], &Settings::default());
    assert_eq!(solution.status, SolveStatus::Unbounded, "{solution:?}");
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    let mut problem = Quadratic::new(DMatrix::identity(2, 2), &[1.0, 1.0]).with_pairs(&[(0, 1)]);
    let solution = solve(&problem, &[f64::NAN, 0.0], &Settings::default());
    assert_eq!(solution.status, SolveStatus::NotFinite(Quantity::Start));
    problem.nan_in_gradient = true;
    let solution = solve(&problem, &[1.0, 1.0], &Settings::default());
    assert_eq!(solution.status, SolveStatus::NotFinite(Quantity::ObjectiveGradient));
    problem.nan_in_gradient = false;
    problem.second.1[0] = f64::NAN;
    let solution = solve(&problem, &[1.0, 1.0], &Settings::warm());
    assert_eq!(solution.status, SolveStatus::NotFinite(Quantity::Pairs));
}

#[test]
fn a_raised_flag_stops_at_once_and_on_the_way() {
    let flag = CancelFlag::default();
    let mut problem = Quadratic::new(DMatrix::identity(2, 2), &[-1.0, -2.0]).with_pairs(&[(0, 1)]);
    let start = DVector::from_element(2, 3.0);
    for calls in [1, 2, 3, 4, 5] {
        let flag = CancelFlag::default();
        problem.cancel_after = Some((Cell::new(calls), flag.clone()));
        let solution = mpec::solve(&problem, &start, &Settings::default(), &flag).expect("valid input");
        assert_eq!(solution.status, SolveStatus::Cancelled, "after {calls}");
    }
    problem.cancel_after = None;
    flag.cancel();
    let solution = mpec::solve(&problem, &start, &Settings::default(), &flag).expect("valid input");
    assert_eq!((solution.status, solution.counts.qp_solves), (SolveStatus::Cancelled, 0));
}

#[test]
fn misuse_is_an_error() {
    let problem = Quadratic::new(DMatrix::identity(2, 2), &[1.0, 1.0]);
    let cancel = CancelFlag::default();
    let short = mpec::solve(&problem, &DVector::zeros(1), &Settings::default(), &cancel);
    assert_eq!(short.err(), Some(ProgramInputError::StartLength { expected: 2, found: 1 }));
    let settings = Settings { relaxation_factor: 1.0, ..Settings::default() };
    let factor = mpec::solve(&problem, &DVector::zeros(2), &settings, &cancel);
    assert!(matches!(factor, Err(ProgramInputError::Setting { name: "relaxation_factor", .. })));
}

#[test]
fn a_warm_start_costs_three_programs_and_a_wrong_one_recovers() {
    // Minimum (0, 2) on the branch x0 = 0; the other branch's (-1 projected) is the origin.
    let problem = Quadratic::new(DMatrix::identity(2, 2), &[1.0, -2.0]).with_pairs(&[(0, 1)]);
    let near = solve(&problem, &[0.0, 1.9], &Settings::warm());
    assert_eq!(near.status, SolveStatus::Solved);
    assert!(near.counts.qp_solves <= 3, "{:?}", near.counts);
    assert_eq!(near.activity, [PairActivity::FirstZero]);
    let wrong = solve(&problem, &[1.0, 0.0], &Settings::warm());
    assert_eq!(wrong.status, SolveStatus::Solved);
    assert!((wrong.objective + 2.0).abs() < 1e-9, "{wrong:?}");
}

/// Numbers in (-1, 1) from a linear congruence, so that the programs are the same everywhere.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.next())
    }
}

/// Minima of all branches by the interior-point method alone.
fn branch_minima(problem: &Quadratic) -> Vec<f64> {
    let pairs = problem.pairs();
    let n = problem.variables();
    let mut minima = Vec::new();
    for branch in 0..1_usize << pairs {
        let pick = |zero: bool| {
            let side = |i: usize| if (branch >> i & 1 == 0) == zero { &problem.first } else { &problem.second };
            let rows = DMatrix::from_fn(pairs, n, |i, j| side(i).0[(i, j)]);
            (rows, DVector::from_fn(pairs, |i, _| side(i).1[i]))
        };
        let (equality, equality_values) = pick(true);
        let (inequality, inequality_values) = pick(false);
        let program = QuadraticProgram {
            hessian: SparseRows::from(&problem.q),
            gradient: problem.c.clone(),
            equality: SparseRows::from(&equality),
            equality_values,
            inequality: SparseRows::from(&inequality),
            inequality_values,
            lower: DVector::from_element(n, f64::NEG_INFINITY),
            upper: DVector::from_element(n, f64::INFINITY),
            cones: Vec::new(),
        };
        if let Ok(solution) = solve_interior(&program, &CancelFlag::default()) {
            minima.push(program.objective(&solution.step));
        }
    }
    minima
}

/// A stationary point of a convex program with complementarity constraints is the minimum of one of its branches.
#[test]
fn random_programs_end_at_a_minimum_of_a_branch() {
    let mut numbers = Numbers(7);
    let (mut solved, mut feasible, mut global) = (0, 0, 0);
    let count = 200;
    for round in 0..count {
        let (n, pairs) = (3 + round % 4, 1 + round % 5);
        let root = numbers.matrix(n, n);
        let c = numbers.matrix(n, 1);
        let mut problem = Quadratic::new(root.transpose() * &root + DMatrix::identity(n, n) * 0.1, c.as_slice());
        let offsets = |numbers: &mut Numbers| DVector::from_fn(pairs, |_, _| numbers.next());
        problem.first = (numbers.matrix(pairs, n), offsets(&mut numbers));
        problem.second = (numbers.matrix(pairs, n), offsets(&mut numbers));
        let minima = branch_minima(&problem);
        let start: Vec<f64> = (0..n).map(|_| numbers.next()).collect();
        let solution = solve(&problem, &start, &Settings::default());
        if round % 10 == 0 {
            let again = solve(&problem, &start, &Settings::default());
            assert_eq!(solution.x, again.x, "round {round}: not the same bits");
        }
        let Some(least) = minima.iter().copied().reduce(f64::min) else {
            assert_eq!(solution.status, SolveStatus::Infeasible, "round {round}: {solution:?}");
            continue;
        };
        feasible += 1;
        if solution.status == SolveStatus::Solved {
            solved += 1;
            let error = |minimum: &f64| (solution.objective - minimum).abs();
            assert!(minima.iter().any(|minimum| error(minimum) < 1e-6), "round {round}: {solution:?} {minima:?}");
            assert!(solution.largest_violation <= 1e-8 && solution.largest_product <= 1e-8);
            global += usize::from(error(&least) < 1e-6);
        } else {
            println!("round {round}: {:?} {:?} {:?}", solution.status, solution.counts, minima);
        }
    }
    println!("{count} programs, {feasible} feasible, {solved} solved, {global} at the global minimum");
    assert_eq!(solved, feasible);
}
