//! Pictures, as SVG.
//!
//! [`result`] is load against displacement, [`study`] error against run time (or what is varied), [`sweep`] limit load against what is
//! varied; [`findings`] is what both of the latter can be read as. [`shapes`] is what all are drawn with, [`chart`] two of them
//! into, [`axis`] finds ranges and tick texts, [`labels`] room for letters. Called by `command` and `http`;
//! knows `result`, `model`, `studies` and `sweeps`.

pub(crate) mod axis;
pub(crate) mod chart;
pub mod findings;
pub(crate) mod labels;
pub mod path;
pub(crate) mod shapes;
pub mod study;
pub mod sweep;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    #[error("a path without increments cannot be drawn")]
    Empty,
    #[error("no path of the study has an error yet, so that nothing can be drawn")]
    NoErrors,
    #[error("no run of the sweep has a limit point yet, so that nothing can be drawn")]
    NoLimitLoads,
    #[error("the picture could not be drawn: {0}")]
    Drawing(String),
}
