//! Scenes with many contacts at once.

mod common;

use arcslip::path::increment::PointKind;
use common::generated::{row_of_bars, slider_chain};
use common::paths::trace;

#[test]
#[ignore]
fn probe_slider() {
    let n: usize = std::env::var("N").unwrap().parse().unwrap();
    let began = std::time::Instant::now();
    let (increments, report) = trace(&slider_chain(n, 1.0, 1.0, 0.3));
    println!("{:?} {} increments {:?}", report.stop_reason, increments.len(), began.elapsed());
    for i in &increments {
        if i.index < 3 || i.point.kind != PointKind::Regular {
            println!(
                "{} {} s {:.15} kind {:?} unexpl {} deg {} ev {:?} t {:.3}",
                i.index,
                i.stage,
                i.load_factor,
                i.point.kind,
                i.point.unexplored_modes,
                i.point.degenerate,
                i.point.event.as_deref().map(|e| &e[..e.len().min(100)]),
                i.diagnostics.elapsed_s
            );
        }
    }
}

#[test]
#[ignore]
fn probe_row() {
    let n: usize = std::env::var("N").unwrap().parse().unwrap();
    let began = std::time::Instant::now();
    let (increments, report) = trace(&row_of_bars(n));
    println!("{:?} {} increments {:?}", report.stop_reason, increments.len(), began.elapsed());
    for i in &increments {
        println!(
            "{} s {:.12} kind {:?} unexpl {} deg {} dirs {} bif {} ev {:?} t {:.3}",
            i.index,
            i.load_factor,
            i.point.kind,
            i.point.unexplored_modes,
            i.point.degenerate,
            i.directions.as_ref().map_or(0, |d| d.len()),
            i.point.bifurcation,
            i.point.event.as_deref().map(|e| &e[..e.len().min(100)]),
            i.diagnostics.elapsed_s
        );
    }
}
