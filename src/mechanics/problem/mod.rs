//! A structure with contacts under its loads.
//!
//! | file | what it holds |
//! |---|---|
//! | `state` | a point of the path and its derivative by arc length |
//! | `loading` | the structure under a load pattern, with what earlier stages hold |
//! | `contact_motion` | the motion of a contact by the degrees of freedom, and its forces on them |
//! | `node_forces` | the forces of all contacts on one node |
//! | `natural_residual` | how far a state is from the laws of contact and friction |
//! | `energy` | external work and dissipation along an increment |
//! | `linearity` | whether every direction of first order holds over some way |

pub(crate) mod contact_motion;
pub(crate) mod energy;
pub(crate) mod linearity;
pub(crate) mod loading;
pub(crate) mod natural_residual;
pub(crate) mod node_forces;
pub(crate) mod state;
