//! The sparsity layout of the tangent of a structure with many unknowns.

use crate::algebra::sparse::Pattern;
use crate::mechanics::structure::Structure;
use crate::resources::budget::{self, Taken};
use itertools::Itertools;
use std::ops::Range;
use std::sync::Arc;

/// The positions of the tangent's entries, found once; the tangent is then assembled in place.
#[derive(Debug)]
pub struct Layout {
    pub pattern: Arc<Pattern>,
    /// For each call that `Structure::each_stiffness` makes, in its order, the position of the entry; `None` where its
    /// row or column is supported.
    places: Vec<Option<u32>>,
    /// Entries below the diagonal, of rows and columns over unknowns, that may differ from those above: those of loads that
    /// follow the structure.
    pub unsymmetric: Vec<(usize, usize)>,
    _held: Taken,
}

impl Layout {
    /// The layout of a structure. Every node has a full block of its own, which also takes the entries of contacts, and
    /// full blocks with the nodes to which elements or other couplings connect it. `None` where memory or the range of
    /// the indices does not suffice.
    pub fn new(structure: &Structure) -> Option<Self> {
        let unknown_of = &structure.unknown_of;
        let block = |rows: Range<usize>, columns: Range<usize>| {
            let unknowns = |freedoms: Range<usize>| freedoms.filter_map(|freedom| unknown_of[freedom]);
            unknowns(rows).flat_map(move |row| unknowns(columns.clone()).map(move |column| (row, column)))
        };
        let of_node = |node: usize| structure.numbering.freedoms_of(node);
        let own = (0..structure.numbering.nodes()).flat_map(|node| block(of_node(node), of_node(node)));
        let between = |nodes: &[usize]| -> Vec<(usize, usize)> {
            let pairs = nodes.iter().array_combinations();
            pairs.flat_map(|[first, second]| block(of_node(*first), of_node(*second))).collect()
        };
        let by_elements = structure.elements().flat_map(|at| between(at.element.nodes()));
        let by_others = structure.couplings.iter().flat_map(|[first, second]| {
            let pairs = first.iter().cartesian_product(second).filter(|(one, other)| one != other);
            pairs.flat_map(|(one, other)| block(of_node(*one), of_node(*other)))
        });
        let pattern = Pattern::new(structure.unknowns(), own.chain(by_elements).chain(by_others))?;
        if u32::try_from(pattern.entries()).is_err() {
            return None;
        }
        let held = budget::take::<Option<u32>>(structure.elements().map(|at| at.freedoms.len().pow(2)).sum());
        let mut places = Vec::new();
        structure.each_stiffness(&vec![0.0; structure.freedoms()], &mut |row, column, _| {
            let place = match (structure.unknown_of[row], structure.unknown_of[column]) {
                (Some(row), Some(column)) => pattern.place(row, column).and_then(|place| u32::try_from(place).ok()),
                _ => None,
            };
            places.push(place);
        });
        let loads = structure.elements().filter(|at| at.element.is_load());
        let below = loads.flat_map(|at| {
            let unknowns = at.freedoms.iter().filter_map(|freedom| unknown_of[*freedom]);
            let pairs = unknowns.clone().cartesian_product(unknowns);
            pairs.filter(|(row, column)| row > column).collect::<Vec<_>>()
        });
        let unsymmetric = below.sorted_unstable().dedup().collect();
        Some(Self { pattern: Arc::new(pattern), places, unsymmetric, _held: held })
    }

    /// The positions of the entries of the calls, in their order.
    pub fn places(&self) -> impl Iterator<Item = Option<usize>> + '_ {
        self.places.iter().map(|place| place.map(|place| place as usize))
    }
}
