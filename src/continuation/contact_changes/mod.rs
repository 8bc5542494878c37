//! Contact changes within a step: predicted by rates, solved for directly, or treated together.
//!
//! | file | contents |
//! |---|---|
//! | `prediction` | the next change, predicted by the rates at the start of a step |
//! | `piecewise_linear` | straight stretches of a path, each of which is one increment |
//! | `simultaneous` | several changes of one step, treated together |
//! | `linear_complementarity` | the contacts closed at the end of such a step, by the equations linearised once |

pub(crate) mod linear_complementarity;
pub(crate) mod piecewise_linear;
pub(crate) mod prediction;
pub(crate) mod simultaneous;
pub(crate) mod tolerances;
