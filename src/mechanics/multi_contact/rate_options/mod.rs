//! What contacts that can change may do next, as options of the rate problem.
//!
//! | file | what it writes down |
//! |---|---|
//! | `contact_options` | a contact that can change, or the contacts of a node that change together |
//! | `spatial` | the ways on of a node that several obstacles hold in space |
//! | `moving_planes` | the ways on of a node between planes that move against each other |

pub(crate) mod contact_options;
pub(crate) mod moving_planes;
pub(crate) mod spatial;
