//! Proof, by factorisations of sparse matrices, that each load rate has at most one solution.
//!
//! Let `Δ` be the difference of two solutions with the same `ṡ`. For unconstrained motions `Δ_x (A Δ)_x = 0`; on the
//! cones `Δ_w Δ_y <= 0`. For a touching contact let `r = ΔR_n`, the row of `A` along its normal: unilateral contact
//! gives `Δ_n r <= 0`, and Coulomb's law `Δ_t ΔR_t <= μ |r| |Δ_t|` (a slipping contact has the traction `μ R_n` whether
//! pressed or not). The sum, with the normal parts weighted by `1 ± η`, `|η| < 1`, with the sign of `r Δ_t`, gives
//!
//! ```text
//! Δᵀ A Δ <= Σ ∓ r b,      b = η Δ_n - μ Δ_t
//! ```
//!
//! so that `Δ = 0` if the symmetric part of `A` is larger than `½ Σ (α r rᵀ + b bᵀ/α)` for some `η` and `α > 0`. Where
//! all contacts are on their cones, the condition is that `A` is definite: then the matrix of the slips is a P-matrix,
//! and there is exactly one solution (R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*,
//! theorem 3.3.7). `η` is chosen such that the motion along `b` that the structure resists least is as small as
//! possible, `α` such that both terms have equal weight.
//!
//! The structure may have one motion `z` without resistance, `A z = Aᵀ z = 0`, and in addition unknowns on which no
//! element acts, if `r` and `b` vanish along all of them. Then `Δ` consists of these motions, and a solution is unique
//! if inequalities that hold strictly for it exclude each of them. With `z_n >= μ |z_t|` at all touching contacts and
//! `z_w >= 0`, the power of the reactions on `z` is nonnegative, so `z·q ṡ <= 0`: the other sign has no solution. With
//! `ṡ = 0` these motions are the only solutions.
//!
//! Past a limit point `A` is not definite. For two solutions with the same power `q·Δ` of the load instead of the same
//! `ṡ`, the difference obeys the same inequality with `q·Δ = 0`: where the symmetric part is definite across `q`, each
//! power has at most one solution, and where all contacts are on their cones it exists if any motion with this power is
//! admissible (a strongly monotone variational inequality; the load rate is the multiplier of the power). Without power
//! nothing moves: the load alone changes. Definiteness across `q` follows from that of the matrix without one column
//! `f` of fast motion if the Schur complement on `f` and the border `q` has a negative determinant.

use crate::algebra::sparse::factors::cholesky::{Definite, Triangle};
use crate::branching::directions::candidate::{CandidateDirection, FoundDirections, is_mechanism};
use crate::branching::directions::tolerances::WEAK_MARGIN;
use crate::branching::uniqueness::sparse_uniqueness::pivoting;
use crate::branching::uniqueness::sparse_uniqueness::sparse_rate_equations::{ChangingContact, Equations};
use crate::branching::uniqueness::sparse_uniqueness::tolerances::{
    DEFINITENESS_MARGIN, DETERMINANT_TOLERANCE, LARGEST_WEIGHT,
};
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::problem::state::Rate;

/// The quantity whose sign distinguishes the solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DistinguishingQuantity {
    /// The sign of the load rate.
    Load,
    /// The sign of the load's power.
    Power,
}

/// Each sign of the control has at most one solution, up to motions without resistance, given as one entry for each
/// column of `A`.
pub(super) struct Proof {
    pub control: DistinguishingQuantity,
    /// The motion without resistance, with a largest entry of about 1.
    null: Option<Vec<f64>>,
    /// Columns on which no element acts.
    loose: Vec<usize>,
}

/// The column of the largest entry.
fn fastest(motion: &[f64]) -> Option<usize> {
    (0..motion.len()).max_by(|a, b| motion[*a].abs().total_cmp(&motion[*b].abs()))
}

/// Removes a column and its row; a unit diagonal entry keeps their place, decoupled from the others.
fn hold(lower: &mut Triangle, held: usize) {
    lower.retain(|(row, column, _)| *row != held && *column != held);
    lower.push((held, held, 1.0));
}

impl Proof {
    /// Dimension of the space of motions without resistance.
    pub fn free_motions(&self) -> usize {
        self.loose.len() + usize::from(self.null.is_some())
    }
}

/// Proves uniqueness where possible; `incoming` suggests the motion that the structure may resist least.
pub(super) fn proof(equations: &Equations<'_>, incoming: Option<&Rate>) -> Option<Proof> {
    let mut lower = equations.symmetric_part();
    let mut is_loose = vec![true; equations.size];
    for (row, column, value) in &lower {
        if *value != 0.0 {
            (is_loose[*row], is_loose[*column]) = (false, false);
        }
    }
    let loose: Vec<usize> = (0..equations.size).filter(|column| is_loose[*column]).collect();
    lower.extend(loose.iter().map(|column| (*column, *column, 1.0)));
    let (inverse, null) = match Definite::new(equations.size, &lower, -DEFINITENESS_MARGIN) {
        Some(definite) => (definite, None),
        None => {
            let shifted = Definite::new(equations.size, &lower, DEFINITENESS_MARGIN);
            match shifted.and_then(|shifted| null(equations, &shifted).map(|null| (shifted, Some(null)))) {
                Some(found) => found,
                None if loose.is_empty() => return proof_by_power(equations, lower, incoming?),
                None => return None,
            }
        }
    };
    let is_rough =
        |one: &ChangingContact| one.direction.is_none() && equations.loading.contacts[one.contact].friction.is_rough();
    if equations.changing.iter().any(is_rough) {
        take_touching(equations, &inverse, null.as_deref(), &mut lower)?;
    } else if null.is_none() {
        return Some(Proof { control: DistinguishingQuantity::Load, null, loose });
    }
    if let Some(null) = &null {
        // Definite across the motion: the column where it is fastest is removed.
        hold(&mut lower, fastest(null)?);
    }
    Definite::new(equations.size, &lower, -DEFINITENESS_MARGIN).map(|_| Proof {
        control: DistinguishingQuantity::Load,
        null,
        loose,
    })
}

/// The proof that the symmetric part is definite across the load.
fn proof_by_power(equations: &Equations<'_>, lower: Triangle, incoming: &Rate) -> Option<Proof> {
    let is_smooth =
        |one: &ChangingContact| one.direction.is_some() || !equations.loading.contacts[one.contact].friction.is_rough();
    if equations.loading.pattern.moves_boundary() || !equations.changing.iter().all(is_smooth) {
        return None;
    }
    let fast = fastest(&equations.columns_of(incoming))?;
    let (mut own, mut column) = (0.0, vec![0.0; equations.size]);
    for (row, other, value) in &lower {
        match (*row == fast, *other == fast) {
            (true, true) => own += value,
            (true, false) => column[*other] += value,
            (false, true) => column[*row] += value,
            (false, false) => {}
        }
    }
    let mut rest = lower;
    hold(&mut rest, fast);
    let rest = Definite::new(equations.size, &rest, -DEFINITENESS_MARGIN)?;
    let mut load = equations.load();
    let at_fast = std::mem::replace(&mut load[fast], 0.0);
    let (mut by_column, mut by_load) = (column.clone(), load.clone());
    rest.solve(&mut by_column);
    rest.solve(&mut by_load);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let stiffness = [own, product(&column, &by_column)];
    let softness = product(&load, &by_load);
    let coupling = [at_fast, product(&column, &by_load)];
    // -det, and the sizes of its terms.
    let value = (coupling[0] - coupling[1]).powi(2) + (stiffness[0] - stiffness[1]) * softness;
    let size = (coupling[0].abs() + coupling[1].abs()).powi(2) + (own.abs() + stiffness[1].abs()) * softness;
    (value > DETERMINANT_TOLERANCE * size).then_some(Proof {
        control: DistinguishingQuantity::Power,
        null: None,
        loose: Vec::new(),
    })
}

/// The motion without resistance.
fn null(equations: &Equations<'_>, shifted: &Definite) -> Option<Vec<f64>> {
    let mut motion = shifted.softest();
    let largest = motion.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    motion.iter_mut().for_each(|value| *value /= largest);
    let (mut images, mut sizes) =
        ([vec![0.0; equations.size], vec![0.0; equations.size]], vec![0.0_f64; equations.size]);
    equations.each_entry(&mut |row, column, value| {
        images[0][row] += value * motion[column];
        images[1][column] += value * motion[row];
        sizes[row] = sizes[row].max(value.abs());
        sizes[column] = sizes[column].max(value.abs());
    });
    let vanishes = |image: &Vec<f64>| image.iter().zip(&sizes).all(|(image, size)| image.abs() <= WEAK_MARGIN * size);
    (images.iter().all(vanishes) && is_mechanism(equations.loading, equations.state, &free_rate(equations, &motion)))
        .then_some(motion)
}

fn free_rate(equations: &Equations<'_>, motion: &[f64]) -> Rate {
    let reactions = vec![Reaction::default(); equations.loading.contacts.len()];
    let mut rate = Rate { displacement: equations.velocities(motion), load: 0.0, reactions };
    let size = rate.size();
    if size > 0.0 {
        rate.scale(1.0 / size);
    }
    rate
}

/// Subtracts the terms that friction at touching contacts may contribute.
fn take_touching(
    equations: &Equations<'_>,
    inverse: &Definite,
    null: Option<&[f64]>,
    lower: &mut Triangle,
) -> Option<()> {
    let mut of_normal = vec![usize::MAX; equations.size];
    for (index, one) in equations.changing.iter().enumerate().filter(|(_, one)| one.direction.is_none()) {
        of_normal[one.column + 1] = index;
    }
    let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); equations.changing.len()];
    equations.each_entry(&mut |row, column, value| {
        if let Some(entries) = rows.get_mut(of_normal[row]) {
            match entries.iter_mut().find(|(known, _)| *known == column) {
                Some((_, sum)) => *sum += value,
                None => entries.push((column, value)),
            }
        }
    });
    let friction_of = |one: &ChangingContact| equations.loading.contacts[one.contact].friction.coefficient;
    let rubs = |(one, row): &(&ChangingContact, &Vec<(usize, f64)>)| {
        one.direction.is_none() && friction_of(one) != 0.0 && row.iter().any(|(_, value)| *value != 0.0)
    };
    let touching: Vec<(&ChangingContact, &Vec<(usize, f64)>)> =
        equations.changing.iter().zip(&rows).filter(rubs).collect();
    let pairs: Vec<[usize; 2]> = touching.iter().map(|(one, _)| [one.column, one.column + 1]).collect();
    for ((one, row), compliances) in touching.into_iter().zip(inverse.inverse_entries(&pairs)) {
        let friction = friction_of(one);
        let resisted = |along: f64, across: f64| {
            let [own, both, other] = compliances;
            [own * along + both * across, both * along + other * across]
        };
        let (tangent, normal) = (one.column, one.column + 1);
        let moves = null.filter(|null| null[tangent].abs().max(null[normal].abs()) > WEAK_MARGIN);
        let weight = match moves {
            Some(null) if null[normal].abs() > WEAK_MARGIN => friction * null[tangent] / null[normal],
            Some(_) => return None,
            None => {
                let [along, own] = resisted(0.0, 1.0);
                (friction * along / own).clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT)
            }
        };
        if weight.abs() > LARGEST_WEIGHT {
            return None;
        }
        let form = [(tangent, -friction), (normal, weight)];
        let [along, own] = resisted(-friction, weight);
        let softness = weight * own - friction * along;
        let stiffness = row.iter().find(|(column, _)| *column == normal).map_or(0.0, |(_, value)| *value);
        let balance = (softness / stiffness).sqrt();
        if !(balance.is_finite() && balance > 0.0) {
            return None;
        }
        for (entries, factor) in [(&row[..], 0.5 * balance), (&form[..], 0.5 / balance)] {
            for (place, (row, value)) in entries.iter().enumerate() {
                for (column, other) in &entries[..=place] {
                    lower.push((*row.max(column), *row.min(column), -factor * value * other));
                }
            }
        }
    }
    Some(())
}

/// Whether a solution is the only one with its sign of the load rate, and is conclusive at first order.
pub(super) fn is_only(equations: &Equations<'_>, candidate: &CandidateDirection, proof: &Proof) -> bool {
    let strict = pivoting::strict(equations, candidate);
    let is_told = |(one, strict): (&ChangingContact, &bool)| *strict || one.direction.is_some();
    if !equations.changing.iter().zip(&strict).all(is_told) {
        return false;
    }
    let holds = |(one, strict): (&ChangingContact, &bool), speed: &dyn Fn(usize) -> f64| {
        let moves = |column: usize| speed(column).abs() > WEAK_MARGIN;
        let normal = one.column + 1;
        *strict
            && match (candidate.modes[one.contact], one.direction) {
                (Mode::Stick, Some(_)) => moves(one.column),
                (Mode::Stick, None) => moves(one.column) || moves(normal),
                (Mode::Slip { .. }, None) => moves(normal),
                (Mode::Slip { .. }, Some(_)) | (Mode::Free, _) => false,
            }
    };
    let is_held =
        |null: &Vec<f64>| equations.changing.iter().zip(&strict).any(|pair| holds(pair, &|column| null[column]));
    let mut owner = vec![usize::MAX; equations.size];
    for (index, one) in equations.changing.iter().enumerate() {
        owner[one.column] = index;
        if one.direction.is_none() {
            owner[one.column + 1] = index;
        }
    }
    let is_fast = |loose: &usize| {
        let pair = equations.changing.get(owner[*loose]).zip(strict.get(owner[*loose]));
        pair.is_some_and(|pair| holds(pair, &|column| f64::from(u8::from(column == *loose))))
    };
    proof.null.iter().all(is_held) && proof.loose.iter().all(is_fast)
}

/// Whether no solution has this sign of the control.
pub(super) fn has_none(equations: &Equations<'_>, sign: f64, proof: &Proof) -> bool {
    if proof.control == DistinguishingQuantity::Power {
        let mut one_sided = vec![false; equations.size];
        for one in &equations.changing {
            one_sided[if one.direction.is_some() { one.column } else { one.column + 1 }] = true;
        }
        let zero = WEAK_MARGIN * equations.largest_load();
        let has_power =
            |(load, one_sided): (&f64, &bool)| if *one_sided { load * sign > zero } else { load.abs() > zero };
        return !equations.load().iter().zip(&one_sided).any(has_power);
    }
    if equations.loading.pattern.moves_boundary() {
        return false;
    }
    let force = equations.largest_load();
    let load = equations.load();
    let lifts = equations.changing.iter().filter(|one| one.direction.is_none()).map(|one| one.column + 1);
    let mut is_pulled = lifts
        .filter(|column| proof.loose.binary_search(column).is_ok())
        .any(|column| load[column] * sign > WEAK_MARGIN * force);
    for sense in [1.0, -1.0] {
        is_pulled |= proof.null.as_ref().is_some_and(|null| {
            let opens = |one: &ChangingContact| match one.direction {
                Some(_) => sense * null[one.column] >= -WEAK_MARGIN,
                None => {
                    let friction = equations.loading.contacts[one.contact].friction.coefficient;
                    sense * null[one.column + 1] >= friction * null[one.column].abs() - WEAK_MARGIN
                }
            };
            equations.changing.iter().all(opens) && sense * sign * equations.power(null) > WEAK_MARGIN * force
        });
    }
    is_pulled
}

/// Adds the motions without resistance that no contact obstructs. All loose columns together count as one motion.
pub(super) fn add_free_motions(equations: &Equations<'_>, proof: &Proof, found: &mut FoundDirections) {
    if proof.free_motions() > 1 {
        (found.degenerate, found.mechanism) = (true, true);
    }
    let mut motions = proof.null.clone().into_iter().collect::<Vec<Vec<f64>>>();
    if !proof.loose.is_empty() {
        let mut together = vec![0.0; equations.size];
        proof.loose.iter().for_each(|column| together[*column] = 1.0);
        motions.push(together);
    }
    let back = |motion: &Vec<f64>| motion.iter().map(|value| -value).collect();
    for motion in motions.iter().flat_map(|motion| [motion.clone(), back(motion)]) {
        let is_open = |one: &ChangingContact| {
            motion[if one.direction.is_some() { one.column } else { one.column + 1 }] >= -WEAK_MARGIN
        };
        if equations.changing.iter().all(is_open) {
            let mut modes = equations.held.clone();
            equations
                .changing
                .iter()
                .for_each(|one| modes[one.contact] = equations.mode_of_motion(one, &motion, WEAK_MARGIN));
            found.candidates.push(pivoting::candidate(equations, free_rate(equations, &motion), modes, Vec::new()));
        }
    }
}
