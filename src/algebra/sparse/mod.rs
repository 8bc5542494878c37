//! Sparse systems with thin borders, `[[K, B], [C, D]]`, `K` symmetric but for friction: as the path's equations are for many unknowns.
//!
//! | room or file | what it does |
//! |---|---|
//! | [`constrained_nodes`] | which border rows hold a node (closed contacts), and the matrices of one node that is held |
//! | [`factors`] | the matrix as it is assembled, where it may have entries, and its factorisations |
//! | `nodal_elimination` | unknowns of a node that border rows hold are eliminated where they are |
//! | `border_schur` | the dense Schur complement of what remains of the borders |
//! | `block_elimination` | both together, the interior factorised, refined on the whole system |
//! | `fallback_lu` | LU of the whole matrix, where block elimination fails |
//! | [`factorisation`] | the one of these that serves |
//! | `preconditioned_refinement` | solutions with the factorisation of a nearby matrix |

pub(crate) mod block_elimination;
pub(crate) mod border_schur;
pub mod constrained_nodes;
pub mod factorisation;
pub mod factors;
pub(crate) mod fallback_lu;
pub(crate) mod nodal_elimination;
pub(crate) mod preconditioned_refinement;
#[cfg(test)]
mod tests;

pub use factorisation::{SparseFactorisation, held_inertia};
pub use factors::bordered_matrix::Bordered;
pub use factors::pattern::Pattern;
pub use factors::symbolic::allow_factor;
pub use nodal_elimination::{Holding, Holdings, IndexList};
