//! All directions of a point, and the direction that the path takes.
//!
//! | file | contents |
//! |---|---|
//! | `enumeration` | every direction of first order |
//! | `second_order` | directions at second order, where first order is inconclusive |
//! | `selection_rule` | the selection rule: largest dissipation, least potential energy, or straightest |

pub(crate) mod enumeration;
pub(crate) mod second_order;
pub(crate) mod selection_rule;
pub(crate) mod tolerances;
