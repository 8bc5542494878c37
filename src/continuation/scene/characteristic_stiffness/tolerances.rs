//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Gap (dimensionless) up to which a contact is closed. The value is the gap 1e-10 that is zero at every point of the
/// path (`CONTACT_TOLERANCE`): well above the round-off of the coordinates, and below the measure of error 1e-9.
pub(crate) const CLOSED_GAP: f64 = 1e-10;

/// Stiffness that fixes a closed contact, relative to that of its node. The contact then yields by a millionth of the
/// node's motion, far less than a scale has to resolve, and the linear system loses six of sixteen digits; a larger
/// value costs digits, and a smaller one lets contacts share the load with the elements.
pub(crate) const CONSTRAINT_STIFFNESS: f64 = 1e6;

/// Energy of the elements, relative to that of the fixed contacts, below which the load is carried by these contacts.
/// With contacts 1e6 times stiffer than their nodes the ratio is about 1e-6 where the contacts carry the load, and
/// about 1e6 where elements of similar stiffness carry it; the value leaves three orders of magnitude on the one side,
/// and more for stiff elements on the other.
pub(crate) const SMALLEST_ELEMENT_ENERGY: f64 = 1e-3;

/// Size of the last correction, relative to the motion, at which Newton's method has converged. The value is above the
/// round-off that contacts 1e6 times stiffer than their nodes leave, 2e-10; a scale needs few digits, and quadratic
/// convergence makes the last digits cheap.
pub(crate) const ACCEPTED_CORRECTION: f64 = 1e-9;

/// Energy, relative to the products of the elements' stiffnesses with whole displacements, below which the energy is
/// round-off. An energy is quadratic in the stretch, so that the value is the square of a relative stretch of 1e-13,
/// some 500 units of round-off, 2e-16.
pub(crate) const ENERGY_ROUND_OFF: f64 = 1e-26;

/// Multiple of the rounding of the elements' forces up to which the load of a motion is round-off: the sums have some ten
/// terms, and a structure whose resistance is below a thousand roundings of its stiffness has no digits to give a scale.
pub(crate) const ROUND_OFF_MULTIPLE: f64 = 1e3;
