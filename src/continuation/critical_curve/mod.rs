//! Curves of critical points: the limit points of a structure as a parameter of it varies.
//!
//! Such a curve is called a fold line (A. Eriksson, *Fold lines for sensitivity analyses in structural instability*, Comput.
//! Methods Appl. Mech. Eng. 114 (1994) 77). There the extended system is equilibrium with the condition that its tangent is
//! singular. Here the state depends on the path as well, through friction, and a limit point may be nonsmooth: the extended
//! system comprises the points at which contacts change, each with the equation of its event, and the limit point at last
//! (`contact_history`). It is block triangular, and is solved block by block (`solved_history`).
//!
//! Along the curve the conditions under which a path passes through these points are watched. Where one of them ends, the
//! critical point changes its kind, or the path to it its changes of contact: a point of codimension two, which is located
//! in the parameter. Past it the path itself is traced once more, and its critical point at the same place goes on with the
//! curve; where there is none, the curve ends, and this is said. Where two limit points meet, the curve turns back in the
//! parameter and goes on along the other one (`turning_point`).
//!
//! | file | contents |
//! |---|---|
//! | `contact_history` | the points by which a path comes to a critical point |
//! | `branch_point_location` | one of these points, by Newton's method along the branch of its mode |
//! | `solved_history` | all of them at one value of the parameter, and the conditions of the path |
//! | `traced_history` | the history of a path, traced for it |
//! | `curve` | the curve, from point to point |
//! | `turning_point` | where it turns back in the parameter |
//! | `critical_point` | a point of the curve in the user's units; its event in words |
//! | `tolerances` | |

mod branch_point_location;
pub(crate) mod contact_history;
pub(crate) mod critical_point;
pub(crate) mod curve;
mod solved_history;
mod tolerances;
mod traced_history;
mod turning_point;

pub use critical_point::CurvePoint;
pub use curve::{CriticalCurve, CurveEnd, CurveFailure, CurveRange, CurveReport, DirectionEnd};
pub use traced_history::CurveStart;
