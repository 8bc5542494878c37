//! arcslip beside two programs that others use for the same scene, the row of n snapping bars: `auto` beside OpenSees
//! (penalty contact, displacement control), `mpec` beside the paper's program in CasADi, solved by IPOPT.
//!
//! `cargo bench --bench peers`, with sizes of one's own `cargo bench --bench peers -- 20 50`, and with the `python3` of a
//! virtual environment `PYTHON=.venv/bin/python cargo bench --bench peers`. A peer that is not installed is left out.
//!
//! Each row is the median of whole paths taken in turn, first one program, then the other, so that what else the machine
//! does meets both; their ratio is of each pair. Reading the model, building the program and importing are not timed.

use arcslip::check::scenes::of_any_size::row_of_bars;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Certificate, Method, Mpec};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind;
use serde::Deserialize;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Pairs of paths at the most, and seconds after which no more are begun: short paths are taken many times, since
/// processors change their speed meanwhile.
const REPEATS: usize = 301;
const SECONDS: f64 = 8.0;
/// Pairs that are taken however long they last, unless it is this long.
const FEWEST: usize = 9;
const MOST_SECONDS: f64 = 30.0;

/// A program, the method that it is compared with, with its certificate or without, and the sizes of the row.
const PEERS: [(&str, &str, Method, Certificate, &[usize]); 3] = [
    ("OpenSees", "opensees_row.py", Method::Auto, Certificate::Use, &[1, 20, 100, 500]),
    ("CasADi + IPOPT", "casadi_row.py", Method::Mpec, Certificate::Use, &[5, 20, 50, 100]),
    ("CasADi + IPOPT", "casadi_row.py", Method::Mpec, Certificate::Skip, &[5, 20]),
];

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    for (name, script, method, certificate, sizes) in PEERS {
        let mut peer = match Peer::start(script) {
            Ok(peer) => peer,
            Err(why) => {
                println!("{name} is left out: {why}");
                continue;
            }
        };
        let way = match (method, certificate) {
            (Method::Mpec, Certificate::Use) => ", certificates used",
            (Method::Mpec, Certificate::Skip) => ", certificates skipped",
            (Method::Auto | Method::Regularised, _) => "",
        };
        println!("\n`{}`{way}, and {name}, ms per increment (least to largest)\n", method.name());
        println!(
            "| n | arcslip | increments | events | limit load | end | {name} | increments | iterations | largest load | its error | went to | end | ratio |"
        );
        println!("|--:|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|---|--:|");
        for &size in if asked.is_empty() { sizes } else { &asked } {
            if let Err(why) = compare(size, (method, certificate), &mut peer) {
                println!("n = {size}: {why}");
                break;
            }
        }
    }
}

/// One row of the table.
fn compare(size: usize, (method, certificate): (Method, Certificate), peer: &mut Peer) -> Result<(), String> {
    let mut request: JobRequest = serde_json::from_value(row_of_bars(size)).map_err(|error| error.to_string())?;
    request.analysis.method = method;
    request.analysis.mpec = (method == Method::Mpec).then_some(Mpec { certificate });
    let scene = Scene::new(&request).map_err(|errors| errors.to_string())?;
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let mut last = None;
    // The first answer of each is not timed: the peer builds its program with it.
    let warm = peer.ask(size)?;
    let began = Instant::now();
    let goes_on = |pairs: usize| {
        let seconds = if pairs < FEWEST { MOST_SECONDS } else { SECONDS };
        pairs == 0 || pairs < REPEATS && began.elapsed().as_secs_f64() < seconds
    };
    while goes_on(ours.len()) {
        let own = trace(&scene)?;
        let answer = peer.ask(size)?;
        ours.push(own.elapsed_s / own.increments as f64 * 1e3);
        theirs.push(answer.elapsed_s / answer.increments.max(1) as f64 * 1e3);
        last = Some(own);
    }
    let own = last.ok_or("no path")?;
    let ratios = Spread::of(ours.iter().zip(&theirs).map(|(own, other)| other / own).collect());
    let limit = own.limit.map_or("none".to_owned(), |limit| format!("{limit:.9}"));
    let error = own.limit.map_or(String::new(), |limit| format!("{:+.1e}", warm.largest_load / limit - 1.0));
    println!(
        "| {size} | {} | {} | {} | {limit} | {} at {:.5} | {} | {} | {:.1} | {:.9} | {error} | u = {:.2}, s = {:.5} | {} | {} |",
        Spread::of(ours),
        own.increments,
        own.events,
        own.end,
        own.last_load,
        Spread::of(theirs),
        warm.increments,
        warm.iterations as f64 / warm.increments.max(1) as f64,
        warm.largest_load,
        warm.travel,
        warm.last_load,
        warm.end,
        ratios
    );
    Ok(())
}

/// Median, least and largest of several figures.
struct Spread([f64; 3]);

impl Spread {
    fn of(mut figures: Vec<f64>) -> Self {
        figures.sort_by(f64::total_cmp);
        Self([figures[figures.len() / 2], figures[0], figures[figures.len() - 1]])
    }
}

impl std::fmt::Display for Spread {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [median, least, largest] = self.0.map(three_digits);
        write!(out, "{median} ({least} to {largest})")
    }
}

/// Three significant digits, and no exponent.
fn three_digits(value: f64) -> String {
    let before_point = value.abs().max(1e-6).log10().floor() as i32 + 1;
    format!("{value:.*}", usize::try_from(3 - before_point).unwrap_or(0))
}

/// A path of arcslip.
struct Own {
    elapsed_s: f64,
    increments: u64,
    events: u64,
    /// Of the first limit point.
    limit: Option<f64>,
    last_load: f64,
    end: String,
}

fn trace(scene: &Scene) -> Result<Own, String> {
    let mut path = Path::new(scene, CancelFlag::default());
    let (mut increments, mut events, mut limit, mut last_load) = (0, 0, None, 0.0);
    let began = Instant::now();
    for increment in path.by_ref() {
        increments += 1;
        events += u64::from(increment.index > 0 && increment.point.event.is_some());
        let is_limit = matches!(increment.point.kind, PointKind::SmoothLimit | PointKind::NonsmoothLimit);
        limit = limit.or(is_limit.then_some(increment.load_factor));
        last_load = increment.load_factor;
    }
    let elapsed_s = began.elapsed().as_secs_f64();
    let report = path.report().ok_or("a path without a report")?;
    let end = serde_json::to_value(report.stop_reason).map_err(|error| error.to_string())?;
    let end = end.as_str().unwrap_or_default().to_owned();
    Ok(Own { elapsed_s, increments, events, limit, last_load, end })
}

/// A script beside this file that answers each n with one line.
struct Peer {
    process: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

#[derive(Deserialize)]
struct Answer {
    elapsed_s: f64,
    increments: u64,
    iterations: u64,
    largest_load: f64,
    last_load: f64,
    /// Displacement of the first tip.
    travel: f64,
    end: String,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Line {
    Answer(Answer),
    Missing { missing: String },
}

impl Peer {
    /// Starts the script and lets it answer once, so that it is known whether what it needs is installed.
    fn start(script: &str) -> Result<Self, String> {
        let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let file = format!("{}/tests/benches/{script}", env!("CARGO_MANIFEST_DIR"));
        let mut process = Command::new(&python)
            .arg(&file)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("`{python}` does not start ({error}); PYTHON=path names another"))?;
        let (questions, answers) = (process.stdin.take(), process.stdout.take());
        let (Some(questions), Some(answers)) = (questions, answers) else { return Err("no pipes".to_owned()) };
        let mut peer = Self { process, questions, answers: BufReader::new(answers) };
        peer.ask(1).map(|_| peer)
    }

    fn ask(&mut self, size: usize) -> Result<Answer, String> {
        // A script that has ended says why in the line it left.
        let _ = writeln!(self.questions, "{size}").and_then(|()| self.questions.flush());
        let mut line = String::new();
        self.answers.read_line(&mut line).map_err(|error| error.to_string())?;
        match serde_json::from_str(&line) {
            Ok(Line::Answer(answer)) => Ok(answer),
            Ok(Line::Missing { missing }) => Err(missing),
            Err(error) => Err(format!("the script answered {line:?} ({error})")),
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It waits for questions that do not come any more.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
