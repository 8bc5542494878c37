//! The rates of the structure for the velocities of the contacts that can change, and for its own direction, `Z` and `z₀`
//! of `condensed_rate_problem`: whole, or at the contacts alone.
//!
//! The rate problem only needs the load rates and the reactions. The displacement rates of hundreds of velocities are
//! most of the work and of the memory with many unknowns; where the equations are sparse, those of the few combinations
//! that are directions are solved for instead.

use crate::algebra::sparse::SparseFactorisation;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::complementarity::rates::rate_problem::MotionOfWeights;
use crate::mechanics::equations::{ModeSystem, rate_recovery};
use crate::mechanics::problem::state::Rate;
use crate::resources::budget;
use nalgebra::{DMatrix, DVector, RowDVector};
use std::fmt;
use std::sync::Arc;

/// The rate of each weight, the last one that of `z₀`.
pub(crate) enum RateBasis<'a> {
    Whole(Vec<Rate>),
    AtContacts(RatesAtContacts<'a>),
}

/// Load rates and rates of reactions, without displacements, and what the displacements follow from.
#[derive(Clone)]
pub(crate) struct RatesAtContacts<'a> {
    pub equations: &'a ModeSystem<'a>,
    pub rates: Vec<Rate>,
    pub solver: Arc<CombinationSolver>,
    /// Arc length of `z₀`.
    pub own_size: f64,
}

impl RateBasis<'_> {
    /// The rates of unit weights; without displacements where they are rates at contacts.
    pub fn rates(&self) -> &[Rate] {
        match self {
            Self::Whole(rates) | Self::AtContacts(RatesAtContacts { rates, .. }) => rates,
        }
    }

    /// The whole rate of a combination; zero where it cannot be solved for.
    pub fn combined(&self, weights: &DVector<f64>) -> Rate {
        match self {
            Self::Whole(rates) => {
                budget::spend(rates.len() * (rates[0].displacement.len() + 4 * rates[0].reactions.len()));
                let mut sum = rates[0].clone();
                sum.scale(weights[0]);
                rates.iter().zip(weights.iter()).skip(1).for_each(|(rate, weight)| sum.add(rate, *weight));
                sum
            }
            Self::AtContacts(RatesAtContacts { equations, solver, .. }) => match solver.solution(weights) {
                Some(values) => rate_recovery::rate_from(equations, equations.anchor, &values),
                None => rate_recovery::no_rate(equations),
            },
        }
    }

    /// The load rates of unit weights.
    pub fn load(&self) -> RowDVector<f64> {
        RowDVector::from_iterator(self.rates().len(), self.rates().iter().map(|rate| rate.load))
    }

    /// The magnitudes of the motions of unit weights. A unit velocity of a contact moves its own node at unit speed, and
    /// the rest of the structure at no more by order of magnitude.
    pub fn sizes(&self) -> Vec<f64> {
        match self {
            Self::Whole(rates) => rates.iter().map(Rate::size).collect(),
            Self::AtContacts(RatesAtContacts { rates, own_size, .. }) => {
                let mut sizes = vec![1.0; rates.len()];
                sizes.splice(rates.len() - 1.., [*own_size]);
                sizes
            }
        }
    }

    /// The motions of combinations of the weights.
    pub fn motion(&self) -> Arc<dyn MotionOfWeights> {
        match self {
            Self::Whole(rates) => {
                let freedoms = rates[0].displacement.len();
                let entry = |row: usize, column: usize| match rates[column].displacement.get(row) {
                    Some(velocity) => *velocity,
                    None => rates[column].load,
                };
                Arc::new(column_by_column(freedoms + 1, rates.len(), entry))
            }
            Self::AtContacts(RatesAtContacts { solver, .. }) => solver.clone(),
        }
    }
}

/// Solves for the rates of combinations of weights.
pub(crate) struct CombinationSolver {
    pub factorisation: Arc<SparseFactorisation>,
    /// The right-hand side of each unit weight.
    pub rights: Vec<SparseEntries>,
    /// Number of unknown displacements; the load rate is the next value.
    pub unknowns: usize,
    /// Arc length of prescribed displacements and load at unit load rate.
    pub load_size: f64,
}

impl CombinationSolver {
    /// The solution of the rate equations; `None` where there is no accurate one.
    fn solution(&self, weights: &DVector<f64>) -> Option<DVector<f64>> {
        budget::spend(self.factorisation.size());
        let mut values = DVector::zeros(self.factorisation.size());
        for (entries, weight) in self.rights.iter().zip(weights.iter()) {
            entries.iter().for_each(|(row, value)| values[*row] += weight * value);
        }
        self.factorisation.solve(&mut values).then_some(values)
    }
}

impl MotionOfWeights for CombinationSolver {
    fn of(&self, weights: &DVector<f64>) -> DVector<f64> {
        let Some(values) = self.solution(weights) else {
            return DVector::from_element(self.unknowns + 1, f64::NAN);
        };
        let mut motion = values.rows(0, self.unknowns + 1).into_owned();
        motion[self.unknowns] *= self.load_size;
        motion
    }
}

impl fmt::Debug for CombinationSolver {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("CombinationSolver").field("rights", &self.rights).finish_non_exhaustive()
    }
}

/// A matrix built column by column, so that the work on a large one can be interrupted.
pub(crate) fn column_by_column(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(rows, columns);
    for (column, mut values) in matrix.column_iter_mut().enumerate() {
        budget::spend(rows);
        values.iter_mut().enumerate().for_each(|(row, value)| *value = entry(row, column));
    }
    matrix
}
