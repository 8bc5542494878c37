//! `@name` in place of a node: the nodes of a set, or of a surface.
//!
//! A model is expanded once, after it is read: checks, solver and results know nodes alone.

use crate::model::input::limits::{MAX_CONTACTS, MAX_NAMED_NODES, MAX_NODES};
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::{
    Analysis, Contact, Element, ElementReference, Model, NamedSet, Record, RecordedContacts, RecordedElements,
    RecordedSupports, Surface,
};
use indexmap::{IndexMap, IndexSet};
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// Puts nodes in place of names of sets and surfaces.
pub(super) fn expand(model: &mut Model, analysis: &mut Analysis, mistakes: &mut Mistakes) {
    if !uses_sets(model, analysis) {
        return;
    }
    let Model { surfaces, sets, elements, .. } = model;
    let groups = Groups::new(surfaces, sets, elements);
    let at = DocumentPlace::ROOT.member("model");
    let given = std::mem::take(&mut model.supports);
    model.supports = groups.map(given, &at.member("supports"), mistakes, |own, more| {
        more.into_iter().for_each(|component| {
            if !own.contains(&component) {
                own.push(component);
            }
        });
        true
    });
    let at_contacts = at.member("contacts");
    (model.contacts, model.posted_contacts) =
        groups.contacts(std::mem::take(&mut model.contacts), &at_contacts, mistakes);
    let at_stages = at.member("stages");
    for (index, stage) in model.stages.iter_mut().enumerate() {
        let at = at_stages.index(index);
        for (name, pattern) in [("forces", &mut stage.forces), ("displacements", &mut stage.displacements)] {
            *pattern = groups.map(std::mem::take(pattern), &at.member(name), mistakes, |own, other| *own == other);
        }
        let moments = std::mem::take(&mut stage.moments);
        stage.moments = groups.map(moments, &at.member("moments"), mistakes, |own, other| *own == other);
    }
    if let Some(record) = &mut analysis.record {
        recorded(&groups, record, mistakes);
    }
}

fn recorded(groups: &Groups<'_>, record: &mut Record, mistakes: &mut Mistakes) {
    let analysis_at = DocumentPlace::ROOT.member("analysis");
    let at = analysis_at.member("record");
    let listed = |names: &mut Vec<String>, at: &DocumentPlace, mistakes: &mut Mistakes| {
        let mut all: IndexSet<String> = IndexSet::new();
        for (index, name) in std::mem::take(names).into_iter().enumerate() {
            match groups.members(&name, &at.index(index), mistakes) {
                Members::Own => drop(all.insert(name)),
                Members::Nodes(nodes) => all.extend(nodes.iter().cloned()),
                Members::Mistaken => {}
            }
        }
        *names = all.into_iter().collect();
    };
    if let Some(nodes) = &mut record.nodes {
        listed(nodes, &at.member("nodes"), mistakes);
    }
    if let Some(RecordedSupports::Named(nodes)) = &mut record.supports {
        listed(nodes, &at.member("supports"), mistakes);
    }
    if let Some(RecordedElements::Listed(listed)) = &mut record.elements {
        *listed = groups.elements(std::mem::take(listed), &at.member("elements"), mistakes);
    }
    if let Some(RecordedContacts::Named(contacts)) = &mut record.contacts {
        let at = at.member("contacts");
        let mut all = Vec::new();
        for (index, contact) in std::mem::take(contacts).into_iter().enumerate() {
            match groups.members(&contact.node, &at.index(index), mistakes) {
                Members::Own => all.push(contact),
                Members::Nodes(nodes) => all.extend(nodes.iter().map(|node| {
                    let mut own = contact.clone();
                    own.node.clone_from(node);
                    own
                })),
                Members::Mistaken => {}
            }
        }
        *contacts = all;
    }
}

fn is_group(name: &str) -> bool {
    name.starts_with('@')
}

fn uses_sets(model: &Model, analysis: &Analysis) -> bool {
    let of_stages = model
        .stages
        .iter()
        .flat_map(|stage| stage.forces.keys().chain(stage.displacements.keys()).chain(stage.moments.keys()));
    let record = analysis.record.as_ref();
    let recorded = record.iter().flat_map(|record| {
        let supports = match &record.supports {
            Some(RecordedSupports::Named(nodes)) => nodes.as_slice(),
            _ => &[],
        };
        let contacts = record.named_contacts().unwrap_or_default().iter().map(|contact| &contact.node);
        let elements = match &record.elements {
            Some(RecordedElements::Listed(listed)) => listed.as_slice(),
            _ => &[],
        };
        let elements = elements.iter().filter_map(|element| match element {
            ElementReference::Name(name) => Some(name),
            ElementReference::Place(_) => None,
        });
        record.nodes.iter().flatten().chain(supports).chain(contacts).chain(elements)
    });
    let of_contacts = model.contacts.iter().map(|contact| &contact.node);
    if model.contacts.iter().any(Contact::names_whole_surface) {
        return true;
    }
    model.supports.keys().chain(of_contacts).chain(of_stages).chain(recorded).any(|name| is_group(name))
}

/// The sets and surfaces of a model, resolved when they are named first.
struct Groups<'a> {
    surfaces: &'a IndexMap<String, Surface>,
    sets: &'a IndexMap<String, NamedSet>,
    elements: &'a [Element],
    /// The places of named elements, where a set of elements is asked for.
    places: OnceCell<HashMap<&'a str, usize>>,
    /// The names of middles of edges, where a surface touches another body.
    middles: OnceCell<HashSet<&'a str>>,
    resolved: RefCell<HashMap<String, Rc<[String]>>>,
    /// How many more nodes names may stand for.
    left: Cell<usize>,
}

/// What a name stands for.
enum Members {
    /// Itself.
    Own,
    Nodes(Rc<[String]>),
    /// Nothing, which has been noted.
    Mistaken,
}

impl<'a> Groups<'a> {
    fn new(
        surfaces: &'a IndexMap<String, Surface>,
        sets: &'a IndexMap<String, NamedSet>,
        elements: &'a [Element],
    ) -> Self {
        let (places, middles, resolved) = (OnceCell::new(), OnceCell::new(), RefCell::default());
        Self { surfaces, sets, elements, places, middles, resolved, left: Cell::new(MAX_NAMED_NODES) }
    }

    /// The middles of the edges of quadratic solids.
    fn middles(&self) -> &HashSet<&'a str> {
        self.middles.get_or_init(|| {
            let of_element = |element: &'a Element| {
                let count = element.solid().map_or(0, |(kind, _)| kind.edges_with_middle().len());
                let nodes = element.nodes();
                nodes[nodes.len().saturating_sub(count)..].iter().map(String::as_str)
            };
            self.elements.iter().flat_map(of_element).collect()
        })
    }

    /// The nodes of a set or a surface, each once; `None` where there is neither.
    fn resolve(&self, group: &str) -> Option<Rc<[String]>> {
        if let Some(known) = self.resolved.borrow().get(group) {
            return Some(Rc::clone(known));
        }
        let nodes: IndexSet<&String> = match (self.sets.get(group), self.surfaces.get(group)) {
            (Some(NamedSet { nodes, .. }), _) if !nodes.is_empty() => nodes.iter().collect(),
            (Some(NamedSet { elements, .. }), _) => {
                let places = self.places.get_or_init(|| {
                    let named = self.elements.iter().enumerate();
                    named.filter_map(|(place, element)| Some((element.name()?, place))).collect()
                });
                let found = elements.iter().filter_map(|name| places.get(name.as_str()));
                found.flat_map(|place| self.elements[*place].nodes()).collect()
            }
            (None, Some(Surface { faces, .. })) => faces.iter().flatten().collect(),
            (None, None) => return None,
        };
        // Beyond the limit no name stands for anything more, and nothing more is kept.
        if nodes.len() > self.left.get() {
            self.left.set(0);
            return Some(Rc::from([]));
        }
        let nodes: Rc<[String]> = nodes.into_iter().cloned().collect();
        self.resolved.borrow_mut().insert(group.to_owned(), Rc::clone(&nodes));
        Some(nodes)
    }

    fn members(&self, name: &str, at: &DocumentPlace, mistakes: &mut Mistakes) -> Members {
        let Some(group) = name.strip_prefix('@') else { return Members::Own };
        let too_many = || format!("sets stand for more than {MAX_NAMED_NODES} nodes altogether, as many as are taken");
        if self.left.get() == 0 {
            mistakes.add(at, too_many);
            return Members::Mistaken;
        }
        let Some(nodes) = self.resolve(group) else {
            mistakes.add(at, || {
                let known = self.sets.keys().chain(self.surfaces.keys()).map(String::as_str);
                format!("there is no set or surface {}{}", quoted(group), suggestion(group, known))
            });
            return Members::Mistaken;
        };
        if self.left.get() == 0 {
            mistakes.add(at, too_many);
            return Members::Mistaken;
        }
        if nodes.is_empty() {
            mistakes.add(at, || {
                if self.surfaces.contains_key(group) {
                    return format!("the surface {} has no faces; one or more are expected", quoted(group));
                }
                format!("the set {} has no nodes: it lists none, and no element of the model by name", quoted(group))
            });
            return Members::Mistaken;
        }
        match self.left.get().checked_sub(nodes.len()) {
            Some(left) => {
                self.left.set(left);
                Members::Nodes(nodes)
            }
            None => {
                self.left.set(0);
                mistakes.add(at, too_many);
                Members::Mistaken
            }
        }
    }

    /// Elements by name or place, those of sets in place of `@name`, each once.
    fn elements(
        &self,
        given: Vec<ElementReference>,
        at: &DocumentPlace,
        mistakes: &mut Mistakes,
    ) -> Vec<ElementReference> {
        let mut all = Vec::with_capacity(given.len());
        let mut known: IndexSet<&String> = IndexSet::new();
        for (index, reference) in given.into_iter().enumerate() {
            let set = match &reference {
                ElementReference::Name(name) => name.strip_prefix('@').map(str::to_owned),
                ElementReference::Place(_) => None,
            };
            let Some(set) = set else {
                all.push(reference);
                continue;
            };
            let elements = self.sets.get(&set).map(|set| &set.elements).filter(|elements| !elements.is_empty());
            let Some(elements) = elements.filter(|elements| elements.len() <= self.left.get()) else {
                mistakes.add(&at.index(index), || {
                    let with_elements = self.sets.iter().filter(|(_, set)| !set.elements.is_empty());
                    let hint = suggestion(&set, with_elements.map(|(name, _)| name.as_str()));
                    format!("there is no set of elements {}{hint}", quoted(&set))
                });
                continue;
            };
            self.left.set(self.left.get() - elements.len());
            let fresh = elements.iter().filter(|name| known.insert(*name));
            all.extend(fresh.map(|name| ElementReference::Name(name.clone())));
        }
        all
    }

    /// A map by nodes; `merge` unites a second value of a node with the first, and returns whether it could.
    fn map<V: Clone>(
        &self,
        given: IndexMap<String, V>,
        at: &DocumentPlace,
        mistakes: &mut Mistakes,
        merge: impl Fn(&mut V, V) -> bool,
    ) -> IndexMap<String, V> {
        let mut all: IndexMap<String, V> = IndexMap::with_capacity(given.len());
        for (name, value) in given {
            let at = at.member(&name);
            let nodes: Rc<[String]> = match self.members(&name, &at, mistakes) {
                Members::Own => Rc::from([name.clone()]),
                Members::Nodes(nodes) => nodes,
                Members::Mistaken => Rc::from([]),
            };
            for node in nodes.iter() {
                match all.get_mut(node) {
                    None => drop(all.insert(node.clone(), value.clone())),
                    Some(own) => {
                        if !merge(own, value.clone()) {
                            mistakes.add(&at, || {
                                format!("the node {} is given another value, too; one is expected", quoted(node))
                            });
                        }
                    }
                }
            }
            if all.len() > MAX_NODES {
                // More than a model may have, which the checks of sizes say.
                break;
            }
        }
        all
    }

    /// The contacts of single nodes, and for each the index of the given one.
    fn contacts(&self, given: Vec<Contact>, at: &DocumentPlace, mistakes: &mut Mistakes) -> (Vec<Contact>, Vec<usize>) {
        let (mut all, mut origins) = (Vec::with_capacity(given.len()), Vec::with_capacity(given.len()));
        for (index, mut contact) in given.into_iter().enumerate() {
            let place = at.index(index);
            let member = if contact.names_whole_surface() { "surface" } else { "node" };
            if contact.names_whole_surface() {
                contact.node = format!("@{}", contact.surface.as_deref().unwrap_or_default());
                // Where bodies touch each other the faces at a node matter.
                if contact.against.is_none() {
                    contact.surface = None;
                }
            }
            match self.members(&contact.node, &place.member(member), mistakes) {
                Members::Own => all.push(contact),
                Members::Nodes(nodes) => {
                    if all.len() + nodes.len() > MAX_CONTACTS {
                        mistakes.add(&place, || {
                            format!("with this set there are more than {MAX_CONTACTS} contacts, as many as are taken")
                        });
                        return (all, origins);
                    }
                    // Where bodies touch each other, middles of edges follow their ends.
                    let follows = |node: &String| contact.against.is_some() && self.middles().contains(node.as_str());
                    let touching = nodes.iter().filter(|node| !follows(node));
                    all.extend(touching.map(|node| Contact { node: node.clone(), ..contact.clone() }));
                }
                Members::Mistaken => {}
            }
            origins.resize(all.len(), index);
        }
        (all, origins)
    }
}
