//! Metrics of jobs: waiting times, stored increments, and work of the solver.

use crate::service::metrics::{long_seconds, observe, seconds};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;
use std::sync::atomic::AtomicU64;
use std::time::{Duration, Instant};

type Kind = [(&'static str, &'static str); 1];

/// The kinds of writes for which jobs wait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Write {
    /// A job is queued.
    Submit,
    /// A worker claims a job, or finds none.
    Claim,
    /// Increments are stored.
    Append,
    /// A lease is renewed.
    Renew,
    /// The end of a job is stored, with its last increments.
    Finish,
}

/// The work of a solver for a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Solved {
    pub time: Duration,
    pub factorisations: u64,
    pub newton_iterations: u64,
    pub qp_solves: u64,
    pub mpec_solves: u64,
    pub sqp_iterations: u64,
    pub certificates: u64,
}

#[derive(Debug)]
pub struct Work {
    queue_wait: Histogram,
    increments: Counter,
    writes: Family<Kind, Histogram, fn() -> Histogram>,
    solve_seconds: Counter<f64, AtomicU64>,
    solver_steps: Family<Kind, Counter>,
}

impl Write {
    fn name(self) -> &'static str {
        match self {
            Self::Submit => "submit",
            Self::Claim => "claim",
            Self::Append => "append",
            Self::Renew => "renew",
            Self::Finish => "finish",
        }
    }
}

impl Work {
    pub(super) fn in_registry(registry: &mut Registry) -> Self {
        let work = Self {
            queue_wait: long_seconds(),
            increments: Counter::default(),
            writes: Family::new_with_constructor(seconds),
            solve_seconds: Counter::default(),
            solver_steps: Family::default(),
        };
        registry.register(
            "queue_wait_seconds",
            "Seconds from queueing a job to its first start",
            work.queue_wait.clone(),
        );
        registry.register(
            "increments",
            "Increments, and paths of studies, stored by this process",
            work.increments.clone(),
        );
        let write = "Seconds that a write to the database took, its wait for other writes included";
        registry.register("store_write_seconds", write, work.writes.clone());
        let solving = "Seconds that paths were solved for, all threads together";
        registry.register("solve_seconds", solving, work.solve_seconds.clone());
        let steps = "Factorisations, Newton iterations and programs solved, by kind";
        registry.register("solver_steps", steps, work.solver_steps.clone());
        work
    }

    pub fn started_after(&self, wait: Duration) {
        observe(&self.queue_wait, wait);
    }

    pub fn stored(&self, increments: usize) {
        self.increments.inc_by(increments as u64);
    }

    /// Times a write; failed writes count, too.
    pub async fn timed<T>(&self, write: Write, writing: impl Future<Output = T>) -> T {
        let began = Instant::now();
        let answer = writing.await;
        observe(&self.writes.get_or_create(&[("write", write.name())]), began.elapsed());
        answer
    }

    pub fn solved(&self, solved: Solved) {
        let Solved { time, factorisations, newton_iterations, qp_solves, mpec_solves, sqp_iterations, certificates } =
            solved;
        self.solve_seconds.inc_by(time.as_secs_f64());
        for (kind, count) in [
            ("factorisation", factorisations),
            ("newton_iteration", newton_iterations),
            ("qp_solve", qp_solves),
            ("mpec_solve", mpec_solves),
            ("sqp_iteration", sqp_iterations),
            ("certificate", certificates),
        ] {
            self.solver_steps.get_or_create(&[("kind", kind)]).inc_by(count);
        }
    }
}
