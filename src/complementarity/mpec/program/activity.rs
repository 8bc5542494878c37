//! Which members of the pairs are zero at a point.

#![warn(missing_docs)]

use nalgebra::DVector;

use crate::complementarity::mpec::program::cone::ConeActivity;
use crate::complementarity::mpec::program::evaluation::{ProgramEvaluation, Quantity};
use crate::complementarity::mpec::program::problem::Problem;

/// Which member of a pair is zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairActivity {
    /// `a = 0 < b`.
    FirstZero,
    /// `b = 0 < a`.
    SecondZero,
    /// Both zero to the biactive tolerance.
    BothZero,
    /// Neither is zero: the solve ended before complementarity was reached.
    NeitherZero,
}

impl PairActivity {
    fn of(a: f64, b: f64, tolerance: f64) -> Self {
        match (a <= tolerance, b <= tolerance) {
            (true, true) => Self::BothZero,
            (true, false) => Self::FirstZero,
            (false, true) => Self::SecondZero,
            (false, false) => Self::NeitherZero,
        }
    }
}

/// Activities of all pairs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Activities {
    /// One per pair.
    pub pairs: Vec<PairActivity>,
    /// One per cone pair.
    pub cones: Vec<ConeActivity>,
}

impl Activities {
    /// The activities at `x`; numbers up to `tolerance` count as zero.
    ///
    /// # Errors
    /// The quantity that is not finite.
    pub fn at<P: Problem + ?Sized>(problem: &P, x: &DVector<f64>, tolerance: f64) -> Result<Self, Quantity> {
        let mut at = ProgramEvaluation::new(problem);
        at.update_values(problem, x)?;
        Ok(Self::of(&at, tolerance, tolerance))
    }

    pub(crate) fn of(at: &ProgramEvaluation, tolerance: f64, cone_tolerance: f64) -> Self {
        let pairs = at.first.iter().zip(at.second.iter());
        Self {
            pairs: pairs.map(|(&a, &b)| PairActivity::of(a, b, tolerance)).collect(),
            cones: at.cones.pairs().map(|(a, b)| ConeActivity::of(a, b, cone_tolerance)).collect(),
        }
    }
}
