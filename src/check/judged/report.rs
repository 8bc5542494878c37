//! A path's report with what the measure says of the whole path.

use crate::check::measure::{Errors, Maxima};
use crate::result::report::Report;
use serde::{Deserialize, Serialize};

/// A point of the path is off the measure where one of its errors of state (equilibrium, support, contact, friction,
/// cone, reported, arc length; dimensionless) is larger than this.
pub const OFF_MEASURE: f64 = 1e-9;

/// Totals and maxima over a whole path; one flat object, `measure` its last member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedReport {
    /// Stop reason and totals.
    #[serde(flatten)]
    pub report: Report,
    /// The largest errors.
    pub measure: MeasureReport,
}

/// What the measure says of a whole path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct MeasureReport {
    /// The largest value of each figure, and the increment where it occurs.
    pub largest: Maxima,
    /// Bar on a point's errors of state (all figures but energy, strain energy and slip direction); null with
    /// `method: "regularised"`, which has its penalties' errors by its nature.
    pub bar: Option<f64>,
    /// Increments above the bar; one is a defect of the solver.
    pub off_measure: u64,
}

impl MeasureReport {
    pub(super) fn with_bar(bar: Option<f64>) -> Self {
        Self { largest: Maxima::default(), bar, off_measure: 0 }
    }

    /// Takes an increment in; answers whether it is off the measure.
    pub(super) fn include(&mut self, index: u64, errors: &Errors) -> bool {
        self.largest.include(index, errors);
        let off = self.bar.is_some_and(|bar| errors.largest_of_state() > bar);
        self.off_measure += u64::from(off);
        off
    }
}

#[cfg(test)]
mod tests {
    use super::{MeasureReport, OFF_MEASURE};
    use crate::check::measure::{Errors, Largest};

    #[test]
    fn what_is_off_the_measure_is_counted_and_where_it_is_largest() {
        let slipping = |friction: f64| Errors { friction, ..Errors::default() };
        let mut report = MeasureReport::with_bar(Some(OFF_MEASURE));
        let found: Vec<bool> = [0.0, 1e-10, 3e-9, 2e-9, 3e-9, 1e-9]
            .into_iter()
            .zip(0..)
            .map(|(friction, index)| report.include(index, &slipping(friction)))
            .collect();
        assert_eq!(found, [false, false, true, true, true, false]);
        assert_eq!((report.off_measure, report.largest.friction), (3, Largest { value: 3e-9, index: Some(2) }));
        assert_eq!(report.largest.cone, Largest { value: 0.0, index: None });
        // A balance of energies falls with the step: no error of the state.
        assert!(!report.include(6, &Errors { energy: 1e-6, slip_direction: 0.1, ..Errors::default() }));
        let mut without = MeasureReport::with_bar(None);
        assert!(!without.include(0, &slipping(0.1)) && without.largest.friction.value == 0.1);
    }
}
