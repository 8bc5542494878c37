//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Largest value of a quantity, over its scale, at a point accepted as its zero. The value is below unit round-off
/// 2e-16, so that the location proceeds as far as rounding permits; a remainder up to the event tolerance 1e-13 that no
/// longer decreases is round-off, and the location ends there.
pub(crate) const LOCATED_VALUE: f64 = 1e-16;

/// Arc length (dimensionless) within which a point counts as the zero of a quantity whose value there is round-off. The
/// gap of a node of a finely divided beam changes by 1e-7 over a unit of arc length: a value of 1e-14 is then as far
/// from the zero as 1e-7, over which reactions change by as much. The length keeps such changes below the tolerance
/// 1e-10 on reactions that are zero.
pub(crate) const LOCATED_LENGTH: f64 = 1e-11;

/// Ratio to the nearest earlier value above which a value has decreased too slowly: the bracket is then halved.
/// Interpolation near a simple zero reduces the value far more than four times, and halving the bracket reduces the
/// value by about a factor of two; the ratio affects effort only.
pub(crate) const SLOWEST_DECREASE: f64 = 0.25;

/// Multiple of the tolerance on zero within which the zero is found by a straight step. Values are then at most 1e-10
/// of their scale, and the error of the step is of second order, far below round-off; the point found has to meet the
/// tolerances like any other.
pub(crate) const STRAIGHT_STEP_MULTIPLE: f64 = 1e3;

/// Largest length of the straight step over the distance to the next point, between which the direction is interpolated
/// linearly. The error of the interpolation is proportional to the ratio times the second difference of the direction;
/// the point found has to meet the accepted residual, so that a larger ratio only adds straight steps in vain.
pub(crate) const LONGEST_STRAIGHT_STEP: f64 = 1e-3;

/// Points closer than this to another, over the bracket (or the step), give no further information: a second difference
/// over a hundredth of the bracket magnifies the round-off of values by 1e4. A larger distance discards useful points;
/// the distance affects effort only, except in the choice of the points that show whether a slip ends.
pub(crate) const SMALLEST_SEPARATION: f64 = 1e-2;

/// Slopes of the secants on both sides of a zero that differ by no more than this factor count as similar: the quantity
/// then falls through zero. A quantity that touches zero or lingers there has secants of opposite sign or of very
/// different slope, since the points lie at different distances; a simple zero has secants of nearly equal slope, and
/// the factor leaves room for its curvature.
pub(crate) const LARGEST_SLOPE_RATIO: f64 = 4.0;

/// Largest distance of the point at which a bound is met from the estimate, over the bracket. The estimate by a
/// polynomial is far more accurate within a step; a point farther away may lie on another branch that meets the same
/// bound, and a refused point costs one solve.
pub(crate) const LARGEST_DEVIATION: f64 = 0.1;

/// Distance at which a point is tried beside a position where none is found, over the tolerance on positions. At the
/// exact position the equations may be singular to the last digit; the multiple lies well outside the rounding of the
/// position, and the point is still so close to the zero that the search continues from there.
pub(crate) const OFFSET_MULTIPLE: f64 = 16.0;

/// Multiple of the rounding of a state's numbers within which two positions coincide. A position is a difference of a
/// few such numbers, each with an error of half a unit of round-off; a smaller multiple would continue a search that
/// rounding prevents, and a larger one would lose digits of the event's place.
pub(crate) const POSITION_ROUND_OFF_MULTIPLE: f64 = 4.0;

/// Largest step, over the step before, for which the path is extrapolated: round-off must not be amplified visibly. At
/// 4 the cubic multiplies the round-off of the chord by 175, to about 4e-14; at ten the factor would be 2299. A longer
/// step starts from the tangent.
pub(crate) const LONGEST_EXTRAPOLATION: f64 = 4.0;

/// Largest turn of the direction (radians) in a step, and of the chord against the directions at both ends. Steps aim
/// at a turn of 0.08, so that ordinary steps are far below; the sphere around the start also meets the path behind and
/// may meet other branches, whose chords turn farther.
pub(crate) const LARGEST_TURN: f64 = 0.6;

/// Cosine of [`LARGEST_TURN`]: the test of a turn needs no inverse cosine.
pub(crate) const SMALLEST_COSINE: f64 = 0.825_335_614_909_678_3;

/// Largest angle (radians) by which the turns at the ends of a step may deflect the chord of a slip. The rule for the
/// chord is a series in the angle; at a tenth its terms fall by a factor of ten or more, and a step with a larger angle
/// is shortened.
pub(crate) const LARGEST_TURN_CORRECTION: f64 = 0.1;

/// Change of the angles (radians) of the directions of slip up to which the directions have settled. An angle turns
/// tractions by the same relative amount, so that the value has to lie below the measure of error 1e-9; the accepted
/// residual 1e-11 of each solve is a tenth of the value.
pub(crate) const SETTLED_ANGLE: f64 = 1e-10;

/// Magnitude of an event function, over its scale, up to which a negative value does not count as passed. The value is
/// 500 units of round-off, 2e-16, the error of gaps and reactions at a point solved to round-off, and a thousandth of
/// the violation 1e-10 that an accepted point may have.
pub(crate) const EVENT_TOLERANCE: f64 = 1e-13;

/// Load rate up to which both ends of a step may be for the load to count as constant: the rounding of a rate of unit length
/// by a matrix of condition 1e4. A body that slides down a slope leaves up to 5e-13; over a step of unit length a
/// maximum between two such rates rises by less than the accepted residual 1e-11 of a point.
pub(crate) const LOAD_RATE_ROUNDING: f64 = 5e-12;

/// Distance (dimensionless) within which a bound of the stage is reached. Load and displacements at a point have errors
/// of some 1e-13; a last solve meets the bound exactly, so that the value only has to exceed these errors and to stay
/// far below the shortest step 1e-9.
pub(crate) const BOUND_TOLERANCE: f64 = 1e-12;

/// Tolerance, over their scales, within which two quantities are zero at the same point. The value is the magnitude
/// 1e-10 up to which gaps and reactions are zero at a point (`CONTACT_TOLERANCE`), so that no step of no length
/// remains up to such a change; the value is a thousand times the event tolerance.
pub(crate) const COINCIDENCE_TOLERANCE: f64 = 1e-10;

/// The ratio of a way along a step to its chord that is allowed for where two gaps are compared with the way between
/// them: a step turns by at most [`LARGEST_TURN`], over which an arc is 1.5 % longer than its chord.
pub(crate) const WAY_MARGIN: f64 = 1.1;

/// Part of a step down to which gaps from curved obstacles are compared with the way between them. An obstacle thinner
/// than this part of a step's motion may be missed; the value bounds the effort to as many gaps.
pub(crate) const SHORTEST_PART: f64 = 1.0 / 64.0;

/// Arc length (dimensionless) within which a node that slips in space may leave its obstacle in one step, however its direction
/// turns. The slip on this way is not resolved: it is shorter than this, and of its direction no more is known. The value is
/// ten times the error 1e-9 that an increment may have, as the slip is a part of the way, and its direction is wrong by a
/// part.
pub(crate) const LAST_SLIP: f64 = 1e-8;
