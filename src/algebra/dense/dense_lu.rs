//! Dense LU factorisations with partial pivoting. Systems of two to six equations use code specialised to their size,
//! without loop overhead.

use crate::algebra::dense::dense_factors::DenseFactors;
use crate::algebra::dense::interruptible_lu::LargeLu;
use crate::algebra::dense::solve_counters::count_solves;
use crate::resources::budget;
use nalgebra::allocator::Allocator;
use nalgebra::constraint::{SameNumberOfRows, ShapeConstraint};
use nalgebra::{Const, DMatrix, DVector, DefaultAllocator, Dim, DimMin, Dyn, LU, OMatrix, OVector, SMatrix};

/// An LU factorisation with partial pivoting of a square matrix, with rows scaled to unit maximum norm.
pub struct Factorisation {
    /// Number of rows of the given matrix; further rows belong to [`Stiffener`]s.
    size: usize,
    factors: Box<dyn DenseFactors>,
    /// Ratio of the smallest to the largest pivot magnitude.
    pivot_ratio: f64,
    /// Sign factor between the determinants of the factorised matrix and of the given matrix.
    sign: f64,
}

/// A summand `k r cᵀ` of a matrix, stored separately.
#[derive(Debug, Clone)]
pub struct Stiffener {
    /// Not zero.
    pub stiffness: f64,
    /// Entries of `r`.
    pub rows: Vec<(usize, f64)>,
    /// Entries of `c`.
    pub columns: Vec<(usize, f64)>,
}

/// Pivots below this fraction of the largest pivot count as zero (rows have unit maximum norm).
const SMALLEST_PIVOT: f64 = 1e-14;
/// Number of rows up to which a matrix is factorised in one piece.
pub(crate) const MOST_AT_ONCE: usize = 500;

/// The factors of a matrix with scaled rows.
struct RowScaledFactors<D: DimMin<D, Output = D>>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    row_scales: OVector<f64, D>,
    lu: LU<f64, D, D>,
}

impl<D: DimMin<D, Output = D>> DenseFactors for RowScaledFactors<D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
    ShapeConstraint: SameNumberOfRows<Dyn, D>,
    OVector<f64, D>: Send + Sync,
    LU<f64, D, D>: Send + Sync,
{
    fn size(&self) -> usize {
        self.row_scales.nrows()
    }

    fn determinant_sign(&self) -> f64 {
        let factors = self.lu.lu_internal();
        let sign: f64 = self.lu.p().determinant();
        (0..factors.nrows()).fold(sign, |sign, index| sign * factors[(index, index)].signum())
    }

    fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool {
        let scaled = right_hand_side.as_mut_slice().iter_mut().zip(self.row_scales.iter());
        scaled.for_each(|(value, scale)| *value /= scale);
        self.lu.solve_mut(right_hand_side) && right_hand_side.as_slice().iter().all(|value| value.is_finite())
    }
}

/// Divides the rows of a square matrix, stored by columns, by their largest magnitudes, which are written to `scales`
/// (zero on entry); `false` where a row is zero or has an entry that is not finite.
#[inline(always)]
fn divide_rows(entries: &mut [f64], scales: &mut [f64]) -> bool {
    let size = scales.len();
    // Remains zero while all entries are finite: zero times infinity or NaN is NaN.
    let mut zero = 0.0;
    for column in entries.chunks_exact(size.max(1)) {
        for (scale, value) in scales.iter_mut().zip(column) {
            zero += 0.0 * value;
            *scale = if value.abs() > *scale { value.abs() } else { *scale };
        }
    }
    if zero != 0.0 || !scales.iter().all(|scale| *scale > 0.0) {
        return false;
    }
    for column in entries.chunks_exact_mut(size.max(1)) {
        column.iter_mut().zip(scales.iter()).for_each(|(value, scale)| *value /= scale);
    }
    true
}

/// Ratio of the smallest to the largest pivot magnitude; `None` where it is too small or not a number.
fn ratio(pivots: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let is_empty = pivots.len() == 0;
    let (smallest, largest) = pivots.fold((f64::INFINITY, 0.0_f64), |(smallest, largest), pivot| {
        (smallest.min(pivot.abs()), largest.max(pivot.abs()))
    });
    let regular = is_empty || (smallest.is_finite() && smallest > SMALLEST_PIVOT * largest);
    regular.then_some(if largest > 0.0 { smallest / largest } else { 0.0 })
}

impl Factorisation {
    /// Factorises; `None` when the matrix is singular to working precision or holds a number that is not finite.
    pub fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        match matrix.nrows() {
            2 => Self::of_known_size::<2>(&matrix),
            3 => Self::of_known_size::<3>(&matrix),
            4 => Self::of_known_size::<4>(&matrix),
            5 => Self::of_known_size::<5>(&matrix),
            6 => Self::of_known_size::<6>(&matrix),
            size => {
                let mut row_scales = DVector::zeros(size);
                let is_regular = divide_rows(matrix.as_mut_slice(), row_scales.as_mut_slice());
                is_regular
                    .then(|| {
                        if size > MOST_AT_ONCE {
                            Self::large(matrix, row_scales)
                        } else {
                            Self::scaled(matrix, row_scales)
                        }
                    })
                    .flatten()
            }
        }
    }

    /// Factorises a large matrix with scaled rows.
    fn large(matrix: DMatrix<f64>, row_scales: DVector<f64>) -> Option<Self> {
        let lu = LargeLu::new(matrix, row_scales);
        let pivot_ratio = ratio(lu.pivots())?;
        Some(Self { size: lu.size(), factors: Box::new(lu), pivot_ratio, sign: 1.0 })
    }

    fn of_known_size<const SIZE: usize>(matrix: &DMatrix<f64>) -> Option<Self>
    where
        Const<SIZE>: DimMin<Const<SIZE>, Output = Const<SIZE>>,
    {
        let mut matrix = SMatrix::<f64, SIZE, SIZE>::from_column_slice(matrix.as_slice());
        let mut row_scales = OVector::<f64, Const<SIZE>>::zeros();
        let is_regular = divide_rows(matrix.as_mut_slice(), row_scales.as_mut_slice());
        is_regular.then(|| Self::scaled(matrix, row_scales)).flatten()
    }

    /// Factorises a matrix with scaled rows.
    fn scaled<D: Dim + DimMin<D, Output = D>>(matrix: OMatrix<f64, D, D>, row_scales: OVector<f64, D>) -> Option<Self>
    where
        DefaultAllocator: Allocator<D, D> + Allocator<D>,
        RowScaledFactors<D>: DenseFactors + 'static,
    {
        let size = matrix.nrows();
        budget::spend(size * size * size / 3);
        let lu = LU::new(matrix);
        let pivot_ratio = ratio((0..size).map(|index| lu.lu_internal()[(index, index)]))?;
        Some(Self { size, factors: Box::new(RowScaledFactors { row_scales, lu }), pivot_ratio, sign: 1.0 })
    }

    /// Factorises `A + Σ k r cᵀ` as `[[A, R], [Cᵀ, -1/K]]`, where large and small stiffnesses are never added, so that
    /// the small stiffnesses keep their digits (a mixed formulation: the new unknowns are the forces `k c·x`).
    pub fn stiffened(matrix: DMatrix<f64>, stiffeners: &[Stiffener]) -> Option<Self> {
        let (size, added) = (matrix.nrows(), stiffeners.len());
        let mut matrix = matrix.resize(size + added, size + added, 0.0);
        let mut sign = 1.0;
        for (index, stiffener) in stiffeners.iter().enumerate() {
            let place = size + index;
            stiffener.rows.iter().for_each(|(row, value)| matrix[(*row, place)] += value);
            stiffener.columns.iter().for_each(|(column, value)| matrix[(place, *column)] += value);
            matrix[(place, place)] = -1.0 / stiffener.stiffness;
            sign *= -stiffener.stiffness.signum();
        }
        Self::new(matrix).map(|whole| Self { size, sign, ..whole })
    }

    /// Sign of the determinant: 1 or -1.
    pub fn determinant_sign(&self) -> f64 {
        self.sign * self.factors.determinant_sign()
    }

    /// Ratio of the smallest to the largest pivot magnitude.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// Solves for one right-hand side, overwritten by the solution; `false` when the result is not finite.
    pub fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool {
        count_solves(1);
        let size = self.factors.size();
        if size == 0 {
            return true;
        }
        if self.size == size {
            return self.factors.solve(right_hand_side);
        }
        let mut whole = right_hand_side.clone().resize_vertically(size, 0.0);
        let solved = self.factors.solve(&mut whole);
        right_hand_side.copy_from(&whole.rows(0, self.size));
        solved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For each size, specialised or not: the residual of a solution, and the sign of the determinant against that from
    /// the general algorithm.
    #[test]
    fn every_size_is_solved() {
        for size in (0..9).chain([MOST_AT_ONCE + 7]) {
            let entry = |row: usize, column: usize| ((1 + row * row + 5 * column * (row + 2)) as f64).sin();
            let matrix = DMatrix::from_fn(size, size, entry);
            let right_hand_side = DVector::from_fn(size, |row, _| 1.0 + row as f64);
            let factorisation = Factorisation::new(matrix.clone()).expect("a regular matrix");
            let mut solution = right_hand_side.clone();
            assert!(factorisation.solve(&mut solution));
            let left_over = (&matrix * &solution - &right_hand_side).amax();
            assert!(left_over < 1e-12 * (1.0 + solution.amax()), "{size}: {left_over}");
            let determinant: f64 = matrix.determinant();
            assert_eq!(factorisation.determinant_sign(), determinant.signum(), "{size}");
            let zeros = DMatrix::zeros(size, size);
            assert_eq!(Factorisation::new(zeros).is_none(), size > 0);
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        assert!(Factorisation::new(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0])).is_none());
        assert!(Factorisation::new(DMatrix::from_row_slice(2, 2, &[1.0, f64::NAN, 2.0, 4.0])).is_none());
    }

    #[test]
    fn the_sign_of_the_determinant_counts_exchanges() {
        for (entries, sign) in [([0.0, 1.0, 1.0, 0.0], -1.0), ([2.0, 1.0, 1.0, 2.0], 1.0), ([1.0, 2.0, 2.0, 1.0], -1.0)]
        {
            let factorisation = Factorisation::new(DMatrix::from_row_slice(2, 2, &entries)).unwrap();
            assert_eq!(factorisation.determinant_sign(), sign);
        }
    }

    #[test]
    fn rows_of_very_different_size_are_solved() {
        let factorisation = Factorisation::new(DMatrix::from_row_slice(2, 2, &[1e-18, 2e-18, 3e18, 4e18])).unwrap();
        let mut solution = DVector::from_vec(vec![5e-18, 11e18]);
        assert!(factorisation.solve(&mut solution));
        assert!((solution[0] - 1.0).abs() < 1e-12 && (solution[1] - 2.0).abs() < 1e-12);
    }

    /// Springs of stiffness 1 and 1e15 in series under a unit force: `x = (1, 1 + 1e-15)`. The sum of 1 and 1e15 would
    /// lose the soft spring.
    #[test]
    fn a_stiffness_kept_apart_spares_the_soft_one() {
        let soft = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0]);
        let along = vec![(0, -1.0), (1, 1.0)];
        let stiff = Stiffener { stiffness: 1e15, rows: along.clone(), columns: along };
        let factorisation = Factorisation::stiffened(soft, &[stiff]).unwrap();
        let mut solution = DVector::from_vec(vec![0.0, 1.0]);
        assert!(factorisation.solve(&mut solution));
        assert!((solution[0] - 1.0).abs() < 1e-15 && (solution[1] - 1.0).abs() < 2e-15);
        assert_eq!(factorisation.determinant_sign(), 1.0);
    }
}
