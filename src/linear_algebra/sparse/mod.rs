//! Sparse systems with thin borders, `[[K, B], [C, D]]`, `K` symmetric but for friction: as the path's equations are for many unknowns.
//!
//! * [`pattern`]: where `K` may have entries, found once.
//! * `symbolic`: the order of elimination that keeps its factors sparse (AMD), and what they take.
//! * [`symmetric`]: `K = L D Lᵀ`; small pivots are raised, and the raise is taken back by a border.
//! * `panels`: the same of large matrices, in pieces.
//! * `unsymmetric`: `K = L U` in the same order, where friction makes `K` unsymmetric, and for few unknowns.
//! * [`bordered`]: the matrix as it is assembled.
//! * [`definite`]: whether a symmetric matrix is positive definite.
//! * [`held`]: unknowns of a node that border rows hold (closed contacts) are eliminated where they are.
//! * `blocks`: what is left when they are, the interior factorised.
//! * [`factorisation`]: block elimination with the dense Schur complement of what remains of the borders, refined on the
//!   whole system.
//! * `nearby`: solutions with the factorisation of a nearby matrix.
//! * [`general`]: LU of any sparse matrix.

mod blocks;
pub mod bordered;
pub mod definite;
pub mod factorisation;
pub mod general;
mod held;
mod lu;
mod nearby;
mod panels;
pub mod pattern;
mod reduced;
mod symbolic;
pub mod symmetric;
#[cfg(test)]
mod tests;
mod unsymmetric;

pub use bordered::Bordered;
pub use factorisation::{SparseFactorisation, held_inertia};
pub use held::{Holding, Holdings, Places};
pub use pattern::Pattern;
pub use symbolic::allow_factor;

use smallvec::SmallVec;

/// Entries of a row or a column: place and value.
pub type Entries = SmallVec<[(usize, f64); 3]>;
