//! # arcslip
//!
//! Equilibrium paths of structures with unilateral contact and Coulomb friction, large displacements included, by the
//! arc-length method of Y. Kanno and J. A. C. Martins, *Arc-length method for frictional contact problems using
//! mathematical programming with complementarity constraints*, J. Optim. Theory Appl. 131 (2006),
//! doi:10.1007/s10957-006-9137-4.
//!
//!
//! ## A path
//!
//! A [`Model`] is built by its methods, or [`read`] from JSON. An [`EquilibriumProblem`] is a checked model; it traces an
//! [`EquilibriumPath`], an iterator of increments. Here Klarbring's node is pressed on the floor and pulled along it, with
//! friction 1.5: it sticks up to the load 1.5, a nonsmooth limit point.
//!
//! ```
//! use arcslip::{Element, EquilibriumProblem, Model, Obstacle, PointKind, Stage, Status, StopReason};
//!
//! let model = Model::new(2)
//!     .node("node", [0.0, 0.0])
//!     .element(Element::spring("node", [[1.0, -0.8], [-0.8, 1.0]]))
//!     .obstacle("floor", Obstacle::plane([0.0, 0.0], [0.0, 1.0]))
//!     .contact("node", "floor", 1.5)
//!     .stage(Stage::new("press").force("node", [0.0, -1.0]).until_load_above(1.0))
//!     .stage(Stage::new("pull").force("node", [1.0, 0.0]).until_load_above(3.0));
//! let problem = EquilibriumProblem::new(model)?;
//!
//! let mut path = problem.trace();
//! let mut corners = Vec::new();
//! for point in &mut path {
//!     assert!(point.measure.largest_of_state() < 1e-9);
//!     let increment = point.increment;
//!     if increment.point.kind == PointKind::NonsmoothLimit {
//!         corners.push((increment.load_factor, increment.displacements["node"][0], increment.contacts[0].status));
//!     }
//! }
//! assert_eq!(corners, [(1.5, 0.0, Status::Stick), (1.25, 1.25, Status::Slip)]);
//! let report = path.report().expect("the path has ended").report;
//! assert_eq!(report.stop_reason, StopReason::StagesCompleted);
//! # Ok::<(), arcslip::InputErrors>(())
//! ```
//!
//! Quantities are in any consistent set of units: lengths, forces, and what is made of them. [`EquilibriumPath::follow`]
//! takes another of the directions at a bifurcation point. [`mpec`] is the solver of mathematical programs with
//! complementarity constraints by itself. All of this builds without the `server` feature, and then neither HTTP nor a
//! database is part of it.
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
//!
//! ## The rooms of the source
//!
//! What is documented here is the interface of the crate. The modules of the source are reachable, too, for this repository's
//! own tests, benchmarks and program, but hidden: they carry no promise of stability. `RUSTDOCFLAGS="--cfg interior" cargo doc`
//! documents them with the rest.
//!
//! The data flow one way, and so do the dependencies; each room imports only rooms above it:
//!
//! | room | what it holds |
//! |---|---|
//! | `resources` | memory and work within a budget, cancelling |
//! | `algebra` | dense and sparse matrices, their factorisations, roots |
//! | `complementarity` | mathematical programs with complementarity constraints, rate problems |
//! | `mechanics` | structure, contact, loads, the equations of one contact mode |
//! | `result` | what a path gives, as plain data |
//! | `step` | one step along a contact mode: corrector, events, the program of an increment |
//! | `branching` | the directions at a point, bifurcations, the choice among directions |
//! | `model` | the JSON contract, checked |
//! | `continuation` | path following: from a request to a sequence of increments |
//! | `check` | the measure of error, paths that are judged by it, built-in scenes |
//! | `output` | tables and pictures |
//! | `studies` | error against run time, limit loads against what is varied |
//! | `service` | queue, storage, HTTP |
//! | `command` | the command line |
//!
//! Everything up to `check`, and the tables, builds without the `server` feature and knows neither HTTP nor SQL. The test
//! `structure` reads the imports and holds these rooms to it.

#![warn(missing_docs)]

// Rooms are hidden and need no documentation on every item, except `result` and those files that define what is exported
// below: they have `missing_docs` as a warning again.
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod algebra;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod branching;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod check;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
#[cfg(feature = "server")]
pub mod command;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod complementarity;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod continuation;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod mechanics;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod model;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod output;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod resources;
#[cfg_attr(not(interior), doc(hidden))]
pub mod result;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
#[cfg(feature = "server")]
pub mod service;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod step;
#[cfg_attr(not(interior), doc(hidden))]
#[allow(missing_docs)]
pub mod studies;

pub use branching::directions::feasible_direction::Selection;
pub use check::judged::equilibrium_path::{EquilibriumPath, PathCheckpoint};
pub use check::judged::equilibrium_problem::EquilibriumProblem;
pub use check::judged::{JudgedCheckpointError, JudgedIncrement, JudgedReport, MeasureReport};
pub use check::measure::{Errors, HistoryError, Largest, Maxima};
pub use continuation::path::checkpoint::CheckpointError;
pub use mechanics::structure::elements::bar::Strain;
pub use model::decode::expanded;
pub use model::request::{
    Analysis, ArcLength, Certificate, Component, Contact, ContactDiscretisation, ContactRange, ContentEncoding,
    DisplacementBound, ElasticConstants, Element, ElementReference, Events, Explore, ForceRange, JobRequest,
    JumpMotion, JumpMotionKind, LoadSign, LockingMend, Material, MeshFile, MeshFormat, MeshGroup, Method, Model, Mpec,
    NamedSet, Obstacle, ObstacleRotation, OnPathEnd, PlaneCondition, Polyline, Record, RecordedContact,
    RecordedContacts, RecordedElements, RecordedSupports, Regularised, RoundedBox, Section, Side, Solid, SolidKind,
    Stage, StageControl, Surface, TriangleMesh, Units, Until,
};
pub use model::{InputError, InputErrors, read};
pub use resources::cancel::CancelFlag;
pub use result::increment::{
    ContactState, DeadLoadStability, Diagnostics, Direction, ElementState, Energy, Increment, Instability, Point,
    PointKind, SpaceVector, Stability, Status, Tangential,
};
pub use result::nodal_values::NodalValues;
pub use result::plan::{LeftOut, Plan};
pub use result::report::Report;
pub use result::stop_reason::{Outcome, StopReason};

/// Mathematical programs with complementarity constraints, independent of structures and contacts.
///
/// ```text
/// min f(x)   s.t.   h(x) = 0,   g(x) >= 0,   lower <= x <= upper,   0 <= a_i(x)  ⊥  b_i(x) >= 0,
///                   K ∋ A_i(x)  ⊥  B_i(x) ∈ K,     K the second-order cone
/// ```
///
/// A program implements [`Problem`](mpec::Problem), and [`solve`](mpec::solve) solves it: regularised programs
/// (`a_i b_i <= ε`, `ε` falling to 0; S. Scholtes, SIAM J. Optim. 11 (2001), doi:10.1137/S1052623499361233) by sequential
/// quadratic programming, then a descent over the branches, in each of which one member of every pair is zero. The result is a
/// local solution, with the kind of its stationarity. All numbers are dimensionless.
///
/// The point of `0 <= x ⊥ y >= 0` nearest to (1, 2) is (0, 2):
///
/// ```
/// use arcslip::CancelFlag;
/// use arcslip::mpec::{DVector, PairActivity, Problem, Settings, SolveStatus, SparseRows, StationarityKind, solve};
///
/// struct Nearest;
///
/// impl Problem for Nearest {
///     fn variables(&self) -> usize {
///         2
///     }
///     fn equalities(&self) -> usize {
///         0
///     }
///     fn inequalities(&self) -> usize {
///         0
///     }
///     fn pairs(&self) -> usize {
///         1
///     }
///     fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
///         (DVector::from_element(2, f64::NEG_INFINITY), DVector::from_element(2, f64::INFINITY))
///     }
///     fn objective(&self, x: &DVector<f64>) -> f64 {
///         (x[0] - 1.0).powi(2) + (x[1] - 2.0).powi(2)
///     }
///     fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
///         gradient[0] = 2.0 * (x[0] - 1.0);
///         gradient[1] = 2.0 * (x[1] - 2.0);
///     }
///     fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
///         first[0] = x[0];
///         second[0] = x[1];
///     }
///     fn pair_jacobians(&self, _x: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
///         first[(0, 0)] = 1.0;
///         second[(0, 1)] = 1.0;
///     }
/// }
///
/// let start = DVector::from_vec(vec![0.5, 1.0]);
/// let solution = solve(&Nearest, &start, &Settings::default(), &CancelFlag::default())?;
/// assert_eq!(solution.status, SolveStatus::Solved);
/// assert_eq!(solution.stationarity, StationarityKind::Strong);
/// assert_eq!(solution.activity, [PairActivity::FirstZero]);
/// assert!((solution.objective - 1.0).abs() < 1e-8);
/// assert!((solution.x[1] - 2.0).abs() < 1e-6);
/// # Ok::<(), arcslip::mpec::ProgramInputError>(())
/// ```
pub mod mpec {
    pub use crate::complementarity::mpec::{
        Activities, ConeActivity, Finish, Growth, Multipliers, PairActivity, Problem, ProgramInputError,
        ProgramSolution, Quantity, Settings, SolveStatus, SolverCounts, SolverIterate, SparseRows, StationarityKind,
        follow_branch, solve,
    };
    pub use nalgebra::{DMatrix, DVector};
}

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
        python: "Python",
        studies: "Sweeps, curves, studies, explorations",
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
