//! Rows of snapping bars by both methods, to where they truly end. (Two and three bars: `exact_scenes`.)

use crate::common::generators::row_of_bars;
use crate::common::paths::{close, scene_file, trace, typed};
use arcslip::model::request::Method;
use arcslip::result::increment::PointKind;
use arcslip::result::stop_reason::StopReason;

#[test]
fn built_in_rows_are_the_generator_s() {
    for (n, name) in [(2, "two-snapping-bars"), (3, "three-snapping-bars"), (4, "four-snapping-bars")] {
        let (file, generated) = (scene_file(name), typed(row_of_bars(n)));
        assert_eq!(file.model.nodes, generated.model.nodes, "{name}");
        assert_eq!(file.model.stages[0].forces, generated.model.stages[0].forces, "{name}");
        assert_eq!(file.model.contacts, generated.model.contacts, "{name}");
        assert_eq!(file.model.elements.len(), generated.model.elements.len(), "{name}");
    }
}

/// One bar snaps alone (formulation, section 4): exhaustive enumeration finds no direction at s = 0.104818.
#[test]
fn four_bars_end_without_a_direction() {
    for method in [Method::Auto, Method::Mpec] {
        let mut request = scene_file("four-snapping-bars");
        request.analysis.method = method;
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::NoDirection);
        let last = increments.last().expect("an end");
        assert_eq!(last.point.kind, PointKind::End);
        close(last.load_factor, 0.104818, 1e-6, "load at the end");
        for (tip, x) in [1.912378, 1.043896, 0.916531, 0.791225].iter().enumerate() {
            close(last.displacements[format!("tip{tip}").as_str()][0], *x, 1e-6, "tip");
        }
    }
}
