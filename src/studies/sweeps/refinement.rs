//! Further values of a parameter where the response of a sweep changes most.

use crate::model::request::sweep::Variation;
use crate::studies::sweeps::Row;
use serde_json::Value;

/// The most values that are added at a time: the next ones are chosen when their runs have ended.
const AT_ONCE: usize = 4;
/// Of the largest change: intervals with less wait.
const LEAST_CHANGE: f64 = 0.5;
/// Intervals that are shorter than this part of the whole are not divided.
const SHORTEST: f64 = 1e-9;

/// Change of a response, relative to its size, that may be the error of an increment.
const ROUND_OFF: f64 = 1e-9;

/// An interval between two neighbouring values.
struct ParameterInterval {
    middle: f64,
    width: f64,
    /// Change of the response; infinite where it appears, disappears, or changes from one word to another.
    change: f64,
}

/// The response that a refinement goes by: the first one of the sweep, or the first limit load.
fn response(variation: &Variation, row: &Row) -> Value {
    match variation.responses.keys().next() {
        Some(name) => row.responses.as_ref().and_then(|found| found.get(name)).cloned().unwrap_or_default(),
        None => row.first_limit.as_ref().map_or(Value::Null, |limit| limit.load_factor.into()),
    }
}

fn change(one: &Value, other: &Value) -> f64 {
    match (one.as_f64(), other.as_f64()) {
        (Some(one), Some(other)) => {
            let change = (one - other).abs();
            if change <= ROUND_OFF * one.abs().max(other.abs()) { 0.0 } else { change }
        }
        _ if one == other => 0.0,
        _ => f64::INFINITY,
    }
}

/// The middle of two values, with no more decimals than tell it from them: 0.425 between 0.4 and 0.45, without round-off.
fn middle(one: f64, other: f64) -> f64 {
    /// Decimals beyond the first digit of the distance.
    const DECIMALS: f64 = 9.0;
    let middle = one + (other - one) / 2.0;
    let decimals = (DECIMALS - (other - one).log10().floor()).clamp(0.0, 300.0) as usize;
    format!("{middle:.decimals$}").parse().unwrap_or(middle)
}

/// The middles of the intervals in which the response changes most, `most` of them or fewer; none where it does not change.
pub fn further_values(variation: &Variation, rows: &[Row], most: usize) -> Vec<Value> {
    let place = |row: &Row| row.values.first().and_then(Value::as_f64);
    let mut known: Vec<(f64, Value)> =
        rows.iter().filter_map(|row| Some((place(row)?, response(variation, row)))).collect();
    known.sort_by(|one, other| one.0.total_cmp(&other.0));
    known.dedup_by(|one, other| one.0 == other.0);
    let (Some(first), Some(last)) = (known.first(), known.last()) else { return Vec::new() };
    let shortest = SHORTEST * (last.0 - first.0);
    let mut intervals: Vec<ParameterInterval> = known
        .windows(2)
        .map(|pair| ParameterInterval {
            middle: middle(pair[0].0, pair[1].0),
            width: pair[1].0 - pair[0].0,
            change: change(&pair[0].1, &pair[1].1),
        })
        .filter(|interval| interval.change > 0.0 && interval.width > shortest)
        .collect();
    // Stable: of equal ones the first.
    intervals.sort_by(|one, other| other.change.total_cmp(&one.change).then(other.width.total_cmp(&one.width)));
    let least = intervals.first().map_or(0.0, |largest| LEAST_CHANGE * largest.change);
    let intervals = intervals.into_iter().filter(|interval| interval.change >= least);
    intervals.take(most.min(AT_ONCE)).map(|interval| interval.middle.into()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::request::sweep::{Combine, SweepParameter};
    use crate::result::increment::PointKind;
    use crate::studies::sweeps::LimitLoad;
    use serde_json::json;

    fn row(run: u64, value: f64, load: Option<f64>) -> Row {
        let limit = |load_factor| LimitLoad {
            increment: 1,
            kind: PointKind::SmoothLimit,
            stage: "push".into(),
            load_factor,
            arc_length: 1.0,
        };
        let first_limit = load.map(limit);
        let values = vec![json!(value)];
        Row {
            run,
            job: None,
            values,
            status: "completed".to_owned(),
            stop_reason: None,
            error: None,
            last_index: None,
            first_limit,
            responses: None,
        }
    }

    #[test]
    fn the_jump_is_divided_first_and_what_does_not_change_never() {
        let parameters = vec![SweepParameter { pointer: "/model/x".to_owned(), values: Vec::new() }];
        let variation = Variation {
            parameters,
            combine: Combine::Grid,
            responses: Default::default(),
            refine: 9,
            response_units: Default::default(),
            warnings: Vec::new(),
        };
        let rows = [row(0, 4.0, Some(5.0)), row(1, 0.0, Some(1.0)), row(2, 1.0, Some(1.0)), row(3, 2.0, Some(1.5))];
        assert_eq!(further_values(&variation, &rows, 9), [json!(3.0)]);
        let lost = [row(0, 0.0, Some(1.0)), row(1, 1.0, Some(9.0)), row(2, 1.5, None), row(3, 2.0, None)];
        assert_eq!(further_values(&variation, &lost, 1), [json!(1.25)], "a limit load that disappears");
        assert!(further_values(&variation, &rows[..1], 4).is_empty());
        let close = [row(0, 0.4, Some(1.0)), row(1, 0.45, Some(2.0))];
        assert_eq!(further_values(&variation, &close, 1), [json!(0.425)]);
        let constant = [row(0, 0.1, Some(1.677_523_232_203_3)), row(1, 0.3, Some(1.677_523_232_203_301))];
        assert!(further_values(&variation, &constant, 4).is_empty(), "round-off");
        for (one, other) in [(-3.0, 1e6), (1e-20, 1.1e-20), (1.0, 1.0 + 1e-12), (-2e300, 1e300)] {
            let middle = middle(one, other);
            assert!(one < middle && middle < other, "{middle} between {one} and {other}");
        }
    }
}
