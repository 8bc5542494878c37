//! Members of sets by place.

use crate::model::mesh::abaqus::definitions::{NameScope, SetDefinition, SetItem};
use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::data::label_index::LabelIndex;
use crate::model::mesh::data::member_budget::MemberBudget;
use indexmap::IndexMap;
use std::collections::HashSet;

/// Nodes or elements, for sets of them.
#[derive(Debug)]
pub struct Population<'a> {
    /// `node` or `element`.
    pub what: &'static str,
    /// Labels in the order of the deck.
    pub labels: &'a [u64],
    /// Places by label.
    pub index: &'a LabelIndex,
    /// Labels of what is not read, and left out of sets.
    pub left_out: &'a HashSet<u64>,
}

/// Sets whose members are known by place.
#[derive(Debug)]
pub struct ResolvedSets<'a> {
    population: Population<'a>,
    sets: IndexMap<(NameScope, String), ResolvedSet>,
}

#[derive(Debug)]
struct ResolvedSet {
    name: String,
    is_internal: bool,
    members: Vec<u32>,
}

impl<'a> ResolvedSets<'a> {
    /// Resolves sets in the order of the deck.
    ///
    /// # Errors
    /// A member or a set is not there, or there are too many members.
    pub fn new(
        population: Population<'a>,
        definitions: &[SetDefinition],
        budget: &mut MemberBudget,
    ) -> Result<Self, MeshError> {
        let mut resolved = Self { population, sets: IndexMap::new() };
        for definition in definitions {
            let mut members = Vec::new();
            for item in &definition.items {
                resolved.extend(&mut members, item, definition.scope, definition.place, budget)?;
            }
            let key = (definition.scope, definition.name.to_ascii_uppercase());
            let set = resolved.sets.entry(key).or_insert_with(|| ResolvedSet {
                name: definition.name.clone(),
                is_internal: definition.is_internal,
                members: Vec::new(),
            });
            set.members.append(&mut members);
        }
        for set in resolved.sets.values_mut() {
            set.members.sort_unstable();
            set.members.dedup();
        }
        Ok(resolved)
    }

    /// Appends the members that an item names.
    ///
    /// # Errors
    /// As of [`ResolvedSets::new`].
    pub fn extend(
        &self,
        members: &mut Vec<u32>,
        item: &SetItem,
        scope: NameScope,
        place: MeshPlace,
        budget: &mut MemberBudget,
    ) -> Result<(), MeshError> {
        match item {
            SetItem::Labels(labels) => {
                budget.take(labels.len(), place)?;
                for label in labels {
                    match self.population.index.get(*label) {
                        Some(member) => members.push(member),
                        None if self.population.left_out.contains(label) => {}
                        None => {
                            let detail = format!("{} {label} is not in the deck", self.population.what);
                            return Err(MeshError::new(place, detail));
                        }
                    }
                }
            }
            SetItem::Range(first, last, step) => self.extend_range(members, [*first, *last, *step], place, budget)?,
            SetItem::Name(name) => {
                let set = self.get(scope, name).ok_or_else(|| {
                    let detail = format!("there is no set of {}s `{name}` before this line", self.population.what);
                    MeshError::new(place, detail)
                })?;
                budget.take(set.len(), place)?;
                members.extend_from_slice(set);
            }
            SetItem::Places(first, count) => {
                budget.take(*count as usize, place)?;
                members.extend(*first..first + count);
            }
        }
        Ok(())
    }

    fn extend_range(
        &self,
        members: &mut Vec<u32>,
        [first, last, step]: [u64; 3],
        place: MeshPlace,
        budget: &mut MemberBudget,
    ) -> Result<(), MeshError> {
        let Population { what, labels, index, left_out } = &self.population;
        let before = members.len();
        let steps = (last - first) / step;
        let mut some_left_out = false;
        budget.take(left_out.len(), place)?;
        // A range may be much wider than the mesh; then the labels of the mesh are fewer to look at.
        if steps < labels.len() as u64 {
            budget.take(usize::try_from(steps).unwrap_or(usize::MAX).saturating_add(1), place)?;
            for label in (0..=steps).map(|number| first + number * step) {
                members.extend(index.get(label));
                some_left_out |= left_out.contains(&label);
            }
        } else {
            budget.take(labels.len(), place)?;
            let is_in = |label: &u64| *label >= first && *label <= last && (*label - first).is_multiple_of(step);
            members.extend((0_u32..).zip(labels.iter()).filter(|(_, label)| is_in(label)).map(|(place, _)| place));
            some_left_out = left_out.iter().any(is_in);
        }
        if members.len() == before && !some_left_out {
            return Err(MeshError::new(place, format!("there is no {what} from {first} to {last} in steps of {step}")));
        }
        Ok(())
    }

    /// The members of a set by its name, upper and lower case alike; one of the part where the assembly has none.
    pub fn get(&self, scope: NameScope, name: &str) -> Option<&[u32]> {
        let name = name.to_ascii_uppercase();
        let own = self.sets.get(&(scope, name.clone()));
        own.or_else(|| self.sets.get(&(NameScope::Part, name))).map(|set| set.members.as_slice())
    }

    /// The sets by name as written, without those for a program's own use. Where the part has a set of the same name,
    /// that of the assembly is named `assembly.NAME`.
    pub fn named(self) -> IndexMap<String, Vec<u32>> {
        let mut named: IndexMap<String, Vec<u32>> = IndexMap::new();
        for ((scope, _), set) in self.sets {
            if set.is_internal || set.members.is_empty() {
                continue;
            }
            let is_taken = scope == NameScope::Assembly && named.contains_key(&set.name);
            let name = if is_taken { format!("assembly.{}", set.name) } else { set.name };
            named.insert(name, set.members);
        }
        named
    }
}
