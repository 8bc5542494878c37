//! Reads the settings of a study.

use crate::model::decode::analysis::METHOD;
use crate::model::decode::reader::{Choices, Fields, Input, count, numbers};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::study::{ReferenceChoice, Study};

const STUDY: Fields = Fields {
    what: "what a study varies",
    known: &["methods", "arc_lengths", "tolerances", "penalties", "repeats", "reference", "refinement"],
    later: &[],
};

const REFERENCE: Choices<ReferenceChoice> = Choices {
    what: "a reference",
    known: &[
        ("auto", ReferenceChoice::Auto),
        ("exact", ReferenceChoice::Exact),
        ("self_converged", ReferenceChoice::SelfConverged),
    ],
    later: &[],
};

pub(super) fn study(input: &Input, mistakes: &mut Mistakes) -> Option<Study> {
    let object = input.object(&STUDY, mistakes)?;
    let default = Study::default();
    let methods = object.optional("methods", mistakes, |input, mistakes| {
        input.list(mistakes, |input, mistakes| input.choice(&METHOD, mistakes))
    });
    let arc_lengths = object.optional("arc_lengths", mistakes, numbers);
    let tolerances = object.optional("tolerances", mistakes, numbers);
    let penalties = object.optional("penalties", mistakes, numbers);
    let repeats = object.with_default("repeats", default.repeats, mistakes, count);
    let reference = object
        .with_default("reference", default.reference, mistakes, |input, mistakes| input.choice(&REFERENCE, mistakes));
    let refinement = object.with_default("refinement", default.refinement, mistakes, count);
    Some(Study {
        methods: methods?,
        arc_lengths: arc_lengths?,
        tolerances: tolerances?,
        penalties: penalties?,
        repeats: repeats?,
        reference: reference?,
        refinement: refinement?,
    })
}
