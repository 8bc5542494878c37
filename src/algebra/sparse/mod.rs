//! Sparse systems with narrow borders, `[[K, B], [C, D]]`, `K` symmetric except for friction: the form of the path's
//! equations with many unknowns.
//!
//! | folder or file | what it does |
//! |---|---|
//! | [`constrained_nodes`] | border rows that constrain nodes (closed contacts), and the matrices of one such node |
//! | [`factors`] | the assembled matrix, its sparsity pattern and its factorisations |
//! | `nodal_elimination` | elimination of constrained unknowns at their nodes |
//! | `border_schur` | the dense Schur complement of the remaining borders |
//! | `block_elimination` | both eliminations combined, with the factorised interior |
//! | `fallback_lu` | LU of the whole matrix, where block elimination fails |
//! | [`bordered_factorisation`] | the choice between block elimination and LU, with iterative refinement on the whole system |
//! | `preconditioned_refinement` | solutions with the factorisation of a nearby matrix |

pub(crate) mod block_elimination;
pub(crate) mod border_schur;
pub mod bordered_factorisation;
pub mod constrained_nodes;
pub mod factors;
pub(crate) mod fallback_lu;
pub(crate) mod nodal_elimination;
pub(crate) mod preconditioned_refinement;
#[cfg(test)]
mod tests;
pub(crate) mod tolerances;

pub use bordered_factorisation::{SparseFactorisation, held_inertia};
pub use factors::bordered_matrix::Bordered;
pub use factors::elimination_order::allow_factor;
pub use factors::pattern::Pattern;
pub use nodal_elimination::{Holding, Holdings, IndexList};
