//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Rates (of unit arc length; forces and powers relative to the largest) above which a rate is nonzero beyond doubt.
/// The margin is a hundred times the margin 1e-9 of weak inequalities; a rate within the margin leads to the search of
/// all modes, so that the value affects only effort.
pub(crate) const STRICT_MARGIN: f64 = 1e-7;

/// Eigenvalues of the symmetric part (of the complement of its raised pivots, with entries of about 1) and pivot ratios
/// of the bordered matrix up to which an eigenvalue or pivot counts as zero. The bound lies far above the error of
/// about 2e-12 of the complement; a matrix within the bound leads to the search of all modes, so that a larger value
/// costs only effort.
pub(crate) const DEFINITENESS_TOLERANCE: f64 = 1e-9;

/// Load rate (of unit arc length) up to which the load rate may be zero, so that uniqueness for each sign of the load
/// rate decides nothing. The bound is ten times the margin 1e-9 at which a load rate counts as stationary; a smaller
/// load rate leads to another proof or to the search of all modes, so that a larger value costs only effort.
pub(crate) const SMALLEST_LOAD_RATE: f64 = 1e-8;
