//! Checks numbers and vectors: finite, within the accepted magnitudes, of the right length.

use crate::model::input::limits::{MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};

/// Directions whose cosine differs from 1 by no more than this are parallel: an angle of some 1e-6.
pub(in crate::model::check) const PARALLEL: f64 = 1e-12;

fn is_sane(value: f64) -> bool {
    value == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&value.abs())
}

/// Whether the vector has the given length and only accepted numbers.
pub(in crate::model::check) fn well_formed(values: &[f64], length: usize) -> bool {
    values.len() == length && values.iter().all(|&value| is_sane(value))
}

/// Notes a number that is not finite, too large or too small.
pub(in crate::model::check) fn number(value: f64, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let sane = is_sane(value);
    if !sane {
        mistakes.add(at, || {
            if !value.is_finite() {
                format!("found {value}; a finite number is expected")
            } else if value.abs() > MAX_MAGNITUDE {
                format!("found {value:e}; at most {MAX_MAGNITUDE:e} in absolute value is accepted: choose other units")
            } else {
                format!("found {value:e}; 0, or at least {MIN_MAGNITUDE:e} in absolute value, is accepted")
            }
        });
    }
    sane
}

/// Also notes a number that is not above 0.
pub(in crate::model::check) fn positive(value: f64, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let sane = number(value, at, mistakes);
    if sane && value <= 0.0 {
        mistakes.add(at, || format!("found {value:?}; a number above 0 is expected"));
    }
    sane && value > 0.0
}

/// Notes a count of 0 or above `limit`.
pub(in crate::model::check) fn count(value: u64, limit: u64, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if value == 0 {
        mistakes.add(at, || "found 0; 1 or more is expected");
    } else if value > limit {
        mistakes.add(at, || format!("found {value}; at most {limit} is accepted"));
    }
}

/// Notes a wrong length and every number that is not accepted.
pub(in crate::model::check) fn vector(
    values: &[f64],
    dimension: usize,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) -> bool {
    let right_length = values.len() == dimension;
    if !right_length {
        let found = values.len();
        mistakes.add(at, || format!("found {found} numbers; {dimension} are expected, one for each dimension"));
    }
    let mut sane = true;
    for (index, &value) in values.iter().enumerate() {
        sane &= number(value, &at.index(index), mistakes);
    }
    right_length && sane
}

pub(in crate::model::check) fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// Euclidean length; within the accepted magnitudes the squares neither overflow nor underflow.
pub(in crate::model::check) fn norm(values: &[f64]) -> f64 {
    dot(values, values).sqrt()
}

pub(in crate::model::check) fn difference(left: &[f64], right: &[f64]) -> Vec<f64> {
    left.iter().zip(right).map(|(left, right)| left - right).collect()
}

pub(in crate::model::check) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// The vector divided by a length.
pub(in crate::model::check) fn scaled(vector: &[f64], length: f64) -> Vec<f64> {
    vector.iter().map(|component| component / length).collect()
}
