//! The picture of a path: load factor against a displacement or another quantity, its events lettered.
//!
//! `against` is that quantity, `curve` extracts the curve from the increments, `legend` explains the letters, `strokes` has lines and marks, `draw` composes
//! the picture. Called by `command` and `http`.

pub(crate) mod against;
pub(crate) mod curve;
pub(crate) mod draw;
pub(crate) mod legend;
pub(crate) mod strokes;

use crate::model::Model;
use crate::result::increment::Increment;
use crate::studies::picture::PlotError;
pub use against::{Against, Farthest};
pub use curve::Curve;

/// The picture as SVG text, which only depends on the increments, not on times.
pub fn svg(model: &Model, increments: &[Increment], against: Option<Against>) -> Result<String, PlotError> {
    let against = match against {
        Some(against) => against,
        None => {
            let mut farthest = Farthest::of(model);
            increments.iter().for_each(|increment| farthest.push(increment));
            farthest.found().ok_or(PlotError::Empty)?
        }
    };
    let mut curve = Curve::new(model, against);
    increments.iter().for_each(|increment| curve.push(increment));
    draw_curve(&curve)
}

/// The picture of a curve as SVG text.
pub fn draw_curve(curve: &Curve) -> Result<String, PlotError> {
    if curve.is_empty() {
        return Err(PlotError::Empty);
    }
    draw::draw(curve).map_err(|error| PlotError::Drawing(error.to_string()))
}
