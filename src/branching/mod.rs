//! Which directions leave a point of the path, and which one is taken.
//!
//! | room | what it holds |
//! |---|---|
//! | [`directions`] | the one-sided directions of first order, by a problem condensed on the contacts that can change |
//! | [`uniqueness`] | tests that prove that there are no others |
//! | [`bifurcation`] | points where an eigenvalue is zero: told, located, and the branches that leave them |
//! | [`selection`] | all directions of a point, and the choice among them |
//!
//! Each room imports only those above it, and what a step is made of ([`crate::step`]). None knows of increments or files.

pub mod bifurcation;
pub mod directions;
pub mod selection;
pub mod uniqueness;
