//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Tolerance for constraints (relative to 1 plus the largest component of the step), for signs of multipliers (relative
/// to 1 plus the largest component of the gradient) and for residuals of the linear system (relative to 1 plus the
/// right-hand side). The residual of a refined solution is about unit round-off 2e-16 times the unknowns, so that the
/// value rejects nearly singular systems, whose unknowns exceed the right-hand side by more than 5e4; the value is a
/// tenth of the accuracy of the interior-point method and far below the tolerance 1e-8 of the sequence.
pub(crate) const OPTIMALITY_TOLERANCE: f64 = 1e-11;

/// Diagonal subtracted in the block of the multipliers where rows are linearly dependent, relative to `1 + max |H|`.
/// The value is the square root of unit round-off: as far above the round-off of the factorisation, which keeps the
/// system regular, as below the entries of `H`, so that refinement with the true matrix removes the effect of the
/// block.
pub(crate) const MULTIPLIER_BLOCK: f64 = 1e-8;

/// Factor of each increase of the weight of the elastic violation. The first weight is ten times the gradient, and
/// three increases raise the weight by 1e6; a smaller factor needs more solves for the same range, and a larger one
/// brings the program sooner to the limit 1e-10 of the interior-point method's accuracy.
pub(crate) const WEIGHT_FACTOR: f64 = 100.0;

/// Margin (of dimensionless constraint values) within which constraints are active at the start, before any multiplier
/// is known. The margin is ten times the accepted violation 1e-8 of a previous point; the active-set method corrects a
/// wrong guess, so that the margin affects effort only.
pub(crate) const INITIAL_ACTIVITY_MARGIN: f64 = 1e-7;

/// Accuracy required of the interior-point method: absolute and relative duality gap, and feasibility. The solution has
/// to separate multipliers from slacks for the active-set step, which refines the solution to round-off; without that
/// step the solution itself has to meet the tolerance 1e-8 of the sequence with a margin, and a much smaller value is
/// out of reach without iterative refinement.
pub(crate) const INTERIOR_POINT_TOLERANCE: f64 = 1e-10;

/// Change of a row along the line, per unit of the parameter, up to which the row does not depend on the parameter. The
/// test concerns rows violated by more than the tolerance 1e-11: with a smaller slope such a row holds only at a
/// distance ten times the size of the point or more, and the slope is then little more than its round-off.
pub(crate) const SMALLEST_SLOPE: f64 = 1e-12;

/// Factor by which another variable has to change faster than the parameter to become the parameter. A ratio up to ten
/// costs at most one digit of the line; a smaller factor changes the parameter more often, and each change discards the
/// symbolic factorisation. The factor affects effort and round-off, not the solution.
pub(crate) const PARAMETER_CHANGE_RATIO: f64 = 10.0;
