//! Parses durations in arguments: `300ms`, `10s`, `2h`, `7d`.

use jiff::{SignedDuration, Span, SpanRelativeTo};
use std::time::Duration;

/// Shorter leases could expire during pauses of a busy machine.
const SHORTEST_LEASE: Duration = Duration::from_millis(100);

/// A positive duration; a day has 24 hours.
pub fn positive(text: &str) -> Result<Duration, String> {
    let span: Span =
        text.parse().map_err(|_| format!("{text:?} is no duration; examples are 300ms, 10s, 2h and 7d"))?;
    let length: SignedDuration =
        span.to_duration(SpanRelativeTo::days_are_24_hours()).map_err(|error| error.to_string())?;
    Duration::try_from(length)
        .ok()
        .filter(|length| !length.is_zero())
        .ok_or_else(|| "a duration above zero is expected".to_owned())
}

pub fn lease(text: &str) -> Result<Duration, String> {
    let length = positive(text)?;
    if length < SHORTEST_LEASE { Err(format!("at least {SHORTEST_LEASE:?} is expected")) } else { Ok(length) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read() {
        for (text, seconds) in [("300ms", 0.3), ("10s", 10.0), ("10 s", 10.0), ("1h30m", 5400.0), ("7d", 604_800.0)] {
            assert_eq!(positive(text).map(|length| length.as_secs_f64()), Ok(seconds), "{text}");
        }
        for refused in ["", "10", "-1s", "0s", "1 fortnight", "s"] {
            assert!(positive(refused).is_err(), "{refused}");
        }
        assert!(lease("99ms").is_err() && lease("100ms").is_ok());
    }
}
