//! The increments of a one-bar truss on a rough floor as mathematical programs with complementarity constraints: the
//! shape of problem that the path follower solves at every increment, with its cost.
//!
//! Pin at (0, 1), tip at (x, y) on the floor `y >= 0`, EA = 1, unstressed at (-1.5, 0), force `s (1, 0)` on the tip.
//! Slipping towards +x: `s = P (μ - x)/L`, `r_n = P/L`, `P = 1 - L/L0`.

use arcslip::complementarity::mpec::{self, Finish, PairActivity, Problem, Settings, SolveStatus, SparseRows};
use arcslip::resources::cancel::CancelFlag;
use nalgebra::DVector;

const START: f64 = -1.5;
const FRICTION: f64 = 0.3;

/// Variables: (Δx, Δy, Δs, r_n, a⁺, a⁻, r_t), dimensionless.
struct Increment {
    tip: [f64; 2],
    load: f64,
    tangential_reaction: f64,
    previous: [f64; 3],
    arc_weight: f64,
    forward_weight: f64,
}

fn rest_length() -> f64 {
    START.hypot(1.0)
}

/// Force that the tip needs to stay where it is, and its derivative.
fn internal_force(x: f64, y: f64) -> ([f64; 2], [[f64; 2]; 2]) {
    let (dx, dy) = (x, y - 1.0);
    let length = dx.hypot(dy);
    let factor = 1.0 / rest_length() - 1.0 / length;
    let slope = 1.0 / length.powi(3);
    let force = [factor * dx, factor * dy];
    let stiffness = [[factor + slope * dx * dx, slope * dx * dy], [slope * dx * dy, factor + slope * dy * dy]];
    (force, stiffness)
}

fn exact_load(x: f64) -> f64 {
    let length = x.hypot(1.0);
    (1.0 - length / rest_length()) * (FRICTION - x) / length
}

impl Problem for Increment {
    fn variables(&self) -> usize {
        7
    }
    fn equalities(&self) -> usize {
        3
    }
    fn inequalities(&self) -> usize {
        0
    }
    fn pairs(&self) -> usize {
        3
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let mut lower = DVector::from_element(7, f64::NEG_INFINITY);
        for j in [3, 4, 5] {
            lower[j] = 0.0;
        }
        (lower, DVector::from_element(7, f64::INFINITY))
    }
    fn objective(&self, v: &DVector<f64>) -> f64 {
        let length: f64 = (0..3).map(|j| v[j] * v[j]).sum();
        let forward: f64 = (0..3).map(|j| self.previous[j] * v[j]).sum();
        0.5 * self.arc_weight * length - self.forward_weight * forward + self.tangential_reaction * (v[4] - v[5])
    }
    fn objective_gradient(&self, v: &DVector<f64>, gradient: &mut DVector<f64>) {
        for j in 0..3 {
            gradient[j] = self.arc_weight * v[j] - self.forward_weight * self.previous[j];
        }
        gradient[4] = self.tangential_reaction;
        gradient[5] = -self.tangential_reaction;
    }
    fn equality_values(&self, v: &DVector<f64>, values: &mut DVector<f64>) {
        let (force, _) = internal_force(self.tip[0] + v[0], self.tip[1] + v[1]);
        values[0] = force[0] - self.load - v[2] - v[6];
        values[1] = force[1] - v[3];
        values[2] = v[0] - v[4] + v[5];
    }
    fn equality_jacobian(&self, v: &DVector<f64>, jacobian: &mut SparseRows) {
        let (_, stiffness) = internal_force(self.tip[0] + v[0], self.tip[1] + v[1]);
        for i in 0..2 {
            for j in 0..2 {
                jacobian[(i, j)] = stiffness[i][j];
            }
        }
        jacobian[(0, 2)] = -1.0;
        jacobian[(0, 6)] = -1.0;
        jacobian[(1, 3)] = -1.0;
        jacobian[(2, 0)] = 1.0;
        jacobian[(2, 4)] = -1.0;
        jacobian[(2, 5)] = 1.0;
    }
    fn pair_values(&self, v: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        first.copy_from_slice(&[self.tip[1] + v[1], FRICTION * v[3] + v[6], FRICTION * v[3] - v[6]]);
        second.copy_from_slice(&[v[3], v[4], v[5]]);
    }
    fn pair_jacobians(&self, _v: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        first[(0, 1)] = 1.0;
        (first[(1, 3)], first[(1, 6)]) = (FRICTION, 1.0);
        (first[(2, 3)], first[(2, 6)]) = (FRICTION, -1.0);
        (second[(0, 3)], second[(1, 4)], second[(2, 5)]) = (1.0, 1.0, 1.0);
    }
    fn quadratic_model(&self, _v: &DVector<f64>) -> Option<SparseRows> {
        let mut model = SparseRows::zeros(7, 7);
        for j in 0..3 {
            model[(j, j)] = self.arc_weight;
        }
        Some(model)
    }
}

const STEP: f64 = 0.02;

/// The increment at `x` while slipping forward, and a guess along the tangent, a little off.
fn increment_at(x: f64) -> (Increment, DVector<f64>) {
    let length = x.hypot(1.0);
    let normal = (1.0 - length / rest_length()) / length;
    let rate = (exact_load(x + 1e-6) - exact_load(x - 1e-6)) / 2e-6;
    let norm = rate.hypot(1.0);
    let previous = [1.0 / norm, 0.0, rate / norm];
    let forward_weight = 1.0;
    let increment = Increment {
        tip: [x, 0.0],
        load: exact_load(x),
        tangential_reaction: -FRICTION * normal,
        previous,
        arc_weight: forward_weight / STEP,
        forward_weight,
    };
    let slip = STEP * previous[0] * 0.9;
    let guess = DVector::from_vec(vec![slip, 0.0, STEP * previous[2] * 0.9, normal, slip, 0.0, -FRICTION * normal]);
    (increment, guess)
}

fn check_slipping(solution: &mpec::ProgramSolution, increment: &Increment, load_error: f64) {
    assert_eq!(solution.activity[0], PairActivity::FirstZero);
    assert_eq!(solution.activity[1], PairActivity::FirstZero);
    assert_eq!(solution.activity[2], PairActivity::SecondZero);
    let x = increment.tip[0] + solution.x[0];
    let error = (increment.load + solution.x[2] - exact_load(x)).abs();
    assert!(error <= load_error, "load error {error} at {x}");
}

/// The whole path from the second increment to near x = +1.5, warm: the pattern is named in at most three quadratic
/// programs, and none of them needs the interior-point method.
#[test]
fn warm_path_names_the_mode_in_two_or_three_programs() {
    let settings = Settings { finish: Finish::PatternSettled, ..Settings::warm() };
    let (mut increments, mut programs, mut interior, mut largest) = (0, 0, 0, 0);
    let mut time = std::time::Duration::ZERO;
    let mut x = -1.45;
    while x < 1.4 {
        let (increment, guess) = increment_at(x);
        let before = std::time::Instant::now();
        let solution = mpec::solve(&increment, &guess, &settings, &CancelFlag::default()).expect("valid input");
        time += before.elapsed();
        assert_eq!(solution.status, SolveStatus::PatternSettled, "at {x}: {solution:?}");
        check_slipping(&solution, &increment, 1e-3);
        increments += 1;
        programs += solution.counts.qp_solves;
        interior += solution.counts.interior_point_solves;
        largest = largest.max(solution.counts.qp_solves);
        x += solution.x[0];
        assert!(solution.x[0] > 0.1 * STEP, "the path runs backward at {x}");
    }
    println!(
        "warm, mode only: {increments} increments, {programs} programs, {interior} interior-point, at most {largest}"
    );
    println!("warm, mode only: {:.1} us an increment", time.as_secs_f64() * 1e6 / increments as f64);
    assert!(largest <= 3);
    assert_eq!(interior, 0);
}

/// The same, each increment converged to the tolerance.
#[test]
fn warm_path_converged() {
    let (mut increments, mut programs, mut interior, mut largest) = (0, 0, 0, 0);
    let mut time = std::time::Duration::ZERO;
    let mut x = -1.45;
    while x < 1.4 {
        let (increment, guess) = increment_at(x);
        let before = std::time::Instant::now();
        let solution = mpec::solve(&increment, &guess, &Settings::warm(), &CancelFlag::default()).expect("valid input");
        time += before.elapsed();
        assert_eq!(solution.status, SolveStatus::Solved, "at {x}: {solution:?}");
        check_slipping(&solution, &increment, 1e-7);
        increments += 1;
        programs += solution.counts.qp_solves;
        interior += solution.counts.interior_point_solves;
        largest = largest.max(solution.counts.qp_solves);
        x += solution.x[0];
    }
    println!(
        "warm, converged: {increments} increments, {programs} programs, {interior} interior-point, at most {largest}"
    );
    println!("warm, converged: {:.1} us an increment", time.as_secs_f64() * 1e6 / increments as f64);
    assert!(largest <= 4);
    assert_eq!(interior, 0);
}

/// From no displacement at all, where the slipping contact is biactive.
#[test]
fn cold_path_finds_the_same_mode() {
    let (mut increments, mut programs, mut interior, mut largest) = (0, 0, 0, 0);
    let mut time = std::time::Duration::ZERO;
    let mut x = -1.45;
    while x < 1.4 {
        let (increment, guess) = increment_at(x);
        let mut start = guess.clone();
        for j in [0, 1, 2, 4, 5] {
            start[j] = 0.0;
        }
        let before = std::time::Instant::now();
        let settings = Settings { first_relaxation: 1e-4, ..Settings::default() };
        let solution = mpec::solve(&increment, &start, &settings, &CancelFlag::default()).expect("valid input");
        time += before.elapsed();
        assert_eq!(solution.status, SolveStatus::Solved, "at {x}: {solution:?}");
        check_slipping(&solution, &increment, 1e-7);
        increments += 1;
        programs += solution.counts.qp_solves;
        interior += solution.counts.interior_point_solves;
        largest = largest.max(solution.counts.qp_solves);
        x += solution.x[0];
    }
    println!("cold: {increments} increments, {programs} programs, {interior} interior-point, at most {largest}");
    println!("cold: {:.1} us an increment", time.as_secs_f64() * 1e6 / increments as f64);
    assert!(largest <= 8);
}

/// Off the floor, pulled along the bar's axis: no reaction, so one of the two friction pairs is always biactive.
fn free_increment() -> (Increment, DVector<f64>) {
    let x = -1.9;
    let (force, stiffness) = internal_force(x, 1.0);
    let norm = stiffness[0][0].hypot(1.0);
    let previous = [-1.0 / norm, 0.0, -stiffness[0][0] / norm];
    let increment = Increment {
        tip: [x, 1.0],
        load: force[0],
        tangential_reaction: 0.0,
        previous,
        arc_weight: 1.0 / STEP,
        forward_weight: 1.0,
    };
    let slip = 0.9 * STEP * previous[0];
    let guess = DVector::from_vec(vec![slip, 0.0, 0.9 * STEP * previous[2], 0.0, 0.0, -slip, 0.0]);
    (increment, guess)
}

#[test]
fn a_free_node_is_solved_although_its_friction_is_degenerate() {
    let (increment, guess) = free_increment();
    for settings in
        [Settings::warm(), Settings::default(), Settings { finish: Finish::PatternSettled, ..Settings::warm() }]
    {
        let solution = mpec::solve(&increment, &guess, &settings, &CancelFlag::default()).expect("valid input");
        println!("free: {:?} {:?} {:?}", solution.status, solution.stationarity, solution.counts);
        assert_eq!(solution.status, SolveStatus::Solved);
        assert_eq!(solution.activity[0], PairActivity::SecondZero);
        assert_eq!(solution.activity[2], PairActivity::FirstZero);
        assert_eq!(solution.x[3], 0.0);
        let (force, _) = internal_force(increment.tip[0] + solution.x[0], 1.0);
        assert!((force[0] - increment.load - solution.x[2]).abs() < 1e-9);
        assert!(((solution.x[0].powi(2) + solution.x[2].powi(2)).sqrt() - STEP).abs() < 1e-3 * STEP);
    }
}

/// The first increment starts with the bar unstressed: contact closed, reaction zero, friction cone shrunk to a point.
#[test]
fn the_first_increment_leaves_the_degenerate_start() {
    let increment = Increment {
        tip: [START, 0.0],
        load: 0.0,
        tangential_reaction: 0.0,
        previous: [0.0, 0.0, 1.0],
        arc_weight: 1.0 / STEP,
        forward_weight: 1.0,
    };
    let solution =
        mpec::solve(&increment, &DVector::zeros(7), &Settings::default(), &CancelFlag::default()).expect("valid input");
    println!("start: {:?} {:?} {:?}", solution.status, solution.stationarity, solution.counts);
    assert_eq!(solution.status, SolveStatus::Solved);
    check_slipping(&solution, &increment, 1e-9);
    assert!(solution.x[0] > 0.0 && solution.x[2] > 0.0);
}
