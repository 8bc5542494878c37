//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Gap (dimensionless) up to which a contact is closed in the check of the supports. The value is the gap 1e-10 that is
/// zero at every point of the path (`CONTACT_TOLERANCE`): well above the round-off of the coordinates, and below
/// the measure of error 1e-9.
pub(crate) const CLOSED_GAP: f64 = 1e-10;

/// Unbalanced forces at the start, relative to the largest element force, up to this are round-off. The value is the
/// residual 1e-11 that every point of the path has to meet: a larger imbalance would make the start a point off the
/// path, and a smaller value would refuse prestress given in rounded numbers.
pub(crate) const ACCEPTED_IMBALANCE: f64 = 1e-11;

/// Planes whose normals and gaps (dimensionless) differ by no more than this coincide; likewise balls by their offsets
/// and gaps. The same surface given in two ways differs by the rounding of its normalisation, some units of round-off
/// 2e-16; the value is 500 units, and a larger value would join surfaces at which events are still told apart.
pub(crate) const COINCIDENCE_TOLERANCE: f64 = 1e-13;

/// Number of steps within which a contact in reach could close: more than the one that is taken, so that computations
/// past the end of the step (the program of an increment looks three steps ahead) find every contact they need. A
/// larger number only puts more contacts into the equations.
pub(crate) const REACH_IN_STEPS: f64 = 4.0;

/// Stiffnesses that differ by no more than this factor are alike: scales based on alike stiffnesses change the
/// increments by no more. Step control absorbs a factor of two in the scale within a step or two; a smaller factor
/// computes the resisting stiffness more often.
pub(crate) const SIMILAR_STIFFNESS_RATIO: f64 = 2.0;

/// Largest ratio between a bar's stiffness and the resisting stiffness, either way, at which the bar may determine the
/// force scale. A bar farther away hardly takes part in the resistance, and the resisting stiffness itself is the
/// scale; the bound is a heuristic that affects the length of increments, not their accuracy.
pub(crate) const LARGEST_STIFFNESS_RATIO: f64 = 100.0;

/// Squares of the areas between normal and tangential rows of a contact of bodies below this part of their sizes leave a
/// single motion: the square of 1e-8, above which rows of round-off have other directions.
pub(super) const SINGLE_MOTION: f64 = 1e-16;

/// An eigenvalue of the products of the columns of two surfaces' motion that is at most this part of the largest one belongs
/// to a motion that supports do not leave: above the round-off of eigenvalues.
pub(super) const MISSING_MOTION: f64 = 1e-13;

/// A motion of supports along the surfaces of two bodies below this part of its columns is round-off: far above the rounding
/// of their sums, and far below any motion that slides.
pub(super) const DRAGGED: f64 = 1e-12;
