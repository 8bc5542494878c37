//! What tells a singular point of the equations of a mode, and how these are made regular there.
//!
//! | file | what it does |
//! |---|---|
//! | `test_functions` | the sign of the bordered determinant and the number of negative eigenvalues |
//! | `null_vectors` | right and left null vectors |
//! | `bordering` | the equations bordered so that they are regular, for many unknowns |

pub(crate) mod bordering;
pub(crate) mod null_vectors;
pub(crate) mod test_functions;
