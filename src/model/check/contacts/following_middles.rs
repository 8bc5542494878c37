//! Checks the middles of edges that follow the ends of these, as quadratic faces do where bodies touch each other: nothing
//! but their solids may ask for them.

use crate::model::check::scope::Scope;
use crate::model::input::mistakes::Mistakes;
use crate::model::input::names::quoted;
use crate::model::request::{Model, Stage};
use crate::model::solids::middle_nodes::{chord_middle, following_middles, is_held};
use std::collections::HashMap;

/// Difference of prescribed displacements or coordinates, relative to the largest, up to which they are equal.
const ALIKE: f64 = 1e-12;

/// A middle with the ends of its edge, by names.
struct FollowingMiddle<'a> {
    middle: &'a str,
    ends: [&'a str; 2],
}

impl FollowingMiddle<'_> {
    fn follows(&self) -> String {
        let [a, b] = self.ends.map(quoted);
        format!(
            "{} is the middle of an edge of bodies that touch each other, and follows the ends {a} and {b}",
            quoted(self.middle)
        )
    }

    /// Whether the middle is not where the chord between its ends has its own.
    fn is_off_its_chord(&self, model: &Model) -> bool {
        let place = |node: &str| model.nodes.get(node).map_or(&[][..], Vec::as_slice);
        let [a, b] = self.ends.map(place);
        let largest = a.iter().chain(b).fold(0.0_f64, |most, value| most.max(value.abs()));
        place(self.middle)
            .iter()
            .zip(a.iter().zip(b))
            .any(|(own, (a, b))| (own - chord_middle(*a, *b)).abs() > ALIKE * largest)
    }

    /// Whether a stage prescribes other displacements of the middle than the mean of its ends.
    fn is_driven_off(&self, stage: &Stage) -> bool {
        let given = |node: &str, axis: usize| {
            stage.displacements.get(node).and_then(|values| values.get(axis)).copied().unwrap_or(0.0)
        };
        stage.displacements.get(self.middle).is_some_and(|values| {
            values.iter().enumerate().any(|(axis, value)| {
                let [a, b] = self.ends.map(|end| given(end, axis));
                (value - 0.5 * (a + b)).abs() > ALIKE * value.abs().max(a.abs()).max(b.abs())
            })
        })
    }
}

pub(super) fn asked_for_by_nothing(scope: &Scope, mistakes: &mut Mistakes) {
    let model = scope.model;
    let name = |node: usize| model.nodes.get_index(node).map_or("", |(name, _)| name.as_str());
    let following: HashMap<&str, FollowingMiddle> = following_middles(model)
        .into_iter()
        .map(|(middle, ends)| (name(middle), FollowingMiddle { middle: name(middle), ends: ends.map(name) }))
        .collect();
    if following.is_empty() {
        return;
    }
    let at_contacts = scope.at.member("contacts");
    for (index, contact) in model.contacts.iter().enumerate().filter(|(_, contact)| contact.against.is_none()) {
        let Some(one) = following.get(contact.node.as_str()) else { continue };
        let at = at_contacts.index(model.posted_contact(index));
        mistakes.add(&at.member("node"), || {
            format!("{}; leave its contact with {} out", one.follows(), quoted(&contact.obstacle))
        });
    }
    let at_elements = scope.at.member("elements");
    for (index, element) in model.elements.iter().enumerate() {
        let middles = element.solid().map_or(0, |(kind, _)| kind.edges_with_middle().len());
        let joined = &element.nodes()[..element.nodes().len().saturating_sub(middles)];
        let Some(one) = joined.iter().find_map(|node| following.get(node.as_str())) else { continue };
        let at = at_elements.index(index);
        mistakes.add(&at.member("nodes"), || format!("{}; join the element to one of these", one.follows()));
    }
    let mut in_order: Vec<&FollowingMiddle> = following.values().collect();
    in_order.sort_unstable_by_key(|one| one.middle);
    let (at_supports, at_stages) = (scope.at.member("supports"), scope.at.member("stages"));
    for one in in_order {
        if one.is_off_its_chord(model) {
            mistakes.add(&scope.at.member("nodes").member(one.middle), || {
                format!("{}; on the chord between them is expected, where `expanded` puts it", one.follows())
            });
        }
        if !one.ends.iter().all(|end| is_held(model, end, one.middle)) {
            mistakes.add(&at_supports.member(one.middle), || {
                format!("{}; hold these in the same components, or leave the support out", one.follows())
            });
        }
        for (index, stage) in model.stages.iter().enumerate() {
            let at = at_stages.index(index);
            if one.is_driven_off(stage) {
                let at = at.member("displacements");
                mistakes.add(&at.member(one.middle), || {
                    format!("{}; the mean of their displacements is expected", one.follows())
                });
            }
            let bound = stage.until.as_ref().and_then(|until| until.displacement.as_ref());
            if bound.is_some_and(|bound| bound.node == one.middle) {
                let (until, node) = (at.member("until"), "node");
                let bound = until.member("displacement");
                mistakes.add(&bound.member(node), || format!("{}; name one of these", one.follows()));
            }
        }
    }
}
