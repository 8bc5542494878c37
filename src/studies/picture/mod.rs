//! Pictures, as SVG; `raster` makes a PNG of one.
//!
//! `result` draws load against displacement, `study` error against run time (or the varied setting), `sweep` limit load against
//! the varied parameters, `critical_curve` limit load along a curve; `findings` is the common interface of the latter three. `shapes` has the drawing primitives,
//! `chart` the chart of two of them, `axis` ranges and tick texts, `labels` places of letters. Called by `command` and `http`;
//! knows `result`, `model`, `studies` and `sweeps`.

pub(crate) mod axis;
pub(crate) mod chart;
pub mod critical_curve;
pub mod findings;
pub(crate) mod labels;
pub mod path;
pub(crate) mod raster;
pub(crate) mod shapes;
pub mod study;
pub mod sweep;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    #[error("no increment has a number to draw")]
    Empty,
    #[error("no path of the study has an error yet, so that nothing can be drawn")]
    NoErrors,
    #[error("no run of the sweep has a number to draw yet: {sought}")]
    NothingFound { sought: String },
    #[error("the curve has no point yet, so that nothing can be drawn")]
    NoPoints,
    #[error("the picture could not be drawn: {0}")]
    Drawing(String),
}
