//! The options, in the rate problem, of a node between two planes that move against each other.

use crate::complementarity::rates::rate_problem::{Choice, Entity, Signed};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size};
use crate::mechanics::multi_contact::moving_planes::{Carried, STILL};
use crate::mechanics::multi_contact::planar;
use crate::mechanics::multi_contact::rate_options::contact_options::{Changeable, Forms, OptionOutcome};
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
    let mut options = Vec::new();
    let mut outcomes = Vec::new();
    let force = entry.force;
    let unloaded = size(&force) <= zero;
    let mut option = |zero: Vec<usize>, nonnegative: Vec<Signed>, modes: [Mode; 2]| {
        options.push(Choice { zero, nonnegative, implied: Vec::new() });
        outcomes.push(OptionOutcome { modes: carried.contacts.into_iter().zip(modes).collect() });
    };
    let against = |forms: &mut Forms<'_>, place: usize, direction: &Vector| {
        let contact = carried.contacts[place];
        forms.motion(|rate| dot(direction, &loading.relative_rate(contact, state, rate)))
    };
    let gaps = [0, 1].map(|place| against(forms, place, &carried.frames[place].normal));
    let tangents = [0, 1].map(|place| against(forms, place, &carried.frames[place].tangents[0]));
    // The active bounds on the force, or `None` where the force lies outside a bound.
    let bounds = |forms: &mut Forms<'_>, contacts: &[usize], modes: &dyn Fn(usize) -> Mode| {
        let inward = planar::sector(loading, contacts, modes, state).inward;
        let values: Vec<Vector> = inward.into_iter().flatten().collect();
        let at = values.iter().filter(|inward| dot(inward, &force) <= zero);
        let signed = at.map(|inward| Signed::plus(forms.force_along(entry, inward))).collect::<Vec<_>>();
        values.iter().all(|inward| dot(inward, &force) >= -zero).then_some(signed)
    };
    for sign in [1.0, -1.0] {
        let modes = carried.modes(sign);
        let of = |contact: usize| modes[usize::from(contact == carried.contacts[1])];
        if let Some(mut nonnegative) = bounds(forms, &carried.contacts, &of) {
            let load = forms.motion(|rate| rate.load);
            nonnegative.push(Signed { form: load, sign });
            option(gaps.to_vec(), nonnegative, modes);
        }
    }
    let alone = |place: usize, mode: Mode| {
        let mut modes = [Mode::Free; 2];
        modes[place] = mode;
        modes
    };
    for place in 0..2 {
        let other = 1 - place;
        let opens = Signed::plus(gaps[other]);
        let (normal, tangent) = (carried.frames[place].normal, carried.frames[place].tangents[0]);
        let rough = carried.frictions[place].is_rough();
        let parting = dot(&carried.frames[other].normal, &add(&carried.shifts[place], -1.0, &carried.shifts[other]));
        // Where the other plane does not open, the node is carried.
        let parts = parting.abs() > STILL * size(&carried.shifts[place]).max(size(&carried.shifts[other]));
        let sticks = |_| Mode::Stick;
        if rough
            && parts
            && dot(&force, &normal) >= -zero
            && let Some(mut nonnegative) = bounds(forms, &carried.contacts[place..=place], &sticks)
        {
            nonnegative.push(opens);
            if unloaded {
                nonnegative.push(Signed::plus(forms.force_along(entry, &normal)));
            }
            option(vec![gaps[place], tangents[place]], nonnegative, alone(place, Mode::Stick));
        }
        let senses: &[f64] = if rough { &[1.0, -1.0] } else { &[0.0] };
        for &sense in senses {
            let direction = scaled(&tangent, sense);
            let ray = carried.ray(place, &direction);
            let across = [-ray[1], ray[0], 0.0];
            if !unloaded && (dot(&across, &force).abs() > zero || dot(&ray, &force) < 0.0) {
                continue;
            }
            let mut nonnegative = vec![opens];
            if rough {
                nonnegative.push(Signed { form: tangents[place], sign: sense });
            }
            if unloaded {
                nonnegative.push(Signed::plus(forms.force_along(entry, &ray)));
            }
            let off = forms.force_along(entry, &across);
            option(vec![gaps[place], off], nonnegative, alone(place, Mode::Slip { direction }));
        }
    }
    if unloaded {
        let apart = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|axis| forms.force_along(entry, &axis));
        option(apart.to_vec(), gaps.map(Signed::plus).to_vec(), [Mode::Free; 2]);
    }
    (Entity { options, touching: None }, outcomes)
}
