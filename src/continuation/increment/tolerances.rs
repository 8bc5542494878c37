//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Largest relative error of an arc length that counts as adapted: further changes of `γ1` move the end by less than a
/// hundredth, and a smaller relaxation is tried instead. The value affects effort only, as Newton's method refines the
/// end at the exact arc length.
pub(crate) const ADAPTED_ARC_LENGTH: f64 = 1e-2;

/// Distance (dimensionless, relative to 1 plus the arc length) between the refined point and the original one within
/// which the points are the same. Both points have residuals up to 1e-11, a hundredth of the value; the value is the
/// measure of error 1e-9 that increments have to meet.
pub(crate) const POINT_DISTANCE: f64 = 1e-9;

/// Reactions relative to the force scale, and gaps relative to the arc length, up to this are zero on the boundary of
/// two modes. The value is the tolerance 1e-6 within which the program takes a pair as biactive: closer to the boundary
/// the program may find either mode.
pub(crate) const MODE_BOUNDARY_TOLERANCE: f64 = 1e-6;

/// Arc length at which a direction is first verified by the program, as a fraction of the path's next step. The
/// fraction is a heuristic for effort: a longer increment more often passes a change and is repeated, and a shorter one
/// has members nearer to the tolerance of the program.
pub(crate) const FIRST_TRIAL_SHARE: f64 = 0.25;

/// Largest part of the distance to the next contact change that the arc length of a trial may reach. The distance is
/// known to first order, and the arc length of the program's increment is only approximately the one requested (up to
/// twice); half the distance keeps the increment before the change.
pub(crate) const SHARE_BEFORE_CHANGE: f64 = 0.5;

/// Arc length below which the program cannot distinguish changes: its products end at a relaxation of 1e-8. A smaller
/// value would accept verdicts that the relaxation makes arbitrary, and a larger value would leave more modes close to
/// a change unverified.
pub(crate) const SHORTEST_RESOLVED_LENGTH: f64 = 1e-8;

/// Factor by which the arc length of a trial is shortened where the extent of the mode is unknown. A decade per trial
/// reaches the shortest resolved length 1e-8 from an ordinary step of 1e-2 in six trials; the factor affects effort
/// only.
pub(crate) const SHORTENING_FACTOR: f64 = 0.1;

/// Smallest fraction of an increment at which a program is believed to find the end of a mode: smaller fractions may be
/// the program's own tolerance. Halved, the fraction leaves at least one more trial above the shortest resolved length
/// 1e-8 for every arc length above 2e-5; the fraction affects effort only.
pub(crate) const SMALLEST_MODE_EXTENT: f64 = 1e-3;

/// Arc length below which a reaction that has just left a boundary may still be on the boundary within the program's
/// tolerance. Reactions change by at most about the arc length (both dimensionless), and the program takes members up
/// to 1e-6 as zero; a factor of ten allows for reactions that change more slowly.
pub(crate) const DOUBTFUL_LENGTH: f64 = 1e-5;

/// Where contacts change one after another, the multiple of the distance between the last two changes within which the
/// next change is sought: over a short distance Newton's method and event location need little work. The multiple is a
/// heuristic for effort: an ordinary step follows where no change lies within it.
pub(crate) const NEXT_CHANGE_RATIO: f64 = 4.0;

/// Largest part of a step over which the next of several changes is sought separately: a search over more than half of
/// the step costs about as much as the step itself. The part affects effort only.
pub(crate) const LARGEST_SHARE_OF_STEP: f64 = 0.5;

/// The turn of the path (radians) for which a step aims. On a circle the straight predictor then misses the point by
/// 0.04 of the step, so that Newton's method converges in a few iterations, and a full circle takes 79 steps; the turn
/// affects the number of points and their cost, not their accuracy.
pub(crate) const TARGET_TURN: f64 = 0.08;

/// The number of Newton iterations to a small error for which a step aims. Quadratic convergence takes about four
/// iterations from an error of a tenth to 1e-6; the number affects effort only: fewer iterations mean more steps, and
/// more iterations mean more refused steps.
pub(crate) const TARGET_ITERATIONS: f64 = 4.0;

/// The energy imbalance of an increment, relative to the largest energy so far, for which a step aims. Two hundred
/// increments with imbalances of one sign then add up to 1e-6, to which the tests hold the energy balance; the
/// imbalance is of fifth order in the arc length, so that a ten times smaller value shortens steps by a factor of 1.6
/// only.
pub(crate) const TARGET_IMBALANCE: f64 = 5e-9;

/// Round-off in the work of an increment, relative to the largest force times the arc length: 16 units of round-off for
/// the sums and differences of which the work consists. A smaller imbalance says nothing about the length of the step.
pub(crate) const WORK_ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Arc length up to which an imbalance within the round-off of the forces, which is proportional to the arc length, is
/// tolerated. Next to stiff elements the energy stored in soft elements may be smaller than the effect of round-off,
/// whatever the step, so that a step this short is not shortened any further; the value is a twentieth of the usual
/// first step 0.02, so that ordinary steps are still controlled by the energy balance.
pub(crate) const SHORT_STEP: f64 = 1e-3;

/// Forces up to this multiple of the rounding of the structure's forces are none: the energies of a motion without
/// stress say nothing about the step. The rounding of a force is one unit, that of a sum over elements a few.
pub(crate) const UNSTRESSED_MULTIPLE: f64 = 100.0;

/// Stretch of a bar at which round-off in displacements of the order of the bar's length rotates the bar by as much as
/// forces may be in error: unit round-off 2e-16 over the stretch 1e-6 is 2e-10, about the violation 1e-10 that an
/// accepted point may have. A shorter bar has no reliable direction.
pub(crate) const SMALLEST_STRETCH: f64 = 1e-6;

/// A step is repeated with a shorter length if the factor for the next step is no larger than this. With factors in
/// eighths of an octave, a step is rejected for seven or more iterations, a turn of more than 0.134 or an imbalance of
/// more than 13 times the target; a larger factor repeats more steps, and a smaller one accepts steps with imbalances
/// far above the target.
pub(crate) const REJECTION_FACTOR: f64 = 0.55;

/// Largest ratio of the next step to the present one; in eighths of an octave the ratio becomes 1.68. The ratio stays
/// below the factor 4 up to which the path is extrapolated, and a step that turns out too long wastes little work; the
/// ratio affects effort only.
pub(crate) const LARGEST_STEP_GROWTH: f64 = 1.8;

/// Largest growth of the path's curvature, relative to the step before, assumed in the prediction for the next step.
/// The bound is a heuristic for effort: a larger growth may be round-off in a small turn, and a step that turns too far
/// is shortened anyway.
pub(crate) const LARGEST_CURVATURE_GROWTH: f64 = 4.0;

/// Arc length past an unresolved bend at which the path resumes, relative to the square of the width of its arms there.
/// The width grows with the square root of the arc length, so that the chord then deviates from the direction by a
/// fifth, `1/√25`, a third of the largest turn of a step; a shorter step would still be in the bend, and a longer one
/// may pass other events.
pub(crate) const LENGTH_PAST_BEND: f64 = 25.0;

/// Arc length (dimensionless) below which a step without contact change counts as creeping. Steps grow from the
/// shortest length distinguishable from round-off, 1e-9 by default, to more than this within a few steps (six at the
/// largest growth), so that a path that recovers is not given up.
pub(crate) const CREEPING_LENGTH: f64 = 2e-8;

/// Largest creeping length, relative to the longest step requested, where only short steps are requested. Steps within
/// three decades of the longest one are the user's choice; a path that stays below a thousandth of that length does not
/// progress.
pub(crate) const CREEPING_SHARE: f64 = 1e-3;

/// A step that ends before this fraction of its attempted length does not let the next be longer. The fraction is a
/// heuristic for effort: a short part of a step says little about a longer step in the mode that follows.
pub(crate) const SMALLEST_COMPLETED_SHARE: f64 = 0.5;

/// Work of the forces of a stage on a motion, relative to the sizes of both, up to which they do none. The motion at a limit
/// point is accurate to about 1e-9 times what the path bends there; forces that do as little work as this drive a motion
/// that is a hundred million times as fast as they are, which no step resolves.
pub(crate) const NO_WORK: f64 = 1e-8;

/// Arc length before the zero of a reaction within which the zero belongs to an event that is located before it. An event
/// is located to the rounding of its quantity over its rate: some 1e-14 over 1e-5 for the gap of a node of a finely
/// divided beam. Points are accepted with an error of 1e-9, and a reaction that vanishes 1e-8 further on cannot be told
/// from one that vanishes there.
pub(crate) const SIMULTANEOUS_LENGTH: f64 = 1e-8;
