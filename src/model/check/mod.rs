//! Checks of a decoded request: names, shapes, magnitudes, geometry, loads, sizes.
//!
//! All checks take time linear in the size of the model, except for pairs of contacts on one node. Mechanisms are only detected
//! here by the connections of nodes; those that depend on the numbers are detected when the tangent stiffness is known.

mod analysis;
mod beams;
mod contacts;
mod loads;
mod mechanism;
mod obstacles;
pub(crate) mod scope;
mod solids;
mod stages;
mod structure;
mod study;
#[cfg(test)]
mod tests;

use crate::model::check::scope::{Scope, printable};
pub use study::study;

use crate::model::input::limits::{MAX_CONTACTS, MAX_ELEMENTS, MAX_NODES, MAX_OBSTACLES, MAX_STAGES, MAX_UNKNOWNS};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::{InputErrors, JobRequest, Model};

/// Refuses a request that cannot be solved, with a list of all mistakes.
///
/// If the sizes exceed the [limits](crate::model::input::limits) or the dimension is neither 2 nor 3, nothing else of the model is
/// checked.
///
/// # Errors
/// The list is never empty; each entry names its place, what was found and what is expected.
pub fn check(request: &JobRequest) -> Result<(), InputErrors> {
    let mut mistakes = Mistakes::default();
    let at = DocumentPlace::ROOT.member("model");
    if sizes(&request.model, &at, &mut mistakes) && dimension(&request.model, &at, &mut mistakes) {
        let free = model(&request.model, &at, &mut mistakes);
        analysis::unknowns_of_method(free, request.analysis.method, &mut mistakes);
        if let Some(record) = &request.analysis.record {
            let at = DocumentPlace::ROOT.member("analysis");
            analysis::recorded(record, &request.model, &at.member("record"), &mut mistakes);
        }
    }
    analysis::jumps(request, &DocumentPlace::ROOT.member("analysis"), &mut mistakes);
    analysis::analysis(&request.analysis, &DocumentPlace::ROOT.member("analysis"), &mut mistakes);
    mistakes.into_result()
}

fn sizes(model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let before = mistakes.count();
    let sizes = [
        ("nodes", model.nodes.len(), MAX_NODES),
        ("supports", model.supports.len(), MAX_NODES),
        ("elements", model.elements.len(), MAX_ELEMENTS),
        ("obstacles", model.obstacles.len(), MAX_OBSTACLES),
        ("contacts", model.contacts.len(), MAX_CONTACTS),
        ("stages", model.stages.len(), MAX_STAGES),
    ];
    for (field, found, limit) in sizes {
        if found > limit {
            mistakes.add(&at.member(field), || format!("found {found} {field}; at most {limit} are taken"));
        }
    }
    obstacles::sizes(model, at, mistakes);
    mistakes.count() == before
}

fn dimension(model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) -> bool {
    let known = matches!(model.dimension, 2 | 3);
    if !known {
        mistakes.add(&at.member("dimension"), || format!("found {}; 2 or 3 is expected", model.dimension));
    }
    known
}

fn model(model: &Model, at: &DocumentPlace, mistakes: &mut Mistakes) -> usize {
    if let Some(name) = &model.name {
        printable(name, &at.member("name"), mistakes);
    }
    if let Some(units) = &model.units {
        let at = at.member("units");
        for (member, label) in [("length", &units.length), ("force", &units.force)] {
            if let Some(label) = label {
                if label.trim().is_empty() {
                    mistakes
                        .add(&at.member(member), || "the label is empty; leave it out, or name the unit, such as `mm`");
                }
                printable(label, &at.member(member), mistakes);
            }
        }
    }
    structure::unexpanded(model, at, mistakes);
    let scope = Scope::new(model, *at);
    structure::nodes(&scope, mistakes);
    structure::supports(&scope, mistakes);
    solids::materials(&scope, mistakes);
    structure::elements(&scope, mistakes);
    solids::one_meaning_of_forces(&scope, mistakes);
    solids::surfaces(&scope, mistakes);
    let obstacles = obstacles::obstacles(&scope, mistakes);
    contacts::contacts(&scope, &obstacles, mistakes);
    mechanism::mechanism(&scope, mistakes);
    stages::stages(&scope, mistakes);
    unknowns(&scope, mistakes)
}

/// Free displacement components.
fn unknowns(scope: &Scope, mistakes: &mut Mistakes) -> usize {
    let dimension = scope.model.dimension;
    let free: usize =
        scope.supported.iter().map(|held| held.iter().take(dimension).filter(|&&held| !held).count()).sum();
    if free > MAX_UNKNOWNS {
        mistakes.add(&scope.at.member("nodes"), || {
            format!(
                "the nodes have {free} free displacement components; at most {MAX_UNKNOWNS} are taken in this version"
            )
        });
    }
    free
}
