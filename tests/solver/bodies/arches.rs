//! Two arches that are pressed past each other.

use super::{Sheet, moved, support};
use crate::common::paths::{judged, request};
use arcslip::result::increment::{Increment, PointKind, Status};
use serde_json::{Value, json};

const SPAN: f64 = 10.0;
const RISE: f64 = 1.5;
const THICKNESS: f64 = 0.4;

/// A shallow arch of circular segments, its apex up or down, from the unit square.
fn arch(prefix: &str, columns: usize, corner: [f64; 2], is_upper: bool) -> Sheet {
    let radius = (SPAN * SPAN / 4.0 + RISE * RISE) / (2.0 * RISE);
    let half = (0.5 * SPAN / radius).asin();
    Sheet::new(prefix, [columns, 2], move |x, y| {
        // Seen from below, the upper arch is turned about its middle.
        let (angle, out) = (half * (2.0 * x - 1.0), radius + THICKNESS * (y - 0.5));
        let [along, up] = [out * angle.sin(), out * angle.cos() - radius + RISE];
        if is_upper { [corner[0] - along, corner[1] - up] } else { [corner[0] + along, corner[1] + up] }
    })
}

/// The upper arch is lowered past the lower one; their outer surfaces touch.
fn arches(friction: f64, swapped: bool, columns: [usize; 2]) -> Value {
    let lower = arch("l", columns[0], [0.0, 0.0], false);
    let upper = arch("u", columns[1], [0.6, 2.0 * RISE + THICKNESS + 0.05], true);
    let (mut nodes, mut elements) = (lower.nodes.clone(), lower.elements.clone());
    nodes.extend(upper.nodes.clone());
    elements.extend(upper.elements.clone());
    let (surface, against) = if swapped { ("below", "above") } else { ("above", "below") };
    let mut model = json!({
        "name": "two arches", "dimension": 2, "nodes": nodes, "elements": elements, "supports": {},
        "materials": {"matter": {"kind": "neo_hookean", "young": 1e3, "poisson": 0.3}},
        "surfaces": {"below": super::faces(&lower.highest()), "above": super::faces(&upper.highest())},
        "contacts": [{"surface": surface, "against": against, "friction": friction}],
    });
    let ends = |sheet: &Sheet, columns: usize| -> Vec<String> {
        (0..=2).flat_map(|row| [sheet.name(0, row), sheet.name(columns, row)]).collect()
    };
    let (below, above) = (ends(&lower, columns[0]), ends(&upper, columns[1]));
    support(&mut model, &below, &["x", "y"]);
    support(&mut model, &above, &["x", "y"]);
    model["stages"] = json!([
        {"name": "lower", "displacements": moved(&above, [0.0, -1.0]), "until": {"load_above": 2.0}},
    ]);
    json!({"model": model, "analysis": {"max_increments": 400}})
}

fn largest_load(increments: &[Increment]) -> f64 {
    let pressed = |increment: &Increment| -> f64 {
        increment.supports.iter().filter(|(node, _)| node.starts_with('u')).map(|(_, force)| -force[1]).sum()
    };
    increments.iter().filter(|increment| increment.load_factor < 1.3).map(pressed).fold(0.0, f64::max)
}

/// Complete paths through the snap, with and without friction: measure, energy, nothing passes through, and the greatest
/// force does not depend on which surface carries the multipliers but for the meshes.
#[test]
fn arches_snap_past_each_other() {
    for friction in [0.0, 0.3, 0.6] {
        let mut loads = Vec::new();
        for swapped in [false, true] {
            let traced = judged(&request(&arches(friction, swapped, [16, 12]).to_string()));
            let what = format!("friction {friction}, swapped {swapped}");
            for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
                assert!(errors.largest_of_state() <= 1e-9, "{what}, increment {}: {errors:?}", increment.index);
                assert!(errors.energy <= 1e-6, "{what}, increment {}: {errors:?}", increment.index);
            }
            let last = traced.increments.last().expect("an increment");
            println!(
                "{what}: {} increments to {:.4}, {:?}, largest load {:.5}",
                traced.increments.len(),
                last.load_factor,
                traced.report.stop_reason,
                largest_load(&traced.increments)
            );
            let closed = traced.increments.iter().flat_map(|increment| &increment.contacts);
            assert!(closed.filter(|contact| contact.status == Status::Slip).count() > 100, "{what}");
            assert!(traced.increments.iter().any(|increment| increment.point.kind == PointKind::ContactChange));
            loads.push(largest_load(&traced.increments));
        }
        assert!((loads[0] / loads[1] - 1.0).abs() < 0.05, "friction {friction}: {loads:?}");
    }
}
