//! Selects the parts of a judged increment that are recorded.

use crate::model::JobRequest;
use crate::model::request::recorded_forces::recorded_supports;
use crate::result::increment::{ContactState, Increment, PointKind};
use std::collections::HashSet;

/// The selection in the `record` of a request.
#[derive(Debug, Clone)]
pub(super) struct Recorder {
    /// One for each node; `None`: all nodes are kept.
    nodes: Option<Vec<bool>>,
    /// Node and obstacle of the selected contacts, in the order of the model; `None`: every row is kept.
    contacts: Option<Vec<(String, String)>>,
    /// One for each support of the model; `None`: the reactions of all are kept.
    supports: Option<Vec<bool>>,
    every: u64,
    directions: bool,
}

impl Recorder {
    /// The selection of a checked request.
    pub fn new(request: &JobRequest) -> Self {
        let record = request.analysis.record.clone().unwrap_or_default();
        let model = &request.model;
        let nodes = record.nodes.as_ref().map(|asked| {
            let mut kept = vec![false; model.nodes.len()];
            for node in asked.iter().filter_map(|name| model.nodes.get_index_of(name)) {
                kept[node] = true;
            }
            kept
        });
        let contacts = record.named_contacts().map(|named| {
            let named: HashSet<(&str, &str)> =
                named.iter().map(|one| (one.node.as_str(), one.obstacle.as_str())).collect();
            let names = model.contacts.iter().map(|contact| (contact.node.clone(), contact.counterpart().to_owned()));
            names.filter(|(node, obstacle)| named.contains(&(node.as_str(), obstacle.as_str()))).collect()
        });
        let recorded: HashSet<&str> = recorded_supports(request).into_iter().collect();
        let supports = (recorded.len() < model.supports.len())
            .then(|| model.supports.keys().map(|name| recorded.contains(name.as_str())).collect());
        Self { nodes, contacts, supports, every: record.every, directions: record.directions }
    }

    pub fn directions(&self) -> bool {
        self.directions
    }

    /// Whether an increment is recorded.
    pub fn keeps(&self, increment: &Increment) -> bool {
        increment.index == 0
            || increment.point.kind != PointKind::Regular
            || increment.point.event.is_some()
            || increment.index.is_multiple_of(self.every)
    }

    /// An increment without the parts that are not kept.
    pub fn cut(&self, mut increment: Increment) -> Increment {
        if let Some(kept) = &self.nodes {
            increment.displacements.keep(|node| kept.get(node).is_some_and(|kept| *kept));
        }
        if let Some(kept) = &self.supports {
            increment.supports.keep(|support| kept.get(support).is_some_and(|kept| *kept));
        }
        if !self.directions {
            increment.directions = None;
        }
        if let Some(named) = &self.contacts {
            // Rows and names are in the model's order, and what is named has a row.
            let mut named = named.iter().peekable();
            let is_next = |row: &ContactState| {
                named.next_if(|(node, obstacle)| **node == *row.node && **obstacle == *row.obstacle).is_some()
            };
            let kept: Vec<bool> = increment.contacts.iter().map(is_next).collect();
            retain(&mut increment.contacts, &kept);
            for direction in increment.directions.iter_mut().flatten() {
                retain(&mut direction.contacts, &kept);
            }
        }
        increment
    }
}

/// Keeps the marked items.
fn retain<Item>(items: &mut Vec<Item>, kept: &[bool]) {
    let mut kept = kept.iter();
    items.retain(|_| kept.next().is_some_and(|kept| *kept));
}
