//! Time that the processor spent on this program: what else a machine does takes none of it.

use std::time::Instant;

/// A stopwatch of one thread.
pub struct Stopwatch {
    began: Instant,
    spent_s: Option<f64>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self { began: Instant::now(), spent_s: spent_s() }
    }

    /// Seconds that the processor spent on this thread since the start; seconds by the clock where the system does not tell.
    pub fn seconds(&self) -> f64 {
        match (self.spent_s, spent_s()) {
            (Some(before), Some(now)) => now - before,
            _ => self.began.elapsed().as_secs_f64(),
        }
    }
}

/// Of this thread, as Linux tells it: nanoseconds, the first number of `schedstat` (proc(5)).
fn spent_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds as f64 * 1e-9)
}
