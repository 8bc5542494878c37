//! Finds unconnected parts of the model, by the connections of nodes alone.
//!
//! A part that is connected to a support, to the ground by a spring, or to an obstacle by a contact may still be a
//! mechanism, which depends on the numbers and is not checked here.

use crate::model::check::scope::Scope;
use crate::model::input::mistakes::Mistakes;
use crate::model::input::names::quoted;
use crate::model::request::Element;
use std::collections::HashSet;

pub(super) fn mechanism(scope: &Scope, mistakes: &mut Mistakes) {
    // Because of a misspelt name, which has been reported, a part could look unconnected.
    if names_nodes_that_exist(scope) {
        note_loose_parts(scope, mistakes);
    }
}

fn names_nodes_that_exist(scope: &Scope) -> bool {
    let exists = |name: &String| scope.model.nodes.contains_key(name);
    let in_elements = scope.model.elements.iter().all(|element| element.nodes().iter().all(exists));
    in_elements
        && scope.model.supports.keys().all(exists)
        && scope.model.contacts.iter().all(|contact| exists(&contact.node))
}

fn note_loose_parts(scope: &Scope, mistakes: &mut Mistakes) {
    let mut parts = Parts::new(scope.model.nodes.len());
    let mut held = scope.supported.iter().map(|held| held.contains(&true)).collect::<Vec<_>>();
    let mut has_element = vec![false; held.len()];
    let number = |name: &String| scope.model.nodes.get_index_of(name);
    for element in &scope.model.elements {
        let numbers: Vec<usize> = element.nodes().iter().filter_map(number).collect();
        for &node in &numbers {
            has_element[node] = true;
            parts.join(numbers[0], node);
        }
        if let (Element::Spring { .. }, [node]) = (element, numbers.as_slice()) {
            held[*node] = true;
        }
    }
    for node in scope.model.contacts.iter().filter_map(|contact| number(&contact.node)) {
        held[node] = true;
    }
    let against: HashSet<&str> = scope.model.contacts.iter().filter_map(|contact| contact.against.as_deref()).collect();
    for (_, surface) in scope.model.surfaces.iter().filter(|(name, _)| against.contains(name.as_str())) {
        surface.faces.iter().flatten().filter_map(number).for_each(|node| held[node] = true);
    }
    note(scope, &has_element, &parts.loose(&held), mistakes);
}

fn note(scope: &Scope, has_element: &[bool], loose: &[bool], mistakes: &mut Mistakes) {
    let at = scope.at.member("nodes");
    for (node, name) in scope.model.nodes.keys().enumerate() {
        let at = at.member(name);
        if !has_element[node] && scope.has_free_component(node) {
            mistakes.add(&at, || {
                format!(
                    "no element holds the node {}: a mechanism; add one, support the node or leave it out",
                    quoted(name)
                )
            });
        } else if has_element[node] && loose[node] {
            mistakes.add(&at, || {
                let part = format!("the part with the node {} hangs on nothing: a mechanism", quoted(name));
                format!("{part}; a support, a spring to the ground or a contact is expected")
            });
        }
    }
}

/// Nodes joined by elements (disjoint sets).
struct Parts {
    parent: Vec<usize>,
}

impl Parts {
    fn new(nodes: usize) -> Self {
        Self { parent: (0..nodes).collect() }
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.parent[node] != node {
            // Path halving keeps later look-ups short.
            self.parent[node] = self.parent[self.parent[node]];
            node = self.parent[node];
        }
        node
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.root(one), self.root(other));
        // The least number represents the part, so that the first node in the document is named.
        self.parent[one.max(other)] = one.min(other);
    }

    /// True for the first node of each part in which no node is held.
    fn loose(mut self, held: &[bool]) -> Vec<bool> {
        let mut loose: Vec<bool> = (0..held.len()).map(|node| self.parent[node] == node).collect();
        for (node, _) in held.iter().enumerate().filter(|(_, held)| **held) {
            let root = self.root(node);
            loose[root] = false;
        }
        loose
    }
}
