//! Scenes with known solutions. Each case gives a row with its errors, its tolerance and the reason for the end of the
//! path.
//!
//! A [`Case`] is a job request with a solution derived by hand, or with the stop reason that must end the path. The
//! [`measure`](crate::check::measure), which shares no code with the solver, checks each increment, and the case checks
//! the whole path. `published` contains the built-in scenes and published problems, `beams` scenes of plane beams with
//! more and more elements, `known` solutions in closed form, and `check::extreme` families of cases over decades; `make`
//! builds requests, and `compare` compares numbers.
//! `command` and tests call this module. The module uses `model`, `continuation`, `measure`, `scenes`, `resources` and
//! `result`, and neither HTTP nor SQL.

pub(crate) mod beams;
pub(crate) mod case;
pub(crate) mod compare;
pub(crate) mod known;
pub(crate) mod make;
pub(crate) mod published;

pub use case::{Case, CaseRow, ENERGY_BAR, STATE_BAR};
