//! The equations of the motion caused by a load, and their factorisation.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::{Bordered, Holdings, SparseFactorisation};
use crate::algebra::{Factorisation, Stiffener, SystemFactorisation};
use crate::continuation::scene::characteristic_stiffness::{StiffnessEstimate, Tie};
use crate::mechanics::structure::elements::Stretching;
use nalgebra::DMatrix;
use std::sync::Arc;

/// Largest number of rows of a dense matrix in which stiff and soft elements are kept separate.
const MOST_APART: usize = 400;
/// Largest number of entries of a factor (of 8 bytes) for which the resisting stiffness is computed: a scale is not
/// worth more memory.
const MOST_ENTRIES: usize = 30_000_000;

/// `p`: the forces on the unknowns for unit load with all unknowns fixed.
pub(super) fn pushed(estimate: &StiffnessEstimate<'_>, displacement: &[f64], ties: &[Tie]) -> Vec<f64> {
    let structure = estimate.structure;
    let mut pushed: Vec<f64> = structure.freedom_of.iter().map(|freedom| estimate.pattern.forces[*freedom]).collect();
    if !estimate.pattern.supports.is_empty() {
        structure.each_stiffness(displacement, &mut |row, column, value| {
            if let (Some(row), None) = (structure.unknown_of[row], structure.unknown_of[column]) {
                pushed[row] -= value * estimate.support_rate(column);
            }
        });
    }
    for tie in ties {
        let by_load = by_load(estimate, &tie.stretching, tie.by_load);
        for (row, value) in unknowns_of(estimate, &tie.stretching) {
            pushed[row] -= tie.stretching.stiffness * value * by_load;
        }
    }
    pushed
}

/// The motion of a stretching for unit load with all unknowns fixed.
fn by_load(estimate: &StiffnessEstimate<'_>, stretching: &Stretching, own: f64) -> f64 {
    let supported = stretching.along.iter().filter(|(freedom, _)| estimate.structure.unknown_of[*freedom].is_none());
    supported.map(|(freedom, value)| value * estimate.support_rate(*freedom)).sum::<f64>() + own
}

pub(super) fn unknowns_of(estimate: &StiffnessEstimate<'_>, stretching: &Stretching) -> Vec<(usize, f64)> {
    let unknown = |(freedom, value): &(usize, f64)| Some((estimate.structure.unknown_of[*freedom]?, *value));
    stretching.along.iter().filter_map(unknown).collect()
}

/// `[[K, -p], [row, 0]]` at a displacement.
pub(super) fn factorise(
    estimate: &StiffnessEstimate<'_>,
    displacement: &[f64],
    ties: &[Tie],
    row: &[f64],
) -> Option<SystemFactorisation> {
    let structure = estimate.structure;
    let unknowns = structure.unknowns();
    // A spring may have as many summands as there are dimensions.
    let summands = structure.dimension * structure.elements().count() + ties.len();
    if unknowns + summands <= MOST_APART {
        return factorise_apart(estimate, displacement, ties, row).map(SystemFactorisation::Dense);
    }
    let Some(layout) = structure.layout() else {
        return factorise_dense(estimate, displacement, ties, row).map(SystemFactorisation::Dense);
    };
    if layout.pattern.factor_entries() > MOST_ENTRIES {
        return None;
    }
    let mut matrix = Bordered::new(layout.pattern.clone(), 1);
    let mut places = layout.places();
    structure.each_stiffness(displacement, &mut |_, _, value| {
        if let Some(place) = places.next().flatten() {
            matrix.add_at(place, value);
        }
    });
    add_ties_and_borders(estimate, displacement, ties, row, &mut matrix);
    SparseFactorisation::new(matrix, &Holdings::new(Vec::new()))
        .map(|factorisation| SystemFactorisation::Sparse(Arc::new(factorisation)))
}

/// The same for few unknowns.
fn factorise_dense(
    estimate: &StiffnessEstimate<'_>,
    displacement: &[f64],
    ties: &[Tie],
    row: &[f64],
) -> Option<Factorisation> {
    if row.len() > MOST_APART {
        return None;
    }
    let mut matrix = DMatrix::zeros(row.len() + 1, row.len() + 1);
    estimate.structure.add_tangent(displacement, &mut matrix);
    add_ties_and_borders(estimate, displacement, ties, row, &mut matrix);
    Factorisation::new(matrix)
}

fn add_ties_and_borders(
    estimate: &StiffnessEstimate<'_>,
    displacement: &[f64],
    ties: &[Tie],
    row: &[f64],
    matrix: &mut impl Sink,
) {
    for tie in ties {
        let entries = unknowns_of(estimate, &tie.stretching);
        for (row, first) in &entries {
            for (column, second) in &entries {
                matrix.add(*row, *column, tie.stretching.stiffness * first * second);
            }
        }
    }
    let unknowns = row.len();
    let pushed = pushed(estimate, displacement, ties);
    for (unknown, (force, entry)) in pushed.iter().zip(row).enumerate() {
        matrix.add(unknown, unknowns, -force);
        matrix.add(unknowns, unknown, *entry);
    }
}

/// The same with every stiffness kept separate, so that soft ones keep their digits next to stiff ones.
fn factorise_apart(
    estimate: &StiffnessEstimate<'_>,
    displacement: &[f64],
    ties: &[Tie],
    row: &[f64],
) -> Option<Factorisation> {
    let structure = estimate.structure;
    let unknowns = structure.unknowns();
    let mut matrix = DMatrix::zeros(unknowns + 1, unknowns + 1);
    for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
        matrix[(unknown, unknowns)] = -estimate.pattern.forces[*freedom];
        matrix[(unknowns, unknown)] = row[unknown];
    }
    let support_rate = |freedom: usize| estimate.support_rate(freedom);
    let add = |row: usize, column: usize, value: f64| matrix[(row, column)] += value;
    structure.each_stiffness_across(displacement, &mut structure.over_unknowns(support_rate, add));
    let stiffener = |stretching: &Stretching, own: f64| {
        let rows = unknowns_of(estimate, stretching);
        let by_load = (unknowns, by_load(estimate, stretching, own));
        let columns = rows.iter().copied().chain(std::iter::once(by_load)).collect();
        (!rows.is_empty()).then_some(Stiffener { stiffness: stretching.stiffness, rows, columns })
    };
    let elements = structure.stretching(displacement);
    let of_elements = elements.iter().filter_map(|stretching| stiffener(stretching, 0.0));
    let held = ties.iter().filter_map(|tie| stiffener(&tie.stretching, tie.by_load));
    let stiffeners: Vec<Stiffener> = of_elements.chain(held).collect();
    Factorisation::stiffened(matrix, &stiffeners)
}
