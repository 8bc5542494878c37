//! Where first order does not tell which directions there are, and second order is asked.
//!
//! That is where first order leaves no way on; and where a slip ends. There the contact that has come to rest sticks along the
//! incoming direction, ahead or back: what its force leaves of the cone is zero at first order, and where no other force
//! changes either, rounding makes it something. A short step tells where the path bends little (`trial_step`), but not
//! where what hangs on the contact is at its fold.

use crate::branching::bifurcation::branch_directions::{SAME, SecondOrderFindings, SingularPoint, in_each_mode};
use crate::branching::directions::choice::{DirectionChoice, PriorMotion, mark_retrace, sign_of};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;

/// Whether directions of first order at the end of a slip are no more than rounding, or one is missing.
pub(crate) fn is_asked(
    loading: Loading<'_>,
    state: &State,
    options: &[DirectionChoice],
    before: PriorMotion<'_>,
) -> bool {
    let PriorMotion::Incoming(incoming) = before else { return false };
    // An odd count says that one is missing, or one too many.
    let is_odd = options.len() % 2 == 1;
    let is_doubtful =
        |option: &DirectionChoice| (is_odd || !option.is_tried) && incoming.is_stopped_in(loading, state, option);
    incoming.is_singular || options.iter().any(is_doubtful)
}

/// The directions as second order tells them; `None` where it is not known, or says less than first order did.
pub(crate) fn directions(here: SingularPoint<'_>, before: PriorMotion<'_>) -> Option<SecondOrderFindings> {
    let mut told = in_each_mode(here)?;
    if let PriorMotion::Incoming(incoming) = before {
        let options = &mut told.options;
        mark_retrace(here.loading, here.state, options, incoming.rate);
        // Of a load that turns, the way back falls as the way on does: it is no other way.
        let goes_back = |option: &&mut DirectionChoice| {
            option.rate.product(incoming.rate) < -SAME && sign_of(option.rate.load) == 0.0
        };
        options.iter_mut().filter(goes_back).for_each(|option| option.load_sign = 0.0);
        // Of two that differ in nothing else that one goes first which bends off as the path came.
        options.sort_by_key(|option| option.beside.as_ref().is_some_and(|side| side.product(incoming.rate) < 0.0));
    }
    let leaves_open = told.unclear && told.options.iter().all(|option| option.retrace);
    (!leaves_open).then_some(told)
}
