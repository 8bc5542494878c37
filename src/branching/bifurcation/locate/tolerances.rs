//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Part of a vector orthogonal to the others, relative to its size, up to which the part is round-off. A vector in the
/// span of the others leaves a few unit round-offs of 2e-16; a remainder of 1e-10 still has six correct digits, which
/// further rounds of the iteration restore, and the place that follows from the vectors is only a starting guess.
pub(crate) const ORTHOGONAL_REMAINDER: f64 = 1e-10;

/// Imaginary part of an eigenvalue, relative to its real part, up to which the eigenvalue is real. An error ε splits a
/// double real eigenvalue into a complex pair with imaginary parts of about √ε: the bound admits errors of 1e-12, and
/// the imaginary part of a truly complex pair is of the order of the real part.
pub(crate) const REAL_EIGENVALUE_TOLERANCE: f64 = 1e-6;

/// Distance between expected crossings, relative to the bracket, up to which the crossings are first treated as one. A
/// heuristic share that affects only effort: the expected places are of second order, the test functions decide whether
/// the crossings coincide, and the first of distinct crossings is then sought alone.
pub(crate) const CLUSTER_WIDTH: f64 = 2e-2;

/// Largest distance outside the bracket, relative to the bracket, at which a crossing may be expected: the estimate is
/// of second order. A heuristic share that affects only effort: a larger one adds starting guesses, and a point that is
/// found is accepted only between the start and the end of the bracket.
pub(crate) const BRACKET_MARGIN: f64 = 0.25;

/// Correction (dimensionless) at which Newton's method on the bordered equations has converged: the next correction
/// would be of the order of its square, 1e-18. With 1e-8 the square would be of the order of round-off, with no room
/// for the curvature of the equations.
pub(crate) const BORDERED_CORRECTION: f64 = 1e-9;

/// Correction (dimensionless) up to which Newton's method on the bordered equations has converged where corrections no
/// longer decrease; the residual then decides. The square 1e-12 of such a correction lies below the accepted residual
/// 1e-11; a larger correction would fail the residual.
pub(crate) const STALLED_CORRECTION: f64 = 1e-6;

/// Test functions (relative to the largest stiffness) up to which the eigenvalues vanish together, as eigenvalues do
/// with dense matrices, and singular values of their scaled derivatives that count as zero. The bound lies well above
/// the error of about 1e-12 of the test functions and their differences, and below it the branches of distinct
/// crossings could not be distinguished.
pub(crate) const TEST_FUNCTION_TOLERANCE: f64 = 1e-10;

/// Largest distance of the point from the cubic interpolant of the path, relative to the step: the interpolation error
/// is of fourth order in the step. A path that turns evenly by the permitted 0.6 radians per step departs from the
/// interpolant by 0.6³/384, 6e-4 of the step; the factor of about thirty covers uneven turns, and a point farther away
/// may lie on another branch and is left to the dense method.
pub(crate) const DISTANCE_FROM_PATH: f64 = 2e-2;

/// Cosine of the largest angle (8 degrees) between the direction at the point and the direction of the interpolant,
/// which the direction at the point has to continue. The direction of the interpolant is accurate to third order in the
/// step, about 2e-3 for a turn of 0.6 radians; a larger angle may belong to another branch, and the point is then left
/// to the dense method.
pub(crate) const CONTINUATION_COSINE: f64 = 0.99;

/// Distance from the point at which eigenvalues are counted, relative to the step. An eigenvalue that crosses has there
/// about 1e-4 of its change over the step, well above the fraction 1e-13 at which pivots count as zero; other crossings
/// at a smaller distance are not separated from the point.
pub(crate) const COUNTING_OFFSET: f64 = 1e-4;

/// Step (dimensionless) of the central differences of the test functions: about the cube root 6e-6 of the unit
/// round-off. At the cube root the truncation error 1e-10 and the rounding error 2e-16/1e-5 = 2e-11 are of the same
/// order.
pub(crate) const DIFFERENCE_STEP: f64 = 1e-5;

/// Correction (dimensionless) at which the search for a folded singularity has converged if corrections no longer
/// decrease; a thousandth of the correction ends the search in any case. The derivatives are accurate to about 1e-10,
/// so that corrections fall fast until round-off stops them; the bound is a tenth of the error 1e-9 that an increment
/// may have.
pub(crate) const FOLDED_CORRECTION: f64 = 1e-10;

/// Largest distance of the folded singularity from the start of the step, relative to the step. The determinant changes
/// sign within the step, but beside the path, so that the point may lie somewhat beyond the end of the step; a
/// heuristic share, since the inequalities and the residual decide on the point and a point farther away can be met in
/// a later step.
pub(crate) const SEARCH_REACH: f64 = 2.0;

/// Pivots of the state equations, relative to the first, up to which a pivot is zero and the point is a bifurcation
/// point instead. The square root of the unit round-off lies well above the error of equations solved to a residual of
/// 1e-11 or less, and well below the pivots of regular equations.
pub(crate) const STATE_RANK_TOLERANCE: f64 = 1e-8;

/// Largest violation of an inequality, relative to the scale of its quantity, with which a folded singularity is
/// accepted. The value is the violation 1e-10 of the laws of contact that any point of the path may have: ten times the
/// accepted residual 1e-11, and a tenth of the error 1e-9 that an increment may have.
pub(crate) const ACCEPTED_VIOLATION: f64 = 1e-10;

/// Relative residual at which closer regular points bring no improvement: about ten unit round-offs. The value affects
/// effort, and the accuracy only beyond this residual: a point is accepted up to a residual of 1e-11, and each further
/// round costs two solves of the path's equations.
pub(crate) const CONVERGED_RESIDUAL: f64 = 2e-15;

/// Distance of an eigenvalue from the first that crosses, relative to the largest eigenvalue, up to which both cross
/// together: the branches of closer crossings cannot be distinguished. For eigenvalues that change by the largest over
/// a unit arc length the crossings are then 1e-10 apart, no more than the violation that a point may have; the distance
/// lies well above the round-off of the eigenvalues.
pub(crate) const COINCIDENT_EIGENVALUES: f64 = 1e-10;

/// Distance (dimensionless) of a crossing from the start of the step up to which the crossing is the start itself. The
/// value is twice the correction 1e-9 at which Newton's method for a singular point ends, so that a start located by
/// this method and found again is recognised.
pub(crate) const START_DISTANCE: f64 = 2e-9;
