//! One step of the path along one contact mode.
//!
//! | module | contents |
//! |---|---|
//! | [`corrector`] | Newton's method, the direction at its end, and the factorisations that they share |
//! | `mode_step` | a step along the mode, ended early by the first event |
//! | `event_functions` | quantities that must not become negative while the mode lasts |
//! | `event_location` | the location of their zeros |
//! | `lift_off` | where a node that slips in space leaves its obstacle |
//! | `interpolation` | interpolation between the points of a step |
//! | `singular_step` | steps from a point at which the equations have another null vector |
//! | `increment_mpec` | the mathematical program of one increment (Kanno and Martins), and its certificate |

pub mod corrector;
pub(crate) mod event_functions;
pub(crate) mod event_location;
pub(crate) mod increment_mpec;
pub(crate) mod interpolation;
pub(crate) mod lift_off;
pub(crate) mod mode_step;
pub(crate) mod singular_step;
pub(crate) mod tolerances;
