//! Time per increment of a lattice arch that snaps through onto a floor, with contacts and with none, by size.
//!
//! `cargo bench --bench lattice` (about 1,000 and 10,000 unknowns), `cargo bench --bench lattice -- 100000` (others)

use arcslip::cancel::CancelFlag;
use arcslip::path::increment::PointKind;
use arcslip::path::{Path, Scene};
use arcslip::scenes::lattice::LatticeArch;
use std::time::Instant;

/// Increments of each path.
const INCREMENTS: usize = 60;

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![1_000, 10_000] } else { asked };
    println!(
        "{:>9} {:>9} {:>9} {:>11} {:>11} {:>9} {:>9} {:>7} {:>7}  end",
        "unknowns", "contacts", "friction", "prepare ms", "increments", "ms/inc", "LU/inc", "closed", "limits"
    );
    for size in sizes {
        // What is pressed over a third of the span lands flat: nearly all contacts close.
        let plain = LatticeArch { increments: INCREMENTS, spread: 0.3, ..LatticeArch::of_unknowns(size) };
        // No more than have room over the floor.
        let contacts = (size / 100).max(10).min(plain.panels / 2);
        for arch in [
            LatticeArch { contacts: 0, ..plain },
            LatticeArch { contacts, friction: 0.0, ..plain },
            LatticeArch { contacts, friction: 0.3, ..plain },
        ] {
            trace(arch);
        }
    }
}

fn trace(arch: LatticeArch) {
    let Ok(request) = arch.request() else { return println!("no request") };
    let began = Instant::now();
    let scene = match Scene::new(&request) {
        Ok(scene) => scene,
        Err(errors) => return println!("{errors}"),
    };
    let prepared = began.elapsed().as_secs_f64();
    let mut path = Path::new(&scene, CancelFlag::default());
    let began = Instant::now();
    let (mut increments, mut closed, mut limits) = (0, 0, 0);
    for increment in path.by_ref() {
        increments += 1;
        limits += usize::from(increment.point.kind == PointKind::SmoothLimit);
        closed = closed.max(increment.contacts.iter().filter(|contact| contact.normal_reaction > 0.0).count());
        if std::env::var_os("ARCSLIP_LATTICE_POINTS").is_some() {
            println!(
                "  {:>4} {:>16} load {:.9e} arc {:.4} {:?} {} LU",
                increment.index,
                format!("{:?}", increment.point.kind),
                increment.load_factor,
                increment.arc_length,
                increment.displacements.values().next(),
                increment.diagnostics.factorisations
            );
        }
    }
    let elapsed = began.elapsed().as_secs_f64();
    let Some(report) = path.report() else { return };
    println!(
        "{:>9} {:>9} {:>9} {:>11.1} {:>11} {:>9.2} {:>9.1} {:>7} {:>7}  {:?}",
        arch.unknowns(),
        arch.contacts,
        arch.friction,
        prepared * 1e3,
        increments,
        elapsed / f64::from(increments) * 1e3,
        report.factorisations as f64 / f64::from(increments),
        closed,
        limits,
        report.stop_reason
    );
}
