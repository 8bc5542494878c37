//! Static condensation of the motions without slip.

use crate::algebra::Factorisation;
use nalgebra::{DMatrix, DVector};

/// Response of the other unknowns to the load rate with all slips zero.
pub(super) struct CondensedResponse {
    factorisation: Option<Factorisation>,
    pub(super) load: DVector<f64>,
}

impl CondensedResponse {
    pub(super) fn new(matrix: &DMatrix<f64>, load: &DVector<f64>, others: &[usize]) -> Option<Self> {
        if others.is_empty() {
            return Some(Self { factorisation: None, load: DVector::zeros(0) });
        }
        let block = DMatrix::from_fn(others.len(), others.len(), |row, column| matrix[(others[row], others[column])]);
        let factorisation = Factorisation::new(block)?;
        let mut response = DVector::from_fn(others.len(), |row, _| -load[others[row]]);
        factorisation.solve(&mut response).then_some(Self { factorisation: Some(factorisation), load: response })
    }

    /// The matrix `M` and load vector `q` condensed on the slips.
    pub(super) fn condensed(
        &self,
        matrix: &DMatrix<f64>,
        load: &DVector<f64>,
        others: &[usize],
        slips: &[usize],
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let along = |row: usize, motion: &DVector<f64>| -> f64 {
            others.iter().zip(motion.iter()).map(|(other, value)| matrix[(slips[row], *other)] * value).sum()
        };
        let mut own = DMatrix::from_fn(slips.len(), slips.len(), |row, column| matrix[(slips[row], slips[column])]);
        let by_load = DVector::from_fn(slips.len(), |row, _| load[slips[row]] + along(row, &self.load));
        if let Some(factorisation) = &self.factorisation {
            for (index, slip) in slips.iter().enumerate() {
                let mut motion = DVector::from_fn(others.len(), |row, _| -matrix[(others[row], *slip)]);
                if !factorisation.solve(&mut motion) {
                    return None;
                }
                (0..slips.len()).for_each(|row| own[(row, index)] += along(row, &motion));
            }
        }
        Some((own, by_load))
    }
}
