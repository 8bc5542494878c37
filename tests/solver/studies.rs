//! Studies of whole scenes: error against the exact solution or a self-converged path, orders, events, text.

use crate::common::paths::scene;
use arcslip::model::request::Method;
use arcslip::model::request::study::{ReferenceChoice, Study, StudyRequest};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::stop_reason::StopReason;
use arcslip::studies::error_against_time::{self, ReferenceKind, StudyReport, StudyRow, StudyRun};
use std::ops::ControlFlow;

fn request(name: &str, study: Study) -> StudyRequest {
    let job = scene(name);
    StudyRequest { model: job.model, analysis: job.analysis, study }
}

fn over(arc_lengths: &[f64], methods: &[Method]) -> Study {
    Study { arc_lengths: Some(arc_lengths.to_vec()), methods: Some(methods.to_vec()), repeats: 1, ..Study::default() }
}

fn run(request: &StudyRequest) -> StudyReport {
    let report =
        error_against_time::run(request, Vec::new(), &CancelFlag::default(), &mut |_| ControlFlow::Continue(()));
    let report = report.unwrap_or_else(|errors| panic!("{errors}")).expect("a report");
    println!("{}", error_against_time::table::text(&report).expect("text"));
    report
}

fn rows(report: &StudyReport, method: Method) -> Vec<&StudyRow> {
    report.rows.iter().filter(|row| row.method == method).collect()
}

fn order(report: &StudyReport, method: Method) -> Option<f64> {
    report.orders.iter().find(|order| order.method == method).expect("the method's order").order
}

const ALL: [Method; 3] = [Method::Auto, Method::Mpec, Method::Regularised];

#[test]
fn one_bar_truss_is_exact_but_for_the_rival() {
    let report = run(&request("one-bar-truss", over(&[0.1, 0.05, 0.02], &ALL)));
    assert_eq!(report.reference.kind, ReferenceKind::Exact);
    for row in report.rows.iter().filter(|row| row.method != Method::Regularised) {
        assert!(row.path_error.expect("an error") < 1e-14, "{row:?}");
        assert!(!row.resolved && row.order.is_none());
        assert_eq!((row.events.expected, row.events.found, row.events.others), (3, 3, 0), "{row:?}");
        assert!(row.events.largest_error.expect("an error") < 1e-8, "{row:?}");
        assert_eq!(row.stop_reason, StopReason::Mechanism);
        assert!(row.time.expect("a time").median_s > 0.0);
    }
    // The rival's penalty is 1e4: penetration and elastic slip of 1e-4, whatever the step.
    for row in rows(&report, Method::Regularised) {
        assert!(row.resolved && row.path_error.expect("an error") > 1e-6, "{row:?}");
    }
}

#[test]
fn penalties_have_order_minus_one() {
    let mut study =
        request("klarbring", Study { penalties: Some(vec![1e2, 1e3, 1e4, 1e5]), repeats: 0, ..Study::default() });
    study.analysis.arc_length.max = 0.05;
    let report = run(&study);
    assert_eq!(report.rows.len(), 4);
    assert!(report.rows.iter().all(|row| row.method == Method::Regularised && row.time.is_none()));
    let order = order(&report, Method::Regularised).expect("an order");
    assert!((-1.2..-0.8).contains(&order), "order {order}");
}

#[test]
fn curving_slip_is_of_fourth_order_against_both_references() {
    let ladder = over(&[0.04, 0.02, 0.01, 0.005], &[Method::Auto]);
    let exact = run(&request("curving-slip", ladder.clone()));
    let fine = run(&request("curving-slip", Study { reference: ReferenceChoice::SelfConverged, ..ladder }));
    assert_eq!((exact.reference.kind, fine.reference.kind), (ReferenceKind::Exact, ReferenceKind::SelfConverged));
    for report in [&exact, &fine] {
        let order = order(report, Method::Auto).expect("an order");
        assert!((3.3..4.7).contains(&order), "order {order}");
    }
    // The two references tell the same errors, as far as the second one resolves them.
    for (exact, fine_row) in exact.rows.iter().zip(&fine.rows) {
        let (a, b) = (exact.path_error.expect("an error"), fine_row.path_error.expect("an error"));
        assert!((a - b).abs() <= 0.01 * a + fine.reference.floor, "{a:e} and {b:e}");
    }
}

#[test]
fn arch_is_measured_against_a_finer_path() {
    let report = run(&request("arch-type-truss", over(&[0.1, 0.05, 0.025], &ALL)));
    assert_eq!(report.reference.kind, ReferenceKind::SelfConverged);
    assert!(report.reference.uncertainty.expect("an uncertainty") < 1e-9, "{:?}", report.reference);
    for row in report.rows.iter().filter(|row| row.method != Method::Regularised) {
        assert!(row.path_error.expect("an error") < 1e-9, "{row:?}");
        assert_eq!(row.events.found, row.events.expected, "{row:?}");
        assert_eq!(row.events.others, 0, "{row:?}");
    }
    assert!(rows(&report, Method::Regularised).iter().all(|row| row.resolved));
}

#[test]
fn capstan_is_measured_against_a_finer_path() {
    let report = run(&request("capstan", over(&[0.1, 0.05], &[Method::Auto, Method::Regularised])));
    assert_eq!(report.reference.kind, ReferenceKind::SelfConverged);
    for row in rows(&report, Method::Auto) {
        assert!(row.path_error.expect("an error") < 1e-9, "{row:?}");
        assert_eq!(row.events.found, row.events.expected, "{row:?}");
    }
}

/// Every exact family: the solver's points lie on its curve, and its events are found.
#[test]
fn scenes_with_exact_paths_lie_on_them() {
    for name in ["one-bar-truss-rough", "klarbring", "slider-chain", "hump", "bowl", "von-mises-truss"] {
        let report = run(&request(name, over(&[0.1], &[Method::Auto, Method::Mpec])));
        assert_eq!(report.reference.kind, ReferenceKind::Exact, "{name}");
        for row in &report.rows {
            assert!(row.path_error.expect("an error") < 1e-12, "{name}: {row:?}");
            assert_eq!((row.events.found, row.events.others), (row.events.expected, 0), "{name}: {row:?}");
            assert!(row.events.largest_error.expect("an error") < 1e-7, "{name}: {row:?}");
        }
    }
    let report = run(&request("turning-drag", over(&[0.02, 0.01], &[Method::Auto])));
    assert_eq!(report.reference.kind, ReferenceKind::Exact);
    assert!(report.rows.iter().all(|row| row.path_error.expect("an error") < 1e-6));
}

#[test]
fn a_study_that_was_broken_off_goes_on_to_the_same_rows() {
    let request = request("klarbring", Study { repeats: 2, ..over(&[0.2, 0.1], &[Method::Auto, Method::Regularised]) });
    let mut runs: Vec<StudyRun> = Vec::new();
    let until = |bound: usize, runs: &mut Vec<StudyRun>| {
        let done = runs.clone();
        error_against_time::run(&request, done, &CancelFlag::default(), &mut |run| {
            runs.push(run.clone());
            if runs.len() == bound { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .expect("a study")
    };
    assert!(until(3, &mut runs).is_none());
    assert!(until(6, &mut runs).is_none());
    let report = until(usize::MAX, &mut runs).expect("a report");
    assert_eq!(runs.len(), 12);
    assert!(runs.iter().enumerate().all(|(index, run)| run.index == index as u64));
    assert!(report.complete && report.rows.iter().all(|row| row.time.expect("a time").repeats == 2));
    let whole = run(&request);
    let timeless = |report: &StudyReport| -> Vec<StudyRow> {
        report.rows.iter().map(|row| StudyRow { time: None, ..row.clone() }).collect()
    };
    assert_eq!(timeless(&report), timeless(&whole));
}

#[test]
fn a_cancelled_study_reports_what_it_has() {
    let request = request("klarbring", Study { repeats: 2, ..over(&[0.2, 0.1], &[Method::Auto]) });
    let cancel = CancelFlag::default();
    let report = error_against_time::run(&request, Vec::new(), &cancel, &mut |_| {
        cancel.cancel();
        ControlFlow::Continue(())
    });
    let report = report.expect("a study").expect("a report");
    assert_eq!(report.rows.len(), 1);
    assert!(!report.complete);
    assert!(error_against_time::table::text(&report).expect("text").contains("not complete"));
}

#[test]
fn tables_have_a_line_a_row() {
    let report = run(&request("klarbring", over(&[0.2, 0.1], &ALL)));
    let csv = error_against_time::table::csv(&report).expect("CSV");
    let cells: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(cells.len(), 7);
    assert!(cells.iter().all(|line| line.len() == cells[0].len()));
    let column = |name: &str| cells[0].iter().position(|cell| *cell == name).expect("a column");
    for (row, line) in report.rows.iter().zip(&cells[1..]) {
        assert_eq!(line[column("path_error")].parse().ok(), row.path_error);
        assert_eq!(line[column("increments")], row.increments.to_string());
        assert_eq!(line[column("reference")], "exact");
    }
    let text = error_against_time::table::text(&report).expect("text");
    assert!(text.contains("exact solution, Klarbring's node"));
    let json = serde_json::to_string(&report).expect("JSON");
    assert_eq!(serde_json::from_str::<StudyReport>(&json).expect("the same"), report);
}
