//! Test functions for singular points of the equations of a mode, and bordered equations that are regular there.
//!
//! | file | contents |
//! |---|---|
//! | `test_functions` | the sign of the bordered determinant and the number of negative eigenvalues |
//! | `null_vectors` | right and left null vectors |
//! | `bordering` | the equations bordered so that they are regular, for many unknowns |

pub(crate) mod bordering;
pub(crate) mod null_vectors;
pub(crate) mod test_functions;
pub(crate) mod tolerances;
