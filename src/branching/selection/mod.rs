//! All directions of a point, and the one that the path takes.
//!
//! | file | what it does |
//! |---|---|
//! | `enumeration` | every direction of first order |
//! | `second_order` | where first order does not tell, second order is asked |
//! | `decision` | the selection rule: largest dissipation, least potential energy, or straightest |

pub(crate) mod decision;
pub(crate) mod enumeration;
pub(crate) mod second_order;
