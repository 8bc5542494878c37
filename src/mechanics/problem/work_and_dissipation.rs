//! External work and dissipation along an increment.
//!
//! ```text
//! ΔW = f_held·Δu + ∫ s d(f·u) + ∫ Q ds + ∫ p_f(u)·du,      ΔD = -Σ ∫ r_t·dx
//! ```
//!
//! `Q` is the force of the supports and obstacles that move with the load factor, work-conjugate to the load factor;
//! `x` is the position of a node relative to its obstacle; `p_f` are loads that follow the structure.
//!
//! Both integrands are products along a curve whose ends and end directions are known: cubic Hermite interpolants of
//! both factors, integrated exactly, give an error of fourth order in the step. The interpolants' parameter is arc
//! length; the chord `S` between directions that differ by an angle `θ` spans `S (1 + θ²/24)` of it.

use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::dot as inner;
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::reaction_in_space;
use crate::mechanics::problem::state::{Rate, State, dot};
use crate::mechanics::structure::following_loads;

/// A scalar at both ends of an increment with its derivatives by arc length.
#[derive(Clone, Copy)]
struct Ends {
    first: f64,
    first_rate: f64,
    last: f64,
    last_rate: f64,
}

/// A point and the direction of the path there.
pub type Placed<'a> = (&'a State, &'a Rate);

/// The energies of an increment.
#[derive(Debug, Clone, Copy)]
pub struct IncrementWork {
    pub external: f64,
    pub dissipated: f64,
    /// The largest part of the external work, of forces held, applied, driving or following: the parts may cancel.
    pub largest_part: f64,
    /// The work of the forces of the load pattern, and that of the supports and obstacles that it moves.
    pub of_pattern: [f64; 2],
}

/// `ΔW` and `ΔD` of an increment in one mode; `turned` is the angle (radians) by which the path's direction turns.
pub fn work_and_dissipation(
    loading: Loading<'_>,
    modes: &[Mode],
    start: Placed<'_>,
    end: Placed<'_>,
    turned: f64,
) -> IncrementWork {
    let length = start.0.distance(end.0) * (1.0 + turned * turned / 24.0);
    let load = Ends { first: start.0.load, first_rate: start.1.load, last: end.0.load, last_rate: end.1.load };
    // Motions are measured from the start, so that large displacements cost no digits.
    let along_chord = |forces: &[f64]| -> f64 {
        let change = end.0.displacement.iter().zip(&start.0.displacement).map(|(end, start)| end - start);
        forces.iter().zip(change).map(|(force, change)| force * change).sum()
    };
    let path = Ends {
        first: 0.0,
        first_rate: dot(&loading.pattern.forces, &start.1.displacement),
        last: along_chord(&loading.pattern.forces),
        last_rate: dot(&loading.pattern.forces, &end.1.displacement),
    };
    let (held, applied) = (along_chord(&loading.held.forces), integral(load, path, length));
    let (mut driving, mut following) = (0.0, 0.0);
    if loading.pattern.moves_boundary() {
        let (first, first_rate) = boundary_force(loading, start);
        let (last, last_rate) = boundary_force(loading, end);
        let driven = Ends { first: 0.0, last: load.last - load.first, ..load };
        driving = integral(Ends { first, first_rate, last, last_rate }, driven, length);
    }
    if loading.structure.has_following_loads() {
        following = work_of_following_loads(loading, start, end, length);
    }
    let mut dissipation = 0.0;
    for (index, (mode, contact)) in modes.iter().zip(loading.contacts).enumerate() {
        if !matches!(mode, Mode::Slip { .. }) || contact.tangents() == 0 {
            continue;
        }
        let chord = loading.relative_motion(index, start.0, end.0);
        let [first, last] = [start, end].map(|at| loading.relative_rate(index, at.0, at.1));
        for k in 0..loading.structure.dimension {
            let traction = Ends {
                first: start.0.reactions[index].tangential[k],
                first_rate: start.1.reactions[index].tangential[k],
                last: end.0.reactions[index].tangential[k],
                last_rate: end.1.reactions[index].tangential[k],
            };
            let slip = Ends { first: 0.0, first_rate: first[k], last: chord[k], last_rate: last[k] };
            dissipation -= integral(traction, slip, length);
        }
    }
    let parts = [held, applied, driving, following];
    let largest_part = parts.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
    IncrementWork {
        external: parts.iter().sum(),
        dissipated: dissipation,
        largest_part,
        of_pattern: [applied, driving],
    }
}

fn work_of_following_loads(loading: Loading<'_>, start: Placed<'_>, end: Placed<'_>, length: f64) -> f64 {
    let structure = loading.structure;
    let forces = [start, end].map(|(state, _)| following_loads::forces(structure, &state.displacement));
    let rates = [start, end]
        .map(|(state, rate)| following_loads::force_rates(structure, &state.displacement, &rate.displacement));
    let mut work = 0.0;
    for (freedom, ((first, last), (first_rate, last_rate))) in
        forces[0].iter().zip(&forces[1]).zip(rates[0].iter().zip(&rates[1])).enumerate()
    {
        let force = Ends { first: *first, first_rate: *first_rate, last: *last, last_rate: *last_rate };
        let path = Ends {
            first: 0.0,
            first_rate: start.1.displacement[freedom],
            last: end.0.displacement[freedom] - start.0.displacement[freedom],
            last_rate: end.1.displacement[freedom],
        };
        work += integral(force, path, length);
    }
    work
}

/// The force `Q` and its derivative by arc length.
pub fn boundary_force(loading: Loading<'_>, at: Placed<'_>) -> (f64, f64) {
    let (state, rate) = at;
    let structure = loading.structure;
    // No list where supports do not move.
    let moved = &loading.pattern.supports;
    let moves = |freedom: usize| moved.get(freedom).is_some_and(|motion| *motion != 0.0);
    let [mut force, mut change] = structure.forces_where(&state.displacement, &rate.displacement, moves);
    let is_moved = |node: &usize| structure.numbering.freedoms_of(*node).any(moves);
    let (mut sum, mut sum_rate) = (0.0, 0.0);
    for (index, contact) in loading.contacts.iter().enumerate() {
        let (reaction, reaction_rate) = reaction_in_space(loading, index, at);
        if contact.kinematics.nodes().iter().any(is_moved) {
            loading.each_column(index, state, |freedom, column| {
                force[freedom] -= inner(column, &reaction);
                change[freedom] -= inner(column, &reaction_rate);
            });
            contact_jacobian::each_curvature(
                structure,
                contact,
                &state.displacement,
                &reaction,
                |row, column, value| {
                    change[row] -= value * rate.displacement[column];
                },
            );
        }
        sum += inner(&reaction, &loading.pattern.shifts[index]);
        sum_rate += inner(&reaction_rate, &loading.pattern.shifts[index]);
    }
    for (freedom, motion) in moved.iter().enumerate().filter(|(freedom, _)| moves(*freedom)) {
        let (pattern, held) = (loading.pattern.forces[freedom], loading.held.forces[freedom]);
        sum += (force[freedom] - (state.load * pattern + held)) * motion;
        sum_rate += (change[freedom] - rate.load * pattern) * motion;
    }
    (sum, sum_rate)
}

/// `∫ a db` over the length; the integrand is of degree five, so that Gauss's three points are exact.
fn integral(a: Ends, b: Ends, length: f64) -> f64 {
    let offset = 0.6_f64.sqrt() / 2.0;
    [(0.5 - offset, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + offset, 5.0 / 18.0)]
        .iter()
        .map(|&(x, weight)| weight * value(a, length, x) * slope(b, length, x))
        .sum()
}

fn value(ends: Ends, length: f64, x: f64) -> f64 {
    let y = 1.0 - x;
    y * y * ((1.0 + 2.0 * x) * ends.first + x * length * ends.first_rate)
        + x * x * ((1.0 + 2.0 * y) * ends.last - y * length * ends.last_rate)
}

/// Derivative with respect to `x`, the arc length over the length of the increment.
fn slope(ends: Ends, length: f64, x: f64) -> f64 {
    let y = 1.0 - x;
    6.0 * x * y * (ends.last - ends.first)
        + length * (y * (1.0 - 3.0 * x) * ends.first_rate + x * (3.0 * x - 2.0) * ends.last_rate)
}
