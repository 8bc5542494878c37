//! Frames at the ends of what is drawn: stiffnesses far apart, units far from one, a single element.

use crate::common::paths::{close, trace, typed};
use crate::common::variants::in_units;
use arcslip::model::JobRequest;
use arcslip::result::increment::Increment;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// A cantilever of one element of `nodes` nodes along x, of length 1.
fn cantilever(nodes: usize, axial: f64, bending: f64, stage: &Value) -> JobRequest {
    let name = |k: usize| format!("n{k}");
    let places: serde_json::Map<String, Value> =
        (0..nodes).map(|k| (name(k), json!([k as f64 / (nodes - 1) as f64, 0.0]))).collect();
    let names: Vec<String> = (0..nodes).map(name).collect();
    typed(json!({
        "model": {
            "dimension": 2, "nodes": places, "supports": {"n0": ["x", "y", "rz"]},
            "elements": [
                {"kind": "beam", "nodes": names, "axial_stiffness": axial, "bending_stiffness": bending}
            ],
            "stages": [stage],
        },
        "analysis": {"max_increments": 2000},
    }))
}

fn last(increments: &[Increment]) -> &Increment {
    increments.last().expect("an end")
}

/// One element bends into a circle under an end moment, and stretches by `P L/EA` under an end force, whatever the ratio of
/// its stiffnesses.
#[test]
fn one_element_with_stiffnesses_far_apart() {
    for (axial, bending) in [(1e12, 1.0), (1.0, 1e-12), (1e6, 1e-6), (1e-6, 1e6), (1.0, 1e12), (1e-12, 1.0)] {
        for nodes in [2, 3] {
            let what = format!("EA = {axial:e}, EI = {bending:e}, {nodes} nodes");
            let tip = format!("n{}", nodes - 1);
            let roll = json!({"name": "roll", "moments": {&tip: TAU * bending}, "until": {"load_above": 1}});
            let (increments, report) = trace(&cantilever(nodes, axial, bending, &roll));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}: {report:?}");
            let [x, y, turn] = last(&increments).displacements[tip.as_str()][..] else { panic!("three components") };
            println!("{what}: {} increments, {x:.12} {y:.1e} {turn:.12}", increments.len());
            assert!((x + 1.0).abs() < 1e-9 && y.abs() < 1e-9 && (turn - TAU).abs() < 1e-9, "{what}: {x} {y} {turn}");
            let force = 0.3 * axial.min(bending);
            let pull = json!({"name": "pull", "forces": {&tip: [force, 0]}, "until": {"load_above": 1}});
            let (increments, report) = trace(&cantilever(nodes, axial, bending, &pull));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}: {report:?}");
            let (moved, exact) = (last(&increments).displacements[tip.as_str()][0], force / axial);
            println!("  {} increments, {moved:e}, exact {exact:e}", increments.len());
            assert!((moved / exact - 1.0).abs() < 1e-8, "{what}: pulled by {moved:e}, not {exact:e}");
        }
    }
}

/// Half an arch of so many elements, its crown pressed down and its foot on a rough floor.
fn arch(count: u32) -> JobRequest {
    let name = |k: usize| format!("n{k}");
    let place = |k: usize| {
        let angle = 0.25 * TAU * k as f64 / f64::from(count);
        json!([angle.sin(), angle.cos()])
    };
    let nodes: serde_json::Map<String, Value> = (0..=count as usize).map(|k| (name(k), place(k))).collect();
    let beam = |k: usize| json!({"kind": "beam", "nodes": [name(k), name(k + 1)], "axial_stiffness": 1e5, "bending_stiffness": 1.0});
    typed(json!({"model": {
        "dimension": 2, "nodes": nodes, "supports": {"n0": ["x", "rz"]},
        "elements": (0..count as usize).map(beam).collect::<Vec<_>>(),
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": name(count as usize), "obstacle": "floor", "friction": 0.8}],
        "stages": [{"name": "press", "forces": {"n0": [0, -1]}, "until": {"limit_points": 2}}],
    }}))
}

#[test]
fn units_far_from_one_change_nothing_but_round_off() {
    let (plain, _) = trace(&arch(12));
    for (length, force) in [(1e12, 1.0), (1e-12, 1.0), (1.0, 1e12), (1.0, 1e-12), (1e12, 1e-12), (1e-12, 1e12)] {
        let (other, _) = trace(&in_units(arch(12), length, force));
        let what = format!("units of {length:e}, {force:e}");
        assert_eq!(other.len(), plain.len(), "{what}");
        for (a, b) in plain.iter().zip(&other) {
            assert_eq!((a.point.kind, a.contacts[0].status), (b.point.kind, b.contacts[0].status), "{what}");
            for (name, moved) in a.displacements.iter() {
                let moved_b = &b.displacements[name];
                let scaled = [moved_b[0] / length, moved_b[1] / length, moved_b[2]];
                let apart = moved.iter().zip(scaled).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-9, "{what}, increment {}: {name} by {apart:e}", a.index);
            }
        }
    }
}

/// The rounding of displacements strains elements a thousandth long by more than the load does. States keep what it leaves:
/// no residual shows it, and the load minimum lies where a tenth of the elements finds it, but for their error.
#[test]
fn the_rounding_of_displacements_moves_no_arch_of_short_elements() {
    let [coarse, fine] = [100, 1_000].map(|count| {
        let mut request = arch(count);
        request.analysis.max_increments = 2_000;
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count} elements");
        assert!(report.largest_residual < 1e-9, "{count} elements: {:e}", report.largest_residual);
        last(&increments).load_factor
    });
    close(coarse / fine, 1.0, 1e-5, "the load minimum");
}

/// A ball comes down on a slender cantilever of so many elements, from a gap, until the node below has sunk by 0.3.
fn ball_on_a_cantilever(count: usize, axial: f64, gap: f64) -> JobRequest {
    let name = |k: usize| format!("n{k}");
    let nodes: serde_json::Map<String, Value> =
        (0..=count).map(|k| (name(k), json!([k as f64 / count as f64, 0]))).collect();
    let beam = |k: usize| json!({"kind": "beam", "nodes": [name(k), name(k + 1)], "axial_stiffness": axial, "bending_stiffness": 1.0});
    let below = name(count * 4 / 5);
    typed(json!({"model": {
        "dimension": 2, "nodes": nodes, "supports": {"n0": ["x", "y", "rz"]},
        "elements": (0..count).map(beam).collect::<Vec<_>>(),
        "obstacles": {"ball": {"kind": "ball", "center": [0.8, 0.2 + gap], "radius": 0.2}},
        "contacts": [{"node": below, "obstacle": "ball", "friction": 0.3}],
        "stages": [{
            "name": "down", "obstacle_motion": {"ball": [0, -1]},
            "until": {"displacement": {"node": below, "component": "y", "below": -0.3}},
        }],
    }}))
}

/// The stretch of a slender beam carries a node that sticks after a millionth of the ball's way, where the rounding of the load
/// factor, which moves the ball, strains the beam by more than the accepted residual. The gap before the touch changes nothing.
#[test]
fn the_rounding_of_the_load_that_moves_a_ball_strains_no_beam() {
    for (count, axial) in [(20, 1e6), (40, 1e6), (20, 1e8)] {
        let [touching, apart] = [0.0, 1e-3].map(|gap| {
            let (increments, report) = trace(&ball_on_a_cantilever(count, axial, gap));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count} elements, EA = {axial:e}, gap {gap}");
            last(&increments).contacts[0].normal_reaction
        });
        close(apart / touching, 1.0, 1e-7, "the force of the ball");
    }
}

/// The load at which a ring of so many elements, pressed onto a floor, is as high as its radius. Its foot opens, and what
/// lies between its two feet comes to lie flat each time that one of them is unloaded: there its reaction and the gaps of
/// all nodes between, which are of second order, vanish together.
fn load_of_ring(count: u32, friction: f64) -> f64 {
    let name = |k: u32| format!("n{}", k % count);
    let place = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count);
        [angle.sin(), angle.cos()]
    };
    let nodes: serde_json::Map<String, Value> = (0..count).map(|k| (name(k), json!(place(k)))).collect();
    let beam = |k: u32| json!({"kind": "beam", "nodes": [name(k), name(k + 1)], "axial_stiffness": 1e4, "bending_stiffness": 1.0});
    let low = (0..count).filter(|k| place(*k)[1] < -0.3);
    let contact = |k: u32| json!({"node": name(k), "obstacle": "floor", "friction": friction});
    let until = json!({"displacement": {"node": "n0", "component": "y", "below": -1.0}});
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": (0..count).map(beam).collect::<Vec<_>>(),
            "supports": {"n0": ["x", "rz"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, -1], "normal": [0, 1]}},
            "contacts": low.map(contact).collect::<Vec<_>>(),
            "stages": [{"name": "press", "forces": {"n0": [0, -1]}, "until": until}],
        },
        "analysis": {"record": {"nodes": ["n0"], "elements": "none"}},
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count} elements, friction {friction}");
    last(&increments).load_factor
}

/// The load changes by 2e-4 from 100 to 200 elements, by 2e-5 from 200 to 400 and to 600, by 2e-6 from 600 to 1,000.
#[test]
fn the_foot_of_a_ring_opens_on_a_smooth_floor() {
    let loads = [100, 200, 400, 600, 1_000].map(|count| load_of_ring(count, 0.0));
    println!("{loads:.8?}");
    for (pair, bar) in loads.windows(2).zip([2e-4, 2e-5, 2e-5, 1e-5]) {
        close(pair[1] / pair[0], 1.0, bar, "the load of a finer ring");
    }
}

/// A ring of a thousand elements sticks where it rolls outwards: the load is that on a smooth floor but for 2e-6, whatever
/// the friction.
#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver frame_extremes -- --ignored"]
fn a_ring_of_a_thousand_elements_rolls_on_a_rough_floor() {
    let smooth = load_of_ring(1_000, 0.0);
    let loads = [0.3, 1.0].map(|friction| load_of_ring(1_000, friction));
    println!("{smooth:.8} {loads:.8?}");
    close(loads[0] / smooth, 1.0, 2e-6, "the load on a rough floor");
    close(loads[1] / loads[0], 1.0, 1e-9, "the load on a rougher floor");
}

/// The load that lowers the top of a ring by a tenth of its perimeter. A third of the ring is drawn flat and lies on a
/// floor: so many contacts touch without force, of which the two at the ends of the flat stretch are pressed.
fn load_of_flat_ring(count: usize, friction: f64) -> f64 {
    let flat = count / 3;
    // The arc of length 2 over a chord of length 1: half the angle of the rest of its circle.
    let (mut low, mut high) = (0.1_f64, 3.0_f64);
    for _ in 0..100 {
        let half = 0.5 * (low + high);
        if (std::f64::consts::PI - half) / half.sin() > 2.0 { low = half } else { high = half }
    }
    let radius = 0.5 / low.sin();
    let place = |k: usize| {
        if k <= flat {
            return [k as f64 / flat as f64 - 0.5, 0.0];
        }
        let part = (k - flat) as f64 / (count - flat) as f64;
        let angle = low - 0.5 * std::f64::consts::PI + 2.0 * (std::f64::consts::PI - low) * part;
        [radius * angle.cos(), radius * (low.cos() + angle.sin())]
    };
    let name = |k: usize| format!("n{}", k % count);
    let top = name((0..count).max_by(|a, b| place(*a)[1].total_cmp(&place(*b)[1])).expect("nodes"));
    let nodes: serde_json::Map<String, Value> = (0..count).map(|k| (name(k), json!(place(k)))).collect();
    let beam = |k: usize| json!({"kind": "beam", "nodes": [name(k), name(k + 1)], "axial_stiffness": 1e4, "bending_stiffness": 1.0});
    let contact = |k: usize| json!({"node": name(k), "obstacle": "floor", "friction": friction});
    let until = json!({"displacement": {"node": top, "component": "y", "below": -0.3}});
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": (0..count).map(beam).collect::<Vec<_>>(),
            "supports": {&top: ["x", "rz"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": (0..count).filter(|k| place(*k)[1] < 0.3).map(contact).collect::<Vec<_>>(),
            "stages": [{"name": "press", "forces": {&top: [0, -1]}, "until": until}],
        },
        "analysis": {"record": {"nodes": [&top], "elements": "none"}},
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{count} elements, friction {friction}");
    last(&increments).load_factor
}

#[test]
fn a_ring_of_which_a_third_lies_on_a_floor_is_pressed() {
    for friction in [0.0, 0.3] {
        let loads = [75, 150, 300].map(|count| load_of_flat_ring(count, friction));
        println!("friction {friction}: {loads:.6?}");
        close(loads[2] / loads[1], 1.0, 2e-3, "the load of a finer ring");
    }
}

#[test]
#[ignore = "a minute in a release build: cargo test --release --test solver frame_extremes -- --ignored"]
fn a_ring_of_a_thousand_elements_of_which_a_third_lies_on_a_floor_is_pressed() {
    for friction in [0.0, 0.3] {
        let loads = [300, 1_000].map(|count| load_of_flat_ring(count, friction));
        println!("friction {friction}: {loads:.6?}");
        close(loads[1] / loads[0], 1.0, 2e-4, "the load of a finer ring");
    }
}
