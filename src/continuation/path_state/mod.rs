//! The state of a path, its owner, and its rows for the user.
//!
//! | file | contents |
//! |---|---|
//! | `path_context` | the owner of everything that changes from increment to increment |
//! | `resumable_state` | everything that determines the continuation of the path: the content of a checkpoint |
//! | `passed_points` | the points of a path at which something happens, where they are kept |
//! | `motion` | the motion of a jump, as far as it has come |
//! | `contact_search` | the contacts in reach |
//! | `visited_states` | states that the path has left, to detect a cycle |
//! | `simultaneous_change_backoff` | waiting time before contact changes are treated together again |
//! | `totals` | sums and maxima along the path |
//! | `row_conversion`, `force_rows`, `event_descriptions` | the row of a point in the user's units and names; its forces; descriptions of events |
//! | `step_factor_rounding`, `tolerances` | step lengths in eighths of an octave; tolerances for coincident states |

pub(crate) mod contact_search;
pub(crate) mod event_descriptions;
pub(crate) mod force_rows;
pub(crate) mod motion;
pub(crate) mod passed_points;
pub(crate) mod path_context;
pub(crate) mod resumable_state;
pub(crate) mod row_conversion;
pub(crate) mod simultaneous_change_backoff;
pub(crate) mod step_factor_rounding;
pub(crate) mod tolerances;
pub(crate) mod totals;
pub(crate) mod visited_states;
