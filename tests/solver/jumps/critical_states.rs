//! Stability where an eigenvalue is zero: it is neither counted nor taken for growth.

use crate::common::paths::{scene_file, trace, typed};
use arcslip::model::request::Record;
use arcslip::output::Table;
use arcslip::result::increment::{DeadLoadStability, PointKind};
use serde_json::{Map, Value, json};
use std::f64::consts::PI;

#[test]
fn stress_free_starts_are_not_unstable() {
    for scene in ["arch-type-truss", "three-snapping-bars", "four-snapping-bars", "curving-slip", "capstan", "hump"] {
        let mut request = scene_file(scene);
        request.analysis.record.get_or_insert_with(Record::default).stability = true;
        request.analysis.max_increments = 1;
        let start = &trace(&request).0[0];
        let stability = start.stability.expect("asked for");
        assert_ne!(stability.dead_load, DeadLoadStability::Unstable, "{scene}: {stability:?}");
        assert_eq!(stability.negative_eigenvalues.unwrap_or(0), 0, "{scene}");
    }
}

/// A flat arch of beams between two hinges, a little off its symmetry, under a force at its crown.
#[test]
fn beyond_a_few_unknowns_a_limit_point_has_one_zero_eigenvalue() {
    let count = 20;
    let mut nodes = Map::new();
    for k in 0..=count {
        let along = f64::from(k) / f64::from(count);
        let height = 0.15 * (PI * along).sin() + 1e-3 * (2.0 * PI * along).sin();
        nodes.insert(format!("n{k}"), json!([along, height]));
    }
    let elements: Vec<Value> = (0..count)
        .map(|k| {
            let ends = [format!("n{k}"), format!("n{}", k + 1)];
            json!({"kind": "beam", "nodes": ends, "axial_stiffness": 1e4, "bending_stiffness": 1.0})
        })
        .collect();
    let end = format!("n{count}");
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"n0": ["x", "y"], (end): ["x", "y"]},
            "stages": [{"name": "press", "forces": {"n10": [0, -1]}, "until": {"limit_points": 2}}],
        },
        "analysis": {"record": {"stability": true}},
    }));
    let (increments, _) = trace(&request);
    let mut limits = 0;
    for (place, one) in increments.iter().enumerate() {
        let stability = one.stability.expect("asked for");
        if one.point.kind == PointKind::SmoothLimit {
            limits += 1;
            let beside = [&increments[place - 1], increments.get(place + 1).unwrap_or(one)];
            let counts = beside.map(|one| one.stability.expect("asked for").negative_eigenvalues.expect("a count"));
            let own = stability.negative_eigenvalues.expect("a count");
            assert!(own == counts[0].min(counts[1]), "{own} between {counts:?}");
            let unstable = if own > 0 { DeadLoadStability::Unstable } else { DeadLoadStability::Unknown };
            assert_eq!(stability.dead_load, unstable, "{stability:?}");
        }
    }
    assert_eq!(limits, 2);
}

#[test]
fn stability_has_columns_where_it_is_recorded() {
    let mut request = scene_file("von-mises-truss");
    assert!(!Table::of(&request).header().contains("stability"));
    request.analysis.record.get_or_insert_with(Record::default).stability = true;
    let table = Table::of(&request);
    let names = table.names();
    let from = names.iter().position(|name| name == "stability.negative_eigenvalues").expect("a column");
    assert_eq!(names[from..], ["stability.negative_eigenvalues", "stability.dead_load", "stability.instability"]);
    let mut seen = std::collections::BTreeSet::new();
    for increment in trace(&request).0 {
        let stability = increment.stability.expect("asked for");
        let word = |value: Option<Value>| value.unwrap_or(json!(""));
        let [dead_load, instability] =
            [serde_json::to_value(stability.dead_load).ok(), stability.instability.map(|one| json!(one))].map(word);
        let row = table.values(&increment, None, &[from, from + 1, from + 2]);
        assert_eq!(row[0].as_f64(), stability.negative_eigenvalues.map(|count| count as f64));
        assert_eq!(row[1], dead_load);
        assert_eq!(row[2].as_str().unwrap_or_default(), instability.as_str().unwrap_or_default());
        seen.insert(dead_load.to_string());
    }
    assert_eq!(seen.len(), 3, "{seen:?}");
}
