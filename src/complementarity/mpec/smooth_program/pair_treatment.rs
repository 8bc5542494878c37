//! The treatment of each pair in a smooth program; `smooth_program::relaxation` and `smooth_program::cone_rows` form
//! the resulting rows.

use crate::complementarity::mpec::program::activity::PairActivity;
use crate::complementarity::mpec::smooth_program::cone_rows::ConeTreatment;

/// The treatment of one pair in the smooth program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairTreatment {
    /// Both members nonnegative, their product at most this bound.
    Product(f64),
    FirstZero,
    SecondZero,
    BothFree,
    BothZero,
}

impl PairTreatment {
    pub fn first_is_zero(self) -> bool {
        matches!(self, Self::FirstZero | Self::BothZero)
    }

    pub fn second_is_zero(self) -> bool {
        matches!(self, Self::SecondZero | Self::BothZero)
    }
}

/// The treatment of every pair.
#[derive(Debug, Clone, PartialEq)]
pub struct TreatmentPattern {
    pub pairs: Vec<PairTreatment>,
    pub cones: Vec<ConeTreatment>,
}

impl TreatmentPattern {
    /// All products at most `smooth_rows`.
    pub fn relaxed(pairs: usize, cones: usize, relaxation: f64) -> Self {
        Self {
            pairs: vec![PairTreatment::Product(relaxation); pairs],
            cones: vec![ConeTreatment::Product(relaxation); cones],
        }
    }

    /// The bound on the products; `None` where no product is bounded.
    pub fn relaxation(&self) -> Option<f64> {
        let of_pairs = self.pairs.iter().find_map(|treatment| match treatment {
            PairTreatment::Product(relaxation) => Some(*relaxation),
            PairTreatment::FirstZero
            | PairTreatment::SecondZero
            | PairTreatment::BothFree
            | PairTreatment::BothZero => None,
        });
        of_pairs.or_else(|| {
            self.cones.iter().find_map(|treatment| match treatment {
                ConeTreatment::Product(relaxation) => Some(*relaxation),
                ConeTreatment::FirstZero
                | ConeTreatment::SecondZero
                | ConeTreatment::AlongFirst
                | ConeTreatment::AlongSecond => None,
            })
        })
    }

    /// The pattern with the given member of each pair zero; an entry with no single zero member changes nothing.
    pub fn with_zeros(mut self, members: &[PairActivity]) -> Self {
        for (treatment, member) in self.pairs.iter_mut().zip(members) {
            match member {
                PairActivity::FirstZero => *treatment = PairTreatment::FirstZero,
                PairActivity::SecondZero => *treatment = PairTreatment::SecondZero,
                PairActivity::BothZero | PairActivity::NeitherZero => {}
            }
        }
        self
    }
}
