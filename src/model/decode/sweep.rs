//! Reads the replacements of a sweep; the values are kept as they are written.

use crate::model::decode::reader::{Choices, Fields, Input, count, number, text};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::response::{NamedPlace, ReachedValue, Response, ResponsePlace, load_factor};
use crate::model::request::sweep::Combine;
use indexmap::IndexMap;

const SWEEP: Fields =
    Fields { what: "what a sweep replaces", known: &["replace", "combine", "responses", "refine"], later: &[] };

const COMBINE: Choices<Combine> =
    Choices { what: "a way to combine values", known: &[("grid", Combine::Grid), ("list", Combine::List)], later: &[] };

const RESPONSE: Fields = Fields { what: "a response", known: &["value", "at", "stage"], later: &[] };

const REACHED: Fields = Fields { what: "a place where a value is reached", known: &["value", "reaches"], later: &[] };

const PLACE: Choices<NamedPlace> = Choices {
    what: "a place of a path",
    known: &[
        ("first_limit", NamedPlace::FirstLimit),
        ("largest_load", NamedPlace::LargestLoad),
        ("first_slip", NamedPlace::FirstSlip),
        ("first_contact_change", NamedPlace::FirstContactChange),
        ("end", NamedPlace::End),
    ],
    later: &[],
};

/// The pointers, in the order of the text, how their values are combined, and what is told of each path.
#[derive(Debug)]
pub struct Form {
    pub replace: Vec<String>,
    pub combine: Combine,
    pub responses: IndexMap<String, Response>,
    pub refine: u64,
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
    let responses =
        object.with_default("responses", IndexMap::new(), mistakes, |input, mistakes| input.map(mistakes, response));
    let refine = object.with_default("refine", 0, mistakes, count);
    Some(Form { replace: replace?, combine: combine?, responses: responses?, refine: refine? })
}

fn response(input: &Input, mistakes: &mut Mistakes) -> Option<Response> {
    let object = input.object(&RESPONSE, mistakes)?;
    let value = object.with_default("value", load_factor(), mistakes, text);
    let at = object.required("at", mistakes, place);
    let stage = object.optional("stage", mistakes, text);
    Some(Response { value: value?, at: at?, stage: stage? })
}

fn place(input: &Input, mistakes: &mut Mistakes) -> Option<ResponsePlace> {
    if !input.is_object() {
        return input.choice(&PLACE, mistakes).map(ResponsePlace::Named);
    }
    let object = input.object(&REACHED, mistakes)?;
    let value = object.required("value", mistakes, text);
    let reaches = object.required("reaches", mistakes, number);
    Some(ResponsePlace::Reached(ReachedValue { value: value?, reaches: reaches? }))
}
