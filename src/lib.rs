//! # arcslip
//!
//! Equilibrium paths of structures with unilateral contact and Coulomb friction, large displacements included, by the
//! arc-length method of Y. Kanno and J. A. C. Martins, *Arc-length method for frictional contact problems using
//! mathematical programming with complementarity constraints*, J. Optim. Theory Appl. 131 (2006),
//! doi:10.1007/s10957-006-9137-4.
//!
//! The data flow one way, and so do the dependencies:
//!
//! ```text
//! model (JSON, checked) -> structure -> contact -> mpec -> path -> judged -> jobs -> store -> http
//! ```
//!
//! `metrics` counts and times what `jobs` and `http` do, and knows neither. `linear_algebra` stands below all of them, [`measure`] beside the solver that it judges ([`judged`] brings both
//! together), [`scenes`] holds the built-in models with their exact solutions, [`studies`] sets the errors of paths against
//! their times, [`sweeps`] limit loads against what is varied. Everything up to [`judged`], and these, builds without the `server` feature and knows neither HTTP nor SQL.
//!
//! ## Notation
//!
//! | symbol | name in the code | meaning |
//! |---|---|---|
//! | `u` | `displacement` | nodal displacements |
//! | `s` | `load_factor` | multiplier of the running stage's pattern |
//! | `r = (r_n, r_t)` | `normal_reaction`, `tangential_reaction` | contact force on the node |
//! | `g` | `gap` | signed distance of the node from the obstacle |
//! | `μ` | `friction` | Coulomb's coefficient |
//! | `S` | `step` | arc length of an increment, `‖(Δu/u_scale, Δs/s_scale)‖` |
//! | `γ1`, `γ2` | `arc_weight`, `forward_weight` | weights of the increment's objective |
//! | `ε` | `relaxation` | bound on the products of complementary quantities |
//! | `·̇` | `rate` | derivative by arc length |

pub mod budget;
pub mod cancel;
pub mod contact;
pub mod judged;
pub mod linear_algebra;
pub mod measure;
pub mod model;
pub mod mpec;
pub mod output;
pub mod panics;
pub mod path;
pub mod scenes;
pub mod structure;
pub mod studies;
pub mod sweeps;
pub mod verify;

#[cfg(feature = "server")]
pub mod command;
#[cfg(feature = "server")]
pub mod http;
#[cfg(feature = "server")]
pub mod jobs;
#[cfg(feature = "server")]
pub mod metrics;
#[cfg(feature = "server")]
pub mod picture;
#[cfg(feature = "server")]
pub mod store;
