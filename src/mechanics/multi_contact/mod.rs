//! Nodes that several obstacles hold at once.
//!
//! | file or room | what it holds |
//! |---|---|
//! | `planar` | the sum of friction cones in the plane |
//! | `spatial` | nodes that are free in space, or guided by supports |
//! | `moving_planes` | a node in the plane between two planes that move against each other |
//! | `reaction_split` | the reactions of least norm that make up a node's force |
//! | `determinacy` | whether equilibrium tells the reactions apart |
//! | `contact_status` | which contacts can change at a point, and between what |
//! | `rate_options` | what contacts may do next, as options of the rate problem |

pub(crate) mod contact_status;
pub(crate) mod determinacy;
pub(crate) mod moving_planes;
pub(crate) mod planar;
pub mod rate_options;
pub(crate) mod reaction_split;
pub(crate) mod spatial;
