//! Where the tangent of a structure with many unknowns has its entries.

use crate::algebra::sparse::Pattern;
use crate::mechanics::structure::Structure;
use crate::resources::budget::{self, Taken};
use std::sync::Arc;

/// Found once; the tangent is then added up in place.
#[derive(Debug)]
pub struct Layout {
    pub pattern: Arc<Pattern>,
    /// For each call that `Structure::each_stiffness` makes, in its order, the place of the entry; `None` where its row or
    /// column is supported.
    places: Vec<Option<u32>>,
    _held: Taken,
}

impl Layout {
    /// Every node has a full block of its own, in which contacts add theirs, and full blocks with the nodes it has elements
    /// with. `None` where memory or the numbers of places do not suffice.
    pub fn new(structure: &Structure) -> Option<Self> {
        let dimension = structure.dimension;
        let unknowns = |node: usize| {
            (node * dimension..(node + 1) * dimension).filter_map(|freedom| structure.unknown_of[freedom])
        };
        let block = |first: usize, second: usize| {
            unknowns(first).flat_map(move |row| unknowns(second).map(move |column| (row, column)))
        };
        let nodes = structure.freedoms() / dimension.max(1);
        let own = (0..nodes).flat_map(|node| block(node, node));
        let of_elements = structure.elements.iter().flat_map(|element| {
            let ends: Vec<usize> = element.nodes().collect();
            block(ends[0], ends[ends.len() - 1]).collect::<Vec<_>>()
        });
        let pattern = Pattern::new(structure.unknowns(), own.chain(of_elements))?;
        if u32::try_from(pattern.entries()).is_err() {
            return None;
        }
        // Three by three entries for each pair of an element's two nodes at the most.
        let held = budget::take::<Option<u32>>(36 * structure.elements.len());
        let mut places = Vec::new();
        structure.each_stiffness(&vec![0.0; structure.freedoms()], &mut |row, column, _| {
            let place = match (structure.unknown_of[row], structure.unknown_of[column]) {
                (Some(row), Some(column)) => pattern.place(row, column).and_then(|place| u32::try_from(place).ok()),
                _ => None,
            };
            places.push(place);
        });
        Some(Self { pattern: Arc::new(pattern), places, _held: held })
    }

    /// Places of the entries of the calls, in their order.
    pub fn places(&self) -> impl Iterator<Item = Option<usize>> + '_ {
        self.places.iter().map(|place| place.map(|place| place as usize))
    }
}
