//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Part of the load scale by which the load is raised to set the structure in motion. At a limit point it moves the
/// structure by its square root, a thousandth of the length scale, far beyond the distances within which states count as
/// the same (1e-9).
pub(crate) const RAISED_LOAD: f64 = 1e-6;

/// Way (in length scales) after which the load is taken back: ten times the motion of the raised load itself, past which
/// the structure moves on without it. Contacts that slip further under a raised load would not slip back at rest.
pub(crate) const WAY_TO_LOWER: f64 = 1e-2;

/// Largest growth of the time step, and its largest reduction (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary
/// Differential Equations I, Springer 1993, section II.4).
pub(crate) const LARGEST_GROWTH: f64 = 2.0;
pub(crate) const LARGEST_REDUCTION: f64 = 0.2;

/// Safety factor of the next time step (ibid.).
pub(crate) const SAFETY: f64 = 0.9;

/// Multiple of the tolerance up to which a time step is accepted; the next one is shortened.
pub(crate) const ACCEPTED_MULTIPLE: f64 = 2.0;

/// Shortest time step: its springs are 1e12 times stiffer than the structure, so that round-off decides the motion.
pub(crate) const SHORTEST_TIME_STEP: f64 = 1e-12;

/// Speed relative to the largest of the motion at which the state at rest is sought for the first time. The rest of an
/// exponential decay is then a thousandth of the way.
pub(crate) const SPEED_AT_REST: f64 = 1e-3;

/// Speed relative to the largest at which a motion has stopped wherever it is: all that is left of it is round-off.
pub(crate) const SPEED_STOPPED: f64 = 1e-9;

/// Largest distance from the moving structure to its state at rest, relative to the way so far. From a motion that
/// passes an unstable state slowly, the sought state would lie off its way.
pub(crate) const DISTANCE_AT_REST: f64 = 0.02;

/// Way (in length scales) after which a motion leads to no state at rest: the structure is ten thousand times as far
/// away as it is large.
pub(crate) const FARTHEST: f64 = 1e4;

/// Increments of the path of one time step before the step is shortened.
pub(crate) const MOST_INCREMENTS: u64 = 400;

/// Shortest arc length of the path of a time step, relative to its expected length.
pub(crate) const SHORTEST_SHARE: f64 = 1e-9;

/// Shortest path of a time step, in units of the arc length: the force that is released counts as this much at least. The
/// end of the path is met within 1e-12 of its load, which is to be nothing beside it.
pub(crate) const LEAST_LENGTH: f64 = 1e-6;

/// Way (in length scales) up to which the error of a time step is compared with this way: a motion that begins at rest has
/// none yet. The error is then a ten-thousandth of the length scale times the tolerance.
pub(crate) const SHORT_WAY: f64 = 1e-4;

/// Part of the largest energy so far with which the energies of a time step are compared at least, where next to nothing
/// is stored: differences of smaller energies are round-off of the displacements.
pub(crate) const STORED_SHARE: f64 = 1e-3;

/// Length (in length scales) by which a structure is pushed off an unstable state. Its energy is a hundred-millionth of the
/// stiffness scale.
pub(crate) const PUSH: f64 = 1e-4;

/// Force out of balance, over the force scale, up to which mass at rest stays there. Time steps are in balance within
/// 1e-10; and a motion that such a force begins takes a thousand times as long as one of the structure's own.
pub(crate) const BALANCED: f64 = 1e-6;

/// Length of the path of a time step from a stop, over the force that is released: obstacles may hold all motion until
/// most of the force is gone, and a shorter path would have a load that is larger than all stiffnesses by as much.
pub(crate) const LENGTH_BY_FORCE: f64 = 1e-2;
