//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Step (dimensionless) of the extrapolated central differences of the matrix for second derivatives; the error of the
/// formula is of fourth order. The value is about the fifth root 7e-4 of the unit round-off, which balances the
/// truncation error 1e-12 and the rounding error 2e-16/1e-3 = 2e-13.
pub(crate) const EXTRAPOLATED_DIFFERENCE_STEP: f64 = 1e-3;

/// Residual of left vectors found by symmetry, relative to the largest stiffness and the size of the vectors, up to
/// which the residual is round-off. The bound leaves room for a few thousand unit round-offs from solves and products;
/// a larger residual, as with friction, makes the left vectors be solved for, at the cost of one more factorisation.
pub(crate) const SYMMETRY_RESIDUAL: f64 = 1e-12;

/// Residual of left vectors found by symmetry near a singular point, as a multiple of the largest test function, that
/// is accepted besides round-off. Away from the point the vectors satisfy the equations only up to the test functions
/// themselves; the factor of ten covers the combination of several vectors, and the test functions decrease with
/// Newton's method.
pub(crate) const SYMMETRY_TEST_FACTOR: f64 = 10.0;

/// Pivots of the equations at a singular point, relative to the first, up to which a pivot is zero. The square root of
/// the unit round-off lies above the pivots that remain at a point located to about 1e-9, and far below the pivots of
/// regular equations; at points that are not located as singular the stricter rank tolerance 1e-11 of the equations
/// holds.
pub(crate) const SINGULAR_PIVOT: f64 = 1e-8;

/// Pivots below this fraction of the largest entry count as zero when eigenvalues are counted. The bound is a few
/// hundred unit round-offs, which the elimination may leave of a vanishing eigenvalue; a larger one would take soft
/// parts beside stiff ones for singular.
pub(crate) const ZERO_PIVOT: f64 = 1e-13;

/// Difference of the tangent and its transpose, relative to the largest entry, beyond which eigenvalues are not counted by
/// signs of pivots. Sums over the elements leave some unit round-offs.
pub(crate) const ASYMMETRY: f64 = 1e-13;
