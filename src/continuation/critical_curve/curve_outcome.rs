//! How a curve ends, and why one is not followed.

use crate::continuation::critical_curve::critical_point::CurvePoint;
use crate::continuation::critical_curve::history::traced_history::CurveRefusal;
use crate::model::InputErrors;
use std::ops::ControlFlow;

/// How a curve ended in one direction of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum DirectionEnd {
    /// At the end of the range.
    Range,
    /// The critical point is lost past this value: the path traced there has none that continues the curve.
    Lost {
        /// The last value at which it is.
        value: f64,
        /// What happens there, in words.
        why: String,
    },
    /// The curve ended so, but points of it are on no path: one that the equations between its changes do not see came before.
    OffPath {
        /// The value of the first such point, as far as points were kept.
        value: f64,
        /// The last value before it at which the point is on a path; `None` where none is known.
        last: Option<f64>,
        /// The first place along the curve that is not known to be on a path.
        place: i64,
        /// How the curve ended.
        end: Box<DirectionEnd>,
    },
    /// The curve comes back to its start.
    Closed,
    /// The curve has as many points as one may have; the last is at this value.
    Long {
        /// The value.
        value: f64,
    },
    /// The model is refused from this value on.
    Model {
        /// The value.
        value: f64,
        /// The mistakes.
        errors: InputErrors,
    },
}

/// How a curve ended.
#[derive(Debug, Clone, PartialEq)]
pub enum CurveEnd {
    /// In both directions.
    Complete {
        /// Towards smaller values.
        below: DirectionEnd,
        /// Towards larger values.
        above: DirectionEnd,
    },
    /// By the flag, or by the receiver of the points.
    Cancelled,
}

/// A curve's end and its work.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveReport {
    /// How it ended.
    pub end: CurveEnd,
    /// Points of the curve.
    pub points: u64,
    /// Paths traced for it, the first one included.
    pub paths: u64,
    /// Newton iterations, without those of the paths.
    pub newton_iterations: u64,
}

/// Why a curve was not followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveFailure {
    /// Mistakes of the model at the first value.
    #[error("the model is refused: {0}")]
    Model(InputErrors),
    /// There is no critical point to follow.
    #[error(transparent)]
    Refused(#[from] CurveRefusal),
}

/// Receives the points of a curve in the order in which they are found; breaks to end it, or to refuse a point.
pub type AcceptPoint<'a> = &'a mut dyn FnMut(CurvePoint) -> ControlFlow<CurveBreak>;

/// Why a receiver of points takes no more.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CurveBreak {
    /// It needs none.
    Curve,
    /// This point is none of the curve, which ends before it in this direction: why, in words.
    Direction(String),
}
