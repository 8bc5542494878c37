//! The increment in space, where friction is a second-order cone.

use crate::complementarity::mpec::{Problem, SparseRows};
use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::kinematics::Kinematics;
use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::{ContactPair, Reaction, Sliding, tangents_in_space};
use crate::mechanics::problem::loading::LoadPattern;
use crate::mechanics::problem::state::dot;
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::elements::bar::Bar;
use crate::mechanics::structure::elements::spring::Spring;
use crate::model::request::Strain;
use crate::step::increment_mpec::solution_extraction;
use crate::step::increment_mpec::*;
use nalgebra::DMatrix;

/// The normal of the floor of these tests.
pub(super) const FLOOR: [f64; 3] = [0.0, 0.0, 1.0];

/// Tractions in the plane of the floor.
pub(super) fn in_plane(reaction: &Reaction) -> Components {
    [reaction.tangential[0], reaction.tangential[1]]
}

/// A reaction of the floor.
pub(super) fn on_floor(normal: f64, tangential: Components) -> Reaction {
    tangent_components::reaction(&tangents_in_space(&FLOOR), normal, tangential)
}

/// A pattern of forces alone.
pub(super) fn forces(forces: Vec<f64>, contacts: usize) -> LoadPattern {
    LoadPattern { forces, supports: Vec::new(), shifts: vec![[0.0; 3]; contacts] }
}

/// One bar from a pin to a tip near the floor `z >= 0`; the tip is pushed by `pattern`.
struct OneBar {
    structure: Structure,
    contacts: Vec<ContactPair>,
    pattern: LoadPattern,
    held: LoadPattern,
}

impl OneBar {
    fn new(pin: [f64; 3], tip: [f64; 3], friction: f64, pattern: [f64; 3]) -> Self {
        let length = (0..3).map(|k| (tip[k] - pin[k]).powi(2)).sum::<f64>().sqrt();
        let bar = Bar {
            nodes: [0, 1],
            reference: [0, 1, 2].map(|k| tip[k] - pin[k]),
            reference_length: length,
            axial_stiffness: 1.0,
            rest_length: length,
            prestress: 0.0,
            strain: Strain::Engineering,
        };
        let supports = [(0, 0), (0, 1), (0, 2)];
        let floor = RigidSurface::Plane { normal: [0.0, 0.0, 1.0] };
        Self {
            structure: Structure::new(3, 2, &supports, [bar].into_iter().collect()),
            contacts: vec![ContactPair {
                kinematics: Kinematics::Node(1),
                obstacle: floor,
                initial_gap: tip[2],
                friction: CoulombFriction::new(friction),
                sliding: Sliding::Plane,
            }],
            pattern: forces([0.0; 3].into_iter().chain(pattern).collect(), 1),
            held: forces(vec![0.0; 6], 1),
        }
    }

    /// Adds a spring to the ground, without which the tip can turn about the pin.
    fn with_spring(mut self, stiffness: f64) -> Self {
        let mut matrix = [[0.0; 3]; 3];
        (0..3).for_each(|k| matrix[k][k] = stiffness);
        self.structure = self.structure.with_elements(&[Spring::to_ground(1, matrix)].into_iter().collect());
        self
    }

    fn loading(&self) -> Loading<'_> {
        Loading {
            structure: &self.structure,
            contacts: &self.contacts,
            corners: &[],
            pattern: &self.pattern,
            held: &self.held,
        }
    }

    fn at_rest(&self) -> State {
        State::at_rest(&self.structure, 1)
    }

    /// A unit rate that moves the tip and raises the load.
    fn rate(&self, tip: [f64; 3], load: f64) -> Rate {
        let displacement = [0.0; 3].into_iter().chain(tip).collect();
        let mut rate = Rate { displacement, load, reactions: vec![Reaction::default()] };
        let size = rate.size();
        rate.scale(1.0 / size);
        rate
    }
}

/// The mean rate between two states, of unit arc length.
fn chord(from: &State, to: &State) -> Rate {
    let reactions = to.reactions.iter().zip(&from.reactions).map(|(to, from)| {
        let (a, b) = (in_plane(to), in_plane(from));
        on_floor(to.normal - from.normal, [a[0] - b[0], a[1] - b[1]])
    });
    let mut rate = Rate {
        displacement: to.displacement.iter().zip(&from.displacement).map(|(to, from)| to - from).collect(),
        load: to.load - from.load,
        reactions: reactions.collect(),
    };
    let size = rate.size();
    rate.scale(1.0 / size);
    rate
}

/// The slip direction in the plane of a mode.
fn slip_in_plane(mode: Mode) -> [f64; 3] {
    let Mode::Slip { direction } = mode else { panic!("{mode:?} is not slip") };
    direction
}

/// The largest violation of equilibrium, Coulomb's law and the arc length at an end, computed independently.
fn off_balance(scene: &OneBar, base: &State, end: &State, step: f64) -> f64 {
    let mut force = vec![0.0; 6];
    scene.structure.internal_force(&end.displacement, &mut force);
    let contact = &scene.contacts[0];
    let (reaction, tangents) = (end.reactions[0], tangents_in_space(&FLOOR));
    let traction = in_plane(&reaction);
    let mut worst = (base.distance(end) - step).abs().max(scene.loading().gap(0, end).abs());
    let normal = FLOOR;
    for k in 0..3 {
        let tangential = traction[0] * tangents[0][k] + traction[1] * tangents[1][k];
        let applied = end.load * scene.pattern.forces[3 + k] + reaction.normal * normal[k] + tangential;
        worst = worst.max((force[3 + k] - applied).abs());
    }
    let slip: [f64; 2] = std::array::from_fn(|k| {
        (0..3).map(|c| tangents[k][c] * (end.displacement[3 + c] - base.displacement[3 + c])).sum()
    });
    let size = slip[0].hypot(slip[1]);
    let strength = contact.friction.bound(reaction.normal);
    for k in 0..2 {
        worst = worst.max((traction[k] + strength * slip[k] / size).abs());
    }
    worst
}

/// The cost and the error of a march along the tractrix.
struct March {
    increments: u64,
    counts: ProgramCounts,
    /// Largest distance from the exact track.
    error: f64,
    worst_residual: f64,
    seconds: f64,
}

/// The curved slip of the exact scenes: b = 0.1, h = 1, x0 = -1.4, μ = 0.8, from rest to x = -0.4. The start is
/// unstressed, so that the first increment does not know in which direction the tip will slip.
fn march(step: f64) -> March {
    let (b, h, x0, friction) = (0.1, 1.0, -1.4, 0.8);
    let scene = OneBar::new([0.0, b, h], [x0, 0.0, 0.0], friction, [1.0, 0.0, 0.0]);
    let mut base = scene.at_rest();
    let mut forward = scene.rate([1.0, 0.0, 0.0], 0.5);
    let mut modes = vec![Mode::Stick];
    let mut march =
        March { increments: 0, counts: ProgramCounts::default(), error: 0.0, worst_residual: 0.0, seconds: 0.0 };
    let clock = std::time::Instant::now();
    let track = |w: f64| {
        let c = friction * h;
        let primitive = |w: f64| (c * c - w * w).sqrt() - c * (c / w).acosh();
        x0 + primitive(w) - primitive(b)
    };
    while x0 + base.displacement[3] < -0.4 {
        let mut program = IncrementProgram::new(scene.loading(), &base, &forward, step, 0.2);
        let start = program.variables_at(&forward);
        let (named, counts) = program.name(&start, &modes, &CancelFlag::default());
        march.counts.qp_solves += counts.qp_solves;
        march.counts.mpec_solves += counts.mpec_solves;
        let named = named.unwrap_or_else(|| panic!("no name at increment {}", march.increments));
        let end = named.end.expect("an exact end");
        march.worst_residual = march.worst_residual.max(off_balance(&scene, &base, &end, step));
        let slip = slip_in_plane(named.modes[0]);
        let moved: f64 = dot(&slip, &chord(&base, &end).displacement[3..6]);
        assert!(moved > 0.0, "the tip moves along its slip");
        forward = chord(&base, &end);
        modes = named.modes;
        base = end;
        march.increments += 1;
        assert!(march.increments < 10_000, "the march ends");
        // The distance from the track: the distance along x at the present w, times the slope of the track.
        let w = b - base.displacement[4];
        let c = friction * h;
        let slope = w / (c * c - w * w).sqrt();
        march.error = march.error.max(((x0 + base.displacement[3] - track(w)) * slope).abs());
    }
    march.seconds = clock.elapsed().as_secs_f64();
    march
}

#[test]
fn the_tip_slides_along_the_tractrix_to_first_order() {
    let (coarse, fine) = (march(0.02), march(0.01));
    for march in [&coarse, &fine] {
        println!(
            "{} increments, {:.2} QPs and {:.2} programs each, {:.1} µs each, track error {:.3e}, residual {:.1e}",
            march.increments,
            march.counts.qp_solves as f64 / march.increments as f64,
            march.counts.mpec_solves as f64 / march.increments as f64,
            march.seconds / march.increments as f64 * 1e6,
            march.error,
            march.worst_residual,
        );
        assert!(march.worst_residual < 1e-14);
        assert!(march.counts.qp_solves <= 3 * march.increments, "more work than it takes");
    }
    let order = (coarse.error / fine.error).log2();
    assert!((0.9..1.1).contains(&order), "order {order}");
    assert!(fine.error < 5e-3, "{:e}", fine.error);
}

/// At an unstressed start nothing determines the direction of slip; the exact one is `(√(c² - b²), -b)/c`.
#[test]
fn the_direction_of_the_first_slip_is_found() {
    let (b, h, friction) = (0.1, 1.0, 0.8);
    let scene = OneBar::new([0.0, b, h], [-1.4, 0.0, 0.0], friction, [1.0, 0.0, 0.0]);
    let base = scene.at_rest();
    let forward = scene.rate([1.0, 0.0, 0.0], 0.5);
    let mut program = IncrementProgram::new(scene.loading(), &base, &forward, 1e-4, 1e-4);
    let start = program.variables_at(&forward);
    let (named, _) = program.name(&start, &[Mode::Stick], &CancelFlag::default());
    let named = named.expect("named");
    let end = named.end.expect("an exact end");
    let traction = in_plane(&end.reactions[0]);
    let slip = slip_in_plane(tangent_components::slip(&tangents_in_space(&FLOOR), [-traction[0], -traction[1]]));
    let c: f64 = friction * h;
    let exact = [(c * c - b * b).sqrt() / c, -b / c, 0.0];
    let miss = (0..3).fold(0.0_f64, |miss, k| miss.max((slip[k] - exact[k]).abs()));
    assert!(miss < 1e-4, "{slip:?} is not {exact:?}");
}

/// A tip above the floor comes down obliquely and lands sliding, in a direction that no reaction determines beforehand.
#[test]
fn a_landing_tip_slides_in_the_direction_in_which_it_lands() {
    let scene = OneBar::new([0.0, 0.1, 1.0], [-1.4, 0.0, 0.004], 0.2, [1.0, 0.2, -0.4]);
    let base = scene.at_rest();
    let forward = scene.rate([0.8, 0.1, -0.5], 0.05);
    let mut program = IncrementProgram::new(scene.loading(), &base, &forward, 0.02, 0.02);
    let start = program.variables_at(&forward);
    let (named, _) = program.name(&start, &[Mode::Free], &CancelFlag::default());
    let named = named.expect("named");
    let end = named.end.expect("an exact end");
    assert!(scene.loading().gap(0, &end).abs() < 1e-13);
    let reaction = end.reactions[0];
    assert!(reaction.normal > 0.0, "{reaction:?}");
    let traction = in_plane(&reaction);
    assert!((traction[0].hypot(traction[1]) - 0.2 * reaction.normal).abs() < 1e-13 * reaction.normal.max(1.0));
    let slip = slip_in_plane(named.modes[0]);
    let moved = [end.displacement[3], end.displacement[4], 0.0];
    let size = dot(&moved, &moved).sqrt();
    assert!(dot(&slip, &moved) / size > 0.999, "{slip:?} against {moved:?}");
}

/// Without the program, from a predictor that knows no reaction and no direction of slip: the residual falls to
/// round-off, at the end quadratically.
#[test]
fn the_landing_converges_quadratically_from_the_predictor() {
    let scene = OneBar::new([0.0, 0.1, 1.0], [-1.4, 0.0, 0.004], 0.2, [1.0, 0.2, -0.4]);
    let base = scene.at_rest();
    let forward = scene.rate([0.8, 0.1, -0.5], 0.05);
    let program = IncrementProgram::new(scene.loading(), &base, &forward, 0.02, 0.02);
    let end =
        solution_extraction::polish(&program, &program.variables_at(&forward), &CancelFlag::default()).expect("finite");
    println!("residuals of the landing: {:?}", end.residuals);
    assert!(end.is_converged, "{:?}", end.residuals);
    assert!(end.residuals.last().is_some_and(|last| *last < 1e-14), "{:?}", end.residuals);
    let small: Vec<f64> = end.residuals.iter().copied().filter(|size| *size < 1e-3).collect();
    assert!(small.len() >= 3, "{:?}", end.residuals);
    for pair in small.windows(2) {
        assert!(pair[1] <= 100.0 * pair[0] * pair[0] + 1e-14, "{:?}", end.residuals);
    }
}

/// A tip near the floor that stays open, and one that leaves the floor: the undetermined bound on the slip does no
/// harm.
#[test]
fn a_tip_that_is_apart_at_the_end_bears_nothing() {
    for (height, pattern, tip) in [(0.01, [1.0, 0.2, 0.0], [0.8, 0.1, 0.0]), (0.0, [0.3, 0.0, 1.0], [0.1, 0.0, 0.5])] {
        let scene = OneBar::new([0.0, 0.1, 1.0], [-1.4, 0.0, height], 0.2, pattern).with_spring(0.5);
        let base = scene.at_rest();
        let forward = scene.rate(tip, 0.05);
        let mut program = IncrementProgram::new(scene.loading(), &base, &forward, 0.02, 0.02);
        assert_eq!(program.pairs(), 1, "the floor is within reach");
        let start = program.variables_at(&forward);
        let (named, _) = program.name(&start, &[Mode::Free], &CancelFlag::default());
        let named = named.expect("named");
        assert_eq!(named.modes, [Mode::Free]);
        let end = named.end.expect("an exact end");
        assert!((base.distance(&end) - 0.02).abs() < 1e-14);
        assert!(end.reactions[0].size() < 1e-14, "{:?}", end.reactions[0]);
        assert!(scene.loading().gap(0, &end) > 1e-4);
    }
}

/// Pushed by less than the friction bound, the tip sticks; only the load changes in the increment.
#[test]
fn a_pressed_tip_sticks() {
    let scene = OneBar::new([0.0, 0.1, 1.0], [-1.4, 0.0, 0.0], 0.8, [0.3, 0.1, -1.0]);
    let base = scene.at_rest();
    let forward = scene.rate([0.0; 3], 1.0);
    let mut program = IncrementProgram::new(scene.loading(), &base, &forward, 0.02, 0.02);
    let start = program.variables_at(&forward);
    let (named, _) = program.name(&start, &[Mode::Stick], &CancelFlag::default());
    let named = named.expect("named");
    assert_eq!(named.modes, [Mode::Stick]);
    let end = named.end.expect("an exact end");
    assert!((end.load - 0.02).abs() < 1e-14 && end.displacement.iter().all(|u| u.abs() < 1e-14));
    assert!((end.reactions[0].normal - 0.02).abs() < 1e-14);
}

/// Functions and derivatives against finite differences, at a generic point.
#[test]
fn derivatives_are_those_of_differences() {
    let scene = OneBar::new([0.0, 0.1, 1.0], [-1.4, 0.0, 0.004], 0.2, [1.0, 0.2, -0.4]);
    let mut base = scene.at_rest();
    base.reactions[0] = on_floor(0.01, [-0.001, 0.0015]);
    let forward = scene.rate([0.8, 0.1, -0.5], 0.05);
    let program = IncrementProgram::new(scene.loading(), &base, &forward, 0.05, 0.02);
    let n = program.variables();
    let (equalities, pairs, in_cones) = (program.equalities(), program.pairs(), 3 * program.cone_sizes().len());
    assert_eq!((n, equalities, pairs, in_cones), (10, 5, 1, 3));
    let x = DVector::from_fn(n, |i, _| 0.3 - 0.11 * i as f64 + 0.05 * (i * i % 7) as f64);
    // All functions, in one vector, and their gradients.
    let values = |x: &DVector<f64>| {
        let mut all = vec![program.objective(x)];
        let (mut h, mut a, mut b) = (DVector::zeros(equalities), DVector::zeros(pairs), DVector::zeros(pairs));
        program.equality_values(x, &mut h);
        program.pair_values(x, &mut a, &mut b);
        let (mut first, mut second) = (DVector::zeros(in_cones), DVector::zeros(in_cones));
        program.cone_values(x, &mut first, &mut second);
        for part in [h, a, b, first, second] {
            all.extend(part.iter());
        }
        DVector::from_vec(all)
    };
    let mut exact = DMatrix::zeros(1 + equalities + 2 * pairs + 2 * in_cones, n);
    let mut gradient = DVector::zeros(n);
    program.objective_gradient(&x, &mut gradient);
    exact.set_row(0, &gradient.transpose());
    let (mut h, mut a, mut b) =
        (SparseRows::zeros(equalities, n), SparseRows::zeros(pairs, n), SparseRows::zeros(pairs, n));
    program.equality_jacobian(&x, &mut h);
    program.pair_jacobians(&x, &mut a, &mut b);
    let (mut first, mut second) = (DMatrix::zeros(in_cones, n), DMatrix::zeros(in_cones, n));
    program.cone_jacobians(&x, &mut first, &mut second);
    let mut row = 1;
    for part in [h.to_dense(), a.to_dense(), b.to_dense(), first, second] {
        exact.rows_mut(row, part.nrows()).copy_from(&part);
        row += part.nrows();
    }
    for j in 0..n {
        let moved = |step: f64| {
            let mut moved = x.clone();
            moved[j] += step;
            values(&moved)
        };
        let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        let miss = (difference - exact.column(j)).amax();
        assert!(miss < 1e-7, "column {j}: {miss:e}");
    }
}

/// With `r_t⁽ᵏ⁾ = 0` the step is `γ2/γ1` times the previous direction plus a combination of the gradients of the active
/// constraints: equilibrium, and those of the cone's branch.
#[test]
fn karush_kuhn_tucker_conditions_of_the_increment_in_space() {
    let scene = OneBar::new([0.0, 0.1, 1.0], [-1.4, 0.0, 0.0], 0.8, [1.0, 0.0, 0.0]);
    let base = scene.at_rest();
    let forward = scene.rate([1.0, -0.1, 0.0], 0.3);
    let mut program = IncrementProgram::new(scene.loading(), &base, &forward, 0.02, 0.05);
    program.forward_weight = 0.7;
    program.arc_weight = 1.3;
    let start = program.variables_at(&forward);
    let solution = mpec::solve(&program, &start, &Settings::warm(), &CancelFlag::default()).unwrap();
    assert!(
        matches!(solution.status, mpec::SolveStatus::Solved | mpec::SolveStatus::Feasible),
        "{:?}",
        solution.status
    );
    let x = &solution.x;
    let moved = x.rows(0, 4).norm();
    assert!(moved > 0.05, "the step must not be zero, {moved}");
    let n = program.variables();
    let mut equalities = SparseRows::zeros(program.equalities(), n);
    program.equality_jacobian(x, &mut equalities);
    let mut columns: Vec<DVector<f64>> = equalities.to_dense().row_iter().map(|row| row.transpose()).collect();
    let (mut gap, mut reaction) = (SparseRows::zeros(1, n), SparseRows::zeros(1, n));
    program.pair_jacobians(x, &mut gap, &mut reaction);
    columns.push(gap.to_dense().row(0).transpose());
    assert_eq!(solution.cone_activity, [mpec::ConeActivity::BothOnBoundary]);
    // The complementarity of a pair on the boundary: the derivative of its natural map, independent of the solver's
    // rows.
    let (mut a, mut b) = (DVector::zeros(3), DVector::zeros(3));
    program.cone_values(x, &mut a, &mut b);
    let (mut first, mut second) = (DMatrix::zeros(3, n), DMatrix::zeros(3, n));
    program.cone_jacobians(x, &mut first, &mut second);
    let projection = mpec::program::cone::projection_derivative((&a - &b).as_slice());
    let natural = &first - projection * (&first - &second);
    columns.extend(natural.row_iter().map(|row| row.transpose()));
    let gradients = DMatrix::from_columns(&columns);
    let mut step = DVector::zeros(n);
    let direction = program.variables_at(&forward);
    for k in 0..4 {
        step[k] = x[k] - program.forward_weight / program.arc_weight * direction[k];
    }
    assert!(step.norm() > 1e-3 * moved, "the gradients have something to explain");
    let fitted = gradients.clone().svd(true, true).solve(&step, 1e-12).unwrap();
    let rest = (&gradients * fitted - &step).amax();
    assert!(rest < 1e-7, "{rest:e} is left");
}
