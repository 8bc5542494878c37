//! The incoming tangent of the path at a point, and the directions that it determines there.
//!
//! Where a slip ends, its speed `w` is zero and so is the distance `y` of its force from the cone: to first order the
//! contact may continue to slip or stick along the same direction. The second rates satisfy the differentiated rate
//! equations
//!
//! ```text
//! A (x', w') - q ṡ' + A' (x, w) - q' ṡ = (0, y'),
//! ```
//!
//! in both modes. If the contact continued to slip, `w' = -κ` (the speed is observed to decrease through zero, `κ > 0`)
//! and `y' = 0`; if it sticks, `w' = 0` and `y' = m κ` at the same load rate, with `m` the quotient of two principal
//! minors of the matrix (its Schur complement). Where the directions are proven to be the only ones these minors are
//! all positive (a P-matrix: R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic
//! Press 1992, section 3.3): the contact sticks, and no trial step is needed.

use crate::branching::directions::candidate::CandidateDirection;
use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::branching::directions::tolerances::{COSINE_TOLERANCE, RESTING_SPEED};
use crate::complementarity::rates::rate_problem::velocity_scale;
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::dot;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cached_factorisation::CachedFactorisation;

/// How the path arrived at a point.
#[derive(Debug, Clone, Copy)]
pub struct Incoming<'a> {
    /// Incoming direction of the path.
    pub rate: &'a Rate,
    /// The contact modes to which this direction belongs at the point, where known.
    pub modes: Option<&'a [Mode]>,
    /// A contact whose slip would reverse if its mode continued: its speed decreases through zero at the point.
    pub stopped: Option<usize>,
    /// A factorisation of the equations of these modes near the point, if there is one.
    pub nearby: Option<&'a CachedFactorisation>,
    /// The equations of these modes have had a second null vector all along the incoming path.
    pub is_singular: bool,
}

impl<'a> Incoming<'a> {
    /// The incoming direction in a mode that continues, or whose end is not known further.
    pub fn along(rate: &'a Rate) -> Self {
        Self { rate, modes: None, stopped: None, nearby: None, is_singular: false }
    }

    /// Whether in a direction contacts that have come to rest stick, while all others keep their modes.
    pub(crate) fn is_stopped_in(&self, loading: Loading<'_>, state: &State, choice: &DirectionChoice) -> bool {
        let Some(modes) = self.modes else { return false };
        // Where the arc length is nearly all load, the slips are as slow as the rest.
        let moved = self.rate.displacement.iter().map(|velocity| velocity * velocity).sum::<f64>().sqrt();
        let resting = RESTING_SPEED * velocity_scale(moved);
        let mut stops = false;
        let as_it_was = |(contact, (was, is)): (usize, (&Mode, &Mode))| match (was, is) {
            (Mode::Slip { direction }, Mode::Stick) => {
                stops = true;
                dot(direction, &loading.relative_rate(contact, state, self.rate)).abs() <= resting
            }
            _ => was.continues(*is),
        };
        modes.iter().zip(&choice.modes).enumerate().all(as_it_was) && stops
    }

    /// Whether a direction that is compatible with two modes at first order is known to be taken in the first of them.
    ///
    /// It is the incoming direction, the uniqueness of its kind is proven, and only the contact that stops is in doubt.
    pub(crate) fn tells(&self, candidate: &CandidateDirection, is_proven: bool) -> bool {
        let in_doubt =
            || candidate.alternatives.iter().filter(|alternatives| alternatives.len() > 1).flatten().flatten();
        is_proven
            && self.stopped.is_some_and(|stopped| {
                candidate.modes[stopped] == Mode::Stick && in_doubt().all(|(contact, _)| *contact == stopped)
            })
            && candidate.rate.product(self.rate) > 1.0 - COSINE_TOLERANCE
    }
}

#[cfg(test)]
mod tests {
    use super::Incoming;
    use crate::branching::directions::feasible_direction::PriorMotion;
    use crate::branching::selection::enumeration::directions;
    use crate::branching::selection::selection_rule::list;
    use crate::check::scenes::of_any_size::row_of_bars;
    use crate::continuation::path::iterator::Path;
    use crate::continuation::scene::Scene;
    use crate::mechanics::contact::Mode;
    use crate::resources::cancel::CancelFlag;

    #[test]
    fn what_is_seen_to_stop_sticks_as_a_trial_step_finds() {
        let request = serde_json::from_value(row_of_bars(20)).expect("a request");
        let scene = Scene::new(&request).expect("a scene");
        let mut path = Path::new(&scene, CancelFlag::default());
        let mut told = 0;
        while let Some(increment) = path.next() {
            let Some(listed) = &path.trace.at.listed else { continue };
            let (Some(arriving), Some(taken)) = (&listed.arriving, listed.taken) else { continue };
            let taken = &listed.options[taken];
            let stops = |contact: &usize| {
                matches!(arriving.modes[*contact], Mode::Slip { .. }) && taken.modes[*contact] == Mode::Stick
            };
            let Some(stopped) = (0..scene.contacts.len()).find(stops) else { continue };
            let (loading, state, rules) = (path.trace.loading(), &path.trace.at.here.state, path.trace.rules());
            let standings = path.trace.standings(state);
            let tried = Incoming::along(&taken.rate);
            let known = Incoming { stopped: Some(stopped), ..tried };
            let found = directions(loading, state, &standings, Some(known), rules.effort);
            told += found.candidates.iter().filter(|one| one.weak && known.tells(one, found.is_proven)).count();
            assert!(!found.candidates.iter().any(|one| known.tells(one, false)), "there is no telling without a proof");
            let [by_trial, by_knowledge] = [tried, known]
                .map(|incoming| list(loading, state, &standings, PriorMotion::Incoming(incoming), rules).0);
            assert_eq!(by_trial.len(), by_knowledge.len(), "increment {}", increment.index);
            for (one, other) in by_trial.iter().zip(&by_knowledge) {
                assert_eq!((&one.modes, &one.rate), (&other.modes, &other.rate), "increment {}", increment.index);
                assert_eq!((one.load_sign, one.dissipation), (other.load_sign, other.dissipation));
            }
        }
        assert!(told >= 15, "{told} of the 19 slips that end");
    }
}
