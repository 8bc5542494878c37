//! Studies: one scene over a ladder of settings and over methods, error against run time.
//!
//! **Error of a path.** Points are compared in the plan's scaled norm, `‖(Δu/u_scale, Δs/s_scale)‖`, stage by stage, and
//! curves rather than points of equal index: the error is the least `e` for which the path's points can be laid, in
//! their order, onto places of the reference curve that never run backward, each within `e` of its point. That is the
//! Fréchet distance (H. Alt, M. Godau, *Computing the Fréchet distance between two polygonal curves*, Int. J. Comput.
//! Geom. Appl. 5 (1995) 75, doi:10.1142/S0218195995000064) with only the points of one of the two curves: chords between
//! them are no part of the result. Because of the order, a path that turns back or takes another branch is not taken for
//! one that goes on. Points past the end of the reference count with their distance from its end.
//!
//! **Reference.** The [exact solution](crate::check::scenes::exact) where one is known. Otherwise a path of the method `auto`
//! with shorter arc lengths, joined by polynomials of degree up to seven (`curve`), never across a contact change, so that
//! corners stay corners. The same path is traced once more with its points in the middle between the first ones, where the
//! polynomials are farthest from the path, and measured against them: a path of other arc lengths would not do, since
//! where the path bends both take the same steps, and see nothing of what lies between. Four times what is found (or
//! the largest `error_estimate`, of slip in space) is stated as the reference's own uncertainty; errors below twice
//! that, or below round-off, are not resolved, and no order is read from them.
//!
//! **Events** are compared by themselves, as a sequence (`events`): how many of the reference's are found, in order and of
//! the same kind, how far off the worst of them is, and how many others there are.
//!
//! **Time** is the solver's own clock. Paths are traced one after another on one thread, all rows in turn and then all
//! rows again, so that a disturbance spreads over all of them; the first round is not timed. Median, least and largest
//! are given.
//!
//! **Order** is the slope of the error against what is varied, on logarithmic scales; of arc lengths the mean one that was
//! taken, since `arc_length.max` is only a bound.
//!
//! | file | what it does |
//! |---|---|
//! | `trace` | a path as scaled points |
//! | `curve`, `interpolation` | the reference as a curve |
//! | `matching`, `nearest` | the error of a path |
//! | `events` | the error of its events |
//! | `reference` | the reference against which errors are measured |
//! | `row`, `report`, `table` | the findings, as values and as text |
//! | `plan`, `run` | the ladder, planned and run |
//!
//! Called by `jobs` and `command`; knows `model`, `continuation` and `scenes`.

pub(crate) mod curve;
pub(crate) mod events;
pub(crate) mod interpolation;
pub(crate) mod matching;
pub(crate) mod nearest;
pub(crate) mod plan;
pub(crate) mod reference;
pub(crate) mod report;
pub(crate) mod row;
pub(crate) mod run;
pub mod table;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_uncertainty;
pub(crate) mod trace;

pub use events::EventsFound;
pub use plan::{StudyPlan, plan};
pub use reference::{Reference, ReferenceKind};
pub use report::{MethodOrder, StudyReport};
pub use row::{StudyRow, StudyRun, Time};
pub use run::run;
