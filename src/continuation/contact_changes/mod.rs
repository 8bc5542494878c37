//! Contact changes within a step: foreseen by rates, solved for at once, or taken together.
//!
//! | file | what it does |
//! |---|---|
//! | `prediction` | the next change, where the rates at the start of a step foresee it |
//! | `piecewise_linear` | straight stretches of a path, which are one increment |
//! | `simultaneous` | several changes of one step, taken together |
//! | `linear_complementarity` | which of them are closed at its end, by equations linearised once |

pub(crate) mod linear_complementarity;
pub(crate) mod piecewise_linear;
pub(crate) mod prediction;
pub(crate) mod simultaneous;
