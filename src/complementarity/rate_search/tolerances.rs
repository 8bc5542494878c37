//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Magnitude up to which a form (of unit size, at a node's point with `t = 1`) counts as zero in the search, and up to
/// which the load rate of a ray of unit arc length has no sign. The value is ten times the infeasibility 1e-8 that the
/// dictionary permits and a hundred times the tolerance 1e-9 of the exact test: the search has to select every
/// combination that the exact test may accept, and a larger value only costs exact tests.
pub(crate) const SEARCH_TOLERANCE: f64 = 1e-7;

/// Change in a sweep, relative to the largest velocity, from which Newton's method takes over. Newton's method
/// converges quadratically, so that a start accurate to 1e-6 suffices for round-off in two iterations; a larger value
/// risks a pattern that still changes, and a smaller value costs sweeps, which converge linearly.
pub(crate) const SETTLED_CHANGE: f64 = 1e-6;

/// Relative magnitude up to which rates count as zero and rays as equal: velocities relative to unit arc length,
/// weights relative to the largest weight. The value is the tolerance of the exact test of rays (`rates::ray`) and the
/// measure of error 1e-9, far above the round-off that Newton's method leaves.
pub(crate) const RATE_TOLERANCE: f64 = 1e-9;

/// Magnitude of coefficients (relative to the largest coefficient of the node) and of forces (relative to the node's
/// load) up to which coefficients and forces are round-off. The value is 5e3 units of round-off, 2e-16, for sums over
/// all weights, and a thousandth of the tolerance 1e-9 on rates.
pub(crate) const COEFFICIENT_ROUND_OFF: f64 = 1e-12;

/// Largest difference of the weights of two rays, relative to the largest weight, at which the rays are equal. Equal
/// rays of different combinations differ by the round-off of their null vectors, unit round-off 2e-16 times the
/// conditioning; the value is the tolerance 1e-9 within which inequalities of rays are weak, so that different rays are
/// not confused.
pub(crate) const RAY_DISTANCE: f64 = 1e-9;

/// Least cosine between the motions of rays at neighbouring angles that belong together. Neighbouring angles differ by
/// 0.1 (cosine 0.995); 0.9, an angle of 0.45, lets the motion turn four times as fast as the direction. Where it
/// turns faster, the angles between are searched, too: a larger value costs searches, and a smaller one joins unrelated
/// rays, for which the root is sought in vain.
pub(crate) const SMALLEST_RAY_COSINE: f64 = 0.9;

/// Misfit of the traction (relative to the force rates) up to which an angle is a root; motions and forces up to this
/// magnitude (relative to unit arc length and the force rates) are none. The value is the measure of error 1e-9 and the
/// tolerance of the exact test of rays; the misfit's round-off, unit round-off times the conditioning of the ray, is
/// smaller.
pub(crate) const MISFIT_TOLERANCE: f64 = 1e-9;
