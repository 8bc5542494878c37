//! How a path comes to a point, and what that tells of the directions there.
//!
//! Where a slip ends, its speed `w` is zero and so is what its force leaves of the cone, `y`: at first order it may slip on or
//! stick along one and the same direction. The rates of the rates obey the equations of the rates once more,
//!
//! ```text
//! A (x', w') - q ṡ' + A' (x, w) - q' ṡ = (0, y'),
//! ```
//!
//! in both modes. If it slipped on, `w' = -κ` (it is seen to fall through zero, `κ > 0`) and `y' = 0`; if it sticks, `w' = 0`
//! and `y' = m κ` at the same load rate, `m` being the quotient of two principal minors of the matrix (its Schur
//! complement). Where the directions are proven to be the only ones these are all positive (a P-matrix: R. W. Cottle,
//! J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press 1992, section 3.3): it sticks, and no trial
//! step need tell.

use crate::branching::directions::candidate::CandidateDirection;
use crate::branching::directions::choice::DirectionChoice;
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::dot;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cached_factorisation::AtHand;

/// One less the product of two directions that are one.
const SAME_WAY: f64 = 1e-9;

/// Speeds (of unit arc length) up to this are what the location of a slip's end leaves.
const AT_REST: f64 = 1e-9;

/// How the path arrived.
#[derive(Debug, Clone, Copy)]
pub struct Incoming<'a> {
    /// Its direction.
    pub rate: &'a Rate,
    /// The modes of which that is the direction at the point, where it is known to be.
    pub modes: Option<&'a [Mode]>,
    /// A contact that would slip backwards if its mode went on: its speed falls through zero here, and not at rest.
    pub stopped: Option<usize>,
    /// A factorisation of the equations of those modes near the point, if there is one.
    pub nearby: Option<&'a AtHand>,
    /// The equations of those modes have had another null vector all along.
    pub is_singular: bool,
}

impl<'a> Incoming<'a> {
    /// In a mode that goes on, or of whose end nothing more is known.
    pub fn along(rate: &'a Rate) -> Self {
        Self { rate, modes: None, stopped: None, nearby: None, is_singular: false }
    }

    /// Whether in a direction contacts that have come to rest stick, all else as it was.
    pub(crate) fn is_stopped_in(&self, loading: Loading<'_>, state: &State, choice: &DirectionChoice) -> bool {
        let Some(modes) = self.modes else { return false };
        let mut stops = false;
        let as_it_was = |(contact, (was, is)): (usize, (&Mode, &Mode))| match (was, is) {
            (Mode::Slip { direction }, Mode::Stick) => {
                stops = true;
                dot(direction, &loading.relative_rate(contact, state, self.rate)).abs() <= AT_REST
            }
            _ => was.continues(*is),
        };
        modes.iter().zip(&choice.modes).enumerate().all(as_it_was) && stops
    }

    /// Whether a direction that may be taken in two modes at first order is known to be taken in the first.
    ///
    /// It is the incoming one, its kind is proven to be the only one, and only the contact that stops is in doubt.
    pub(crate) fn tells(&self, candidate: &CandidateDirection, is_proven: bool) -> bool {
        let in_doubt =
            || candidate.alternatives.iter().filter(|alternatives| alternatives.len() > 1).flatten().flatten();
        is_proven
            && self.stopped.is_some_and(|stopped| {
                candidate.modes[stopped] == Mode::Stick && in_doubt().all(|(contact, _)| *contact == stopped)
            })
            && candidate.rate.product(self.rate) > 1.0 - SAME_WAY
    }
}

#[cfg(test)]
mod tests {
    use super::Incoming;
    use crate::branching::directions::choice::PriorMotion;
    use crate::branching::selection::decision::list;
    use crate::branching::selection::enumeration::directions;
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
