//! A snap-fit: a cantilever hook that is pushed over a catch and pulled back out.

use super::{Sheet, faces, moved, support, whole_path};
use crate::common::paths::request;
use arcslip::result::increment::{Increment, Status};
use serde_json::{Value, json};

const LENGTH: f64 = 10.0;
const BARB: f64 = 0.8;
const GENTLE: f64 = 3.0;
const STEEP: f64 = 2.0;
const STROKE: f64 = 9.0;

/// From 1 at the apex down to 0: a gentle flank on the side of positive `x`, a steep one on the other; curvature is
/// continuous.
fn barb(x: f64) -> f64 {
    let down = (if x > 0.0 { x / GENTLE } else { -x / STEEP }).min(1.0);
    1.0 - down.powi(3) * (10.0 - 15.0 * down + 6.0 * down * down)
}

/// The hook above the catch; the gentle flanks meet first on the way in, the steep ones on the way out.
fn snap_fit(friction: f64, swapped: bool, fineness: usize) -> Value {
    let (columns, rows) = (20 * fineness, 2 * fineness);
    let hook = Sheet::new("h", [columns, rows], |x, y| {
        let (along, lower) = (x * LENGTH, -BARB * barb(x * LENGTH - (LENGTH - GENTLE)));
        [along, lower + y * (1.0 - lower)]
    });
    let catch = Sheet::new("c", [columns, rows], |x, y| {
        let along = 5.5 + x * LENGTH;
        [along, -2.5 + y * (BARB * barb(12.5 - along) - BARB - 0.05 + 2.5)]
    });
    let (mut nodes, mut elements) = (hook.nodes.clone(), hook.elements.clone());
    nodes.extend(catch.nodes.clone());
    elements.extend(catch.elements.clone());
    let (surface, against) = if swapped { ("catch", "barb") } else { ("barb", "catch") };
    let mut model = json!({
        "name": "snap-fit", "dimension": 2, "nodes": nodes, "elements": elements, "supports": {},
        "materials": {"matter": {"kind": "neo_hookean", "young": 1e3, "poisson": 0.3}},
        "surfaces": {"barb": faces(&hook.lowest()[columns / 3..]), "catch": faces(&catch.highest())},
        "contacts": [{"surface": surface, "against": against, "friction": friction}],
    });
    let root: Vec<String> = (0..=rows).map(|row| hook.name(0, row)).collect();
    support(&mut model, &root, &["x", "y"]);
    support(&mut model, &catch.lowest(), &["x", "y"]);
    model["stages"] = json!([
        {"name": "in", "displacements": moved(&root, [STROKE, 0.0]), "until": {"load_above": 1}},
        {"name": "out", "displacements": moved(&root, [-STROKE, 0.0]), "until": {"load_above": 1}},
    ]);
    json!({"model": model, "analysis": {"max_increments": 4000}})
}

/// The largest force that the root needs in a stage: forwards on the way in, backwards on the way out.
fn largest_force(increments: &[Increment], stage: &str, sign: f64) -> f64 {
    let force = |increment: &Increment| -> f64 {
        increment.supports.iter().filter(|(node, _)| node.starts_with('h')).map(|(_, force)| sign * force[0]).sum()
    };
    increments.iter().filter(|increment| &*increment.stage == stage).map(force).fold(0.0, f64::max)
}

/// The forces in and out.
fn forces(friction: f64, swapped: bool, fineness: usize) -> [f64; 2] {
    let what = format!("friction {friction}, swapped {swapped}, fineness {fineness}");
    let increments = whole_path(&request(&snap_fit(friction, swapped, fineness).to_string()));
    // Clear of the catch, the hook is where it began, free of stress.
    let last = increments.last().expect("an increment");
    assert!(last.contacts.iter().all(|contact| contact.status == Status::Free), "{what}");
    let moved = last.displacements.values().flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert!(moved < 1e-9, "{what}: {moved:e}");
    let found = [largest_force(&increments, "in", 1.0), largest_force(&increments, "out", -1.0)];
    println!("{what}: {} increments, in and out {found:?}", increments.len());
    found
}

/// Whole paths in and out, either surface with the multipliers. Without friction the way back is the way in: the hook needs
/// the force out that held it back past the apex. Friction adds to both.
#[test]
#[ignore = "half a minute in a release build"]
fn a_snap_fit_goes_in_and_out() {
    let [smooth, rough] = [0.0, 0.2].map(|friction| [false, true].map(|swapped| forces(friction, swapped, 1)));
    for (smooth, rough) in smooth.iter().zip(&rough) {
        assert!(smooth[0] < smooth[1], "the steep flank holds better: {smooth:?}");
        assert!(rough[0] > 1.5 * smooth[0] && rough[1] > 1.2 * smooth[1], "{smooth:?}, {rough:?}");
    }
    for found in [smooth, rough] {
        for (one, other) in found[0].iter().zip(found[1]) {
            assert!((one / other - 1.0).abs() < 0.1, "{found:?}");
        }
    }
}
