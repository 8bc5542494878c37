//! What must hold for every input: the same bits for the same model, and nothing but round-off from other units.

use crate::common::paths::{scene, trace};
use crate::common::variants::{in_units, turned_in_plane};
use arcslip::result::increment::Increment;

/// Everything but the clock, as text.
fn bits(increments: &[Increment]) -> String {
    let mut increments = increments.to_vec();
    increments.iter_mut().for_each(|increment| increment.diagnostics.elapsed_s = 0.0);
    serde_json::to_string(&increments).unwrap()
}

#[test]
fn the_same_model_gives_the_same_bits() {
    for built_in in arcslip::check::scenes::ALL {
        let request = scene(built_in.name);
        let first = bits(&trace(&request).0);
        let handles: Vec<_> = (0..4)
            .map(|_| {
                let request = request.clone();
                std::thread::spawn(move || bits(&trace(&request).0))
            })
            .collect();
        for handle in handles {
            assert_eq!(handle.join().unwrap(), first, "{}", built_in.name);
        }
    }
}

#[test]
fn units_change_nothing_but_round_off() {
    // The capstan is symmetric: at its start two mirror images of each other tie, and round-off chooses.
    for built_in in arcslip::check::scenes::ALL.iter().filter(|scene| scene.name != "capstan") {
        let (plain, _) = trace(&scene(built_in.name));
        for (length, force) in [(1e3, 1e-6), (1e9, 1.0), (1e-9, 1.0), (1.0, 1e9), (1.0, 1e-9), (3.0, 7.0)] {
            let (other, _) = trace(&in_units(scene(built_in.name), length, force));
            let place = format!("{} in units of {length:e}, {force:e}", built_in.name);
            assert_eq!(plain.len(), other.len(), "{place}");
            for (a, b) in plain.iter().zip(&other) {
                assert_eq!(a.point.kind, b.point.kind, "{place}, increment {}", a.index);
                assert_eq!(a.point.bifurcation, b.point.bifurcation, "{place}, increment {}", a.index);
                assert!((a.load_factor - b.load_factor).abs() <= 1e-9, "{place}, increment {}", a.index);
                for (a, b) in a.displacements.values().flatten().zip(b.displacements.values().flatten()) {
                    assert!((a - b / length).abs() <= 1e-8, "{place}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn a_written_increment_reads_back_to_the_same_bits() {
    let (increments, _) = trace(&scene("arch-type-truss"));
    for increment in increments {
        let text = serde_json::to_string(&increment).unwrap();
        let back: Increment = serde_json::from_str(&text).unwrap();
        assert_eq!(back, increment);
        assert_eq!(serde_json::to_string(&back).unwrap(), text);
    }
}

/// Energy balance falls with the step.
#[test]
fn energy_balance_falls_with_the_step() {
    for name in ["one-bar-truss", "arch-type-truss", "von-mises-truss"] {
        let error = |most: f64| {
            let mut request = scene(name);
            request.analysis.arc_length.max = most;
            request.analysis.arc_length.initial = most;
            request.analysis.max_increments = 100_000;
            let (increments, _) = trace(&request);
            increments.last().map_or(f64::NAN, |increment| increment.diagnostics.energy_error)
        };
        let (coarse, fine) = (error(4e-3), error(2e-3));
        assert!(fine < coarse / 8.0, "{name}: {coarse:e} falls to {fine:e}");
    }
}

#[test]
fn axes_and_origin_change_nothing_but_round_off() {
    for name in ["one-bar-truss", "one-bar-truss-rough", "klarbring"] {
        let (plain, _) = trace(&scene(name));
        for (angle, shift, tolerance) in
            [(0.1, 0.0, 1e-8), (1.0, 0.0, 1e-8), (-2.5, 10.0, 1e-8), (0.7, 1e5, 1e-6), (2.5, 1e6, 1e-5)]
        {
            let (other, report) = trace(&turned_in_plane(scene(name), angle, shift));
            let place = format!("{name} turned by {angle}, moved by {shift:e}: {:?}", report.stop_reason);
            // Far away the input itself has fewer digits, and the number of points may differ.
            if shift <= 10.0 {
                assert_eq!(plain.len(), other.len(), "{place}");
            }
            let events = |increments: &[Increment]| -> Vec<(f64, String)> {
                let located = increments.iter().filter(|i| i.point.event.is_some());
                located.map(|i| (i.load_factor, i.point.event.clone().unwrap_or_default())).collect()
            };
            let (plain, other) = (events(&plain), events(&other));
            assert_eq!(plain.len(), other.len(), "{place}");
            for (a, b) in plain.iter().zip(&other) {
                assert_eq!(a.1, b.1, "{place}");
                assert!((a.0 - b.0).abs() <= tolerance, "{place}: {} {}", a.0, b.0);
            }
        }
    }
}
