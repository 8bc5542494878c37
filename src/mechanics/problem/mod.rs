//! A structure with contacts under its loads.
//!
//! | file | contents |
//! |---|---|
//! | `state` | a point of the path and its derivative by arc length |
//! | `loading` | the structure under a load pattern and the constant loads of earlier stages |
//! | `contact_jacobian` | the motion of a contact with the degrees of freedom, and its forces on them |
//! | `equilibrium` | the out-of-balance force without contacts |
//! | `node_contact_forces` | the forces of all contacts on one node |
//! | `natural_residual` | the violation of the laws of contact and friction by a state |
//! | `work_and_dissipation` | external work and dissipation along an increment |
//! | `linearity` | whether every direction of first order holds over a finite length |

pub(crate) mod contact_jacobian;
pub(crate) mod equilibrium;
pub(crate) mod linearity;
pub(crate) mod loading;
pub(crate) mod natural_residual;
pub(crate) mod node_contact_forces;
pub(crate) mod state;
pub(crate) mod tolerances;
pub(crate) mod work_and_dissipation;
