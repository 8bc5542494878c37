//! `auto` and `mpec` trace the same path: the same points, events and directions, on every built-in scene.

mod common;

use arcslip::model::request::Method;
use common::paths::{scene, trace};

#[test]
fn auto_and_mpec_agree_on_every_scene() {
    for built_in in arcslip::scenes::ALL {
        let mut request = scene(built_in.name);
        let (by_auto, auto_report) = trace(&request);
        request.analysis.method = Method::Mpec;
        let (by_mpec, mpec_report) = trace(&request);
        assert_eq!(by_auto.len(), by_mpec.len(), "{}", built_in.name);
        assert_eq!(auto_report.stop_reason, mpec_report.stop_reason);
        for (auto, mpec) in by_auto.iter().zip(&by_mpec) {
            let place = format!("{}, increment {}", built_in.name, auto.index);
            assert_eq!(auto.point, mpec.point, "{place}");
            assert_eq!(auto.directions, mpec.directions, "{place}");
            assert!((auto.load_factor - mpec.load_factor).abs() <= 1e-8, "{place}");
            for (a, b) in auto.displacements.values().flatten().zip(mpec.displacements.values().flatten()) {
                assert!((a - b).abs() <= 1e-8, "{place}");
            }
            assert_ne!(mpec.diagnostics.mode_named_by_mpec, Some(false), "{place}: the program names another mode");
        }
        let contacts = !request.model.contacts.is_empty();
        assert_eq!(mpec_report.mpec_solves > 0, contacts, "{}", built_in.name);
        let by_increment = mpec_report.qp_solves as f64 / mpec_report.increments as f64;
        println!("{}: {by_increment:.1} quadratic programs an increment", built_in.name);
    }
}
