//! The elements and supports whose forces an increment has, from `analysis.record` and its defaults.

use crate::model::request::record::{ElementReference, ForceRange, RecordedElements, RecordedSupports};
use crate::model::request::{JobRequest, Model};
use std::collections::HashSet;

/// Up to this number of elements, and of supported nodes, an increment has the forces of each. With more, it has none
/// unless requested.
pub const MAX_FORCES_UNASKED: usize = 200;

/// Places of the elements whose forces an increment has, ascending.
pub fn recorded_elements(request: &JobRequest) -> Vec<usize> {
    let (elements, record) = (&request.model.elements, request.analysis.record.as_ref());
    match record.and_then(|record| record.elements.as_ref()) {
        None if elements.len() <= MAX_FORCES_UNASKED => (0..elements.len()).collect(),
        None | Some(RecordedElements::Range(ForceRange::None)) => Vec::new(),
        Some(RecordedElements::Range(ForceRange::All)) => (0..elements.len()).collect(),
        Some(RecordedElements::Listed(listed)) => {
            let listed: HashSet<&ElementReference> = listed.iter().collect();
            let is_listed = |place: &usize| {
                let by_name = || elements[*place].name().map(|name| ElementReference::Name(name.to_owned()));
                listed.contains(&ElementReference::Place(*place as u64))
                    || by_name().is_some_and(|name| listed.contains(&name))
            };
            (0..elements.len()).filter(is_listed).collect()
        }
    }
}

/// The supported nodes whose reactions an increment has, in the order of the model's `supports`.
pub fn recorded_supports(request: &JobRequest) -> Vec<&str> {
    let (supports, record) = (&request.model.supports, request.analysis.record.as_ref());
    let all = supports.keys().map(String::as_str);
    match record.and_then(|record| record.supports.as_ref()) {
        None if supports.len() <= MAX_FORCES_UNASKED => all.collect(),
        None | Some(RecordedSupports::Range(ForceRange::None)) => Vec::new(),
        Some(RecordedSupports::Range(ForceRange::All)) => all.collect(),
        Some(RecordedSupports::Named(named)) => {
            let named: HashSet<&str> = named.iter().map(String::as_str).collect();
            all.filter(|name| named.contains(name)).collect()
        }
    }
}

/// What an element is called: its name, or its place.
pub fn element_label(model: &Model, place: usize) -> String {
    let name = model.elements.get(place).and_then(|element| element.name());
    name.map_or_else(|| place.to_string(), str::to_owned)
}
