//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Ratio of the smallest to the largest pivot below which the sign of the determinant is uncertain. The round-off of
/// the smallest pivot, relative to the largest, is unit round-off 2e-16 times the growth of errors in the elimination;
/// the value allows for a growth of 5e5, and a larger value leaves more signs undecided.
pub(crate) const UNCERTAIN_PIVOT_RATIO: f64 = 1e-10;

/// Ratio of successive corrections above which the correction has not decreased. At a singular point the ratio is 1/2,
/// and 0.7 lies midway between this convergent case and a ratio of 1.
pub(crate) const RISING_CORRECTION_RATIO: f64 = 0.7;

/// Largest ratio of the second correction to the first in a step that may be shortened, where a factorisation is most
/// of the work: from farther away Newton's method need not converge (P. Deuflhard, Newton Methods for Nonlinear
/// Problems, Springer 2011, section 5.1). Where directions of slip turn, which displacements do not show at first, it is
/// the ratio of the residuals instead. The ratio affects effort only: a step with a larger ratio is repeated at a shorter
/// length.
pub(crate) const FIRST_CORRECTION_RATIO: f64 = 0.25;

/// Residual that an accepted point must have: of equilibrium, relative to the largest force, and of gaps and arc
/// length, dimensionless. The value is a tenth of the accepted violation 1e-10 of the contact laws and a hundredth of
/// the measure of error 1e-9; the value leaves a factor of 5e4 above unit round-off for stiff elements.
pub(crate) const ACCEPTED_RESIDUAL: f64 = 1e-11;

/// Relative residual below which further iterations gain nothing: a few units of round-off, 2e-16. A smaller value
/// costs iterations without progress, and a larger value ends the iteration before the event functions are accurate to
/// round-off.
pub(crate) const ATTAINABLE_RESIDUAL: f64 = 1e-15;

/// Predicted arc length (dimensionless) of the next correction below which the correction is not computed where the
/// residual is round-off. The value is some 18 units of round-off, 2e-16, of displacements of order one, and well below
/// the event tolerance 1e-13.
pub(crate) const NEGLIGIBLE_CORRECTION: f64 = 4e-15;

/// Error below which Newton's method has practically converged: quadratic convergence takes an error of 1e-6 to 1e-12,
/// below the accepted residual, in one more iteration. Iterations are counted up to this error, so that round-off does
/// not enter the step length, and only smaller errors permit the reuse of a factorisation.
pub(crate) const SMALL_ERROR: f64 = 1e-6;

/// Smallest ratio of the smallest to the largest pivot of a factorisation that may be reused: with a smaller ratio the
/// residual says little about the error of the state. A large structure is soft compared with its elements, and the
/// ratio falls with its size: it is 8e-5 in a lattice of 102,304 unknowns that touches with friction, and the value
/// lies just below; a larger value would cost such structures a factorisation per iteration.
pub(crate) const REUSABLE_PIVOT_RATIO: f64 = 3e-5;

/// Largest last correction, over the pivot ratio, with which a factorisation below [`REUSABLE_PIVOT_RATIO`] may be
/// reused: so small a correction changes the smallest pivot by at most this fraction. At a hundredth each reuse still
/// reduces the error a hundredfold.
pub(crate) const LARGEST_RELATIVE_CORRECTION: f64 = 1e-2;

/// Largest ratio of successive errors for which a factorisation from elsewhere is reused. Such a factorisation has to
/// converge faster than a fresh one would; the ratio is a heuristic for effort: at more than a tenth many solves
/// replace one factorisation, and a smaller ratio discards factorisations that still save one.
pub(crate) const REUSE_CONTRACTION: f64 = 0.1;

/// Multiple of the bound on rounding within which a residual counts as round-off. The bound counts one unit of
/// round-off for each displacement, and the evaluation of a force takes a few operations more; a larger multiple would
/// accept residuals that another iteration reduces.
pub(crate) const ROUND_OFF_MULTIPLE: f64 = 8.0;

/// Errors of gaps and arc lengths (dimensionless) up to this may be round-off: 500 units of round-off, 2e-16, for
/// displacements of order one. The value is a hundredth of the accepted residual and no larger than the event tolerance
/// 1e-13.
pub(crate) const POSITION_ROUND_OFF: f64 = 1e-13;

/// Ratio of the present force scale to that of the best iterate below which the best iterate's residual is related to
/// the present forces: stiff elements that an early iterate strains make its forces, and so the residual that passes for
/// small, far larger than those of the solution. Forces that fall less cost less than one digit.
pub(crate) const FALLEN_FORCES: f64 = 0.1;

/// Rows with forces below this fraction of the force scale are judged relative to their own forces. A residual at the
/// attainable 1e-15 of the force scale is 1e-12 or less of the forces of any other row, below the accepted residual
/// 1e-11, so that only weaker rows need a judgement of their own.
pub(crate) const WEAK_ROW_FORCE: f64 = 1e-3;

/// Ratio of successive corrections above which corrections are round-off. Close to the solution quadratic convergence
/// reduces corrections far more than four times, unless rounding prevents it; the residual of each equation has to be
/// within rounding as well.
pub(crate) const ROUND_OFF_CORRECTION_RATIO: f64 = 0.25;
