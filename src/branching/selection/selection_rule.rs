//! Decides which direction the path takes.
//!
//! Directions that hold only at first order are tested by a small step; the direction that retraces the path is never a
//! candidate. The rule then takes the largest dissipation per arc length (Kanno and Martins), the smallest rate of
//! potential energy (Hilding 2000), or the straightest direction. Ties go to the straightest in displacement,
//! `u̇·u̇_prev` alone: a rule that included the load would depend on its units. Where this is a tie, too (nothing
//! moves), the load continues to rise or fall as before.
//!
//! The potential energy is that of structure and loads, `Π = W(u) - f_held·u - s f·u`. Along a direction
//! `Π̇ = (f_int - f_held - s f)·u̇ - ṡ f·u`, and by equilibrium the bracket equals the reactions, whose power is `-D`
//! with the dissipation `D = -Σ r_t·u̇_t`: so `Π̇ = -D - ṡ f·u`, per unit arc length.

use crate::branching::bifurcation::branch_directions::{SecondOrderFindings, SingularPoint};
use crate::branching::directions::candidate::{FoundDirections, is_mechanism, remove_inner};
use crate::branching::directions::feasible_direction::{
    DirectionChoice, PriorMotion, Rules, Selection, mark_retrace, potential_rate, sign_of,
};
use crate::branching::directions::trial_step::confirm;
use crate::branching::selection::enumeration::directions;
use crate::branching::selection::second_order;
use crate::branching::selection::tolerances::{DISSIPATION_TIE_TOLERANCE, MOTION_TIE_TOLERANCE, RESTING_MOTION};
use crate::branching::stability::negative_ahead;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::linearity;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State, dot};
use crate::result::stop_reason::StopReason;
use crate::step::corrector::cached_factorisation::CachedFactorisation;

/// The directions at a point and the one taken.
#[derive(Debug, Clone)]
pub struct Decision {
    pub options: Vec<DirectionChoice>,
    /// Index in `options` of the direction taken; `None` where the path ends.
    pub taken: Option<usize>,
    /// Why the path ends here, if it does.
    pub stop: Option<StopReason>,
    pub unexplored: u64,
    pub degenerate: bool,
}

/// Lists the directions at a point.
pub fn list(
    loading: Loading<'_>,
    state: &State,
    standings: &[Standing],
    before: PriorMotion<'_>,
    rules: Rules<'_>,
) -> (Vec<DirectionChoice>, FoundDirections) {
    let incoming = match before {
        PriorMotion::Incoming(incoming) => Some(incoming),
        PriorMotion::StageStart { .. } => None,
    };
    let mut found = directions(loading, state, standings, incoming, rules.effort);
    let mut candidates = std::mem::take(&mut found.candidates);
    found.degenerate |= remove_inner(&mut candidates);
    let mut options = Vec::with_capacity(candidates.len());
    let holds_exactly = || rules.effort.certify && linearity::is_linear(loading);
    for candidate in candidates {
        let mechanism = is_mechanism(loading, state, &candidate.rate);
        let is_known = || incoming.is_some_and(|incoming| incoming.tells(&candidate, found.is_proven));
        let confirmed = if candidate.weak && !mechanism && !holds_exactly() && !is_known() {
            confirm(loading, state, &candidate, rules.force_scale)
        } else {
            Some((candidate.modes.clone(), 0.0))
        };
        let Some((modes, later_load)) = confirmed else { continue };
        let cached = if modes == candidate.modes { candidate.cached } else { CachedFactorisation::default() };
        let load_sign = sign_of(if sign_of(candidate.rate.load) == 0.0 { later_load } else { candidate.rate.load });
        let potential_rate = potential_rate(loading, state, &candidate.rate, candidate.dissipation);
        options.push(DirectionChoice {
            rate: candidate.rate,
            modes,
            dissipation: candidate.dissipation,
            potential_rate,
            load_sign,
            retrace: false,
            mechanism,
            is_singular: false,
            beside: None,
            is_tried: candidate.weak,
            cached,
        });
    }
    if let Some(incoming) = incoming {
        mark_retrace(loading, state, &mut options, incoming.rate);
    }
    (options, found)
}

/// Lists the directions and takes one.
pub fn decide(
    loading: Loading<'_>,
    state: &State,
    standings: &[Standing],
    before: PriorMotion<'_>,
    rules: Rules<'_>,
) -> Decision {
    let (options, found) = list(loading, state, standings, before, rules);
    let is_doubtful = second_order::is_asked(loading, state, &options, before);
    let decision = taken_of((loading, state), options, &found, before, rules);
    let ends = matches!(decision.stop, Some(StopReason::Degenerate | StopReason::NoDirection));
    if !(ends || is_doubtful) || found.unexplored > 0 || rules.effort.cancel.is_cancelled() {
        return decision;
    }
    let here = SingularPoint { loading, state, standings, force_scale: rules.force_scale };
    let Some(SecondOrderFindings { options, unclear }) = second_order::directions(here, before) else {
        return decision;
    };
    taken_of(
        (loading, state),
        options,
        &FoundDirections { degenerate: unclear, ..FoundDirections::default() },
        before,
        rules,
    )
}

/// Takes one of the directions found.
fn taken_of(
    (loading, state): (Loading<'_>, &State),
    options: Vec<DirectionChoice>,
    found: &FoundDirections,
    before: PriorMotion<'_>,
    rules: Rules<'_>,
) -> Decision {
    let odd = options.len() % 2 == 1;
    let mut open: Vec<usize> = (0..options.len()).filter(|&index| !options[index].retrace).collect();
    let mut push = loading.pattern.forces.clone();
    push.iter_mut().zip(&loading.pattern.supports).for_each(|(sum, value)| *sum += value);
    let mut goal = Rate { displacement: push, load: 0.0, reactions: Vec::new() };
    let previous = match before {
        PriorMotion::Incoming(incoming) => {
            if rules.load_rises && open.iter().any(|&index| options[index].load_sign >= 0.0) {
                open.retain(|&index| options[index].load_sign >= 0.0);
            }
            incoming.rate
        }
        PriorMotion::StageStart { free } => {
            if let Some(free) = free {
                goal.displacement.copy_from_slice(free);
            }
            if found.unexplored > 0 && open.iter().all(|&index| options[index].load_sign <= 0.0) {
                // The load is to rise, and the mode in which it does may be among those not examined.
                open.clear();
            }
            if open.iter().any(|&index| options[index].load_sign > 0.0) {
                open.retain(|&index| options[index].load_sign > 0.0);
            }
            &goal
        }
    };
    if rules.load_rises {
        retain_most_stable(loading, state, &options, &mut open, rules);
    }
    let taken = preferred(&options, previous, rules, |index| open.contains(&index));
    let stop = match taken {
        Some(index) if options[index].mechanism => Some(StopReason::Mechanism),
        Some(_) => None,
        None if found.corner_not_available => Some(StopReason::CornerNotAvailable),
        None if found.unexplored > found.slips_in_doubt => Some(StopReason::ModeLimit),
        None if found.unexplored > 0 => Some(StopReason::SlipsNotFound),
        None if found.mechanism => Some(StopReason::Mechanism),
        None if found.degenerate => Some(StopReason::Degenerate),
        None => Some(StopReason::NoDirection),
    };
    Decision {
        taken: taken.filter(|_| stop.is_none()),
        options,
        stop,
        unexplored: found.unexplored,
        degenerate: found.degenerate || odd,
    }
}

/// Leaves of several directions those along which the fewest eigenvalues are negative: under load control a structure
/// takes a stable branch where there is one. All stay where this is not known of each.
pub(crate) fn retain_most_stable(
    loading: Loading<'_>,
    state: &State,
    options: &[DirectionChoice],
    open: &mut Vec<usize>,
    rules: Rules<'_>,
) {
    if open.len() < 2 {
        return;
    }
    let count = |index: &usize| {
        let option = &options[*index];
        let holds = !option.mechanism && !rules.effort.cancel.is_cancelled();
        holds.then(|| negative_ahead(loading, state, (&option.rate, &option.modes), rules.force_scale)).flatten()
    };
    let Some(counts) = open.iter().map(count).collect::<Option<Vec<usize>>>() else { return };
    let least = counts.iter().min().copied();
    let mut counts = counts.into_iter();
    open.retain(|_| counts.next() == least);
}

/// The direction that the rule prefers among those that are eligible.
pub fn preferred(
    options: &[DirectionChoice],
    previous: &Rate,
    rules: Rules<'_>,
    eligible: impl Fn(usize) -> bool,
) -> Option<usize> {
    (0..options.len())
        .filter(|&index| eligible(index))
        .reduce(|best, other| if is_preferred(&options[other], &options[best], previous, rules) { other } else { best })
}

/// Whether the rule prefers the first of two directions to the second.
fn is_preferred(first: &DirectionChoice, second: &DirectionChoice, previous: &Rate, rules: Rules<'_>) -> bool {
    match rules.selection {
        Selection::Straightest => is_straighter(first, second, previous, true),
        Selection::MaxDissipation | Selection::MinPotentialEnergy => {
            let difference = match rules.selection {
                Selection::MinPotentialEnergy => second.potential_rate - first.potential_rate,
                Selection::MaxDissipation | Selection::Straightest => first.dissipation - second.dissipation,
            };
            if difference.abs() > DISSIPATION_TIE_TOLERANCE * rules.force_scale {
                difference > 0.0
            } else {
                is_straighter(first, second, previous, false)
            }
        }
    }
}

/// Whether the first of two directions has the larger product (or cosine) with the incoming direction, in displacement;
/// in case of a tie, whether it alone keeps the sign of the load rate.
fn is_straighter(first: &DirectionChoice, second: &DirectionChoice, previous: &Rate, by_cosine: bool) -> bool {
    let size = |rate: &Rate| {
        let size = dot(&rate.displacement, &rate.displacement).sqrt();
        if size > RESTING_MOTION * rate.size() { size } else { 0.0 }
    };
    let before = size(previous);
    let sizes = [first, second].map(|choice| size(&choice.rate));
    let largest = if by_cosine { 1.0 } else { sizes[0].max(sizes[1]) };
    let along = |choice: &DirectionChoice, size: f64| {
        let product = if size > 0.0 { dot(&choice.rate.displacement, &previous.displacement) } else { 0.0 };
        if by_cosine && size > 0.0 { product / size } else { product }
    };
    let difference = along(first, sizes[0]) - along(second, sizes[1]);
    if before > 0.0 && difference.abs() > MOTION_TIE_TOLERANCE * largest * before {
        return difference > 0.0;
    }
    let goes_on = |choice: &DirectionChoice| choice.load_sign * previous.load > 0.0;
    goes_on(first) && !goes_on(second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complementarity::rate_search::branch_and_bound::Effort;
    use crate::resources::cancel::CancelFlag;

    fn choice(displacement: [f64; 2], dissipation: f64, potential_rate: f64) -> DirectionChoice {
        let rate = Rate { displacement: displacement.to_vec(), load: 0.0, reactions: Vec::new() };
        let (modes, load_sign) = (Vec::new(), 1.0);
        DirectionChoice {
            rate,
            modes,
            dissipation,
            potential_rate,
            load_sign,
            retrace: false,
            mechanism: false,
            is_singular: false,
            beside: None,
            is_tried: false,
            cached: CachedFactorisation::default(),
        }
    }

    #[test]
    fn where_nothing_moves_the_load_goes_on_as_it_did() {
        let cancel = CancelFlag::default();
        let still = |load: f64| {
            let mut choice = choice([1e-18 * load, 0.0], 0.0, 0.0);
            (choice.rate.load, choice.load_sign) = (load, load);
            choice
        };
        let options = [still(-1.0), still(1.0)];
        for selection in [Selection::MaxDissipation, Selection::MinPotentialEnergy, Selection::Straightest] {
            for (load, index) in [(0.5, 1), (-0.5, 0)] {
                let previous = Rate { displacement: vec![-0.3 * load, 0.8], load, reactions: Vec::new() };
                let effort = Effort { most_modes: 1, certify: true, cancel: &cancel };
                let rules = Rules { selection, load_rises: false, effort, force_scale: 1.0 };
                assert_eq!(preferred(&options, &previous, rules, |_| true), Some(index));
            }
        }
    }

    #[test]
    fn each_rule_takes_its_own_direction_and_ties_go_straight_on() {
        let options = [choice([0.6, 0.8], 3.0, -1.0), choice([0.8, 0.6], 2.0, -4.0), choice([1.0, 0.0], 3.0, -4.0)];
        let previous = choice([0.0, 1.0], 0.0, 0.0).rate;
        let cancel = CancelFlag::default();
        let taken = |selection| {
            let effort = Effort { most_modes: 1, certify: true, cancel: &cancel };
            let rules = Rules { selection, load_rises: false, effort, force_scale: 1.0 };
            preferred(&options, &previous, rules, |_| true)
        };
        assert_eq!(taken(Selection::MaxDissipation), Some(0));
        assert_eq!(taken(Selection::MinPotentialEnergy), Some(1));
        assert_eq!(taken(Selection::Straightest), Some(0));
    }
}
