//! Sparse matrices with narrow borders and their factorisations.
//!
//! | file | contents |
//! |---|---|
//! | `pattern` | the sparsity pattern of a matrix, found once |
//! | `elimination_order` | the elimination order that keeps the factors sparse, and the size and work of a factor |
//! | `nested_dissection` | an elimination order by separators, for large factors in space |
//! | `bordered_matrix` | the assembled matrix |
//! | `ldl`, `supernodal_ldl` | `K = L D Lᵀ`: small pivots raised, increments removed by borders; in pieces if large |
//! | `substitutions` | forward and backward substitution with `L D Lᵀ`, several right-hand sides together |
//! | `cholesky` | whether a symmetric matrix is positive definite |
//! | `static_pivot_lu`, `lu_pattern` | `K = L U` in the order of the symmetric factors, and the factors' patterns |
//! | `pivoted_lu` | LU of any sparse matrix |
//! | `entries` | entries of a row or a column |

pub mod bordered_matrix;
pub mod cholesky;
pub(crate) mod elimination_order;
pub(crate) mod entries;
pub mod ldl;
pub(crate) mod lu_pattern;
pub(crate) mod nested_dissection;
pub mod pattern;
pub mod pivoted_lu;
pub(crate) mod static_pivot_lu;
pub(crate) mod substitutions;
pub(crate) mod supernodal_ldl;
pub(crate) mod tolerances;
