//! The state of a path, its owner, and its rows for the user.
//!
//! | file | contents |
//! |---|---|
//! | `trace` | the owner of everything that changes from increment to increment |
//! | `progress` | everything that determines the continuation of the path: the content of a checkpoint |
//! | `contact_search` | the contacts in reach |
//! | `visited_states` | states that the path has left, to detect a cycle |
//! | `backoff` | waiting time before contact changes are treated together again |
//! | `totals` | sums and maxima along the path |
//! | `record`, `event_names` | the row of a point in the user's units and names; descriptions of events |
//! | `step_quantum`, `tolerances` | step lengths in eighths of an octave; tolerances for coincident states |

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
