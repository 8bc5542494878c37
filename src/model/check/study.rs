//! Checks the settings of a study and the amount of its work.

use crate::model::InputErrors;
use crate::model::check::scope::numbers;
use crate::model::input::limits::{
    MAX_INCREMENTS, MAX_STUDY_REFINEMENT, MAX_STUDY_REPEATS, MAX_STUDY_RUNGS, MAX_STUDY_VALUES,
};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::listed;
use crate::model::request::Method;
use crate::model::request::study::{Parameter, Study, StudyRequest};

/// Refuses mistakes in `study`, by itself or in combination with `analysis`. Each job of the study is checked by
/// [`check`](crate::model::check::check).
///
/// # Errors
/// As for [`check`](crate::model::check::check).
pub fn study(request: &StudyRequest) -> Result<(), InputErrors> {
    let mut mistakes = Mistakes::default();
    let at = DocumentPlace::ROOT.member("study");
    let study = &request.study;
    let sane = ladder(request, &at, &mut mistakes);
    methods(study, &at, &mut mistakes);
    if study.repeats > MAX_STUDY_REPEATS {
        mistakes
            .add(&at.member("repeats"), || format!("found {}; at most {MAX_STUDY_REPEATS} is taken", study.repeats));
    }
    if !(2..=MAX_STUDY_REFINEMENT).contains(&study.refinement) {
        let found = study.refinement;
        mistakes.add(&at.member("refinement"), || format!("found {found}; 2 to {MAX_STUDY_REFINEMENT} is expected"));
    }
    let analysis = DocumentPlace::ROOT.member("analysis");
    // The values that those of the study replace have to be valid, too.
    crate::model::check::analysis::arc_lengths(
        &request.analysis.arc_length,
        &analysis.member("arc_length"),
        &mut mistakes,
    );
    if let Some(regularised) = &request.analysis.regularised {
        crate::model::check::analysis::regularised(regularised, &analysis.member("regularised"), &mut mistakes);
    }
    if request.analysis.explore.is_some() {
        mistakes.add(&analysis.member("explore"), || "a study follows no other directions; leave it out");
    }
    if request.analysis.record.is_some() {
        mistakes
            .add(&analysis.member("record"), || "a study compares whole paths and keeps no increments; leave it out");
    }
    if request.analysis.regularised.is_some() && !study.methods().contains(&Method::Regularised) {
        mistakes.add(
            &analysis.member("regularised"),
            || "parameters of the method `regularised`, which is not among the study's; leave them out",
        );
    }
    if sane {
        sizes(request, &analysis, &mut mistakes);
    }
    mistakes.into_result()
}

fn ladder(request: &StudyRequest, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let before = mistakes.count();
    let study = &request.study;
    let given = [
        (Parameter::ArcLength, &study.arc_lengths),
        (Parameter::Tolerance, &study.tolerances),
        (Parameter::Penalty, &study.penalties),
    ];
    let mut first: Option<Parameter> = None;
    for (parameter, values) in given {
        let Some(values) = values else { continue };
        let at = at.member(parameter.field());
        match first {
            None => first = Some(parameter),
            Some(first) => mistakes.add(&at, || {
                format!("a study varies one thing, and `{}` is given too; leave one of them out", first.field())
            }),
        }
        rungs(request, parameter, values, &at, mistakes);
    }
    mistakes.count() == before
}

fn rungs(request: &StudyRequest, parameter: Parameter, values: &[f64], at: &DocumentPlace, mistakes: &mut Mistakes) {
    if values.is_empty() || values.len() > MAX_STUDY_RUNGS {
        mistakes.add(at, || format!("found {} values; 1 to {MAX_STUDY_RUNGS} are taken", values.len()));
        return;
    }
    let least = request.analysis.arc_length.min;
    for (index, &value) in values.iter().enumerate() {
        let at = at.index(index);
        if !numbers::positive(value, &at, mistakes) {
            continue;
        }
        let before = index.checked_sub(1).map(|before| values[before]);
        let (in_order, order) = match parameter {
            Parameter::ArcLength | Parameter::Tolerance => (before.is_none_or(|before| value < before), "less"),
            Parameter::Penalty => (before.is_none_or(|before| value > before), "more"),
        };
        if let (false, Some(before)) = (in_order, before) {
            mistakes.add(&at, || {
                format!("found {value:?} after {before:?}; {order} is expected: rungs go from coarse to fine")
            });
        }
        if parameter == Parameter::ArcLength && value < least {
            mistakes
                .add(&at, || format!("found {value:?}; at least `analysis.arc_length.min`, {least:?}, is expected"));
        }
        if parameter == Parameter::Tolerance && value >= 1.0 {
            mistakes.add(&at, || format!("found {value:?}; a number between 0 and 1 is expected"));
        }
    }
}

fn methods(study: &Study, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let Some(methods) = &study.methods else { return };
    let at = at.member("methods");
    if methods.is_empty() {
        mistakes.add(&at, || "no method is given; one or more is expected");
    }
    let (parameter, _) = study.ladder();
    for (index, method) in methods.iter().enumerate() {
        if methods[..index].contains(method) {
            mistakes.add(&at.index(index), || format!("`{}` stands twice; once would do", method.name()));
        }
        if !parameter.methods().contains(method) {
            let fitting = listed(parameter.methods().iter().map(|method| method.name()));
            mistakes.add(&at.index(index), || {
                format!("`{}` has no {} to vary; {fitting} would do", method.name(), parameter.name())
            });
        }
    }
}

/// Bounds the number of points of the longest path of a study, the reference.
fn sizes(request: &StudyRequest, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let increments = request.finer_job(request.study.refinement as f64).analysis.max_increments;
    let at = at.member("max_increments");
    if increments > MAX_INCREMENTS {
        mistakes.add(&at, || {
            format!(
                "the finest path of the study may have {increments} increments; at most {MAX_INCREMENTS} are taken: \
                 lower it, or leave out the finest rung"
            )
        });
        return;
    }
    let components = request.model.nodes.len() as f64 * request.model.dimension as f64;
    let values = increments as f64 * components;
    if values > MAX_STUDY_VALUES {
        mistakes.add(&at, || {
            format!(
                "the finest path of the study may have {increments} increments of {components} displacement components; \
                 at most {MAX_STUDY_VALUES:e} numbers are held: lower it, or leave out the finest rung"
            )
        });
    }
}
