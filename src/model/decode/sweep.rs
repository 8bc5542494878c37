//! Reads the replacements of a sweep; the values are kept as they are written.

use crate::model::decode::reader::{Choices, Fields, Input};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::sweep::Combine;

const SWEEP: Fields = Fields { what: "what a sweep replaces", known: &["replace", "combine"], later: &[] };

const COMBINE: Choices<Combine> =
    Choices { what: "a way to combine values", known: &[("grid", Combine::Grid), ("list", Combine::List)], later: &[] };

/// The pointers, in the order of the text, and how their values are combined.
#[derive(Debug)]
pub struct Form {
    pub replace: Vec<String>,
    pub combine: Combine,
}

pub(super) fn sweep(input: &Input, mistakes: &mut Mistakes) -> Option<Form> {
    let object = input.object(&SWEEP, mistakes)?;
    let replace = object.required("replace", mistakes, |input, mistakes| {
        let places = input.map(mistakes, |values, mistakes| values.list(mistakes, |_, _| Some(())))?;
        if places.is_empty() {
            return input.refuse("at least one place", mistakes);
        }
        Some(places.into_keys().collect())
    });
    let combine = object
        .with_default("combine", Combine::default(), mistakes, |input, mistakes| input.choice(&COMBINE, mistakes));
    Some(Form { replace: replace?, combine: combine? })
}
