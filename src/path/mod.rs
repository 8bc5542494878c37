//! Tracing the path: from a checked scene to a sequence of increments.
//!
//! [`Path`] is an iterator; whoever drives it (command line, worker, test) decides what to do with each increment.
//!
//! | file | what it does |
//! |---|---|
//! | `scene`, `plan` | a request made dimensionless; what it needs and what is left out |
//! | `state`, `loading` | a point; the structure under a pattern of forces, supports and obstacles that move |
//! | `mode_system`, `newton`, `tangent` | the equations of one contact mode; Newton's method on them; the path's direction at what it finds |
//! | `contact_law` | how far a state is from the laws of contact and friction |
//! | `corner`, `pocket`, `carried` | nodes that several obstacles hold at once: in the plane; in space, or guided by supports; between planes that move against each other |
//! | `track`, `drift` | slip in a plane: its rule of fourth order; the error that is left |
//! | `watch`, `advance` | what ends a mode; one step, ended exactly at the first event |
//! | `interpolation`, `locate`, `root` | between points that are reached; where a quantity is zero |
//! | `at_once`, `complementary`, `glance` | contact changes of one step that are taken together; which of them, by equations linearised once; one iteration of a mode, to see what it breaks |
//! | `foresight`, `straight` | the next contact change that rates foresee, solved for at once; stretches without bend |
//! | `singular`, `critical`, `branches` | whether a step passes a smooth bifurcation; where; which directions leave it |
//! | `bordering` | the equations at such a point made regular by borders, for many unknowns |
//! | `common_limit` | limit points that uncoupled parts have in common |
//! | `bound` | a bound of the stage at or beside a smooth bifurcation |
//! | `folded` | points of slip in a plane at which the direction is not determined |
//! | `near` | which contacts are in reach |
//! | `standing`, `incoming`, `directions`, `condensed`, `changeable`, `columns` | which contacts can change; how the path arrives; every direction; the structure's rates by the velocities of those contacts |
//! | `at_hand` | a factorisation that an earlier solve left over, for the next that it serves |
//! | `sole` | many contacts that can change: one direction for each sign of the load rate, without condensation |
//! | `going_on` | the directions where the mode goes on, if a cheap test says that there are two |
//! | `combinations` | one of each of several lists, in one order |
//! | `confirm`, `second_order`, `decide` | those that hold beyond first order; which one is taken |
//! | `past_fold` | steps from a fold of what hangs on a contact |
//! | `rates`, `turning`, `together` | all rays of a rate problem, linear forms only; slip whose direction is unknown, of one node and of several at once |
//! | `program`, `naming`, `by_program` | the MPEC of an increment; where it names the mode; increments found by it alone |
//! | `name_event`, `displacements` | an event in words; displacements by node for a row |
//! | `energy`, `record`, `increment`, `report`, `stop` | balances, rows, totals, reasons |
//! | `tracer`, `stages`, `stepping`, `trying`, `arrival` | the iterator; how a stage begins; how far a step goes; one try of it; what a point turned out to be |
//! | `history` | states that the path has left, for telling a cycle |
//! | `totals` | sums and maxima along a path, of either method |
//! | `progress`, `checkpoint`, `follow` | what decides how a path goes on; a path put down at a point and taken up again; along another direction |
//! | `regularised`, `traced` | the rival method; the path by whichever method is named |

mod advance;
mod arrival;
mod at_hand;
mod at_once;
mod bordering;
mod bound;
mod branches;
mod by_program;
mod carried;
mod changeable;
pub mod checkpoint;
mod columns;
mod combinations;
mod common_limit;
mod complementary;
mod condensed;
mod confirm;
mod contact_law;
mod corner;
mod critical;
mod decide;
mod directions;
pub mod displacements;
mod drift;
mod energy;
#[cfg(test)]
mod exhaustive;
mod folded;
mod follow;
mod foresight;
mod glance;
mod going_on;
mod history;
mod incoming;
pub mod increment;
mod interpolation;
mod loading;
mod locate;
mod mode_system;
mod name_event;
mod naming;
mod near;
mod newton;
mod past_fold;
pub mod plan;
mod pocket;
mod program;
mod progress;
mod rates;
mod record;
pub mod regularised;
pub mod report;
mod root;
pub mod scene;
mod second_order;
mod singular;
mod sole;
mod stages;
mod standing;
mod state;
mod stepping;
pub mod stop;
mod straight;
mod tangent;
#[cfg(test)]
mod tests_of_lattice;
mod together;
mod totals;
mod traced;
pub mod tracer;
mod track;
mod trying;
mod turning;
mod watch;

pub use by_program::{ContactIterate, ProgramIterate};
pub use checkpoint::{Checkpoint, CheckpointError};
pub use increment::Increment;
pub use plan::Plan;
pub use regularised::RegularisedPath;
pub use report::Report;
pub use scene::Scene;
pub use stop::{Outcome, StopReason};
pub use traced::TracedPath;
pub use tracer::Path;
