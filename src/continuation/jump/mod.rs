//! Jumps: the motion from a state where the path cannot go on to the next state at rest.
//!
//! At a limit point under a load that does not yield, and where there is no quasi-static direction, the structure moves.
//! The load is raised by a small part to set it in motion, and damping, with inertia where it is asked for, resists:
//!
//! ```text
//! M q̈ + C q̇ = s f + f_held - f_int(q) + Σ Bᵀ r,        r by Signorini and Coulomb
//! ```
//!
//! Backward Euler (with inertia the θ-method of J. J. Moreau and M. Jean with θ = 1: M. Jean, Comput. Methods Appl.
//! Mech. Engrg. 177 (1999) 235, doi:10.1016/S0045-7825(98)00383-1) makes a time step of length `h` an equilibrium
//! problem of the same structure, held by springs of stiffness `k = M/h² + C/h` at the place `a` where free motion would
//! lead:
//!
//! ```text
//! f_int(q) + k (q - a) = s f + f_held + Σ Bᵀ r,         k a = (M/h² + C/h) q₀ + M/h v₀
//! ```
//!
//! That problem is solved as every other one here, by following a path: the force that is out of balance at the state
//! before, `R`, is held back at first and then released, `(λ - 1) R` from `λ = 0` to 1. Contact and friction are exact at
//! the end of the step, and each change within it is an event of that path. A step is accepted where its path goes
//! straight to the end and the structure with its springs is stable there.
//!
//! | file | contents |
//! |---|---|
//! | `held_structure` | the structure with the springs of a time step |
//! | `time_step` | one implicit time step as an equilibrium path |
//! | `jump_motion` | the motion: its beginning, the lengths of its steps, its end at rest |
//! | `comparison` | the other kind of motion from the same state, on request |
//! | `rows` | the rows of a jump, and the directions at the state at rest |

mod comparison;
mod held_structure;
mod jump_motion;
pub(crate) mod rows;
mod time_step;
mod tolerances;
