//! # arcslip
//!
//! Equilibrium paths of structures with unilateral contact and Coulomb friction, large displacements included, by the
//! arc-length method of Y. Kanno and J. A. C. Martins, *Arc-length method for frictional contact problems using
//! mathematical programming with complementarity constraints*, J. Optim. Theory Appl. 131 (2006),
//! doi:10.1007/s10957-006-9137-4.
//!
//! The data flow one way, and so do the dependencies; each room imports only rooms above it:
//!
//! | room | what it holds |
//! |---|---|
//! | [`resources`] | memory and work within a budget, cancelling |
//! | [`algebra`] | dense and sparse matrices, their factorisations, roots |
//! | [`complementarity`] | mathematical programs with complementarity constraints, rate problems |
//! | [`mechanics`] | structure, contact, loads, the equations of one contact mode |
//! | [`result`] | what a path gives, as plain data |
//! | [`step`] | one step along a contact mode: corrector, events, the program of an increment |
//! | [`branching`] | the directions at a point, bifurcations, the choice among directions |
//! | [`model`] | the JSON contract, checked |
//! | [`continuation`] | path following: from a request to a sequence of increments |
//! | [`check`] | the measure of error, paths that are judged by it, built-in scenes |
//! | [`output`] | tables and pictures |
//! | [`studies`] | error against run time, limit loads against what is varied |
//! | `service` | queue, storage, HTTP |
//! | `command` | the command line |
//!
//! Everything up to [`check`], and the tables, builds without the `server` feature and knows neither HTTP nor SQL. The test
//! `structure` reads the imports and holds these rooms to it.
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

pub mod algebra;
pub mod branching;
pub mod check;
#[cfg(feature = "server")]
pub mod command;
pub mod complementarity;
pub mod continuation;
pub mod mechanics;
pub mod model;
pub mod output;
pub mod resources;
pub mod result;
#[cfg(feature = "server")]
pub mod service;
pub mod step;
pub mod studies;
