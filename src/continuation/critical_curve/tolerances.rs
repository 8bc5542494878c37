//! Tolerances of curves of critical points.

/// Distance between the extrapolated and the corrected critical point, relative to the distance between two points of the
/// curve, from which on the step is refused: another critical point may have been found.
pub(crate) const LARGEST_DEVIATION: f64 = 0.5;

/// Largest change of the critical point in the first step from a point without direction, relative to the size of the state:
/// a larger one may be that to another critical point.
pub(crate) const FIRST_DEVIATION: f64 = 0.1;

/// Such distances are never taken for shorter than this, in dimensionless displacement and load.
pub(crate) const SHORTEST_CHORD: f64 = 1e-5;

/// Shortest step of the parameter, relative to the range.
pub(crate) const SHORTEST_STEP: f64 = 1e-7;

/// Corrections of the parameter up to this, relative to it, are round-off where they no longer become smaller.
pub(crate) const PARAMETER_ROUND_OFF: f64 = 1e-11;

/// Part of the longest step below which the curve may be close to a point where it turns back, and is sought across.
pub(crate) const TURNING_STEP: f64 = 1.0 / 16.0;

/// A turning point is that of the step that failed if it lies within so many of these steps: the parabola through the last
/// points may have a top far away, with changes of the curve in between.
pub(crate) const TURNING_REACH: f64 = 4.0;

/// A point in a plane past a turning point has gone back by at least this part of the last step: far enough for a parabola.
pub(crate) const SMALLEST_RETURN: f64 = 0.05;

/// Part of the longest step below which a refused model ends the curve: what makes a model impossible, such as a stiffness of
/// zero, is stated to that.
pub(crate) const MODEL_STEP: f64 = 1.0 / 64.0;

/// Remainders of the range up to this part of a step are round-off, and are no steps of their own.
pub(crate) const STEP_ROUND_OFF: f64 = 1e-9;

/// Width of a bracket of the turning point, in units of the last chord, at which its parabola has converged.
pub(crate) const TURNING_WIDTH: f64 = 1e-6;

/// Factor by which a step that was accepted grows.
pub(crate) const STEP_GROWTH: f64 = 2.0;

/// Where the kind of the critical points changes, the path is traced anew at such a part of the step past the change: close to
/// it the change of contact and the limit point are too close to each other to be told apart, far from it another change may
/// lie in between.
pub(crate) const PAST_CHANGE: [f64; 3] = [0.25, 1.0 / 32.0, 1.0 / 256.0];

/// Points closer to a change than this part of the longest step are not compared with paths.
pub(crate) const CLEAR_OF_CHANGE: f64 = 0.2;

/// Points closer than this part of the longest step to the value past which the curve is lost are not compared with paths. It
/// is small, since steps become short before that value, and all points after the last long step may be on no path.
pub(crate) const CLEAR_OF_LOSS: f64 = 1e-3;

/// A point is on a path if a limit point of the path is as near as this, relative to the size of the state. Both are exact to
/// some 1e-10; another limit point is rarely as near.
pub(crate) const ON_PATH: f64 = 1e-6;

/// Powers of the distance in the parameter with which limit points come to a bifurcation point: about 1/3, and less exactly so
/// some way off.
pub(crate) const CUSP_EXPONENTS: [f64; 2] = [0.2, 0.5];

/// Points of two histories coincide within this (dimensionless displacement and load).
pub(crate) const SAME_POINT: f64 = 1e-7;

/// Width, relative to the range of the parameter, within which the value is found from which on a path takes another direction.
pub(crate) const PREFERENCE_WIDTH: f64 = 1e-11;

/// Where a curve is lost between two values, the change may be this many shortest steps away from the last point.
pub(crate) const UNLOCATED_STEPS: f64 = 4.0;
