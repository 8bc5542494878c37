//! The work of eight scenes, counted, beside what it was: more than `work.txt` says fails, and so does less, so that the file
//! stays true. The counts are the same whatever the machine does; of allocations, which a compiler may save, the file has
//! the most that there may be.

use crate::common::paths::scene_file;
use allocation_counter::measure;
use arcslip::algebra::solves;
use arcslip::check::scenes::lattice::LatticeArch;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::resources::cancel::CancelFlag;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/work.txt");
const RENEW: &str = "ARCSLIP_RENEW_WORK=1 cargo test --no-default-features --test work";
const HEADER: &str = "scene method increments factorisations solves newton_iterations qp_solves mpec_solves allocations_an_increment_at_most";

/// A sparse arch of some 400 unknowns that lands on its floor.
fn lattice() -> JobRequest {
    let arch = LatticeArch { contacts: 12, increments: 30, ..LatticeArch::of_unknowns(400) };
    arch.request().expect("a request")
}

/// One of some 1,000 unknowns that lands flat, with contacts that close and open from the middle of its path on.
fn landing(friction: f64) -> JobRequest {
    let arch = LatticeArch { increments: 60, friction, ..LatticeArch::of_unknowns(1_000) };
    arch.landing(10).request().expect("a request")
}

/// Scene and method, six counts, and allocations an increment.
struct Work {
    name: String,
    counts: [u64; 6],
    allocations: f64,
}

impl Work {
    fn of(name: &str, method: Method, mut request: JobRequest) -> Self {
        request.analysis.method = method;
        let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{name}: {errors}"));
        let mut report = None;
        let solved_before = solves();
        let allocated = measure(|| {
            let mut path = Path::new(&scene, CancelFlag::default());
            path.by_ref().for_each(drop);
            report = path.report();
        });
        let report = report.expect("an ended path has a report");
        let counts = [
            report.increments,
            report.factorisations,
            solves() - solved_before,
            report.newton_iterations,
            report.qp_solves,
            report.mpec_solves,
        ];
        // The row of the start is one more.
        let allocations = allocated.count_total as f64 / (report.increments + 1) as f64;
        Self { name: format!("{name} {}", method.name()), counts, allocations }
    }

    /// As it stands in the file, with room for what another compiler does.
    fn line(&self) -> String {
        let counts = self.counts.map(|count| count.to_string()).join(" ");
        format!("{} {counts} {}", self.name, (self.allocations * 1.02).ceil())
    }

    /// What differs from the file's line.
    fn complaint(&self, line: Option<&&str>) -> Option<String> {
        let Some(line) = line else { return Some(format!("{}: not in the file", self.name)) };
        let words: Vec<&str> = line.split_whitespace().collect();
        let [_, _, counts @ .., allowed] = &words[..] else { return Some(format!("{line}: not a row")) };
        let own = self.counts.map(|count| count.to_string());
        let allowed: f64 = allowed.parse().unwrap_or(0.0);
        (counts != own.each_ref().map(String::as_str) || self.allocations > allowed)
            .then(|| format!("  was {line}\n  is  {}", self.line()))
    }
}

#[test]
fn work_is_what_it_was() {
    let mut all = Vec::new();
    for name in ["one-bar-truss", "klarbring", "arch-type-truss", "three-snapping-bars", "curving-slip"] {
        for method in [Method::Auto, Method::Mpec] {
            all.push(Work::of(name, method, scene_file(name)));
        }
    }
    all.push(Work::of("lattice-arch", Method::Auto, lattice()));
    all.push(Work::of("landing-arch", Method::Auto, landing(0.0)));
    all.push(Work::of("landing-arch-rough", Method::Auto, landing(0.3)));
    if std::env::var_os("ARCSLIP_RENEW_WORK").is_some() {
        let lines: Vec<String> = all.iter().map(Work::line).collect();
        std::fs::write(FILE, format!("{HEADER}\n{}\n", lines.join("\n"))).expect("the file can be written");
    }
    let text = std::fs::read_to_string(FILE).expect("the file can be read");
    let line_of = |work: &Work| text.lines().find(|line| line.starts_with(&format!("{} ", work.name)));
    let complaints: Vec<String> = all.iter().filter_map(|work| work.complaint(line_of(work).as_ref())).collect();
    assert!(
        complaints.is_empty(),
        "the work has changed ({HEADER}):\n{}\nwhere that is meant, `{RENEW}` writes the file anew",
        complaints.join("\n")
    );
}
