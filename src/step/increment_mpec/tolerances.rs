//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Magnitude up to which a member of a pair at an exact point is zero and above which the member is positive (members
/// are dimensionless: gaps and slips over the arc length, forces over the force scale). Exact points have residuals up
/// to 1e-11; the value is a hundred times larger, equals the measure of error 1e-9 and is far below the program's own
/// tolerance 1e-6 on biactive pairs.
pub(crate) const MEMBER_TOLERANCE: f64 = 1e-9;

/// Smallest ratio of a positive member to the constraint violation, the rounding of equilibrium and the relative error
/// at the point. A factor of ten keeps the member positive at the exact solution nearby; a larger factor leaves more
/// points to the search, which costs effort only.
pub(crate) const VIOLATION_MULTIPLE: f64 = 10.0;

/// Rounding of rates: of velocities of unit arc length, and of forces relative to the largest rate of force. The value
/// is 5e3 units of round-off, 2e-16, for the conditioning of the equations of the direction; where a rate is smaller
/// the certificate leaves the decision to the search.
pub(crate) const RATE_ROUND_OFF: f64 = 1e-12;

/// Least cosine between the chord of the increment and the direction at its end. A step of the path has a cosine of at
/// least 0.825 (a turn of 0.6), so that the value, an angle of 60 degrees, refuses only points off the path, whose
/// quotients by the cosine would be large.
pub(crate) const SMALLEST_CHORD_COSINE: f64 = 0.5;

/// Contacts whose gap is beyond this many arc lengths cannot close in the increment and are left out. A solution has at
/// most twice the prescribed arc length, and a gap changes by about the arc length at most; three leave room for moving
/// obstacles. A larger number only enlarges the program; the contacts in reach of the path extend to four steps.
pub(crate) const REACH_IN_LENGTHS: f64 = 3.0;

/// Ratio of the weight `γ2` of the forward term to the dissipation, a fraction that does not depend on the step. At a
/// tenth the dissipation decides wherever branches differ in dissipation, and the forward term decides only among
/// branches with nearly equal dissipation; a much smaller share would be lost in the tolerance 1e-8.
pub(crate) const FORWARD_WEIGHT_SHARE: f64 = 0.1;

/// Dissipation per arc length (over the force scale) below which the dissipation is round-off of a sticking motion.
/// Velocities of a sticking contact are zero to unit round-off 2e-16 times the conditioning of the direction; the value
/// allows for a conditioning of 5e3.
pub(crate) const SMALLEST_DISSIPATION: f64 = 1e-12;

/// Multiple of the bound on rounding within which the residual of equilibrium counts as round-off; Newton's method on
/// the equations of a mode uses the same multiple. The bound counts one unit of round-off for each displacement, and
/// the evaluation of a force takes a few operations more.
pub(crate) const ROUND_OFF_MULTIPLE: f64 = 8.0;

/// Largest tolerance with which modes are determined, where stiff elements prevent a smaller residual; members of pairs
/// are of order one, so that a thousandth still tells a positive member from zero. A larger tolerance would determine
/// modes from round-off.
pub(crate) const LOOSEST_TOLERANCE: f64 = 1e-3;

/// The largest first bound on the products. A bound of a hundredth of the members' magnitude lets contacts within their
/// cones slip by about a hundredth, with a spurious dissipation that is small compared with the gain of the objective
/// along the path; a smaller first bound starts closer to one branch and lets contacts change less easily.
pub(crate) const FIRST_RELAXATION: f64 = 1e-2;

/// The ratio of successive bounds on the products. From the largest first bound 1e-2 to the last bound 1e-8 four
/// programs are solved; a smaller ratio starts each program farther from its solution, and a larger one solves more
/// programs. The ratio affects effort only.
pub(crate) const RELAXATION_FACTOR: f64 = 1e-2;

/// The last bound on the products: the tolerance 1e-8 to which the sequential quadratic programs are solved, so that a
/// smaller bound cannot be resolved. A larger bound leaves a spurious slip of that order in the end from which Newton's
/// method starts.
pub(crate) const LAST_RELAXATION: f64 = 1e-8;

/// Largest change of each displacement and of the load in an increment, over the prescribed arc length: the largest arc
/// length from which an end is refined, 2. Ends farther away belong to distant solutions, whose arc length cannot be
/// adapted to the prescribed one.
pub(crate) const LARGEST_MOTION: f64 = 2.0;

/// Tangential force (over the force scale) or slip (over the arc length) up to which its direction is undefined. An
/// error of 1e-11, the residual of an exact end, turns a vector of this size by a hundredth; a smaller vector has no
/// reliable direction, and a larger bound would discard known directions.
pub(crate) const SMALLEST_DIRECTED_SIZE: f64 = 1e-9;

/// Least cosine between the motion that the program found and the exact motion. The program is accurate to 1e-8 and its
/// arc length is adapted, so that the two motions of one solution are nearly parallel; 0.9, an angle of 26 degrees, is
/// a heuristic that rejects another solution nearby.
pub(crate) const SMALLEST_MOTION_COSINE: f64 = 0.9;
