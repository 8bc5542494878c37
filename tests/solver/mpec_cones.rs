//! Programs with complementary pairs in second-order cones: a mass on a rough plane held by springs in space, a load to be
//! chosen, the nearest complementary pair; each with an answer by hand.

use arcslip::complementarity::mpec::program::cone;
use arcslip::complementarity::mpec::{
    self, ConeActivity, Problem, ProgramSolution, Settings, SolveStatus, SparseRows, StationarityKind,
    semismooth_newton,
};
use arcslip::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// A point mass on the plane `z = 0`, springs `stiffness` to the ground, pressed by 1 and pushed by a tangential force
/// that is given, or chosen as a multiple of `push` so that `½ |u_t - target|² + ½ weight force²` is least.
///
/// Variables: `u (3)`, `r_n`, `r_t (2)`, `λ`, `Δu_t (2)`, and where it is chosen the multiple.
struct Mass {
    stiffness: Matrix3<f64>,
    friction: f64,
    push: [f64; 2],
    chosen: Option<([f64; 2], f64)>,
}

impl Mass {
    fn given(stiffness: Matrix3<f64>, friction: f64, push: [f64; 2]) -> Self {
        Self { stiffness, friction, push, chosen: None }
    }

    fn solve(&self, start: &DVector<f64>, settings: &Settings) -> ProgramSolution {
        mpec::solve(self, start, settings, &CancelFlag::default()).expect("a well-formed problem")
    }
}

impl Problem for Mass {
    fn variables(&self) -> usize {
        9 + usize::from(self.chosen.is_some())
    }
    fn equalities(&self) -> usize {
        5
    }
    fn inequalities(&self) -> usize {
        0
    }
    fn pairs(&self) -> usize {
        1
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let n = self.variables();
        (DVector::repeat(n, f64::NEG_INFINITY), DVector::repeat(n, f64::INFINITY))
    }
    fn objective(&self, x: &DVector<f64>) -> f64 {
        let Some((target, weight)) = self.chosen else { return 0.0 };
        0.5 * ((x[0] - target[0]).powi(2) + (x[1] - target[1]).powi(2) + weight * x[9] * x[9])
    }
    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
        let Some((target, weight)) = self.chosen else { return };
        gradient[0] = x[0] - target[0];
        gradient[1] = x[1] - target[1];
        gradient[9] = weight * x[9];
    }
    fn equality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        let force = self.stiffness * Vector3::new(x[0], x[1], x[2]);
        let multiple = if self.chosen.is_some() { x[9] } else { 1.0 };
        for k in 0..2 {
            values[k] = force[k] - multiple * self.push[k] - x[4 + k];
            values[3 + k] = x[k] - x[7 + k];
        }
        values[2] = force[2] + 1.0 - x[3];
    }
    fn equality_jacobian(&self, _x: &DVector<f64>, jacobian: &mut SparseRows) {
        for (i, j) in (0..9).map(|place| (place / 3, place % 3)) {
            jacobian[(i, j)] = self.stiffness[(i, j)];
        }
        for k in 0..2 {
            jacobian[(k, 4 + k)] = -1.0;
            jacobian[(3 + k, k)] = 1.0;
            jacobian[(3 + k, 7 + k)] = -1.0;
            if self.chosen.is_some() {
                jacobian[(k, 9)] = -self.push[k];
            }
        }
        jacobian[(2, 3)] = -1.0;
    }
    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        first[0] = x[2];
        second[0] = x[3];
    }
    fn pair_jacobians(&self, _x: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        first[(0, 2)] = 1.0;
        second[(0, 3)] = 1.0;
    }
    fn cone_sizes(&self) -> Vec<usize> {
        vec![3]
    }
    fn cone_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        first.copy_from_slice(&[self.friction * x[3], x[4], x[5]]);
        second.copy_from_slice(&[x[6], x[7], x[8]]);
    }
    fn cone_jacobians(&self, _x: &DVector<f64>, first: &mut DMatrix<f64>, second: &mut DMatrix<f64>) {
        first[(0, 3)] = self.friction;
        first[(1, 4)] = 1.0;
        first[(2, 5)] = 1.0;
        (0..3).for_each(|k| second[(k, 6 + k)] = 1.0);
    }
}

fn from_rest(problem: &Mass) -> DVector<f64> {
    DVector::zeros(problem.variables())
}

#[test]
fn a_mass_pushed_less_than_friction_bears_sticks() {
    let mass = Mass::given(Matrix3::identity() * 2.0, 0.5, [0.3, -0.2]);
    let end = mass.solve(&from_rest(&mass), &Settings::default());
    assert_eq!(end.status, SolveStatus::Solved);
    assert_eq!(end.cone_activity, [ConeActivity::SecondZero]);
    let expected = [0.0, 0.0, 0.0, 1.0, -0.3, 0.2, 0.0, 0.0, 0.0];
    assert!((end.x - DVector::from_column_slice(&expected)).amax() < 1e-9);
    assert_eq!(end.stationarity, StationarityKind::Strong);
}

/// Equal springs: the mass slides along the force until the springs bear what friction does not.
#[test]
fn a_mass_pushed_harder_slides_along_the_force() {
    let mass = Mass::given(Matrix3::identity() * 2.0, 0.5, [0.6, -0.8]);
    let end = mass.solve(&from_rest(&mass), &Settings::default());
    assert_eq!(end.status, SolveStatus::Solved);
    assert_eq!(end.cone_activity, [ConeActivity::BothOnBoundary]);
    let expected = [0.15, -0.2, 0.0, 1.0, -0.3, 0.4, 0.25, 0.15, -0.2];
    assert!((&end.x - DVector::from_column_slice(&expected)).amax() < 1e-9, "{}", end.x);
    assert!(end.largest_violation < 1e-9 && end.largest_product < 1e-9);
}

/// Springs that couple all three directions: no closed form for the direction. Equilibrium and Coulomb's law are asked for.
#[test]
fn unequal_springs_turn_the_direction_of_slip() {
    let stiffness = Matrix3::new(2.0, 0.3, -0.2, 0.3, 1.0, -0.4, -0.2, -0.4, 3.0);
    let mass = Mass::given(stiffness, 0.4, [1.0, 0.5]);
    let end = mass.solve(&from_rest(&mass), &Settings::default());
    assert_eq!(end.cone_activity, [ConeActivity::BothOnBoundary]);
    assert!(end.largest_violation < 1e-8, "{:e}", end.largest_violation);
    let (slip, traction) = (Vector3::new(end.x[0], end.x[1], 0.0), Vector3::new(end.x[4], end.x[5], 0.0));
    assert!((traction.norm() - 0.4 * end.x[3]).abs() < 1e-8);
    assert!((traction + slip * (0.4 * end.x[3] / slip.norm())).amax() < 1e-8);
    let force = Vector3::new(1.0, 0.5, 0.0);
    assert!(slip.normalize().dot(&force.normalize()) < 0.999, "the slip is not along the force");
}

/// Lifted off: no reaction, and the motion along the plane is free.
#[test]
fn a_mass_pulled_off_the_plane_bears_no_friction() {
    let mut stiffness = Matrix3::identity() * 2.0;
    stiffness[(2, 0)] = -3.0;
    let mass = Mass::given(stiffness, 0.5, [2.0, 0.0]);
    let end = mass.solve(&from_rest(&mass), &Settings::default());
    // u_x = 1 without friction, and then the coupling pulls with 3 against the weight of 1.
    assert!((end.x[0] - 1.0).abs() < 1e-7 && (end.x[2] - 1.0).abs() < 1e-7, "{}", end.x);
    assert!(matches!(end.cone_activity[0], ConeActivity::FirstZero | ConeActivity::FirstZeroSecondOnBoundary));
}

/// `min ½ |u_t - d|² + ½ w m²` with the push `m d`, `|d| = 1`. Slip: `m = μ + k u`, `u = (1 - w k μ)/(1 + w k²)`. Stick: `m = 0`.
/// Both are minima; at the onset of slip, where the two branches meet, the slope leads into slip.
#[test]
fn both_branches_of_a_chosen_load_are_found() {
    let direction = [0.6, 0.8];
    let (stiffness, friction, weight) = (1.0, 1.0, 0.1);
    let mass = Mass { stiffness: Matrix3::identity(), friction, push: direction, chosen: Some((direction, weight)) };
    let slip = (1.0 - weight * stiffness * friction) / (1.0 + weight * stiffness * stiffness);
    let load = friction + stiffness * slip;
    let point = |slip: f64, load: f64| {
        let traction = load - stiffness * slip;
        let [x, y] = direction;
        DVector::from_column_slice(&[
            slip * x,
            slip * y,
            0.0,
            1.0,
            -traction * x,
            -traction * y,
            slip,
            slip * x,
            slip * y,
            load,
        ])
    };
    let warm = Settings::warm();
    let sliding = mass.solve(&point(0.3, 1.3), &warm);
    assert_eq!(sliding.cone_activity, [ConeActivity::BothOnBoundary]);
    assert!((&sliding.x - point(slip, load)).amax() < 1e-6, "{}", sliding.x);
    assert_eq!((sliding.status, sliding.stationarity), (SolveStatus::Solved, StationarityKind::Strong));

    let stuck = mass.solve(&point(0.0, 0.5), &warm);
    assert_eq!(stuck.cone_activity, [ConeActivity::SecondZero]);
    assert!((&stuck.x - point(0.0, 0.0)).amax() < 1e-6, "{}", stuck.x);
    assert_eq!((stuck.status, stuck.stationarity), (SolveStatus::Solved, StationarityKind::Strong));

    // At the onset of slip both branches lead down.
    let onset = mass.solve(&point(0.0, friction), &warm);
    assert_eq!(onset.status, SolveStatus::Solved);
    assert!(onset.objective < mass.objective(&point(0.0, friction)) - 1e-3);
}

/// `min ½ |a - p|² + ½ |b - q|²` over complementary members of the cone.
struct Nearest {
    p: [f64; 3],
    q: [f64; 3],
}

impl Problem for Nearest {
    fn variables(&self) -> usize {
        6
    }
    fn equalities(&self) -> usize {
        0
    }
    fn inequalities(&self) -> usize {
        0
    }
    fn pairs(&self) -> usize {
        0
    }
    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        (DVector::repeat(6, f64::NEG_INFINITY), DVector::repeat(6, f64::INFINITY))
    }
    fn objective(&self, x: &DVector<f64>) -> f64 {
        let target = self.p.iter().chain(&self.q);
        0.5 * x.iter().zip(target).map(|(x, t)| (x - t).powi(2)).sum::<f64>()
    }
    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
        gradient.iter_mut().zip(x.iter().zip(self.p.iter().chain(&self.q))).for_each(|(g, (x, t))| *g = x - t);
    }
    fn pair_values(&self, _x: &DVector<f64>, _first: &mut DVector<f64>, _second: &mut DVector<f64>) {}
    fn pair_jacobians(&self, _x: &DVector<f64>, _first: &mut SparseRows, _second: &mut SparseRows) {}
    fn cone_sizes(&self) -> Vec<usize> {
        vec![3]
    }
    fn cone_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        first.copy_from(&x.rows(0, 3));
        second.copy_from(&x.rows(3, 3));
    }
    fn cone_jacobians(&self, _x: &DVector<f64>, first: &mut DMatrix<f64>, second: &mut DMatrix<f64>) {
        (0..3).for_each(|k| {
            first[(k, k)] = 1.0;
            second[(k, 3 + k)] = 1.0;
        });
    }
}

/// Values of the objective at the minima of all branches: `a = 0`, `b = 0`, and the local minima over the direction `e` of
/// `a = t (1, e)`, `b = τ (1, -e)`.
fn branch_minima(problem: &Nearest) -> Vec<f64> {
    let squared = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
    let outside = |v: &[f64; 3]| squared(&v.map(|x| x)) - cone::projection(v).norm_squared();
    let (p, q) = (&problem.p, &problem.q);
    let mut values = vec![0.5 * (squared(p) + outside(q)), 0.5 * (outside(p) + squared(q))];
    let along = |angle: f64| {
        let e = [angle.cos(), angle.sin()];
        let first = (p[0] + p[1] * e[0] + p[2] * e[1]).max(0.0);
        let second = (q[0] - q[1] * e[0] - q[2] * e[1]).max(0.0);
        0.5 * (squared(p) + squared(q)) - 0.25 * (first * first + second * second)
    };
    let count = 20_000;
    let step = std::f64::consts::TAU / f64::from(count);
    for k in 0..count {
        let angle = f64::from(k) * step;
        let here = along(angle);
        if here <= along(angle - step) && here <= along(angle + step) {
            values.push(here);
        }
    }
    values
}

#[test]
fn the_nearest_complementary_pair_is_a_minimum_of_a_branch() {
    let mut state = 11_u64;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 4.0 - 2.0
    };
    let (mut global, mut on_boundary) = (0, 0);
    let count = 100;
    for round in 0..count {
        let problem = Nearest { p: [number(), number(), number()], q: [number(), number(), number()] };
        let start = DVector::from_iterator(6, problem.p.into_iter().chain(problem.q));
        let end = mpec::solve(&problem, &start, &Settings::default(), &CancelFlag::default()).expect("well-formed");
        assert!(matches!(end.status, SolveStatus::Solved | SolveStatus::Feasible), "{round}: {:?}", end.status);
        assert!(end.largest_violation <= 1e-8 && end.largest_product <= 1e-8, "{round}: {}", end.x);
        let minima = branch_minima(&problem);
        let miss = minima.iter().fold(f64::INFINITY, |miss, value| miss.min((value - end.objective).abs()));
        assert!(miss < 1e-6, "{round}: {} is none of {minima:?}, {:?}", end.objective, end.stationarity);
        let least = minima.iter().copied().fold(f64::INFINITY, f64::min);
        global += usize::from(end.objective < least + 1e-6);
        on_boundary += usize::from(end.cone_activity[0] == ConeActivity::BothOnBoundary);
    }
    assert!(on_boundary >= 20, "only {on_boundary} of {count} exercise the boundary");
    assert!(global >= 90, "only {global} of {count} are global");
}

/// Where two branches meet and neither leads down, that is claimed; where both members vanish, infinitely many meet and no
/// more is claimed than that of one.
#[test]
fn what_is_claimed_of_biactive_pairs_is_what_was_examined() {
    let end = |p, q| {
        let problem = Nearest { p, q };
        mpec::solve(&problem, &DVector::zeros(6), &Settings::default(), &CancelFlag::default()).expect("well-formed")
    };
    let at_onset = end([1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]);
    assert_eq!(at_onset.cone_activity, [ConeActivity::SecondZeroFirstOnBoundary]);
    assert!((&at_onset.x - DVector::from_column_slice(&[1.0, 1.0, 0.0, 0.0, 0.0, 0.0])).amax() < 1e-7);
    assert_eq!((at_onset.status, at_onset.stationarity), (SolveStatus::Solved, StationarityKind::Branch));

    let at_apex = end([-1.0, 0.2, 0.0], [-1.0, 0.0, 0.3]);
    assert_eq!(at_apex.cone_activity, [ConeActivity::BothZero]);
    assert!(at_apex.x.amax() < 1e-7);
    assert_eq!((at_apex.status, at_apex.stationarity), (SolveStatus::Solved, StationarityKind::OneBranch));
}

/// Newton's method on the system itself, from a mass at rest under a push that makes it slide in a direction that the
/// start does not know: round-off, and each error near the square of the one before.
#[test]
fn the_semismooth_method_converges_quadratically_to_round_off() {
    let stiffness = Matrix3::new(2.0, 0.3, -0.2, 0.3, 1.0, -0.4, -0.2, -0.4, 3.0);
    let mass = Mass::given(stiffness, 0.4, [1.0, 0.5]);
    let end = semismooth_newton::polish(&mass, &from_rest(&mass), None, &CancelFlag::default()).expect("finite");
    assert!(end.is_converged, "{:?}", end.residuals);
    let last = end.residuals.last().copied().unwrap_or(f64::INFINITY);
    assert!(last < 1e-14, "{:?}", end.residuals);
    // Once below a hundredth, residuals square until round-off stops them.
    let small: Vec<f64> = end.residuals.iter().copied().filter(|size| *size < 1e-2).collect();
    assert!(small.len() >= 2 && small.len() <= 4, "{:?}", end.residuals);
    for pair in small.windows(2) {
        assert!(pair[1] <= 10.0 * pair[0] * pair[0] + 1e-15, "{:?}", end.residuals);
    }
    let by_program = mass.solve(&from_rest(&mass), &Settings::default());
    assert!((by_program.x - end.x).amax() < 1e-7);
}

#[test]
fn members_of_size_one_are_refused() {
    struct Short;
    impl Problem for Short {
        fn variables(&self) -> usize {
            1
        }
        fn equalities(&self) -> usize {
            0
        }
        fn inequalities(&self) -> usize {
            0
        }
        fn pairs(&self) -> usize {
            0
        }
        fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
            (DVector::zeros(1), DVector::zeros(1))
        }
        fn objective(&self, _x: &DVector<f64>) -> f64 {
            0.0
        }
        fn objective_gradient(&self, _x: &DVector<f64>, _gradient: &mut DVector<f64>) {}
        fn pair_values(&self, _x: &DVector<f64>, _first: &mut DVector<f64>, _second: &mut DVector<f64>) {}
        fn pair_jacobians(&self, _x: &DVector<f64>, _first: &mut SparseRows, _second: &mut SparseRows) {}
        fn cone_sizes(&self) -> Vec<usize> {
            vec![1]
        }
    }
    let refused = mpec::solve(&Short, &DVector::zeros(1), &Settings::default(), &CancelFlag::default());
    assert_eq!(refused.err(), Some(mpec::ProgramInputError::ConeSize { pair: 0, size: 1 }));
}
