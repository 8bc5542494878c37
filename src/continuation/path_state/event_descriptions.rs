//! Descriptions of events.

use crate::continuation::path_state::row_conversion::status;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::Mode;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::result::increment::Status;
use std::sync::Arc;

/// Description of the start of a stage; `met`: one of its bounds is already met.
pub(crate) fn describe_start(scene: &Scene, stage: usize, met: bool) -> String {
    let ends = if met { " and ends at once: its bound is met already" } else { "" };
    let stages = &scene.stages[..=stage];
    let name = &stages[stage].name;
    if stages[..stage].last().is_some_and(|before| before.turns) {
        return format!("the load of stage \"{name}\" turns{ends}");
    }
    format!("stage \"{name}\" begins{ends}")
}

/// Description of the contacts that change, with their old and new modes; where the path ends, of the contacts at the
/// limit of their mode.
///
/// `names` are those of the contacts' nodes and obstacles.
pub(crate) fn describe_change<'a>(
    names: impl Iterator<Item = &'a (Arc<str>, Arc<str>)>,
    old: &[Mode],
    new: Option<&[Mode]>,
    standings: &[Standing],
) -> String {
    let mut parts = Vec::new();
    for ((index, before), (node, obstacle)) in old.iter().enumerate().zip(names) {
        let after = new.map(|new| new[index]);
        let word = |mode: Mode| match status(mode) {
            Status::Free => "free",
            Status::Stick => "stick",
            Status::Slip => "slip",
        };
        match after {
            Some(after) if after.continues(*before) => {}
            Some(after) if word(after) == word(*before) => {
                parts.push(format!("{node} on {obstacle}: slip turns round"));
            }
            Some(after) => parts.push(format!("{node} on {obstacle}: {} to {}", word(*before), word(after))),
            None => match standings[index] {
                Standing::Settled(_) => {}
                Standing::OnCone { .. } => parts.push(format!("{node} on {obstacle}: on the friction cone")),
                Standing::Cornered { .. } => parts.push(format!("{node} on {obstacle}: about to leave the corner")),
                Standing::Touching => parts.push(format!("{node} on {obstacle}: reaction zero")),
            },
        }
    }
    if parts.is_empty() { "contact touches the limit of its mode and keeps it".to_owned() } else { parts.join("; ") }
}

/// Contacts that are named where they slip from the start; the others are counted.
const MOST_SLIPPING: usize = 12;

/// Description of the contacts that slip against friction from the start; `None` where there are none.
pub(crate) fn describe_slipping<'a>(
    names: impl Iterator<Item = &'a (Arc<str>, Arc<str>)>,
    loading: Loading<'_>,
    modes: &[Mode],
) -> Option<String> {
    let slips = |contact: usize| status(modes[contact]) == Status::Slip && loading.contacts[contact].tangents() > 0;
    let named = names.enumerate().filter(|(contact, _)| slips(*contact));
    let mut parts: Vec<String> = named.map(|(_, (node, obstacle))| format!("{node} on {obstacle}: slip")).collect();
    let more = parts.len().saturating_sub(MOST_SLIPPING);
    parts.truncate(MOST_SLIPPING);
    if more > 0 {
        parts.push(format!("and {more} more"));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Nodes that a description of a motion names.
const NAMED: usize = 3;
/// Motion of a node, relative to the largest, above which the node counts as moved.
const MOVED: f64 = 1e-6;

/// Description of the nodes that move most along a rate of all degrees of freedom, with their axes.
pub(crate) fn describe_motion(scene: &Scene, rate: &[f64]) -> String {
    let rates = scene.nodal_motion(rate, 1.0);
    let size = |components: &[f64]| components.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let largest = rates.values().map(size).fold(0.0, f64::max);
    let mut moved: Vec<_> = rates.iter().filter(|(_, components)| size(components) > MOVED * largest).collect();
    // Nodes that move alike stay in their order.
    let rank = |components: &[f64]| (size(components) / (MOVED * largest)).round();
    moved.sort_by(|(_, one), (_, other)| rank(other).total_cmp(&rank(one)));
    let along = |components: &[f64]| {
        let names: &[&str] =
            if scene.structure.dimension == 2 { &["x", "y", "rz"] } else { &["x", "y", "z", "rx", "ry", "rz"] };
        let axes = names.iter().copied().zip(components);
        let axes = axes.filter(|(_, value)| value.abs() > 0.1 * size(components)).map(|(axis, _)| axis);
        axes.collect::<Vec<_>>().join(" and ")
    };
    let named = moved.iter().take(NAMED).map(|(name, components)| format!("`{name}` along {}", along(components)));
    let mut parts: Vec<String> = named.collect();
    match moved.len().saturating_sub(NAMED) {
        0 => {}
        1 => parts.push("one more node".to_owned()),
        others => parts.push(format!("{others} more nodes")),
    }
    parts.join(", ")
}
