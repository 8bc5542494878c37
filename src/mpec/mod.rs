//! Mathematical programs with complementarity constraints.
//!
//! ```text
//! min f(x)   s.t.   h(x) = 0,   g(x) >= 0,   lower <= x <= upper,   0 <= a_i(x)  ⊥  b_i(x) >= 0
//! ```
//!
//! solved through a sequence of regularised problems (`a_i b_i <= ε`, ε falling to 0) by sequential quadratic
//! programming. Nothing here knows of structures or contacts; [`problem::Problem`] is all that is asked.

pub mod problem;

pub use problem::Problem;
