//! Scenes with known solutions; each gives a row with the result, the solution and the tolerance.
//!
//! A [`Case`] is a job request with a solution derived by hand, or the stop reason with which its path has to end. Each of its
//! increments is judged by [`measure`](crate::check::measure), which shares no code with the solver, and the whole path by the
//! case itself. `published` holds the built-in scenes and published problems, `check::extreme` families of
//! cases over decades; `make` builds requests, `compare` compares numbers. Called by `command` and by tests; knows
//! `model`, `continuation`, `measure` and `scenes`, and neither HTTP nor SQL.

pub(crate) mod case;
pub(crate) mod compare;
pub(crate) mod known;
pub(crate) mod make;
pub(crate) mod published;

pub use case::{Case, CaseRow, ENERGY_BAR, STATE_BAR};
