//! Sparse matrices with thin borders and their factorisations.
//!
//! | file | what it holds |
//! |---|---|
//! | `pattern` | where a matrix may have entries, found once |
//! | `symbolic` | the order of elimination that keeps its factors sparse (AMD), and what they take |
//! | `bordered_matrix` | the matrix as it is assembled |
//! | `ldl`, `supernodal_ldl` | `K = L D Lᵀ`; small pivots are raised, and the raise is taken back by a border; large ones in pieces |
//! | `cholesky` | whether a symmetric matrix is positive definite |
//! | `static_pivot_lu`, `lu_pattern` | `K = L U` in the order of the symmetric factors, and where these have entries |
//! | `pivoted_lu` | LU of any sparse matrix |
//! | `entries` | entries of a row or a column |

pub mod bordered_matrix;
pub mod cholesky;
pub(crate) mod entries;
pub mod ldl;
pub(crate) mod lu_pattern;
pub mod pattern;
pub mod pivoted_lu;
pub(crate) mod static_pivot_lu;
pub(crate) mod supernodal_ldl;
pub(crate) mod symbolic;
