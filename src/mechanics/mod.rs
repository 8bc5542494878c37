//! The mechanics: structure, contact, loads, and the equations of one contact mode.
//!
//! | module | contents |
//! |---|---|
//! | [`structure`] | unknowns, elements, internal forces and tangent |
//! | [`contact`] | a node against an obstacle: gap, frame, reaction, modes |
//! | [`problem`] | states and rates, the structure under its loads, energies, the laws of contact as a residual |
//! | [`rotation`] | rotations in space |
//! | [`multi_contact`] | nodes in contact with several obstacles at once |
//! | `equations` | the equations of one contact mode, their matrix, and the equation that closes them |
//!
//! All quantities are dimensionless. The module knows neither the JSON contract nor paths.

pub mod contact;
pub(crate) mod equations;
pub mod multi_contact;
pub mod problem;
pub mod rotation;
pub mod structure;

/// The dimensionless pressure, angle or translation of a degree of freedom of 1 of an auxiliary node. So large that the
/// degree of freedom, which is no displacement of the structure, does not count in the norm of the arc length beyond
/// round-off; a power of two, so that no digit is lost.
pub(crate) const AUXILIARY_UNIT: f64 = 1_099_511_627_776.0;
