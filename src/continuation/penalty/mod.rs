//! The regularised method, for comparison: penalty contact and elastic-plastic friction with a conventional arc-length
//! method.
//!
//! ```text
//! contact      r_n = κ_n <-g>                                            penetration carries the reaction
//! friction     trial  t = t₀ - κ_t Δx_t;   |t| <= μ r_n: stick;   else slip: t = μ r_n t/|t|     (backward Euler)
//! equilibrium  G(u, s) = f_int(u) - s f - f_held - Σ (r_n n + t) = 0     consistent, unsymmetric tangent
//! arc length   |Δu|² + ψ² Δs² = S²
//! ```
//!
//! Contact and friction after D. Perić and D. R. J. Owen, *Computational model for 3-D contact problems with friction
//! based on the penalty method*, Int. J. Numer. Meth. Eng. 35 (1992) 1289, doi:10.1002/nme.1620350609. Arc length after
//! M. A. Crisfield, *A fast incremental/iterative solution procedure that handles "snap-through"*, Comput. Struct. 13
//! (1981) 55, doi:10.1016/0045-7949(81)90108-5, and *Non-linear Finite Element Analysis of Solids and Structures*,
//! Wiley 1991, chapter 9: two solves per iteration, a quadratic equation for the load, the root whose increment makes
//! the smaller angle with that of the previous iterate, `S ∝ √(desired/needed iterations)`, half the step after a
//! failure. The sign of the predictor is that of the determinant (Crisfield), or follows from the previous increment,
//! `sgn Δu·K⁻¹f` (Y. T. Feng, D. Perić, D. R. J. Owen, Comput. Struct. 58 (1996) 479,
//! doi:10.1016/0045-7949(95)00168-G).
//!
//! Unlike the other methods this one does not locate events (a point reports the changes within its step), list
//! directions or distinguish branches. A stage still ends exactly at its bound, by a last increment under control of
//! the load or displacement concerned.
//!
//! | file | contents |
//! |---|---|
//! | `law` | one contact: reaction and its derivative |
//! | `penalty_equations` | residual and tangent of the whole structure |
//! | `increment` | predictor and corrector of one increment |
//! | `step_control` | step lengths, and the increment that ends a stage |
//! | `iterator` | the iterator: points accepted, stages, rows |
//! | `penalty_work` | energies and rows |

pub(crate) mod increment;
pub(crate) mod iterator;
pub(crate) mod law;
pub(crate) mod penalty_equations;
pub(crate) mod penalty_work;
pub(crate) mod step_control;
#[cfg(test)]
mod tests;
pub(crate) mod tolerances;

pub use iterator::RegularisedPath;
