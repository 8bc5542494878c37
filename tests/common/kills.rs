//! What tests share that end processes at chosen and at random moments.

use super::process::{has_ended, lines, until};
use super::service::without_elapsed;
use reqwest::Client;
use serde_json::Value;

/// xorshift64*: the same kills in every run.
pub struct Random(u64);

impl Random {
    pub fn fixed() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    pub fn next(&mut self, below: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % below
    }
}

/// Lines but for their times.
pub fn strip(lines: &[String]) -> Vec<String> {
    lines.iter().map(|line| without_elapsed(line)).collect()
}

/// Ended as it should, with increments that rise by one, times that never fall, and all else as `arcslip solve` has it.
pub async fn assert_undisturbed(client: &Client, url: &str, id: &str, expected: &[String]) -> Value {
    let job = until(client, url, &format!("/v1/jobs/{id}"), has_ended).await;
    assert!(matches!(job["status"].as_str(), Some("completed" | "stopped")), "{job}");
    let lines = lines(client, url, id).await;
    assert!(strip(&lines) == expected, "{id}: {} lines, expected {}; {job}", lines.len(), expected.len());
    let times: Vec<f64> = lines
        .iter()
        .map(|line| {
            serde_json::from_str::<Value>(line).expect("JSON")["diagnostics"]["elapsed_s"].as_f64().expect("a time")
        })
        .collect();
    assert!(times.is_sorted(), "{id}: {times:?}");
    // Two attempts may overlap while a lease is lost: the report's time is that of the attempt which ended.
    assert!(job["report"]["elapsed_s"].as_f64().is_some_and(|time| time > 0.0), "{job}");
    assert_eq!(job["report"]["increments"], job["progress"]["last_index"]);
    job
}
