//! Time per increment of a lattice arch that snaps through onto a floor, with contacts and with none, by size. Contact changes
//! are increments of their own. Ratios are to the same arch with the contacts taken away, by increment, by increment since
//! the first touch, and by arc length since then. The paths of one size are traced in turn, an increment each, so that all
//! meet the machine as it is at that moment.
//!
//! `cargo bench --bench lattice` (about 1,000 and 10,000 unknowns), `cargo bench --bench lattice -- 100000 increments=100`

use arcslip::check::scenes::lattice::LatticeArch;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind;
use std::time::{Duration, Instant};

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Increments of each path, where no others are asked for.
const INCREMENTS: usize = 60;

/// A path and what its increments took.
struct Run<'a> {
    arch: LatticeArch,
    prepared: Duration,
    path: Path<'a>,
    elapsed: Duration,
    increments: u32,
    closed: usize,
    changes: usize,
    arc_length: f64,
    /// Time, increments and arc length where the first contact touched; the start where there is none.
    touched: Option<(Duration, u32, f64)>,
}

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
        let plain = LatticeArch { increments, ..LatticeArch::of_unknowns(size) }.landing((size / 100).max(10));
        let without = LatticeArch { contacts: 0, ..plain };
        let with = [0.0, 0.3].map(|friction| LatticeArch { friction, ..plain });
        compare(&[without, with[0], with[1]]);
    }
}

/// Traces all of them; the first is that without contacts.
fn compare(arches: &[LatticeArch]) {
    let Some(scenes) = arches.iter().map(prepared).collect::<Option<Vec<(Scene, Duration)>>>() else { return };
    let mut runs: Vec<Run<'_>> = arches
        .iter()
        .zip(&scenes)
        .map(|(arch, (scene, prepared))| Run {
            arch: *arch,
            prepared: *prepared,
            path: Path::new(scene, CancelFlag::default()),
            elapsed: Duration::ZERO,
            increments: 0,
            closed: 0,
            changes: 0,
            arc_length: 0.0,
            touched: None,
        })
        .collect();
    while runs.iter_mut().map(Run::advance).filter(|goes_on| *goes_on).count() > 0 {}
    let without = runs[0].times();
    runs.iter().for_each(|run| run.print(&without));
}

fn prepared(arch: &LatticeArch) -> Option<(Scene, Duration)> {
    let request = arch.request().ok()?;
    let began = Instant::now();
    match Scene::new(&request) {
        Ok(scene) => Some((scene, began.elapsed())),
        Err(errors) => {
            println!("{errors}");
            None
        }
    }
}

impl Run<'_> {
    /// One increment; `false` at the end.
    fn advance(&mut self) -> bool {
        let began = Instant::now();
        let increment = self.path.next();
        self.elapsed += began.elapsed();
        let Some(increment) = increment else { return false };
        self.increments += 1;
        self.arc_length = increment.arc_length;
        let changed = matches!(increment.point.kind, PointKind::ContactChange | PointKind::NonsmoothLimit);
        if changed || (self.arch.contacts == 0 && self.touched.is_none()) {
            self.touched.get_or_insert((self.elapsed, self.increments, self.arc_length));
        }
        self.changes += usize::from(changed);
        let closed = increment.contacts.iter().filter(|contact| contact.normal_reaction > 0.0).count();
        self.closed = self.closed.max(closed);
        true
    }

    fn times(&self) -> Times {
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
        let (time, number, place) = self.touched.unwrap_or_default();
        let since = milliseconds(self.elapsed - time);
        Times {
            an_increment: milliseconds(self.elapsed) / f64::from(self.increments).max(1.0),
            an_increment_since_touch: since / f64::from(self.increments - number).max(1.0),
            an_arc_length_since_touch: since / (self.arc_length - place).max(f64::MIN_POSITIVE),
        }
    }

    fn print(&self, without: &Times) {
        let times = self.times();
        let ratio = |of: fn(&Times) -> f64| match self.arch.contacts {
            0 => String::new(),
            _ => format!("{:.2}", of(&times) / of(without)),
        };
        let Some(report) = self.path.report() else { return };
        println!(
            "{:>9} {:>9} {:>9} {:>11.1} {:>11} {:>9.2} {:>9.1} {:>7} {:>8} {:>6} {:>7} {:>7}  {:?}",
            self.arch.unknowns(),
            self.arch.contacts,
            self.arch.friction,
            self.prepared.as_secs_f64() * 1e3,
            self.increments,
            times.an_increment,
            report.factorisations as f64 / f64::from(self.increments),
            self.closed,
            self.changes,
            ratio(|times| times.an_increment),
            ratio(|times| times.an_increment_since_touch),
            ratio(|times| times.an_arc_length_since_touch),
            report.stop_reason
        );
    }
}
