//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Growth of the largest velocity, relative to the first sweep, from which the sweeps count as divergent. Beyond 1e9
/// the velocities of the first sweep are below the tolerance 1e-9 for zero rates, so that the sweeps no longer describe
/// the load; the value affects effort only, as every combination found is examined exactly.
pub(crate) const DIVERGENT_GROWTH: f64 = 1e9;

/// Largest change of a velocity in a sweep, relative to the largest velocity, below which the sweeps have settled. The
/// value is well above round-off, so that sweeps end, and far below the tolerance 1e-9 for zero rates, so that slow
/// convergence is not mistaken for the limit; the value affects effort only, as every combination found is examined
/// exactly.
pub(crate) const SETTLED_CHANGE: f64 = 1e-12;

/// Coefficients up to this fraction of the largest coefficient, and values up to this fraction of their terms, are
/// round-off. The value is 5e3 units of round-off, 2e-16: enough for sums of thousands of terms, and a thousandth of
/// the tolerance 1e-9 within which inequalities of rates are weak.
pub(crate) const RELATIVE_ROUND_OFF: f64 = 1e-12;

/// Coefficients up to this value, relative to the largest of their column (at least 1), are not used as pivots, and
/// smaller ratios are compared absolutely. Rows and columns have about unit size, so that the value is 5e4 units of
/// round-off, 2e-16; a smaller pivot would fill the tableau with round-off, and a larger bound might exclude the row
/// that has to leave. Every combination found is examined exactly.
pub(crate) const SMALLEST_PIVOT: f64 = 1e-11;

/// Difference of two ratios, relative to their magnitude, up to which the ratios are a tie, broken lexicographically.
/// The value is 5e3 units of round-off, 2e-16, the error that pivots leave in a ratio; a ratio chosen wrongly within
/// 1e-12 makes basic variables negative by no more than that.
pub(crate) const TIE_TOLERANCE: f64 = 1e-12;

/// Margin by which a matrix has to be positive definite, and a diagonal entry positive, relative to the largest entry:
/// beyond round-off. The backward error of a Cholesky factorisation is the number of rows times unit round-off, 2e-12
/// for 1e4 rows; a smaller margin might certify a matrix wrongly, and a larger margin only forgoes certificates.
pub(crate) const DEFINITENESS_MARGIN: f64 = 1e-10;

/// Largest coefficient of a form of unit size up to which the form vanishes: its entries are round-off. The value
/// equals the tolerance 1e-9 for zero rates and is well above the round-off of exchanges in a dictionary; a form that
/// counts as vanishing only forgoes the certificate.
pub(crate) const VANISHING_FORM: f64 = 1e-9;

/// Fraction of the largest value of its kind up to which a member of a pair is zero, so that both options of the pair
/// are examined. The value is a hundred times the tolerance 1e-9 of the exact test, so that no option is lost; a larger
/// value only adds combinations to examine.
pub(crate) const VANISHING_VALUE: f64 = 1e-7;

/// Smallest scale of the values (at a load rate of 1) relative to which members are zero: where the largest value is
/// smaller, all values may be round-off. With the relative bound 1e-7 on vanishing values the absolute bound is 1e-12,
/// the round-off of the coefficients.
pub(crate) const SMALLEST_VALUE_SCALE: f64 = 1e-5;

/// Fraction of their terms up to which values of the function whose zeros are sought are zero. The value is a thousand
/// times the round-off at a change of pieces, so that doubtful zeros are included; the doubtful zeros are then examined
/// exactly, and a larger value only adds such examinations.
pub(crate) const DOUBTFUL_ZERO: f64 = 1e-9;

/// Fraction of the largest coefficient that the terms of a value count as at least: the rest of smaller terms may be
/// round-off. With the relative round-off 1e-12 the absolute bound on zero is 1e-14 of the largest coefficient, some 50
/// units of round-off, which pivots leave even where the terms cancel.
pub(crate) const SMALLEST_TERM: f64 = 1e-2;

/// Diagonal shift, relative to the largest entry, that makes a singular matrix regular. The shift is 500 units of
/// round-off, so that the factorisation succeeds, and far below the margin 1e-10 of a definite matrix; the inverse only
/// proposes pairs to leave out, and each proposal is verified.
pub(crate) const DIAGONAL_SHIFT: f64 = 1e-13;

/// Tolerance within which inequalities (of rates of unit arc length; of forces, relative to the largest rate of force
/// or to the contact's own) hold with equality: such inequalities are weak. The value is the measure of error 1e-9, a
/// hundred times the rank tolerance 1e-11 of the equations; a trial step decides about weak inequalities, so that a
/// smaller value would trust round-off and a larger value costs trial steps.
pub(crate) const RATE_TOLERANCE: f64 = 1e-9;

/// Values below this, relative like the weak tolerance, may change sign within the small steps (at least 1e-6) by which
/// weak rays are tried: over such a step a rate changes by the curvature of the path times its length. The value is a
/// hundred times the weak tolerance 1e-9 and a tenth of the shortest trial step; a larger value only adds options in
/// doubt to the trials.
pub(crate) const DOUBTFUL_RATE: f64 = 1e-7;

/// Rounding error of a sum, relative to the sum of the magnitudes of its terms: some 50 units of round-off, 2e-16, for
/// sums of many terms whose errors partly cancel. Where no force changes, sums of this size count as zero; a larger
/// value would hide the small forces along a chain close to jamming.
pub(crate) const SUM_ROUND_OFF: f64 = 1e-14;

/// Pivot, relative to the first pivot of complete pivoting, up to which elimination ends and which so decides the rank
/// of a combination's equations. Rows have unit size, so that pivots of dependent rows are unit round-off 2e-16 times
/// their growth; the value is well above and a hundredth of the tolerance 1e-9 for zero rates.
pub(crate) const RANK_TOLERANCE: f64 = 1e-11;

/// Difference of misfits (relative to the largest value of their kind, velocity or force) up to which options are in
/// doubt and all are proposed. The value is ten times the magnitude 1e-7 of values in doubt on a ray; the proposals are
/// examined exactly, so that the value affects effort only.
pub(crate) const MISFIT_TIE: f64 = 1e-6;

/// Velocity (of unit arc length) below which the scale of velocities decreases with it. A stiff contact slips little while
/// the rest of a structure moves or its load rises, and velocities of 1e-10 decide. The value is a heuristic: above it, a
/// velocity that counts as zero changes its force by at most 1e-7 of the largest.
pub(crate) const SMALL_VELOCITY: f64 = 1e-2;

/// Smallest scale of velocities. With the tolerance 1e-9 on rates, velocities up to 1e-13 count as zero: the accuracy to
/// which the end of a slip is located, a thousand times unit round-off.
pub(crate) const SMALLEST_VELOCITY_SCALE: f64 = 1e-4;

/// Largest difference of the rates of force of two rays, relative to the largest, at which the rays may be equal. Rays
/// whose weights agree to 1e-9 have forces that agree to 1e-7, unless a contact is so stiff that they differ.
pub(crate) const RAY_FORCES: f64 = 1e-6;
