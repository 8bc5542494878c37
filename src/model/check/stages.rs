//! Checks the names and ends of stages.

use std::collections::HashSet;

use crate::model::check::loads::{self, Surroundings, loads};
use crate::model::check::scope::numbers;
use crate::model::check::scope::{Scope, proper_name};
use crate::model::check::structure::{component, component_name};
use crate::model::input::limits::MAX_TURNS;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::quoted;
use crate::model::request::{DisplacementBound, Stage, StageControl, Until};

pub(super) fn stages(scope: &Scope, mistakes: &mut Mistakes) {
    let at = scope.at.member("stages");
    if scope.model.stages.is_empty() {
        mistakes.add(&at, || "there are no stages; at least one is expected");
    }
    let around = Surroundings::new(scope);
    let mut names = HashSet::new();
    for (index, stage) in scope.model.stages.iter().enumerate() {
        let at = at.index(index);
        proper_name(&stage.name, &at.member("name"), mistakes);
        if !names.insert(&stage.name) {
            let name = quoted(&stage.name);
            mistakes.add(&at.member("name"), || format!("the name {name} stands twice; each stage has its own"));
        }
        loads(scope, &around, stage, &at, mistakes);
        if let Some(ends) = &stage.until {
            until(scope, stage, ends, index == 0, &at.member("until"), mistakes);
        }
        control(stage, &at, mistakes);
    }
}

/// What drives the load, and where it turns.
fn control(stage: &Stage, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if stage.control == StageControl::Path {
        for (field, given) in [("history", !stage.history.is_empty()), ("cycles", stage.cycles.is_some())] {
            if given {
                mistakes.add(&at.member(field), || "goes with `\"control\": \"load\"`; give that, or leave it out");
            }
        }
        return;
    }
    if stage.until.as_ref().is_some_and(|until| until.load_above.is_some() && until.load_below.is_some()) {
        mistakes.add(&at.member("until"), || {
            "under load control the load goes one way: one of `load_above` and `load_below` is expected, or a `history`"
        });
    }
    if stage.history.is_empty() {
        if stage.cycles.is_some() {
            mistakes.add(&at.member("cycles"), || "there is no `history` to go through; give one, or leave it out");
        }
        return;
    }
    if stage.until.is_some() {
        mistakes.add(&at.member("until"), || "the stage ends where its `history` does; leave one of the two out");
    }
    let at_history = at.member("history");
    let mut before = 0.0;
    for (index, target) in stage.history.iter().enumerate() {
        let at = at_history.index(index);
        if numbers::number(*target, &at, mistakes) && *target == before {
            mistakes.add(&at, || format!("found {target:?} where the load is {before:?} already; another is expected"));
        }
        before = *target;
    }
    let Some(cycles) = stage.cycles else { return };
    if cycles > 1 && stage.history.first() == stage.history.last() {
        mistakes.add(&at_history.index(stage.history.len() - 1), || {
            format!("found {before:?}, where the next cycle begins; another number is expected, or leave it out")
        });
    }
    let at_cycles = at.member("cycles");
    numbers::count(cycles, MAX_TURNS, &at_cycles, mistakes);
    let turns = cycles.saturating_mul(stage.history.len() as u64);
    if cycles <= MAX_TURNS && turns > MAX_TURNS {
        mistakes.add(&at_cycles, || format!("the load turns {turns} times; at most {MAX_TURNS} are taken"));
    }
}

fn until(scope: &Scope, stage: &Stage, until: &Until, first: bool, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if *until == Until::default() {
        mistakes.add(at, || {
            let known = "`load_above`, `load_below`, `displacement`, `limit_points`, `contact_change`, `increments`";
            format!("no end is given; one or more of {known} is expected, or leave `until` out")
        });
    }
    load_bounds(until, at, mistakes);
    if let Some(bound) = &until.displacement {
        displacement_bound(scope, stage, bound, first, &at.member("displacement"), mistakes);
    }
    let counts = [
        ("limit_points", until.limit_points),
        ("contact_change", until.contact_change),
        ("increments", until.increments),
    ];
    for (field, count) in counts {
        if let Some(count) = count {
            numbers::count(count, u64::MAX, &at.member(field), mistakes);
        }
    }
}

fn load_bounds(until: &Until, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let bounds = [("load_above", until.load_above, 1.0, "above"), ("load_below", until.load_below, -1.0, "below")];
    for (field, bound, sign, side) in bounds {
        let Some(bound) = bound else { continue };
        let at = at.member(field);
        if numbers::number(bound, &at, mistakes) && sign * bound <= 0.0 {
            mistakes.add(&at, || {
                format!("found {bound:?}; the load factor of a stage starts at 0, so a number {side} 0 is expected")
            });
        }
    }
}

/// A supported component moves only in a stage that prescribes its displacement.
fn displacement_bound(
    scope: &Scope,
    stage: &Stage,
    bound: &DisplacementBound,
    first: bool,
    at: &DocumentPlace,
    mistakes: &mut Mistakes,
) {
    let node = scope.node(&bound.node, &at.member("node"), mistakes);
    let component_at = at.member("component");
    let known = component(bound.component, scope.model.dimension, &component_at, mistakes);
    let dimension = scope.model.dimension;
    let place = bound.component.place(dimension);
    let prescribed = stage.displacements.get(&bound.node).and_then(|displacement| displacement.get(place));
    let turns = bound.component.is_rotation();
    let known = known
        && (!turns || node.is_some_and(|node| loads::rotation(scope, node, &bound.node, &component_at, mistakes)));
    let is_free =
        |node| if turns { scope.turns_freely_by(node, bound.component.index()) } else { scope.is_free(node, place) };
    let moves = |node| is_free(node) || prescribed.is_some_and(|&displacement| displacement != 0.0);
    if turns && scope.model.dimension == 3 && node.is_some_and(is_free) {
        mistakes.add(&component_at, || {
            "a rotation in space that is free ends no stage; a translation, a rotation that the stage's `displacements` move, \
             or the load would do"
        });
    }
    if known && node.is_some_and(|node| !moves(node)) {
        mistakes.add(&component_at, || {
            let component = component_name(bound.component);
            format!(
                "the component {component} of {} is supported and never moves in this stage; a free one would do, or \
                 one that the stage's `displacements` move",
                quoted(&bound.node)
            )
        });
    }
    if bound.above.is_some() == bound.below.is_some() {
        mistakes.add(at, || "exactly one of `above` and `below` is expected");
    }
    for (field, value, sign) in [("above", bound.above, 1.0), ("below", bound.below, -1.0)] {
        let Some(value) = value else { continue };
        let at = at.member(field);
        if numbers::number(value, &at, mistakes) && first && sign * value <= 0.0 {
            mistakes.add(&at, || {
                format!("found {value:?}; displacements start at 0, where this is reached already; a number {field} 0 is expected")
            });
        }
    }
}
