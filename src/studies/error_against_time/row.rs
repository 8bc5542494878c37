//! The findings for a path of a study.

use crate::model::request::Method;
use crate::result::stop_reason::StopReason;
use crate::studies::error_against_time::events::EventsFound;
use crate::studies::error_against_time::reference::Reference;
use serde::{Deserialize, Serialize};

/// One method at one rung of the ladder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudyRow))]
pub struct StudyRow {
    /// Place in the table, from 0: the rungs of the first method from coarse to fine, then those of the next.
    pub row: u64,
    pub method: Method,
    /// Of what the study varies.
    pub value: f64,
    /// Arc length of the path over its increments.
    pub mean_step: f64,
    /// Largest distance of the path's points from the reference, in order, in the plan's scaled norm; null where the
    /// reference has nothing to compare with.
    pub path_error: Option<f64>,
    /// The error is larger than what the reference leaves open.
    pub resolved: bool,
    /// Points in stages that the reference does not reach; they are in no error.
    pub points_outside: u64,
    pub events: EventsFound,
    /// Largest `error_estimate` of the path's own increments.
    pub largest_estimate: f64,
    pub increments: u64,
    pub factorisations: u64,
    pub newton_iterations: u64,
    pub qp_solves: u64,
    pub mpec_solves: u64,
    pub stop_reason: StopReason,
    /// Of the times measured so far; null before the first.
    pub time: Option<Time>,
    /// Slope of the error's logarithm against that of what is varied (for arc lengths, of the mean step), from the rung
    /// before; null where one of the two errors is not resolved, or the settings are less than a quarter apart.
    pub order: Option<f64>,
}

/// Solver time of a whole path, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudyTime))]
pub struct Time {
    pub median_s: f64,
    pub least_s: f64,
    pub largest_s: f64,
    pub repeats: u64,
}

impl Time {
    pub(super) fn of(times: &[f64]) -> Option<Self> {
        let mut sorted = times.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (least, largest) = (*sorted.first()?, *sorted.last()?);
        let middle = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) };
        Some(Self { median_s: median, least_s: least, largest_s: largest, repeats: sorted.len() as u64 })
    }
}

/// A path that has been traced: what a study's stream sends and the store keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudyRun))]
pub struct StudyRun {
    /// From 0, over the whole study.
    pub index: u64,
    /// 0 for the first time each path is traced, which is not timed.
    pub round: u64,
    /// Solver time of this one path.
    pub elapsed_s: f64,
    /// The row as it stands now.
    pub row: StudyRow,
    /// What its error is measured against.
    pub reference: Reference,
}

impl StudyRow {
    /// The abscissa for orders: the mean step, or the varied value.
    pub fn setting(&self, by_step: bool) -> f64 {
        if by_step { self.mean_step } else { self.value }
    }

    /// The error, if it is resolved.
    fn readable(&self) -> Option<f64> {
        self.path_error.filter(|_| self.resolved)
    }
}

/// Settings that differ by less than a quarter give no slope, as the step control of the solver made them alike. The variance of
/// two logarithms is half the square of their difference.
const LEAST_SPREAD: f64 = 0.5 * 0.2231 * 0.2231;

/// The slope through two rows.
pub(super) fn order(coarse: &StudyRow, fine: &StudyRow, by_step: bool) -> Option<f64> {
    slope(&[coarse, fine], by_step)
}

/// The slope through all rows with a resolved error, by least squares.
pub(super) fn slope(rows: &[&StudyRow], by_step: bool) -> Option<f64> {
    let logarithms: Vec<(f64, f64)> = rows
        .iter()
        .filter_map(|row| Some((row.setting(by_step).ln(), row.readable()?.ln())))
        .filter(|(setting, error)| setting.is_finite() && error.is_finite())
        .collect();
    let count = logarithms.len() as f64;
    // Both rows of a pair, or all rows with a resolved error.
    if logarithms.len() < 2 {
        return None;
    }
    let mean = |part: fn(&(f64, f64)) -> f64| logarithms.iter().map(part).sum::<f64>() / count;
    let (middle, level) = (mean(|place| place.0), mean(|place| place.1));
    let spread: f64 = logarithms.iter().map(|(setting, _)| (setting - middle).powi(2)).sum();
    let together: f64 = logarithms.iter().map(|(setting, error)| (setting - middle) * (error - level)).sum();
    (spread >= LEAST_SPREAD).then(|| together / spread)
}
