//! The increment's optimality conditions.

use crate::complementarity::mpec::{Problem, SparseRows};
use crate::continuation::scene::Scene;
use crate::step::increment_mpec::*;
use nalgebra::DMatrix;

/// The conditions of Karush, Kuhn and Tucker for the increment: with `r_t⁽ᵏ⁾ = 0` the step is `γ2/γ1` times the
/// previous direction plus a combination of the gradients of the active constraints, equilibrium among them.
fn kkt_holds(name: &str, forward: impl Fn(&Scene) -> Rate) {
    let text = crate::check::scenes::find(name).unwrap().request;
    let request = crate::model::decode::decode(text.as_bytes()).unwrap();
    let scene = Scene::new(&request).unwrap();
    let held = scene.stages[0].pattern.zeroed();
    let loading = Loading {
        structure: &scene.structure,
        contacts: &scene.contacts,
        corners: &scene.corners,
        pattern: &scene.stages[0].pattern,
        held: &held,
    };
    let base = State::at_rest(&scene.structure, scene.contacts.len());
    let mut forward = forward(&scene);
    let size = forward.size();
    forward.scale(1.0 / size);
    let mut program = IncrementProgram::new(loading, &base, &forward, 0.02, 0.05);
    program.forward_weight = 0.7;
    program.arc_weight = 1.3;
    let start = program.variables_at(&forward);
    let settings = Settings::warm();
    let solution = mpec::solve(&program, &start, &settings, &CancelFlag::default()).unwrap();
    assert!(
        matches!(solution.status, mpec::SolveStatus::Solved | mpec::SolveStatus::Feasible),
        "{:?}",
        solution.status
    );
    let x = &solution.x;
    let moved = x.rows(0, scene.structure.unknowns() + 1).norm();
    assert!(moved > 0.05, "{name}: the step must not be zero, {moved}");
    // Gradients of all active constraints, one per column.
    let mut equalities = SparseRows::zeros(program.equalities(), program.variables());
    program.equality_jacobian(x, &mut equalities);
    let mut columns: Vec<DVector<f64>> = equalities.to_dense().row_iter().map(|row| row.transpose()).collect();
    let (mut first, mut second) = (DVector::zeros(program.pairs()), DVector::zeros(program.pairs()));
    program.pair_values(x, &mut first, &mut second);
    let mut first_rows = SparseRows::zeros(program.pairs(), program.variables());
    let mut second_rows = first_rows.clone();
    program.pair_jacobians(x, &mut first_rows, &mut second_rows);
    let (first_rows, second_rows) = (first_rows.to_dense(), second_rows.to_dense());
    for pair in 0..program.pairs() {
        if first[pair].abs() < 1e-6 {
            columns.push(first_rows.row(pair).transpose());
        }
        if second[pair].abs() < 1e-6 {
            columns.push(second_rows.row(pair).transpose());
        }
    }
    let gradients = DMatrix::from_columns(&columns);
    // y - (γ2/γ1) d must lie in the span of the gradients.
    let unknowns = scene.structure.unknowns() + 1;
    let mut step = DVector::zeros(program.variables());
    let direction = program.variables_at(&forward);
    for k in 0..unknowns {
        step[k] = x[k] - program.forward_weight / program.arc_weight * direction[k];
    }
    let fitted = gradients.clone().svd(true, true).solve(&step, 1e-12).unwrap();
    let rest = (&gradients * fitted - &step).amax();
    assert!(rest < 1e-7, "{name}: {rest:e} is left");
}

fn towards_the_load(scene: &Scene) -> Rate {
    let pattern = scene.stages[0].pattern.forces.clone();
    // A guess of slip, so that the start selects the branch.
    let pressed = |contact: &crate::mechanics::contact::ContactPair| crate::mechanics::contact::Reaction {
        normal: 0.4,
        tangential: [-0.4 * contact.friction.coefficient, 0.0, 0.0],
    };
    let reactions = scene.contacts.iter().map(pressed).collect();
    Rate { displacement: pattern, load: 0.3, reactions }
}

#[test]
fn karush_kuhn_tucker_conditions_of_the_increment() {
    kkt_holds("von-mises-truss", towards_the_load);
    kkt_holds("one-bar-truss", towards_the_load);
    kkt_holds("two-snapping-bars", towards_the_load);
}
