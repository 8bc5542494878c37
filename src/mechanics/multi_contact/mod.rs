//! Nodes in contact with several obstacles at once.
//!
//! | module | contents |
//! |---|---|
//! | `planar` | the sum of friction cones in the plane |
//! | `spatial` | nodes that are free in space, or guided by supports |
//! | `moving_planes` | a node in the plane between two planes that move against each other |
//! | `reaction_sharing` | the reactions of least norm with a given sum |
//! | `determinacy` | whether equilibrium determines the reactions |
//! | `changeable_contacts` | which contacts can change at a point, and to which modes |
//! | `rate_options` | the possible modes of contacts that can change, as options of the rate problem |

pub(crate) mod changeable_contacts;
pub(crate) mod determinacy;
pub(crate) mod moving_planes;
pub(crate) mod planar;
pub mod rate_options;
pub(crate) mod reaction_sharing;
pub(crate) mod spatial;
pub(crate) mod tolerances;
