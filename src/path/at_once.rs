//! Contact changes of one step that are taken together.
//!
//! Contacts without friction that touch or lift off within a step leave no trace of where they did: the end of the step is
//! found from the laws at the end alone,
//!
//! ```text
//! equilibrium,    0 <= g ⊥ r_n >= 0,    ‖(Δu, Δs)‖ = S
//! ```
//!
//! by Newton's method in one mode after another: what a mode breaks at its end is changed, all of it at once (a
//! primal-dual active set: M. Hintermüller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2002) 865,
//! doi:10.1137/S1052623401383558).
//!
//! That end is the path's where nothing on the way leaves a choice. With `M` the stiffness that the contacts which
//! change feel (the others as they are), each sign of the load rate has exactly one direction in any mode of theirs if
//! `M` is positive definite: see `rates`. By the additivity of inertia it is if and only if the reduced tangent has as
//! many negative eigenvalues with all of them held as with all of them free. That is asked for at both ends of the
//! step, and the same number at both: no eigenvalue crosses zero in between, so that no limit point and no bifurcation
//! lies there in any mode that the path may have had. The way on from each change is then not the way back, and keeps the
//! sign of the load rate.
//!
//! Everything else ends a step as it always does: friction remembers where a node has landed.

use super::advance::{Attempt, COINCIDING, MOST_TURN, PASSED, Reached, Start, Work};
use super::mode_system::ModeSystem;
use super::newton::{Corrected, Place};
use super::singular::{Signature, negative_eigenvalues};
use super::standing::{Standing, standings};
use super::state::{Rate, State};
use super::watch::{self, Watch};
use crate::contact::Mode;
use crate::linear_algebra::SystemFactorisation;
use std::collections::BTreeSet;

/// Modes that are tried at the end of a step.
const MOST_ROUNDS: usize = 12;

/// The end of a step with contact changes inside.
pub(super) struct Joined {
    pub reached: Reached,
    /// How many.
    pub changes: u64,
    pub signature: Option<Signature>,
    /// The path's direction at the step's end if no contact changed: how much it turns beside its kinks.
    pub unchanged: Rate,
}

impl Start<'_> {
    /// The end of a step that passes several contact changes, if they can be taken together.
    pub(super) fn join_changes(&self, tried: &Attempt, work: &mut Work) -> Option<Joined> {
        let Attempt { reached: far, watches, passed, .. } = tried;
        let turns = watches.iter().any(|watch| matches!(watch, Watch::LoadRate { .. }));
        if passed.len() < 2 || !turns || !self.may_join() {
            return None;
        }
        let first = passed.iter().map(|watch| self.smooth(*watch)).collect::<Option<BTreeSet<usize>>>()?;
        // What holds at neither end is not worth the solves.
        let negative = self.negative_where_held_or_free(&first, self.state)?;
        let mut serving = None;
        let (modes, corrected) = self.end_modes(&first, far, &mut serving, work)?;
        let end = Start { modes: &modes, ..*self };
        let system = ModeSystem::new(self.loading, &modes, self.state);
        let hardness = far.corrected.iterations_to_small;
        let place = Place::ArcLength { from: self.state, step: far.step };
        let mut reached = end.directed(system, corrected, place, &mut serving, work).ok()?;
        reached.corrected.iterations_to_small = hardness;
        let changed: BTreeSet<usize> =
            (0..modes.len()).filter(|contact| modes[*contact] != self.modes[*contact]).collect();
        let turn = self.rate.product(&reached.rate).clamp(-1.0, 1.0).acos();
        if changed.len() < 2 || turn > MOST_TURN || !self.nothing_else_ends(watches, &changed, &reached) {
            return None;
        }
        let same = |state: &State| self.negative_where_held_or_free(&changed, state) == Some(negative);
        if (changed != first && !same(self.state)) || !same(&reached.corrected.state) {
            return None;
        }
        let analysed = self.loading.structure.allows_dense();
        let signature = reached.determinant.filter(|_| analysed);
        let signature = signature.map(|determinant| Signature { determinant, negative: Some(negative) });
        Some(Joined { reached, changes: changed.len() as u64, signature, unchanged: far.rate.clone() })
    }

    /// Whether changes in a step may be taken together: not where a contact slips against friction.
    pub(super) fn may_join(&self) -> bool {
        let mut modes = self.modes.iter().zip(self.loading.contacts);
        let slides = modes.any(|(mode, contact)| matches!(mode, Mode::Slip { .. }) && contact.tangents() > 0);
        self.drift.is_none() && !slides
    }

    /// The contact that touches or lifts off where a quantity is zero, if it has no friction and its node no other contact.
    fn smooth(&self, watch: Watch) -> Option<usize> {
        let (Watch::Gap(contact) | Watch::Normal(contact)) = watch else { return None };
        let alone = !self.loading.corners.iter().any(|corner| corner.contacts.contains(&contact));
        (alone && self.loading.contacts[contact].tangents() == 0).then_some(contact)
    }

    /// The modes that hold at the end of the step, and the point there, with the `last` factorisation.
    fn end_modes(
        &self,
        first: &BTreeSet<usize>,
        far: &Reached,
        last: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Option<(Vec<Mode>, Corrected)> {
        let mut modes = self.modes.to_vec();
        let mut state = far.corrected.state.clone();
        let mut wrong: Vec<usize> = first.iter().copied().collect();
        let mut tried = BTreeSet::new();
        for _ in 0..MOST_ROUNDS {
            for contact in &wrong {
                let held = modes[*contact].is_active();
                modes[*contact] = if held { Mode::Free } else { Mode::Slip { direction: [0.0; 3] } };
            }
            if !tried.insert(modes.iter().map(|mode| mode.is_active()).collect::<Vec<bool>>()) {
                return None;
            }
            let system = ModeSystem::new(self.loading, &modes, self.state);
            let place = Place::ArcLength { from: self.state, step: far.step };
            // Each mode has equations of its own.
            *last = None;
            let corrected = system.correct_from(system.iterate(state), place, self.force_scale, last).ok()?;
            work.newton_iterations += corrected.iterations;
            work.factorisations += corrected.factorisations;
            let forces = self.force_scale.max(corrected.force_scale);
            let broken =
                watch::of_mode(self.loading, &modes, &corrected.state, self.rate).into_iter().filter(|watch| {
                    let value = watch.value(self.loading, &modes, &corrected.state, self.rate);
                    value < -PASSED * watch.scale(self.loading, &corrected.state, forces)
                });
            wrong = broken.map(|watch| self.smooth(watch)).collect::<Option<Vec<usize>>>()?;
            if wrong.is_empty() {
                return Some((modes, corrected));
            }
            state = corrected.state;
        }
        None
    }

    /// Whether no stage ends within the step or at its end, the load rate keeps its sign, the other contacts keep their
    /// modes, and none can change at the end.
    fn nothing_else_ends(&self, watches: &[Watch], changed: &BTreeSet<usize>, reached: &Reached) -> bool {
        let state = &reached.corrected.state;
        let forces = self.force_scale.max(reached.corrected.force_scale);
        let ends = ((self.state, self.rate), (state, &reached.rate));
        let holds = |watch: &Watch| {
            if self.smooth(*watch).is_some_and(|contact| changed.contains(&contact)) {
                return true;
            }
            let zero = PASSED * watch.scale(self.loading, state, forces);
            let last = watch.value(self.loading, self.modes, state, &reached.rate);
            let dip = watch.dip(self.loading, self.modes, ends.0, ends.1, reached.step, zero);
            last > watch.zero_within(self.loading, state, COINCIDING, forces) && dip.is_none()
        };
        let settled = |standing: &Standing| matches!(standing, Standing::Settled(_));
        watches.iter().all(holds) && standings(self.loading, state, forces).iter().all(settled)
    }

    /// Negative eigenvalues of the tangent at a state with some contacts held and with them free, where these are as many.
    fn negative_where_held_or_free(&self, contacts: &BTreeSet<usize>, state: &State) -> Option<usize> {
        let count = |mode: Mode| {
            let mut modes = self.modes.to_vec();
            contacts.iter().for_each(|contact| modes[*contact] = mode);
            negative_eigenvalues(self.loading, &modes, self.state, state)
        };
        let free = count(Mode::Free)?;
        (count(Mode::Slip { direction: [0.0; 3] })? == free).then_some(free)
    }
}
