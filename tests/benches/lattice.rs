//! Time per increment of a lattice arch that snaps through onto a floor, with contacts and with none, by size. Contact changes
//! are increments of their own. Ratios are to the same arch with the contacts taken away, by increment, by increment since
//! the first touch, and by arc length since then.
//!
//! `cargo bench --bench lattice` (about 1,000 and 10,000 unknowns), `cargo bench --bench lattice -- 100000 increments=100`

use arcslip::cancel::CancelFlag;
use arcslip::path::increment::PointKind;
use arcslip::path::{Path, Scene};
use arcslip::scenes::lattice::LatticeArch;
use std::time::Instant;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Increments of each path, where no others are asked for.
const INCREMENTS: usize = 60;

/// Milliseconds.
struct Times {
    an_increment: f64,
    an_increment_since_touch: f64,
    an_arc_length_since_touch: f64,
}

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let named = std::env::args().find_map(|word| word.strip_prefix("increments=")?.parse().ok());
    let increments = named.unwrap_or(INCREMENTS);
    let sizes = if asked.is_empty() { vec![1_000, 10_000] } else { asked };
    println!(
        "{:>9} {:>9} {:>9} {:>11} {:>11} {:>9} {:>9} {:>7} {:>8} {:>6} {:>7} {:>7}  end",
        "unknowns",
        "contacts",
        "friction",
        "prepare ms",
        "increments",
        "ms/inc",
        "LU/inc",
        "closed",
        "changes",
        "ratio",
        "touched",
        "by arc"
    );
    for size in sizes {
        // What is pressed over a third of the span lands flat: nearly all contacts close in the end.
        let mut plain = LatticeArch { increments, spread: 0.3, ..LatticeArch::of_unknowns(size) };
        let contacts = (size / 100).max(10).min(plain.panels - 1);
        // The outermost has room over the floor.
        let place = (contacts + 1) as f64 / plain.panels as f64;
        plain.clearance = plain.clearance.max(1.05 * plain.rise * place.powi(2));
        let Some(without) = trace(LatticeArch { contacts: 0, ..plain }, None) else { return };
        for friction in [0.0, 0.3] {
            trace(LatticeArch { contacts, friction, ..plain }, Some(&without));
        }
    }
}

fn trace(arch: LatticeArch, without: Option<&Times>) -> Option<Times> {
    let request = arch.request().ok()?;
    let began = Instant::now();
    let scene = match Scene::new(&request) {
        Ok(scene) => scene,
        Err(errors) => {
            println!("{errors}");
            return None;
        }
    };
    let prepared = began.elapsed().as_secs_f64();
    let mut path = Path::new(&scene, CancelFlag::default());
    let began = Instant::now();
    let (mut increments, mut closed, mut changes) = (0, 0, 0);
    // Time, increments and arc length where the first contact touched; the start apart where none does.
    let (mut touch, mut arc) = (None, 0.0);
    for increment in path.by_ref() {
        increments += 1;
        arc = increment.arc_length;
        let changed = matches!(increment.point.kind, PointKind::ContactChange | PointKind::NonsmoothLimit);
        if changed || (without.is_none() && touch.is_none()) {
            touch.get_or_insert((began.elapsed().as_secs_f64(), increments, arc));
        }
        changes += usize::from(changed);
        closed = closed.max(increment.contacts.iter().filter(|contact| contact.normal_reaction > 0.0).count());
    }
    let elapsed = began.elapsed().as_secs_f64();
    let report = path.report()?;
    let (time, number, place) = touch.unwrap_or((0.0, 0, 0.0));
    let since = (elapsed - time) * 1e3;
    let times = Times {
        an_increment: elapsed / f64::from(increments) * 1e3,
        an_increment_since_touch: since / f64::from(increments - number).max(1.0),
        an_arc_length_since_touch: since / (arc - place).max(f64::MIN_POSITIVE),
    };
    let ratio = |of: fn(&Times) -> f64| match without {
        Some(without) => format!("{:.2}", of(&times) / of(without)),
        None => String::new(),
    };
    println!(
        "{:>9} {:>9} {:>9} {:>11.1} {:>11} {:>9.2} {:>9.1} {:>7} {:>8} {:>6} {:>7} {:>7}  {:?}",
        arch.unknowns(),
        arch.contacts,
        arch.friction,
        prepared * 1e3,
        increments,
        times.an_increment,
        report.factorisations as f64 / f64::from(increments),
        closed,
        changes,
        ratio(|times| times.an_increment),
        ratio(|times| times.an_increment_since_touch),
        ratio(|times| times.an_arc_length_since_touch),
        report.stop_reason
    );
    Some(times)
}
