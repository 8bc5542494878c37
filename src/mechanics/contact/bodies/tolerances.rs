//! Tolerances of contacts between bodies.

/// A face is not covered by a part of the opposite surface over less than this part of its length: of less, the round-off
/// of the mean would be larger than 1e-6.
pub(super) const LEAST_COVERED: f64 = 1e-8;

/// A face of the opposite surface that is behind by more than this part of the own face is not in front of it: it belongs to
/// the far side of a body.
pub(super) const DEEPEST: f64 = 0.5;

/// A face of the opposite surface whose distance changes by more than this per length of the own face is not in front of it:
/// it belongs to another side of a corner.
pub(super) const STEEPEST: f64 = 4.0;

/// The part of a face that is still covered where a node counts as at the end of the surface that it touches: above
/// [`LEAST_COVERED`], so that the end is found before the contact is lost.
pub(super) const LAST_COVERED: f64 = 1e-6;

/// Distances that differ by less than this part count as equal: those of two faces from a point off their common corner.
pub(super) const SAME_DISTANCE: f64 = 1e-9;

/// Newton's method for the closest point ends at a correction below this (in lengths of faces).
pub(super) const CLOSEST_POINT: f64 = 1e-15;

/// Steps towards the closest point that are larger have to come nearer; smaller ones are Newton's near the solution.
pub(super) const SMALL_STEP: f64 = 1e-4;

/// Iterations for the closest point; from the best of the samples a few do.
pub(super) const CLOSEST_POINT_ITERATIONS: usize = 60;

/// Positions on each piece of a smoothed surface at which the closest point may be sought first.
pub(super) const SAMPLES: usize = 4;

/// How far beside a face, in its own length and the thickness of the wall, the other side of a wall does not touch it: a
/// wall that bends moves its sides along each other by less.
pub(super) const BEHIND_A_WALL: f64 = 3.0;

/// Faces of one surface that cross at the start by less than this part of the shorter one, or are behind each other by less
/// than this part of a face, are those of meshes that touch.
pub(super) const CROSSING: f64 = 0.05;
