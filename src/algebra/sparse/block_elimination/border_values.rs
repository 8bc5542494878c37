//! What solutions are at the borders for right-hand sides with entries in border rows alone: products of half solutions,
//! which reach few unknowns, where the solutions themselves reach all.
//!
//! The compliance of a structure seen from its contacts is such a matrix: velocities of contacts are entries in border
//! rows, and their reactions stand at borders.

use crate::algebra::sparse::block_elimination::{Blocks, ReducedRow};
use crate::algebra::sparse::border_schur::SplitVectors;
use crate::algebra::sparse::constrained_nodes::constrained_node::{HeldNode, times};
use crate::algebra::sparse::factors::entries::SparseEntries;
use nalgebra::{DMatrix, Vector3};

/// The value that sparse entries have at a place.
fn at(entries: &[(usize, f64)], place: usize) -> f64 {
    entries.iter().filter(|(own, _)| *own == place).map(|(_, value)| value).sum()
}

/// A reaction, as the combination of the forces at constrained unknowns.
struct ReactionPart {
    unknown: usize,
    border: usize,
    factor: f64,
}

/// The values at the first `given` borders, one row each, for right-hand sides given by their entries in border rows,
/// one column each; `None` where block elimination gives no result.
pub(super) fn border_values(blocks: &Blocks, given: usize, rights: &[SparseEntries]) -> Option<DMatrix<f64>> {
    let (parts, rows) = functionals(blocks, given);
    let mut columns = SplitVectors::new(rights.len(), blocks.kept_rows.len());
    let mut own = DMatrix::zeros(given, rights.len());
    for (number, right) in rights.iter().enumerate() {
        let forces = add_right(blocks, right, number, &mut columns);
        for (unknown, force) in &forces {
            for part in parts_of(&parts, *unknown) {
                own[(part.border, number)] += part.factor * force;
            }
        }
    }
    Some(own + blocks.reduced.products(&rows, &columns)?)
}

fn parts_of(parts: &[ReactionPart], unknown: usize) -> impl Iterator<Item = &ReactionPart> {
    let first = parts.partition_point(|part| part.unknown < unknown);
    parts[first..].iter().take_while(move |part| part.unknown == unknown)
}

/// The values at the borders as functionals of the reduced solution, and the parts of those that are reactions at
/// eliminated nodes, in the order of the unknowns.
fn functionals(blocks: &Blocks, given: usize) -> (Vec<ReactionPart>, SplitVectors) {
    let elimination = &blocks.elimination;
    let mut rows = SplitVectors::new(given, blocks.kept_columns.len());
    for (place, border) in blocks.kept_columns.iter().enumerate().filter(|(_, border)| **border < given) {
        rows.lower[(place, *border)] = 1.0;
    }
    let mut parts = Vec::new();
    for node in elimination.nodes().iter().filter(|node| !node.keeps) {
        let reaction = elimination.matrices(node).reaction;
        for (index, unknown) in node.held().enumerate() {
            let factors = reaction.chunks_exact(node.held().len()).nth(index).into_iter().flatten();
            for (border, factor) in node.columns().zip(factors).filter(|(border, _)| *border < given) {
                parts.push(ReactionPart { unknown, border, factor: *factor });
                let equilibrium = elimination.equilibrium(node, index).iter();
                let free = equilibrium.filter(|(row, _)| !elimination.is_held(*row));
                rows.upper[border].extend(free.map(|(row, value)| (*row, -factor * value)));
            }
        }
    }
    parts.sort_by_key(|part| (part.unknown, part.border));
    for (place, held_part) in blocks.held_parts.iter().enumerate() {
        for (unknown, value) in held_part {
            for part in parts_of(&parts, *unknown) {
                rows.lower[(place, part.border)] -= part.factor * value;
            }
        }
    }
    (parts, rows)
}

/// Writes the right-hand side of the reduced system that belongs to entries in border rows; returns the forces at the
/// constrained unknowns.
fn add_right(blocks: &Blocks, right: &SparseEntries, number: usize, columns: &mut SplitVectors) -> SparseEntries {
    let elimination = &blocks.elimination;
    let (mut motions, mut forces) = (SparseEntries::new(), SparseEntries::new());
    let is_moved = |node: &&HeldNode| node.rows().any(|row| right.iter().any(|(own, _)| *own == row));
    for node in elimination.nodes().iter().filter(is_moved) {
        let mut given = Vector3::zeros();
        given.iter_mut().zip(node.rows()).for_each(|(value, row)| *value = at(right, row));
        let motion = times(elimination.matrices(node).constraint, node.held().len(), &given);
        for (index, (unknown, motion)) in node.held().zip(motion.iter()).enumerate() {
            motions.push((unknown, *motion));
            let stiffness = elimination.stiffness(node, index).iter().map(|(row, value)| (*row, -value * motion));
            elimination.split_into(stiffness, &mut columns.upper[number], &mut forces);
        }
    }
    for (place, row) in blocks.kept_rows.iter().enumerate() {
        columns.lower[(place, number)] = match row {
            ReducedRow::Equilibrium(unknown) => at(&forces, *unknown),
            ReducedRow::Border(row, entries) if motions.is_empty() || entries.is_empty() => at(right, *row),
            ReducedRow::Border(row, entries) => {
                at(right, *row) - entries.iter().map(|(unknown, value)| value * at(&motions, *unknown)).sum::<f64>()
            }
        };
    }
    forces
}
