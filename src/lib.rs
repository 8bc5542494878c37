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

/// The manual: one module for each chapter, which the service shows at `/manual`.
///
/// The texts are in `src/manual`. A chapter that is listed here is in the contents of the service, too, in this order.
// Chapters are written for the service's pages first, where `[x]` and `<x>` mean nothing else.
#[allow(rustdoc::bare_urls, rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]
pub mod manual {
    /// A chapter of the manual.
    #[derive(Debug, Clone, Copy)]
    pub struct Chapter {
        /// The name of its file, and its place in the address.
        pub name: &'static str,
        /// As in its first line.
        pub title: &'static str,
        /// Markdown; its first line is the title.
        pub text: &'static str,
    }

    macro_rules! chapters {
        ($($name:ident: $title:literal,)*) => {
            /// Every chapter, in the order of the contents.
            pub const CHAPTERS: &[Chapter] = &[$(Chapter {
                name: stringify!($name),
                title: $title,
                text: include_str!(concat!("manual/", stringify!($name), ".md")),
            },)*];

            // The build script makes the links lead from module to module.
            $(#[doc = include_str!(concat!(env!("OUT_DIR"), "/manual/", stringify!($name), ".md"))] pub mod $name {})*
        };
    }

    chapters! {
        model: "A model",
        scenes_and_commands: "Scenes and the command line",
        results: "Results",
        method: "The method",
        library: "The library",
        http: "The HTTP interface",
        studies: "Sweeps, studies, explorations",
        operation: "Operation",
        many_machines: "Many machines",
        performance: "Performance",
        validation: "Validation",
        penalty_method: "Comparison with the penalty method",
        limits: "Limits",
        how_it_is_built: "How it is built",
        development: "Development",
        changes: "Changes",
    }
}
