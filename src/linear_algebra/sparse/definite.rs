//! Whether a sparse symmetric matrix is positive definite, by its Cholesky factorisation.

use faer::Side;
use faer::sparse::{SparseColMat, Triplet};

/// Entries of the lower triangle, diagonal included; several at one place are added up.
pub type Triangle = Vec<(usize, usize, f64)>;

/// Whether a symmetric matrix stays positive definite when `margin` of each diagonal entry is taken away, so that rounding
/// cannot have made it so. No where a diagonal entry is not above `margin` times the sizes of what adds up to its row.
pub fn is_positive_definite(size: usize, lower: &Triangle, margin: f64) -> bool {
    let (mut diagonal, mut sizes) = (vec![0.0; size], vec![0.0_f64; size]);
    for &(row, column, value) in lower {
        sizes[row] += value.abs();
        if row == column {
            diagonal[row] += value;
        } else {
            sizes[column] += value.abs();
        }
    }
    let is_clear = |(value, size): (&f64, &f64)| value.is_finite() && size.is_finite() && *value > margin * size;
    if !diagonal.iter().zip(&sizes).all(is_clear) {
        return false;
    }
    // A congruence: the diagonal becomes 1 and definiteness stays.
    let scales: Vec<f64> = diagonal.iter().map(|value| 1.0 / value.sqrt()).collect();
    let scaled =
        lower.iter().map(|&(row, column, value)| Triplet::new(row, column, value * scales[row] * scales[column]));
    let margins = (0..size).map(|place| Triplet::new(place, place, -margin));
    let triplets: Vec<Triplet<usize, usize, f64>> = scaled.chain(margins).collect();
    SparseColMat::try_new_from_triplets(size, size, &triplets)
        .is_ok_and(|matrix| matrix.sp_cholesky(Side::Lower).is_ok())
}

#[cfg(test)]
mod tests {
    use super::is_positive_definite;

    /// A chain of springs 1, held at one end by a spring of its own.
    fn chain(size: usize, held: f64) -> Vec<(usize, usize, f64)> {
        let mut lower = vec![(0, 0, held)];
        for place in 1..size {
            lower.extend([(place - 1, place - 1, 1.0), (place, place, 1.0), (place, place - 1, -1.0)]);
        }
        lower
    }

    #[test]
    fn a_long_chain_is_definite_while_something_holds_it() {
        assert!(is_positive_definite(10_000, &chain(10_000, 1.0), 1e-12));
        assert!(!is_positive_definite(10_000, &chain(10_000, 0.0), 1e-12));
        assert!(!is_positive_definite(50, &chain(50, -1e-3), 1e-12));
        assert!(!is_positive_definite(2, &vec![(0, 0, 1.0), (1, 1, f64::NAN)], 1e-12));
        assert!(is_positive_definite(0, &Vec::new(), 1e-12));
    }
}
