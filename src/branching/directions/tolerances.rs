//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// One less the product of two directions of unit arc length up to which the directions coincide: an angle of 4.5e-5.
/// The angle lies well above the errors of both directions, the incoming direction being that of a slip whose end is
/// located to about 1e-9, and far below the angle to the direction of another mode.
pub(crate) const COSINE_TOLERANCE: f64 = 1e-9;

/// Speeds (of unit arc length) up to which a contact rests within the accuracy with which the end of a slip is located.
/// The value is the error 1e-9 that an increment may have; a slip that another event interrupts still has a far higher
/// speed there.
pub(crate) const RESTING_SPEED: f64 = 1e-9;

/// Margin of an inequality (of rates of unit arc length; forces relative to the largest) up to which the inequality is
/// weak, and a trial step decides. The value is the error 1e-9 that an increment may have, far above the round-off of
/// rates; a larger margin only costs more trial steps, and a smaller one would take rounding for a sign.
pub(crate) const WEAK_MARGIN: f64 = 1e-9;

/// Angle between two directions, and difference of their forces relative to the largest, up to which the directions are
/// merged into one. The angle follows from the cosine, whose rounding 2e-16 alone corresponds to an angle of 2e-8, so
/// that the bound can hardly be smaller; distinct modes differ by far larger angles.
pub(crate) const MERGE_TOLERANCE: f64 = 1e-7;

/// Rates of a contact's forces, relative to the largest, that are round-off where directions of one family are compared:
/// some hundred times that of rates of about 1. Chains whose friction is 1e-11 have directions of their own that differ
/// in friction alone.
pub(crate) const FRICTION_ROUND_OFF: f64 = 1e-13;

/// Load rates (of unit arc length) up to which the load is stationary. The value is the error 1e-9 that an increment
/// may have: the sign of a smaller load rate at first order may be rounding or the remainder of the location of a limit
/// point, and the load rate after a trial step decides.
pub(crate) const STATIONARY_LOAD_RATE: f64 = 1e-9;

/// Largest difference (of unit arc length) from the reversed incoming direction at which a direction may retrace the
/// path. The difference corresponds to a cosine of -1 + 8e-10, within the 1e-9 by which two directions of a list count
/// as reverses of each other; only the closest direction within the bound is taken for the way back.
pub(crate) const RETRACE_MOTION: f64 = 4e-5;

/// Largest difference of the rates of the forces on the nodes from the reversed incoming ones, relative to the largest,
/// at which a direction may retrace the path. The bound is wider than that of the motion, since stiffnesses amplify
/// differences of motions into differences of forces, and far below the change of force by another mode, which is of
/// the order of the largest.
pub(crate) const RETRACE_FORCES: f64 = 1e-4;

/// Largest cosine of the angle between a direction and a normal at which the direction counts as tangential. Directions
/// and normals of a frame are perpendicular within a few unit round-offs of 2e-16, and the neglected normal part stays
/// far below the error 1e-9 of rates; otherwise the equations are factorised again, at more effort.
pub(crate) const TANGENTIAL_COSINE: f64 = 1e-12;

/// Accepted backward error of the solutions combined into columns, the same 1e-11 as with a factorisation of their own:
/// on a lattice of 102,304 unknowns the rates are accurate to about 2e-9. Ten times more would leave these rates above
/// the margin 1e-9 of weak inequalities by far, and a smaller error costs further corrections.
pub(crate) const ACCEPTED_BACKWARD_ERROR: f64 = 1e-11;

/// Smallest ratio of the pivots of the matrix of velocities and loads of the solutions (entries of about 1) at which
/// the solutions span the space. The combination amplifies the errors of the solutions by about the inverse ratio, at
/// most three digits; below the ratio the columns are solved for with a factorisation of their own, so that the value
/// mainly affects effort.
pub(crate) const SMALLEST_SPANNING_PIVOT: f64 = 1e-3;

/// Quantities over their scale, and slopes (of unit arc length; forces relative to the largest), up to which the
/// quantity is zero at first order, so that the trial step tests the quantity. The value is ten times the margin 1e-9
/// of weak inequalities, so that every weak inequality is tested, and about the square root of the unit round-off; a
/// larger value would test quantities whose end is a later event.
pub(crate) const FIRST_ORDER_TOLERANCE: f64 = 1e-8;

/// Slopes of forces after a trial step, relative to the contact's own forces, above which a slope has a sign (but no
/// smaller than the round-off relative to the largest force). The value is the margin 1e-9 of weak inequalities: even
/// after the shortest trial step 1e-6 a slope that grows at a rate of order one is a thousand times larger, and a slope
/// within the bound is left to a longer step.
pub(crate) const CLEAR_SLOPE: f64 = 1e-9;

/// Round-off of the slope of a force, relative to the largest force: smaller slopes have no sign, however small the
/// contact's own forces. Some two hundred unit round-offs cover the sums of the factorisation and of the reactions;
/// along a chain close to jamming forces fall by orders of magnitude from node to node, so that a larger value would
/// hide the signs of small forces.
pub(crate) const FORCE_RATE_ROUNDING: f64 = 5e-14;

/// Velocity normal to an obstacle or along a slip after a trial step, relative to the node's own velocity, up to which
/// the velocity has no sign. A smaller velocity leaves the gap within round-off, a few hundred unit round-offs, over
/// the whole path.
pub(crate) const RELATIVE_SPEED_ROUNDING: f64 = 1e-13;

/// Round-off of a velocity (of unit arc length): some fifty unit round-offs for the sums of a solve. The bound is added
/// to that relative to the node's own velocity, so that a node on a stiff spring, which moves slowly, keeps a clear
/// direction.
pub(crate) const SPEED_ROUNDING: f64 = 1e-14;

/// Load rates (of unit arc length) up to which the load rate is round-off, unless a smaller bound of its rounding is
/// known. The value leaves room for the amplification of the unit round-off by a few thousand in a solve; a smaller
/// load rate counts only above the computed bound, as close to critical friction, where the load rises or falls very
/// slowly.
pub(crate) const LOAD_RATE_ROUNDING: f64 = 1e-12;

/// Number of unit round-offs assumed in each entry of the equations and of their solution, in the bound of the rounding
/// of a load rate. An entry sums the contributions of a few elements, each rounded a few times; the bound adds the
/// magnitudes of all terms, so that a larger number would make the bound only more pessimistic.
pub(crate) const ROUNDINGS_PER_ENTRY: f64 = 8.0;

/// Relative change of a load rate over a trial step up to which the load rate is steady. Half of the load rate leaves
/// the sign certain; a load rate that grows from zero along the path differs from that at the start by far more over
/// trial steps from 1e-6 to 1e-3.
pub(crate) const STEADY_RATE_CHANGE: f64 = 0.5;

/// Largest negative value of a watched quantity, over its scale, that is permitted after a trial step, beyond what is
/// below zero at its start: the residual 1e-11 up to which a point is accepted. A true violation is of second order in
/// the step and exceeds the bound from the trial step 1e-5 on; for the shortest step 1e-6 the slope shows the violation.
pub(crate) const TRIAL_VIOLATION: f64 = 1e-11;
