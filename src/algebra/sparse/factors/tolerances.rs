//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Multiplications per entry of the factor above which a Cholesky factorisation works by dense blocks: the ratio at
/// which the `faer` library changes over by default. The value affects only effort, and the result by no more than
/// rounding.
pub(crate) const BLOCKED_CHOLESKY_WORK: f64 = 40.0;

/// Multiplications per entry of the factor above which an `L D Lᵀ` factorisation works by dense blocks, in two thirds
/// of the time for a plane lattice of 10,000 unknowns. The value affects only effort, and the result by no more than
/// rounding.
pub(crate) const BLOCKED_LDL_WORK: f64 = 10.0;

/// Magnitude below which a pivot is raised by 1, in a matrix whose scaled rows have entries of about 1. A pivot of 1e-4
/// costs four of sixteen digits and leaves an error of about 2e-12, below the accepted backward error 1e-11 even before
/// refinement; a bound ten times smaller would exceed this error, and a larger one would raise more pivots, each of
/// which costs a border and a solve.
pub(crate) const SMALLEST_PIVOT: f64 = 1e-4;

/// Magnitude that replaces a smaller pivot, so that the remaining pivots can be computed: a few unit round-offs of the
/// scaled entries of about 1, so that a smaller pivot is not distinguishable from zero. The value does not enter a
/// result, since every pivot below the much larger bound for raised pivots leads to another factorisation.
pub(crate) const PIVOT_SUBSTITUTE: f64 = 1e-15;
