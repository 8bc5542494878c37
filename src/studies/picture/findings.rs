//! The findings of studies, sweeps and curves as tables and pictures; called by `command` and `http`.

use crate::studies::critical_curves::{self, CurveFound};
use crate::studies::error_against_time::StudyReport;
use crate::studies::error_against_time::table;
use crate::studies::picture::{PlotError, critical_curve, study, sweep};
use crate::studies::sweeps::Found;
use serde::Serialize;

/// Findings that can be written as tables and drawn.
pub trait Findings: Serialize {
    /// Why there may be no picture yet.
    const NOT_DRAWN: &'static str;

    /// A table with named columns.
    ///
    /// # Errors
    /// A value that cannot be written.
    fn csv(&self) -> serde_json::Result<String>;

    /// Aligned columns.
    ///
    /// # Errors
    /// A value that cannot be written.
    fn text(&self) -> serde_json::Result<String>;

    /// A picture.
    ///
    /// # Errors
    /// There is nothing to draw yet, or the drawing failed.
    fn svg(&self) -> Result<String, PlotError>;
}

impl Findings for StudyReport {
    const NOT_DRAWN: &'static str = "no path of it has an error yet";

    fn csv(&self) -> serde_json::Result<String> {
        table::csv(self)
    }

    fn text(&self) -> serde_json::Result<String> {
        table::text(self)
    }

    fn svg(&self) -> Result<String, PlotError> {
        study::svg(self)
    }
}

impl Findings for CurveFound {
    const NOT_DRAWN: &'static str = "no point of it has been found yet";

    fn csv(&self) -> serde_json::Result<String> {
        critical_curves::table::csv(self)
    }

    fn text(&self) -> serde_json::Result<String> {
        critical_curves::table::text(self)
    }

    fn svg(&self) -> Result<String, PlotError> {
        critical_curve::svg(self)
    }
}

impl Findings for Found {
    const NOT_DRAWN: &'static str = "no run of it has a limit point yet";

    fn csv(&self) -> serde_json::Result<String> {
        self.csv()
    }

    fn text(&self) -> serde_json::Result<String> {
        self.text()
    }

    fn svg(&self) -> Result<String, PlotError> {
        sweep::svg(self)
    }
}
