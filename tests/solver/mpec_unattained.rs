//! Programs whose infimum is not attained: the iterates go to infinity, and nothing there is a solution.

use arcslip::complementarity::mpec::{self, Problem, ProgramSolution, Settings, SolveStatus, SparseRows};
use arcslip::resources::cancel::CancelFlag;
use nalgebra::DVector;

/// Dempe's bilevel program (MacMPEC: dempe) in other units: `x`, `z` and `w` are these multiples of the variables, the
/// objective is one of `f`.
///
/// ```text
/// min (x - 3.5)² + (z + 4)²    s.t.    z - 3 + 2 z w = 0,    0 <= x - z²  ⊥  w >= 0
/// ```
///
/// With `w > 0`, `x = z²` and `z = 3/(1 + 2 w)`: the infimum 28.25 is that of `w → ∞`. `cost` w is added to the objective:
/// with it the minimum is attained, far out where it is small.
struct Dempe {
    units: [f64; 3],
    of_objective: f64,
    cost: f64,
}

impl Dempe {
    fn own(&self, v: &DVector<f64>) -> [f64; 3] {
        [v[0] / self.units[0], v[1] / self.units[1], v[2] / self.units[2]]
    }
}

impl Problem for Dempe {
    fn variables(&self) -> usize {
        3
    }
    fn equalities(&self) -> usize {
        1
    }
    fn inequalities(&self) -> usize {
        0
    }
    fn pairs(&self) -> usize {
        1
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let free = f64::INFINITY;
        (DVector::from_vec(vec![-free, -free, 0.0]), DVector::repeat(3, free))
    }
    fn objective(&self, v: &DVector<f64>) -> f64 {
        let [x, z, w] = self.own(v);
        self.of_objective * ((x - 3.5).powi(2) + (z + 4.0).powi(2) + self.cost * w)
    }
    fn objective_gradient(&self, v: &DVector<f64>, gradient: &mut DVector<f64>) {
        let [x, z, _] = self.own(v);
        let by = [2.0 * (x - 3.5), 2.0 * (z + 4.0), self.cost];
        (0..3).for_each(|j| gradient[j] = self.of_objective * by[j] / self.units[j]);
    }
    fn equality_values(&self, v: &DVector<f64>, values: &mut DVector<f64>) {
        let [_, z, w] = self.own(v);
        values[0] = z - 3.0 + 2.0 * z * w;
    }
    fn equality_jacobian(&self, v: &DVector<f64>, jacobian: &mut SparseRows) {
        let [_, z, w] = self.own(v);
        jacobian[(0, 1)] = (1.0 + 2.0 * w) / self.units[1];
        jacobian[(0, 2)] = 2.0 * z / self.units[2];
    }
    fn pair_values(&self, v: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        let [x, z, w] = self.own(v);
        (first[0], second[0]) = (x - z * z, w);
    }
    fn pair_jacobians(&self, v: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        let [_, z, _] = self.own(v);
        first[(0, 0)] = 1.0 / self.units[0];
        first[(0, 1)] = -2.0 * z / self.units[1];
        second[(0, 2)] = 1.0 / self.units[2];
    }
}

/// From `w` on the branch where the first member of the pair is zero.
fn solve_from(w: f64, problem: &Dempe, settings: &Settings) -> ProgramSolution {
    let z = 3.0 / (1.0 + 2.0 * w);
    let own = [z * z, z, w];
    let start = DVector::from_iterator(3, own.iter().zip(&problem.units).map(|(own, unit)| own * unit));
    let solution = mpec::solve(problem, &start, settings, &CancelFlag::default()).expect("valid input");
    println!(
        "units {:?} of f {:e} cost {:e}: {:?} f = {:.9e} w = {:e}, {} quadratic programs",
        problem.units,
        problem.of_objective,
        problem.cost,
        solution.status,
        solution.objective,
        solution.x[2] / problem.units[2],
        solution.counts.qp_solves
    );
    solution
}

/// From the collection's start; the other that it gives, (1, 1, 1), is a stationary point.
#[test]
fn iterates_that_go_to_infinity_are_no_solution() {
    let problem = Dempe { units: [1.0; 3], of_objective: 1.0, cost: 0.0 };
    for settings in [Settings::default(), Settings::warm()] {
        let SolveStatus::UnboundedIterates(growth) = solve_from(3.00379, &problem, &settings).status else {
            panic!("the infimum is not attained")
        };
        assert_eq!(growth.variable, 2);
        assert!(growth.from > 100.0 && growth.to > 500.0 * growth.from, "{growth:?}");
    }
}

/// Whatever the units, nothing far out passes for a solution; the other branch has one, at `w = 0`.
#[test]
fn units_do_not_decide() {
    let mut unbounded = 0;
    for units in [[1.0, 1.0, 1e-3], [1.0, 1.0, 1e3], [1e-3, 1e-3, 1.0], [10.0, 10.0, 1.0], [1e-3; 3]] {
        for of_objective in [1.0, 1e-3, 1e3] {
            let solution = solve_from(30.0, &Dempe { units, of_objective, cost: 0.0 }, &Settings::warm());
            let w = solution.x[2] / units[2];
            assert!(
                w < 20.0 || solution.status != SolveStatus::Solved,
                "{units:?}, {of_objective}: {:?}",
                solution.status
            );
            unbounded += usize::from(matches!(solution.status, SolveStatus::UnboundedIterates(_)));
        }
    }
    assert!(unbounded >= 8, "{unbounded}");
}

/// `8 z + cost w` is least at about `w = √(12/cost)`: far out, but there.
#[test]
fn a_minimum_far_out_is_a_solution() {
    for cost in [1e-2, 1e-4, 1e-6, 1e-7] {
        for units in [[1.0; 3], [1.0, 1.0, 1e-3], [1.0, 1.0, 1e3]] {
            for of_objective in [1.0, 1e3] {
                let problem = Dempe { units, of_objective, cost };
                let status = solve_from(30.0, &problem, &Settings::warm()).status;
                assert!(!matches!(status, SolveStatus::UnboundedIterates(_)), "{cost:e} {units:?}: {status:?}");
            }
        }
    }
}

/// MacMPEC's `scale` family and beyond: `min of (a x - 1)² + (b y - 1)²` with `0 <= x ⊥ y >= 0`.
struct Scaled {
    by: [f64; 2],
    of_objective: f64,
}

impl Problem for Scaled {
    fn variables(&self) -> usize {
        2
    }
    fn equalities(&self) -> usize {
        0
    }
    fn inequalities(&self) -> usize {
        0
    }
    fn pairs(&self) -> usize {
        1
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        (DVector::repeat(2, f64::NEG_INFINITY), DVector::repeat(2, f64::INFINITY))
    }
    fn objective(&self, v: &DVector<f64>) -> f64 {
        (0..2).map(|j| self.of_objective * (self.by[j] * v[j] - 1.0).powi(2)).sum()
    }
    fn objective_gradient(&self, v: &DVector<f64>, gradient: &mut DVector<f64>) {
        (0..2).for_each(|j| gradient[j] = 2.0 * self.of_objective * self.by[j] * (self.by[j] * v[j] - 1.0));
    }
    fn pair_values(&self, v: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        (first[0], second[0]) = (v[0], v[1]);
    }
    fn pair_jacobians(&self, _v: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        (first[(0, 0)], second[(0, 1)]) = (1.0, 1.0);
    }
}

/// Their solutions are at `1/a` or `1/b`, however far out.
#[test]
fn scales_are_no_growth() {
    for by in [[1.0, 1.0], [1e2, 1.0], [1e-2, 1.0], [1e-4, 1e-4], [1e-6, 1.0], [1e6, 1e-6]] {
        for of_objective in [1.0, 1e-4, 1e4] {
            for start in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
                let start = DVector::from_column_slice(&start);
                let problem = Scaled { by, of_objective };
                let solution = mpec::solve(&problem, &start, &Settings::default(), &CancelFlag::default());
                let status = solution.expect("valid input").status;
                assert!(!matches!(status, SolveStatus::UnboundedIterates(_)), "{by:?} {of_objective}: {status:?}");
            }
        }
    }
}
