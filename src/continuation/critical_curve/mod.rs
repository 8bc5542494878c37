//! Curves of critical points: limit points, bifurcation points and contact changes of a structure as a parameter varies.
//!
//! Such a curve is called a fold line (A. Eriksson, *Fold lines for sensitivity analyses in structural instability*, Comput.
//! Methods Appl. Mech. Eng. 114 (1994) 77). There the extended system is equilibrium with the condition that its tangent is
//! singular. Here the state depends on the path as well, through friction, and a limit point may be nonsmooth: the extended
//! system comprises the points at which contacts change, each with the equation of its event, and the limit point at last
//! (`history`):
//!
//! ```text
//! R_k(x_k; x_{k-1}, p) = 0,    e_k(x_k) = 0,    k = 1, ..., n
//! ```
//!
//! with the equilibrium `R_k` of the contact mode that begins at `x_{k-1}`, and the event function `e_k` that is zero at its
//! end; `e_n` is the load rate, or the event function of the contact with which the load turns, or that of any contact that
//! changes; at a bifurcation point it is the test functions of the bordered equations. The system is block triangular, and is
//! solved block by block (`history::solved_history`).
//!
//! Along the curve the conditions under which a path passes through these points are watched. Where one of them ends, the
//! critical point changes its kind, or the path to it its changes of contact: a point of codimension two, which is located
//! in the parameter. Past it the path itself is traced once more, and its critical point at the same place goes on with the
//! curve; where there is none, the curve ends, and this is said. The selection rule is watched in the same way: where the path
//! comes to prefer another direction at one of the points, that is located and told (`history::taken_directions`). Where two
//! limit points meet, the curve turns back in the parameter and goes on along the other one (`turning_point`); where they come
//! to a bifurcation point, it is located (`cusp`). At each end one of the last points is compared with a path.
//!
//! | file | contents |
//! |---|---|
//! | `history` | the points by which a path comes to a critical point, at one value of the parameter |
//! | `curve`, `curve_position` | the curve, from point to point |
//! | `traced_paths`, `last_points` | paths to go on past a change, and to compare the ends of the curve with |
//! | `turning_point` | where it turns back in the parameter |
//! | `meeting_changes` | where two changes of contact meet and vanish |
//! | `cusp` | where it passes through a bifurcation point |
//! | `critical_point`, `curve_outcome` | a point of the curve in the user's units, its event in words; how a curve ends |
//! | `tolerances` | |

pub(crate) mod critical_point;
pub(crate) mod curve;
pub(crate) mod curve_outcome;
pub(crate) mod curve_position;
mod cusp;
pub(crate) mod history;
mod last_points;
mod meeting_changes;
mod tolerances;
mod traced_paths;
mod turning_point;

pub use critical_point::CurvePoint;
pub use curve::{CriticalCurve, CurveRange};
pub use curve_outcome::{CurveBreak, CurveEnd, CurveFailure, CurveReport, DirectionEnd};
pub use history::traced_history::CurveStart;
