//! The points of a path at which something happens: a contact changes, the load turns, paths branch, a stage ends.

use crate::continuation::path_state::resumable_state::Progress;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget::{self, Taken};
use crate::result::increment::PointKind;
use crate::step::event_functions::EventFunction;
use crate::step::tolerances::BOUND_TOLERANCE;

/// Such a point, over all contacts of the scene; those out of reach are free.
#[derive(Debug, Clone)]
pub(crate) struct PassedPoint {
    /// Index of its increment.
    pub index: u64,
    pub kind: PointKind,
    pub stage: usize,
    pub state: State,
    /// What ended the step here; `None` where contacts changed together within the step, and at a bifurcation point.
    pub event: Option<EventFunction>,
    /// The modes in which the path arrives, and its direction.
    pub modes: Vec<Mode>,
    pub rate: Rate,
    /// The modes in which it leaves, and its direction; `None` where it ends.
    pub leaving_modes: Vec<Mode>,
    pub leaving_rate: Option<Rate>,
    /// Whether the stage ends here.
    pub stage_ends: bool,
    /// The largest force so far.
    pub force_scale: f64,
    _held: Taken,
}

impl PassedPoint {
    /// The present point.
    pub fn at(
        scene: &Scene,
        at: &Progress,
        rate: Rate,
        modes: &[Mode],
        event: Option<EventFunction>,
        kind: PointKind,
        stage_ends: bool,
    ) -> Self {
        // State and two rates over all degrees of freedom, each with a reaction a contact, and two modes a contact.
        let contacts = scene.contacts.len();
        let mut held = budget::take::<f64>(3 * scene.structure.freedoms());
        held.add::<Reaction>(3 * contacts);
        held.add::<Mode>(2 * contacts);
        let whole = WholeScene { scene, near: &at.near };
        let state = whole.state(&at.here.state);
        let bound = || {
            let met = scene.stages[at.stage].ends.iter().find(|end| is_met(end, &state));
            met.map(|end| EventFunction::End(*end))
        };
        let event = event.and_then(|event| whole.event(event)).or_else(|| bound().filter(|_| stage_ends));
        Self {
            index: at.totals.index,
            kind,
            stage: at.stage,
            event,
            modes: whole.modes(modes),
            rate: whole.rate(&rate),
            leaving_modes: whole.modes(&at.here.modes),
            leaving_rate: at.here.rate.as_ref().map(|rate| whole.rate(rate)),
            state,
            stage_ends,
            force_scale: at.totals.force_scale,
            _held: held,
        }
    }
}

fn is_met(end: &End, state: &State) -> bool {
    match *end {
        End::Load { bound, .. } => (state.load - bound).abs() <= BOUND_TOLERANCE,
        End::Displacement { freedom, bound, .. } => (state.displacement[freedom] - bound).abs() <= BOUND_TOLERANCE,
        End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_) => false,
    }
}

/// From the contacts in reach to all contacts of the scene.
struct WholeScene<'a> {
    scene: &'a Scene,
    near: &'a [usize],
}

impl WholeScene<'_> {
    fn reactions(&self, near: &[Reaction]) -> Vec<Reaction> {
        let mut all = vec![Reaction::default(); self.scene.contacts.len()];
        self.near.iter().zip(near).for_each(|(contact, reaction)| all[*contact] = *reaction);
        all
    }

    fn modes(&self, near: &[Mode]) -> Vec<Mode> {
        let mut all = vec![Mode::Free; self.scene.contacts.len()];
        self.near.iter().zip(near).for_each(|(contact, mode)| all[*contact] = *mode);
        all
    }

    fn state(&self, state: &State) -> State {
        State { reactions: self.reactions(&state.reactions), ..state.clone() }
    }

    fn rate(&self, rate: &Rate) -> Rate {
        Rate { reactions: self.reactions(&rate.reactions), ..rate.clone() }
    }

    /// `None` for a corner that the scene does not have, which does not occur.
    fn event(&self, event: EventFunction) -> Option<EventFunction> {
        let contact = |near: usize| self.near[near];
        // The corners in reach keep their order; each has at least two of its contacts in reach.
        let in_reach = |contacts: &[usize]| {
            contacts.iter().filter(|contact| self.near.binary_search(contact).is_ok()).nth(1).is_some()
        };
        let corner = |near: usize| {
            let all = self.scene.corners.iter().enumerate();
            all.filter(|(_, corner)| in_reach(&corner.contacts)).nth(near).map(|(corner, _)| corner)
        };
        Some(match event {
            EventFunction::Gap(near) => EventFunction::Gap(contact(near)),
            EventFunction::Normal(near) => EventFunction::Normal(contact(near)),
            EventFunction::Cone { contact: near, side } => EventFunction::Cone { contact: contact(near), side },
            EventFunction::Sliding(near) => EventFunction::Sliding(contact(near)),
            EventFunction::SurfaceEnd(near) => EventFunction::SurfaceEnd(contact(near)),
            EventFunction::Facet { corner: near, side } => EventFunction::Facet { corner: corner(near)?, side },
            EventFunction::Slide { corner: near } => EventFunction::Slide { corner: corner(near)? },
            EventFunction::Hold { corner: near } => EventFunction::Hold { corner: corner(near)? },
            EventFunction::Return { corner: near } => EventFunction::Return { corner: corner(near)? },
            EventFunction::LoadRate { .. } | EventFunction::End(_) => event,
        })
    }
}
