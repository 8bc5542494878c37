//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Part of its motion that a null vector must retain after orthogonalisation against the others, and least motion
/// relative to its largest reaction, to count as independent. The bound is about the square root of the unit round-off:
/// a smaller remainder is accurate to less than half of the digits, and may be the rounding error of a dependent
/// vector.
pub(crate) const REMAINING_MOTION: f64 = 1e-8;

/// Width of a parabola at a unit arc length up to which the parabola counts as a line: round-off in the equations moves
/// a point at the fold by as much. The width is the square root of `2 |σ/c|`, so that 1e-7 corresponds to `σ/c` =
/// 5e-15, some twenty unit round-offs.
pub(crate) const SMALLEST_PARABOLA_WIDTH: f64 = 1e-7;

/// Singular values of the coordinate vectors (of unit size) up to which the vectors are linearly dependent, and largest
/// error of the product with their pseudo-inverse. The vectors come from forms whose eigenvalues up to 1e-6 of the
/// largest count as zero, so that smaller singular values are not distinguished either; those of uncoupled parts are of
/// order one.
pub(crate) const COORDINATE_RANK_TOLERANCE: f64 = 1e-6;

/// Residual of the reduced equations, relative to their largest coefficient, at which Newton's method has converged.
/// Round-off in the few terms stays well below, and Newton's method converges quadratically; at a double root, where
/// the error of the shares is the square root of the residual, the shares are accurate to 1e-6, well within the angle
/// 4.5e-3 at which directions coincide.
pub(crate) const REDUCED_RESIDUAL: f64 = 1e-12;

/// Singular values of the scaled reduced equations and of the fit of the cubics, with entries of about 1, up to which
/// singular values are zero: along a continuum of branches Newton's method takes the shortest correction. The square
/// root of the unit round-off lies well above the error of about 1e-12 of the extrapolated second derivatives, and
/// below the singular values of isolated roots.
pub(crate) const SINGULAR_VALUE_BOUND: f64 = 1e-8;

/// Step (dimensionless) of the second difference of the matrix for third derivatives: a truncation error of about 1e-6
/// and a rounding error of 2e-16/1e-6 = 2e-10. The step is larger than the fourth root 1e-4 of round-off, since
/// stiffnesses far larger than their derivatives raise the rounding error; both errors stay far below the angle 4.5e-3
/// at which directions coincide, and a trial step confirms each direction.
pub(crate) const THIRD_DERIVATIVE_STEP: f64 = 1e-3;

/// Second derivatives up to this fraction of the largest are zero. The bound lies a hundred times above the truncation
/// error 1e-8 of the central differences, and below the curvature of a branch that bends with its structure, which is
/// of the order of the largest.
pub(crate) const CURVATURE_TOLERANCE: f64 = 1e-6;

/// Second derivatives along null vectors up to this fraction of the largest are round-off. The central differences leave
/// 2e-12 of it in each entry, and their products with the vectors add up many: an arch of 600 nodes, symmetric, leaves
/// 5e-11, where the eigenvalue crosses with a second derivative of 2.5e-5.
pub(crate) const DERIVATIVE_ROUND_OFF: f64 = 1e-10;

/// Radius (dimensionless) of the sphere on which branch points are sought; the chords to this radius and to half of the
/// radius are extrapolated to radius zero. The extrapolation leaves an error of the square of the radius, 1e-4, well
/// within the angle 4.5e-3 at which directions coincide; at smaller radii the equations are the more nearly singular.
pub(crate) const SEARCH_RADIUS: f64 = 1e-2;

/// Cosine of the angle 4.5e-3 below which two directions coincide. The angle lies well above the error 1e-4 of
/// directions extrapolated from branch points at a radius of 1e-2, and well below the spacing of 10 degrees at which
/// directions around a plane are tried.
pub(crate) const COINCIDENCE_COSINE: f64 = 1.0 - 1e-5;

/// Margin of an inequality (velocities at unit arc length, forces relative to the largest) below which the inequality
/// is in doubt, and size up to which a velocity or force counts as zero. The margin is ten times the truncation error
/// 1e-8 of the second derivatives from which directions follow; a larger margin only adds modes that a trial step then
/// refuses, a smaller one may lose a branch.
pub(crate) const DOUBTFUL_MARGIN: f64 = 1e-7;

/// Step (dimensionless) of the central differences of the dense matrix for second derivatives: a truncation error of
/// about 1e-8 and a rounding error of 2e-16/1e-4 = 2e-12. The step is larger than the cube root 6e-6 of round-off,
/// since stiffnesses far larger than their derivatives raise the rounding error; both errors stay well below the bound
/// 1e-6 for vanishing second derivatives.
pub(crate) const SECOND_DERIVATIVE_STEP: f64 = 1e-4;

/// Rates of first order (of unit arc length; forces relative to the largest) up to which second order decides, as trial
/// steps decide elsewhere; directions whose forces differ by no more coincide. The value is that of the trial steps,
/// about the square root of the unit round-off and ten times the margin 1e-9 at which a rate counts as zero.
pub(crate) const FIRST_ORDER_TOLERANCE: f64 = 1e-8;

/// Accuracy (dimensionless) of the location of events along the path: where the path bends sharply, a quantity that is
/// zero at an event is zero at first order except for its change over this arc length. The value is the residual 1e-11
/// up to which a point is accepted; a smaller one would take the remainder of an event for a rate of first order.
pub(crate) const LOCATION_ERROR: f64 = 1e-11;

/// Changes of rates up to this part of the largest, and bends up to this size, are zero: such changes are within the
/// error of the differences of the tangent. The bend follows from central differences with a truncation error of about
/// 1e-8; the factor of a hundred covers the solve with the bordered matrix, and a change that decides an inequality is
/// of the order of the largest.
pub(crate) const RATE_CHANGE_TOLERANCE: f64 = 1e-6;

/// Radius of curvature (dimensionless) below which no step follows a bend: the path resumes past the bend. The shortest
/// trial radius 1e-4 is ten times larger, so that every trial step would end past the bend; a path with a larger radius
/// is left to ordinary steps.
pub(crate) const SMALLEST_CURVATURE_RADIUS: f64 = 1e-5;
