//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Size of the remainder of a unit motion, orthogonalised against the path's direction and the other motions, that
/// counts as none. The bound is about the square root of the unit round-off: a smaller remainder is accurate to less
/// than half of the digits, and may be the rounding error of a dependent motion.
pub(crate) const REMAINING_MOTION: f64 = 1e-8;

/// Ratio of the smallest to the largest pivot of a dense factorisation below which the digits lost are worth the larger
/// system that saves them. A ratio of 1e-4 leaves an error of about 2e-16/1e-4 = 2e-12, a few times below the accepted
/// residual 1e-11; a larger bound would cost the larger system, with one unknown more per element, without need.
pub(crate) const DENSE_PIVOT_RATIO: f64 = 1e-4;

/// Pivot ratio of a sparse factorisation below which the digits lost are worth a larger dense system that saves them: a
/// tenth of the ratio for dense factorisations, because small pivots were raised and corrected by borders, and the
/// pivots that remain are little larger than the bound 1e-4 for raised pivots. The largest pivot may be several times
/// the scaled entries of about 1, so that a healthy factorisation may have a ratio below 1e-4; a ratio of 1e-5 shows
/// digits lost in the complement of the borders.
pub(crate) const SPARSE_PIVOT_RATIO: f64 = 1e-5;

/// Lower bound on the friction force (dimensionless) in Newton's matrix, without which a turn of the slip would change
/// nothing and the matrix would be singular. A reaction of 1e-10 counts as zero, so that the bound replaces only forces
/// that are none; the residual is not affected, and the bound changes the corrections, but not the solution.
pub(crate) const SMALLEST_FRICTION_FORCE: f64 = 1e-10;

/// Gap (dimensionless) up to which a gap is the round-off of zero: a few hundred unit round-offs of a coordinate of
/// about 1. A larger gap that counts as zero, up to 1e-10, is kept, so that the path continues without a jump; a
/// smaller bound would keep mere rounding as a gap.
pub(crate) const GAP_ROUNDING: f64 = 1e-13;

/// Pivot, relative to the first in an elimination with complete pivoting of rows of unit size, that decides the rank of
/// a mode's equations. The bound leaves exactly dependent rows room for tens of thousands of unit round-offs from the
/// assembly and the elimination; a larger bound would take a soft part beside a stiff one for a free motion.
pub(crate) const RANK_TOLERANCE: f64 = 1e-11;

/// Upper bound on `z = λ h`, which keeps `z` finite as the reaction vanishes; larger values make no difference. At the
/// square root of the inverse unit round-off the friction force is about `K h/z`, 1e-8 of the elastic force `K h`, and
/// the departure of the direction from `θ*`, of the order of the turn over `z`, changes the forces by no more than
/// 1e-16 of `K h`.
pub(crate) const LARGEST_SETTLING: f64 = 1e8;

/// Speed (at unit arc length) and friction bound (over the rate of the reaction), the divisors of the turn of a
/// direction, up to which the turn is not defined. The value is the error 1e-9 that an increment may have, so that a
/// smaller divisor may have no correct digit; a direction without a known turn is integrated by the rule of lower
/// order.
pub(crate) const SMALLEST_TURN_DIVISOR: f64 = 1e-9;

/// Normal reaction at the end of an increment, relative to that at its start, up to which the turn at the end says
/// nothing of the turn on the way. Where a slip lifts off, its direction may move away as a power of the reaction, and
/// its turn per length grows without bound; the correction assumes a turn that is smooth over the increment.
pub(crate) const LIFTING_OFF: f64 = 1e-4;

/// Arc length to the loss of the normal reaction, at its rate at the start of the increment, up to which a slip may turn
/// by any angle: ten times the error 1e-9 that an increment may have. A direction that moves away as a slip lifts off
/// turns again and again at smaller and smaller reactions, and the motion on the way is no longer than this.
pub(crate) const LOOSE: f64 = 1e-8;
