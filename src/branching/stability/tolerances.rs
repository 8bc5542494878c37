//! The numerical tolerances and limits of this folder, with the reason for each value.

/// Largest number of unknowns whose eigenvalues are computed: they take some 25 n³ operations, two seconds at this size.
pub(super) const MOST_UNKNOWNS: usize = 500;

/// Largest number of combinations of contact modes that are examined at one point ...
pub(super) const MOST_MODES: usize = 1024;

/// ... and of them times the cube of the unknowns: some ten seconds.
pub(super) const MOST_OPERATIONS: f64 = 2e9;

/// Largest number of iterations for the eigenvalues of a matrix, for each of its rows.
pub(super) const MOST_ITERATIONS: usize = 100;

/// Stiffness (dimensionless) up to which an eigenvalue is zero. Limit points are located with an error of 1e-10 in arc
/// length, by which the eigenvalue changes in proportion.
pub(super) const NEUTRAL: f64 = 1e-8;

/// Shifts (dimensionless stiffness) where an eigenvalue is zero: the compliances of the others, with an error of round-off
/// over the shift, then tell stiffnesses up to 1e12 from those of held motions, and the zero one is as exact as it was.
pub(super) const SHIFTS: [f64; 4] = [1.37e-3, 2.11e-3, 3.07e-3, 4.79e-3];

/// Largest entry of a matrix times its inverse, less the identity: round-off times the condition number, as far as an
/// eigenvalue is told from zero.
pub(super) const INVERSE_ERROR: f64 = 1e-4;

/// Distance of every eigenvalue from a shift, relative to the shift.
pub(super) const CLEAR_OF_SHIFT: f64 = 1e-3;

/// Imaginary part relative to the size of an eigenvalue up to which it is real: a double eigenvalue comes out as a pair
/// that differs by the square root of round-off.
pub(super) const REAL: f64 = 1e-7;

/// Distance of two eigenvalues, relative to their size, within which they have no motions of their own.
pub(super) const MULTIPLE: f64 = 1e-6;

/// Rates of a motion of unit size that violate a law of contact by less are admissible: the motion is an eigenvector with
/// an error of round-off over the distance of the eigenvalues.
pub(super) const ADMISSIBLE: f64 = 1e-8;

/// Margin, relative to the largest entry, by which a form has to be positive definite: its entries are sums of products
/// with an error of round-off.
pub(super) const DEFINITE: f64 = 1e-12;

/// Arc lengths along a direction after which its stability is told, the first one that its modes hold for. An eigenvalue
/// that is zero at the point, as at a limit point, is then some thousand times its error 1e-8.
pub(super) const SHORT_WAYS: [f64; 2] = [1e-4, 1e-6];
