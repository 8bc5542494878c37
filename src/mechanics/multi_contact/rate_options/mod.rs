//! The possible modes of contacts that can change, as options of the rate problem.
//!
//! | file | contents |
//! |---|---|
//! | `contact_options` | a contact that can change, or the contacts of a node that change together |
//! | `spatial` | the options of a node in contact with several obstacles in space |
//! | `moving_planes` | the options of a node between planes that move against each other |

pub(crate) mod contact_options;
pub(crate) mod moving_planes;
pub(crate) mod spatial;
pub(crate) mod tolerances;
