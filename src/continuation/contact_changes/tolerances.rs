//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Length by which the trial step exceeds the distance to the event, relative to this distance: the event is then
/// detected as passed. The path is straight up to the event, so that a sixty-fourth suffices, far more than the
/// tolerance 1e-13 on passed events; a larger part would reach contacts that the event does not need.
pub(crate) const EVENT_OVERSHOOT: f64 = 1.0 / 64.0;

/// Change per unit arc length, as a fraction of the scale of a contact quantity, up to which the quantity is constant.
/// Contact quantities are differences of other quantities, whose round-off exceeds unit round-off 2e-16 by the ratio of
/// these quantities to the scale; a quantity that changes by less than 1e-10 violates its law, over a unit arc length,
/// by no more than the largest accepted violation 1e-10.
pub(crate) const CONSTANT_SLOPE: f64 = 1e-10;

/// Change per unit arc length up to which the load or a displacement that ends a stage is constant. Load and
/// displacements are not differences of other quantities: their rates, of unit arc length, have an error of some 50
/// units of round-off, 2e-16, at most, and a larger value would miss bounds that are far away.
pub(crate) const CONSTANT_BOUND_SLOPE: f64 = 1e-14;

/// Value of a decreasing quantity, relative to its scale, up to which the quantity counts as zero at the present point:
/// no event is then predicted. The value is ten times the tolerance 1e-13 on passed events, and a value above the
/// round-off of the location of events only forgoes the long increment.
pub(crate) const VANISHING_EVENT_VALUE: f64 = 1e-12;

/// Length of the step relative to the distance to the predicted change: the prediction of first order is not exact. The
/// ratio is a heuristic for effort: with a smaller ratio the step may end before the change, and with a larger ratio
/// the end is farther from the change and costs more iterations.
pub(crate) const PREDICTED_STEP_RATIO: f64 = 1.25;

/// Smallest distance of the change, relative to the prediction, that is accepted; the largest is the end of the step. A
/// zero at less than half of the predicted distance is probably another zero than the one predicted; a rejected zero
/// costs one solve, and the ordinary step then locates the change.
pub(crate) const SMALLEST_DISTANCE_RATIO: f64 = 0.5;

/// Smallest part of its intended length to which a step is cut. The value, a power of two, is a heuristic for effort:
/// location of an event within a step of this length is as cheap as within a shorter one, and the path does not stall
/// where predicted changes are close.
pub(crate) const SMALLEST_STEP_SHARE: f64 = 1.0 / 256.0;

/// Assumed bound of the length of a path with kinks, relative to its chord; not proven. Without kinks, a turn of at
/// most 0.6 keeps the ratio below 1.02; the factor 4 leaves room for kinks, and a larger factor refuses to treat
/// changes together more often, with shorter steps instead.
pub(crate) const LONGEST_PATH_RATIO: f64 = 4.0;
