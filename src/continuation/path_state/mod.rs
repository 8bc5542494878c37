//! The state of a path, its owner, and the rows that a user sees of it.
//!
//! | file | what it holds |
//! |---|---|
//! | `trace` | the owner of everything that changes from increment to increment |
//! | `progress` | what decides how the path goes on: the content of a checkpoint |
//! | `contact_search` | which contacts are in reach |
//! | `visited_states` | states that the path has left, for telling a cycle |
//! | `backoff` | when contact changes are to be taken together again |
//! | `totals` | sums and maxima along the path |
//! | `record`, `event_names` | the row of a point in the user's units and names; events in words |
//! | `step_quantum`, `tolerances` | steps in eighths of an octave; when states are one |

pub(crate) mod backoff;
pub(crate) mod contact_search;
pub(crate) mod event_names;
pub(crate) mod progress;
pub(crate) mod record;
pub(crate) mod step_quantum;
pub(crate) mod tolerances;
pub(crate) mod totals;
pub(crate) mod trace;
pub(crate) mod visited_states;
