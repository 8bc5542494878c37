//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Backward error (the residual of each row relative to the magnitudes of its terms) at which the refinement of a
/// solution ends: a few unit round-offs of 2e-16. The residual is itself rounded in every term, so that a tenth would
/// rarely be reached and would cost all permitted refinements, and ten times more would leave a digit to be gained.
pub(crate) const CONVERGED_BACKWARD_ERROR: f64 = 1e-15;

/// Backward error up to which a refined solution is accepted; otherwise a sparse LU factorisation of the whole matrix
/// takes over. Refinement usually reaches 1e-15, so that only a factorisation that has lost its digits fails, and the
/// bound is the relative residual 1e-11 that a point of the path must have, well below the error 1e-9 that an increment
/// may have.
pub(crate) const ACCEPTED_BACKWARD_ERROR: f64 = 1e-11;

/// Smallest pivot of the complement of the borders, relative to the magnitude of its terms, above which the matrix
/// counts as regular without a test. The interior has pivots of at least 1e-4 and leaves a rounding error of about
/// 2e-16/1e-4 = 2e-12 in the complement, so that such a pivot has more than the three correct digits that the test asks
/// of known solutions; below the bound these or a new factorisation decide, so that the value affects only effort. An
/// arch of 200 slender beams has pivots of 4e-7.
pub(crate) const REGULAR_PIVOT_RATIO: f64 = 1e-8;

/// Error of a recovered known solution, relative to the scales of its entries, above which the matrix counts as
/// singular. With the usual backward error 1e-15 an error of 1e-3 needs a condition number of about 1e12, and a matrix
/// that is singular to working precision gives errors of about 1: the bound lies between the two, and three correct
/// digits suffice for a Newton correction.
pub(crate) const KNOWN_SOLUTION_ERROR: f64 = 1e-3;

/// Largest ratio of the second correction to the first at which two matrices count as near: an estimate of the norm of
/// `G = F⁻¹ A - I` from one vector. A norm below 1 keeps the sign of the determinant, and the factor of a thousand
/// covers a vector in which the dominant direction is weak; with three digits per correction the permitted corrections
/// also suffice for round-off.
pub(crate) const FIRST_CONTRACTION: f64 = 1e-3;

/// Backward error up to which a solution that improves no further is accepted: ten times the error at which refinement
/// ends, for rows with many terms, whose rounding errors add up. A larger error that stagnates shows that the
/// factorised matrix is not near enough, and the matrix itself is factorised.
pub(crate) const STAGNATED_BACKWARD_ERROR: f64 = 1e-14;

/// Fraction of the accepted backward error below which the next error, extrapolated from the last contraction, need not
/// be computed. The next contraction may thus be a thousand times weaker than the last one before the accepted error is
/// exceeded; the value saves one product with the matrix and affects only effort.
pub(crate) const EXTRAPOLATION_MARGIN: f64 = 1e-3;

/// Largest difference of a border's value by half solutions from that of a refined solution, relative to its terms. The
/// value is a hundredth of the tolerance 1e-9 for zero rates; half solutions are not refined, and beyond it stiffnesses
/// are so different that the solutions themselves are needed.
pub(crate) const BORDER_VALUE_ERROR: f64 = 1e-11;
