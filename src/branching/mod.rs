//! Directions that leave a point of the path, and the choice of the one taken.
//!
//! | module | contents |
//! |---|---|
//! | [`directions`] | the one-sided directions of first order, by a problem condensed on the contacts that can change |
//! | [`uniqueness`] | tests that prove that there are no other directions |
//! | [`bifurcation`] | points where an eigenvalue is zero: detection, location, and the branches that leave them |
//! | `stability` | whether a state is stable: eigenvalues of its mode, motions that grow under a load that stays |
//! | [`selection`] | all directions of a point, and the choice among them |
//!
//! Each module imports only those above it and the parts of a step ([`crate::step`]). No module depends on increments
//! or files.

pub mod bifurcation;
pub mod directions;
pub mod selection;
pub(crate) mod stability;
pub mod uniqueness;
