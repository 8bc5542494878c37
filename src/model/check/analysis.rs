//! Checks the settings of the analysis.

use crate::model::check::scope::numbers;
use crate::model::input::limits::{
    MAX_DENSE_UNKNOWNS, MAX_DESIRED_ITERATIONS, MAX_EXPLORE_DEPTH, MAX_EXPLORE_JOBS, MAX_INCREMENTS, MAX_JUMP_STEPS,
    MAX_MODES, MAX_UNKNOWNS, MIN_JUMP_TOLERANCE,
};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::recorded_forces::element_label;
use crate::model::request::{
    Analysis, ArcLength, ElementReference, JobRequest, JumpMotionKind, Method, Model, OnPathEnd, Record,
    RecordedContact, RecordedElements, RecordedSupports, Regularised, StageControl,
};
use std::collections::{HashMap, HashSet};

pub(super) fn analysis(analysis: &Analysis, at: &DocumentPlace, mistakes: &mut Mistakes) {
    arc_length(&analysis.arc_length, &at.member("arc_length"), mistakes);
    numbers::count(analysis.max_increments, MAX_INCREMENTS, &at.member("max_increments"), mistakes);
    numbers::count(analysis.max_modes, MAX_MODES, &at.member("max_modes"), mistakes);
    if let Some(explore) = analysis.explore {
        let at = at.member("explore");
        if analysis.method == Method::Regularised {
            mistakes.add(&at, || "the method `regularised` lists no directions that could be followed; leave it out");
        }
        numbers::count(explore.depth, MAX_EXPLORE_DEPTH, &at.member("depth"), mistakes);
        numbers::count(explore.max_jobs, MAX_EXPLORE_JOBS, &at.member("max_jobs"), mistakes);
    }
    if let Some(record) = &analysis.record {
        let at = at.member("record");
        numbers::count(record.every, MAX_INCREMENTS, &at.member("every"), mistakes);
        if record.stability && analysis.method == Method::Regularised {
            mistakes
                .add(&at.member("stability"), || "the method `regularised` finds none; leave it out, or take another");
        }
        if !record.directions && analysis.explore.is_some() {
            mistakes
                .add(&at.member("directions"), || "`explore` follows directions, which are left out here; give true");
        }
    }
    if analysis.mpec.is_some() && analysis.method != Method::Mpec {
        mistakes.add(&at.member("mpec"), || "parameters of the method `mpec`, which is not the one chosen; leave them out, or give `\"method\": \"mpec\"`".to_owned());
    }
    if let Some(given) = &analysis.regularised {
        let at = at.member("regularised");
        if analysis.method != Method::Regularised {
            mistakes.add(&at, || "parameters of the method `regularised`, which is not the one chosen; leave them out, or give `\"method\": \"regularised\"`".to_owned());
        }
        regularised(given, &at, mistakes);
    }
}

/// Whether and how the structure jumps where the path cannot go on.
pub(super) fn jumps(request: &JobRequest, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let JobRequest { model, analysis } = request;
    let load_control = model.stages.iter().position(|stage| stage.control == StageControl::Load);
    let jumps = load_control.is_some() || analysis.on_path_end == OnPathEnd::Jump;
    if jumps && analysis.method == Method::Regularised {
        let (stages, on_path_end) = (DocumentPlace::ROOT.member("model"), at.member("on_path_end"));
        let stages = stages.member("stages");
        let stage = stages.index(load_control.unwrap_or_default());
        let control = stage.member("control");
        let at = if load_control.is_some() { &control } else { &on_path_end };
        mistakes.add(at, || "the method `regularised` does not jump; `auto` or `mpec` would do");
    }
    let Some(motion) = analysis.jump_motion else { return };
    let at = at.member("jump_motion");
    if !jumps {
        mistakes.add(
            &at,
            || "nothing jumps; give `\"on_path_end\": \"jump\"`, a stage with `\"control\": \"load\"`, or leave it out",
        );
    }
    if let Some(ratio) = motion.damping_ratio {
        let at = at.member("damping_ratio");
        numbers::positive(ratio, &at, mistakes);
        if motion.kind == JumpMotionKind::Overdamped {
            mistakes.add(&at, || "goes with the kind `inertial`; an overdamped motion has no mass: leave it out");
        }
    }
    let at_tolerance = at.member("tolerance");
    let is_number = numbers::number(motion.tolerance, &at_tolerance, mistakes);
    if is_number && !(MIN_JUMP_TOLERANCE..1.0).contains(&motion.tolerance) {
        mistakes.add(&at_tolerance, || {
            format!("found {:?}; a number from {MIN_JUMP_TOLERANCE:e} to below 1 is expected", motion.tolerance)
        });
    }
    numbers::count(motion.max_steps, MAX_JUMP_STEPS, &at.member("max_steps"), mistakes);
}

/// The methods with dense matrices accept fewer unknowns.
pub(super) fn unknowns_of_method(free: usize, method: Method, mistakes: &mut Mistakes) {
    let is_dense = matches!(method, Method::Mpec | Method::Regularised);
    if is_dense && (MAX_DENSE_UNKNOWNS + 1..=MAX_UNKNOWNS).contains(&free) {
        mistakes.add(&DocumentPlace::ROOT.member("analysis").member("method"), || {
            format!(
                "the nodes have {free} free displacement components; this method takes at most {MAX_DENSE_UNKNOWNS}: \
                 give `\"method\": \"auto\"`"
            )
        });
    }
}

/// Every name in `record` is in the model, and occurs once.
pub(super) fn recorded(record: &Record, model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let mut seen = HashSet::new();
    for (index, name) in record.nodes.iter().flatten().enumerate() {
        let at = &at.member("nodes");
        let at = at.index(index);
        if !model.nodes.contains_key(name) {
            let known = || suggestion(name, model.nodes.keys().map(String::as_str));
            mistakes.add(&at, || format!("there is no node {}{}", quoted(name), known()));
        } else if !seen.insert(name) {
            mistakes.add(&at, || format!("{} occurs twice", quoted(name)));
        }
    }
    recorded_elements(record, model, at, mistakes);
    recorded_supports(record, model, at, mistakes);
    let contacts: HashSet<(&str, &str)> =
        model.contacts.iter().map(|contact| (contact.node.as_str(), contact.counterpart())).collect();
    let mut seen = HashSet::new();
    for (index, RecordedContact { node, obstacle }) in record.named_contacts().into_iter().flatten().enumerate() {
        let at = &at.member("contacts");
        let at = at.index(index);
        let pair = (node.as_str(), obstacle.as_str());
        if !model.nodes.contains_key(node) {
            let known = || suggestion(node, model.nodes.keys().map(String::as_str));
            mistakes.add(&at.member("node"), || format!("there is no node {}{}", quoted(node), known()));
        } else if !model.obstacles.contains_key(obstacle) && !contacts.iter().any(|(_, name)| name == obstacle) {
            let known = || suggestion(obstacle, model.obstacles.keys().map(String::as_str));
            mistakes.add(&at.member("obstacle"), || format!("there is no obstacle {}{}", quoted(obstacle), known()));
        } else if !contacts.contains(&pair) {
            mistakes.add(&at, || format!("there is no contact of {} with {}", quoted(node), quoted(obstacle)));
        } else if !seen.insert(pair) {
            mistakes.add(&at, || format!("{} with {} occurs twice", quoted(node), quoted(obstacle)));
        }
    }
}

/// Every element that is listed is in the model, and occurs once, be it by place or by name.
fn recorded_elements(record: &Record, model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let Some(RecordedElements::Listed(listed)) = &record.elements else { return };
    let named: HashMap<&str, usize> =
        model.elements.iter().enumerate().filter_map(|(place, element)| Some((element.name()?, place))).collect();
    let at = at.member("elements");
    let mut seen = HashSet::new();
    for (index, reference) in listed.iter().enumerate() {
        let at = at.index(index);
        let place = match reference {
            ElementReference::Place(place) if *place < model.elements.len() as u64 => *place as usize,
            ElementReference::Place(place) => {
                let last = model.elements.len().saturating_sub(1);
                mistakes.add(&at, || format!("there is no element {place}; 0 to {last} would do"));
                continue;
            }
            ElementReference::Name(name) => match named.get(name.as_str()) {
                Some(place) => *place,
                None => {
                    let known = || suggestion(name, model.elements.iter().filter_map(|element| element.name()));
                    mistakes.add(&at, || format!("there is no element {}{}", quoted(name), known()));
                    continue;
                }
            },
        };
        if !seen.insert(place) {
            mistakes.add(&at, || format!("element {} occurs twice", element_label(model, place)));
        }
    }
}

/// Every node that is named has a support, and occurs once.
fn recorded_supports(record: &Record, model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let Some(RecordedSupports::Named(named)) = &record.supports else { return };
    let at = at.member("supports");
    let mut seen = HashSet::new();
    for (index, name) in named.iter().enumerate() {
        let at = at.index(index);
        if !model.supports.contains_key(name) {
            let known = || suggestion(name, model.supports.keys().map(String::as_str));
            mistakes.add(&at, || format!("there is no support at a node {}{}", quoted(name), known()));
        } else if !seen.insert(name) {
            mistakes.add(&at, || format!("{} occurs twice", quoted(name)));
        }
    }
}

/// Checks each value by itself.
pub(super) fn regularised(regularised: &Regularised, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let &Regularised { normal_penalty, tangential_penalty, desired_iterations, tolerance, load_weight, load_sign: _ } =
        regularised;
    numbers::positive(normal_penalty, &at.member("normal_penalty"), mistakes);
    numbers::positive(tangential_penalty, &at.member("tangential_penalty"), mistakes);
    numbers::count(desired_iterations, MAX_DESIRED_ITERATIONS, &at.member("desired_iterations"), mistakes);
    let at_tolerance = at.member("tolerance");
    if numbers::positive(tolerance, &at_tolerance, mistakes) && tolerance >= 1.0 {
        mistakes.add(&at_tolerance, || format!("found {tolerance:?}; a number between 0 and 1 is expected"));
    }
    let at_weight = at.member("load_weight");
    if numbers::number(load_weight, &at_weight, mistakes) && load_weight < 0.0 {
        mistakes.add(&at_weight, || format!("found {load_weight:?}; 0 or more is expected"));
    }
}

fn arc_length(arc_length: &ArcLength, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let &ArcLength { initial, min, max, .. } = arc_length;
    if !arc_lengths(arc_length, at, mistakes) {
        return;
    }
    if min > max {
        mistakes.add(&at.member("max"), || format!("found {max:?}; at least `min`, {min:?}, is expected"));
    } else if initial < min || initial > max {
        mistakes.add(&at.member("initial"), || {
            format!("found {initial:?}; a number between `min`, {min:?}, and `max`, {max:?}, is expected")
        });
    }
}

/// Each value by itself, as all of them have to be; whether they are.
pub(super) fn arc_lengths(arc_length: &ArcLength, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let &ArcLength { initial, min, max, displacement_scale, load_scale, jump: _ } = arc_length;
    let mut sane = true;
    sane &= numbers::positive(max, &at.member("max"), mistakes);
    // What is not given is at most `max`, and would be blamed with it.
    for (field, value) in [("initial", initial), ("min", min)] {
        if sane || value != max {
            sane &= numbers::positive(value, &at.member(field), mistakes);
        }
    }
    for (field, scale) in [("displacement_scale", displacement_scale), ("load_scale", load_scale)] {
        if let Some(scale) = scale {
            sane &= numbers::positive(scale, &at.member(field), mistakes);
        }
    }
    sane
}
