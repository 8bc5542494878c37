//! Tolerances for coincident states and for reactions that are zero within the accuracy of event location.

/// States closer than this coincide: displacements and load in arc length (dimensionless), reactions relative to the
/// largest force so far. Points have residuals up to 1e-11 and meet the measure of error 1e-9, so that two visits of
/// one state differ by less; a larger value might take a slow path for a cycle.
pub(crate) const SAME_STATE: f64 = 1e-9;

/// Reactions up to this, relative to the largest force so far, are zero within the accuracy of event location. Events
/// are located to round-off, and the value is some 50 units of round-off, 2e-16; a larger value would change reactions
/// of the published point by more than their rounding.
pub(crate) const REACTION_ROUND_OFF: f64 = 1e-14;

/// Round-off allowed for in the arc length before which a gap cannot close, relative to this arc length. The path's arc
/// length is a sum of up to 1e5 and more steps, with an error up to the number of steps times unit round-off, 2e-11;
/// too large a value only evaluates gaps a little earlier, and too small a value might miss a contact.
pub(crate) const DISTANCE_ROUND_OFF: f64 = 1e-9;

/// Energies below this fraction of the force scale times the displacement scale are round-off. Energies are sums and
/// differences of products of forces and displacements, with an error of some units of round-off 2e-16 of that product
/// for each increment; the value covers 5e3 such errors.
pub(crate) const ENERGY_ROUND_OFF: f64 = 1e-12;

/// Energies are compared with at least this multiple of the rounding of forces times the arc length: where no more is
/// stored, given or dissipated, six digits of the energies, to which their balance is held, do not exist.
pub(crate) const ENERGY_DIGITS: f64 = 1e6;

/// The first time step, in units of the damping over the stiffness scale. The springs are then as stiff as the structure
/// at large; the first step is shortened where the structure is more unstable.
pub(crate) const FIRST_TIME_STEP: f64 = 1.0;
