//! Directions at second order, used where first order is inconclusive.
//!
//! First order is inconclusive where it leaves no direction to continue, and may be where a slip ends. There the
//! contact that has come to rest sticks along the incoming direction or its reverse: the distance of its force from the
//! cone is zero at first order, and where no other force changes either, round-off makes it nonzero. A short step
//! decides where the path bends little (`trial_step`), but not where a part attached to the contact is at its fold.

use crate::branching::bifurcation::branch_directions::tolerances::COINCIDENCE_COSINE;
use crate::branching::bifurcation::branch_directions::{SecondOrderFindings, SingularPoint, in_each_mode};
use crate::branching::directions::feasible_direction::{DirectionChoice, PriorMotion, mark_retrace, sign_of};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;

/// Whether directions of first order at the end of a slip may be mere round-off, or a direction is missing; or whether a stage
/// begins at a limit point under a load that does no work on the motion there: the equations then have a second null vector,
/// and first order tells no branch.
pub(crate) fn is_asked(
    loading: Loading<'_>,
    state: &State,
    options: &[DirectionChoice],
    before: PriorMotion<'_>,
) -> bool {
    let incoming = match before {
        PriorMotion::Incoming(incoming) => incoming,
        PriorMotion::StageStart { free } => return free.is_some(),
    };
    // An odd count indicates that a direction is missing, or that there is one too many.
    let is_odd = options.len() % 2 == 1;
    let is_doubtful =
        |option: &DirectionChoice| (is_odd || !option.is_tried) && incoming.is_stopped_in(loading, state, option);
    incoming.is_singular || options.iter().any(is_doubtful)
}

/// The directions at second order; `None` where they are not available, or are less conclusive than at first order.
pub(crate) fn directions(here: SingularPoint<'_>, before: PriorMotion<'_>) -> Option<SecondOrderFindings> {
    let mut told = in_each_mode(here)?;
    if let PriorMotion::Incoming(incoming) = before {
        let options = &mut told.options;
        mark_retrace(here.loading, here.state, options, incoming.rate);
        // Where the load turns, the load falls along the reverse as it does ahead: the reverse does not count as
        // another direction.
        let goes_back = |option: &&mut DirectionChoice| {
            option.rate.product(incoming.rate) < -COINCIDENCE_COSINE && sign_of(option.rate.load) == 0.0
        };
        options.iter_mut().filter(goes_back).for_each(|option| option.load_sign = 0.0);
        // Of two directions that differ in nothing else, the one that bends towards the incoming side comes first.
        options.sort_by_key(|option| option.beside.as_ref().is_some_and(|side| side.product(incoming.rate) < 0.0));
    }
    let leaves_open = told.unclear && told.options.iter().all(|option| option.retrace);
    (!leaves_open).then_some(told)
}
