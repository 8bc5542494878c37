//! The options, in the rate problem, of a node between two planes that move against each other.

use crate::complementarity::rates::rate_problem::{Choice, Entity, Signed};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size};
use crate::mechanics::multi_contact::moving_planes::Carried;
use crate::mechanics::multi_contact::planar;
use crate::mechanics::multi_contact::rate_options::contact_options::{Changeable, Forms, OptionOutcome};
use crate::mechanics::multi_contact::tolerances::RESTING_VELOCITY;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;

/// The options of the node, with the modes of each; forces up to `zero` count as zero.
pub fn options(
    carried: &Carried,
    loading: Loading<'_>,
    state: &State,
    entry: &Changeable,
    zero: f64,
    forms: &mut Forms<'_>,
) -> (Entity, Vec<OptionOutcome>) {
    let against = |forms: &mut Forms<'_>, place: usize, direction: &Vector| {
        let contact = carried.contacts[place];
        forms.motion(|rate| dot(direction, &loading.relative_rate(contact, state, rate)))
    };
    let gaps = [0, 1].map(|place| against(forms, place, &carried.frames[place].normal));
    let tangents = [0, 1].map(|place| against(forms, place, &carried.frames[place].tangents[0]));
    let unloaded = size(&entry.force) <= zero;
    let node = NodeBetweenPlanes { carried, loading, state, entry, zero, unloaded, gaps, tangents };
    let mut all: Vec<ModeOption> = [1.0, -1.0].into_iter().filter_map(|sign| node.carried(sign, forms)).collect();
    for place in 0..2 {
        all.extend(node.sticking(place, forms));
        let senses: &[f64] = if carried.frictions[place].is_rough() { &[1.0, -1.0] } else { &[0.0] };
        all.extend(senses.iter().filter_map(|sense| node.slipping(place, *sense, forms)));
    }
    all.extend(node.open(forms));
    let outcome = |modes: [Mode; 2]| OptionOutcome { modes: carried.contacts.into_iter().zip(modes).collect() };
    let (options, outcomes) = all.into_iter().map(|(choice, modes)| (choice, outcome(modes))).unzip();
    (Entity { options, touching: None }, outcomes)
}

/// The conditions of an option, and the modes of both contacts.
type ModeOption = (Choice, [Mode; 2]);

fn mode_option(zero: Vec<usize>, nonnegative: Vec<Signed>, modes: [Mode; 2]) -> ModeOption {
    (Choice { zero, nonnegative, implied: Vec::new() }, modes)
}

/// The modes where one contact is closed and the other one opens.
fn alone(place: usize, mode: Mode) -> [Mode; 2] {
    let mut modes = [Mode::Free; 2];
    modes[place] = mode;
    modes
}

/// A node between two planes that move against each other, at a state.
struct NodeBetweenPlanes<'a> {
    carried: &'a Carried,
    loading: Loading<'a>,
    state: &'a State,
    entry: &'a Changeable,
    /// The force that counts as zero.
    zero: f64,
    /// Whether the force on the node counts as zero.
    unloaded: bool,
    /// The forms of the rates of both gaps, and of the motions along both planes.
    gaps: [usize; 2],
    tangents: [usize; 2],
}

impl NodeBetweenPlanes<'_> {
    /// The conditions at the active bounds on the force; `None` where the force lies outside a bound.
    fn bounds(&self, contacts: &[usize], modes: impl Fn(usize) -> Mode, forms: &mut Forms<'_>) -> Option<Vec<Signed>> {
        let (force, zero) = (&self.entry.force, self.zero);
        let inward = planar::sector(self.loading, contacts, modes, self.state).inward;
        let values: Vec<Vector> = inward.into_iter().flatten().collect();
        let at = values.iter().filter(|inward| dot(inward, force) <= zero);
        let signed = at.map(|inward| Signed::plus(forms.force_along(self.entry, inward))).collect::<Vec<_>>();
        values.iter().all(|inward| dot(inward, force) >= -zero).then_some(signed)
    }

    /// Both planes carry the node along, while the load increases (`sign` 1) or decreases (-1).
    fn carried(&self, sign: f64, forms: &mut Forms<'_>) -> Option<ModeOption> {
        let modes = self.carried.modes(sign);
        let of = |contact: usize| modes[usize::from(contact == self.carried.contacts[1])];
        let mut nonnegative = self.bounds(&self.carried.contacts, of, forms)?;
        let load = forms.motion(|rate| rate.load);
        nonnegative.push(Signed { form: load, sign });
        Some(mode_option(self.gaps.to_vec(), nonnegative, modes))
    }

    /// The node sticks to one plane, and the other one opens.
    fn sticking(&self, place: usize, forms: &mut Forms<'_>) -> Option<ModeOption> {
        let Carried { contacts, frames, frictions, shifts, .. } = self.carried;
        let other = 1 - place;
        let normal = frames[place].normal;
        let parting = dot(&frames[other].normal, &add(&shifts[place], -1.0, &shifts[other]));
        // Where the other plane does not open, both planes carry the node.
        let parts = parting.abs() > RESTING_VELOCITY * size(&shifts[place]).max(size(&shifts[other]));
        if !frictions[place].is_rough() || !parts || dot(&self.entry.force, &normal) < -self.zero {
            return None;
        }
        let mut nonnegative = self.bounds(&contacts[place..=place], |_| Mode::Stick, forms)?;
        nonnegative.push(Signed::plus(self.gaps[other]));
        if self.unloaded {
            nonnegative.push(Signed::plus(forms.force_along(self.entry, &normal)));
        }
        Some(mode_option(vec![self.gaps[place], self.tangents[place]], nonnegative, alone(place, Mode::Stick)))
    }

    /// The node slips along one plane in the sense of its tangent (1), against it (-1), or without friction (0), and
    /// the other plane opens.
    fn slipping(&self, place: usize, sense: f64, forms: &mut Forms<'_>) -> Option<ModeOption> {
        let force = &self.entry.force;
        let direction = scaled(&self.carried.frames[place].tangents[0], sense);
        let ray = self.carried.ray(place, &direction);
        let across = [-ray[1], ray[0], 0.0];
        if !self.unloaded && (dot(&across, force).abs() > self.zero || dot(&ray, force) < 0.0) {
            return None;
        }
        let mut nonnegative = vec![Signed::plus(self.gaps[1 - place])];
        if self.carried.frictions[place].is_rough() {
            nonnegative.push(Signed { form: self.tangents[place], sign: sense });
        }
        if self.unloaded {
            nonnegative.push(Signed::plus(forms.force_along(self.entry, &ray)));
        }
        let off = forms.force_along(self.entry, &across);
        Some(mode_option(vec![self.gaps[place], off], nonnegative, alone(place, Mode::Slip { direction })))
    }

    /// Both planes open.
    fn open(&self, forms: &mut Forms<'_>) -> Option<ModeOption> {
        if !self.unloaded {
            return None;
        }
        let apart = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|axis| forms.force_along(self.entry, &axis));
        Some(mode_option(apart.to_vec(), self.gaps.map(Signed::plus).to_vec(), [Mode::Free; 2]))
    }
}
