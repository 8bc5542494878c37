//! How the path is to be traced.

use super::numbers;
use crate::model::limits::{MAX_EXPLORE_DEPTH, MAX_EXPLORE_JOBS, MAX_INCREMENTS, MAX_MODES};
use crate::model::mistakes::{Mistakes, Place};
use crate::model::request::{Analysis, ArcLength};

pub(super) fn analysis(analysis: &Analysis, at: &Place, mistakes: &mut Mistakes) {
    arc_length(&analysis.arc_length, &at.member("arc_length"), mistakes);
    numbers::count(analysis.max_increments, MAX_INCREMENTS, &at.member("max_increments"), mistakes);
    numbers::count(analysis.max_modes, MAX_MODES, &at.member("max_modes"), mistakes);
    if let Some(explore) = analysis.explore {
        let at = at.member("explore");
        numbers::count(explore.depth, MAX_EXPLORE_DEPTH, &at.member("depth"), mistakes);
        numbers::count(explore.max_jobs, MAX_EXPLORE_JOBS, &at.member("max_jobs"), mistakes);
    }
}

fn arc_length(arc_length: &ArcLength, at: &Place, mistakes: &mut Mistakes) {
    let &ArcLength { initial, min, max, displacement_scale, load_scale } = arc_length;
    let mut sane = true;
    for (field, value) in [("initial", initial), ("min", min), ("max", max)] {
        sane &= numbers::positive(value, &at.member(field), mistakes);
    }
    for (field, scale) in [("displacement_scale", displacement_scale), ("load_scale", load_scale)] {
        if let Some(scale) = scale {
            numbers::positive(scale, &at.member(field), mistakes);
        }
    }
    if !sane {
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
