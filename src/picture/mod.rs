//! Pictures, as SVG.
//!
//! [`path`] is load against displacement, [`study`] error against run time (or what is varied); [`shapes`] is what both are drawn with,
//! [`labels`] finds room for letters. Called by `command` and `http`; knows `path`, `model` and `studies`.

mod labels;
pub mod path;
mod shapes;
pub mod study;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    #[error("a path without increments cannot be drawn")]
    Empty,
    #[error("no path of the study has an error yet, so that nothing can be drawn")]
    NoErrors,
    #[error("the picture could not be drawn: {0}")]
    Drawing(String),
}
