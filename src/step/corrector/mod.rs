//! From a predictor to a point of the path: Newton's method on the equations of one contact mode.
//!
//! | file | contents |
//! |---|---|
//! | `newton` | the iteration |
//! | `tangent` | the direction of the path at the point found, and an estimate of its error |
//! | `single_iteration` | a single iteration, for an approximate solution |
//! | `cached_factorisation` | factorisations that an earlier solve leaves for the next |
//! | `slip_error` | the error of curved slip, accumulated along the path |
//! | `cost_counters` | counts of work |
//! | `determinant_sign` | when the sign of a determinant is certain |

pub(crate) mod cached_factorisation;
pub(crate) mod cost_counters;
pub(crate) mod determinant_sign;
pub(crate) mod newton;
pub(crate) mod single_iteration;
pub(crate) mod slip_error;
pub(crate) mod tangent;
pub(crate) mod tolerances;
