//! A certificate that a point already reached by the path solves the increment's program.
//!
//! Where at a feasible point one member of every pair is positive, the feasible points nearby belong to one contact
//! mode, and where the equations of this mode are regular, these points form a curve. Along the curve, with
//! `τ = ‖(Δu, Δs)‖/S` as parameter and `y = (Δu, Δs)/S`, the objective is
//!
//! ```text
//! φ(τ) = ℓ·y(τ) - ½ γ1 τ²,        ℓ·v = -r_t⁽ᵏ⁾·v_t/F + γ2 d·v
//! ```
//!
//! and the point at `τ = 1` is a strict local solution where `φ'(1) = 0` and `φ''(1) < 0`. `γ1` is the parameter that
//! is adapted until the increment has the prescribed arc length: `φ'(1) = 0` gives it directly, `γ1 = ℓ·y'(1)`, and it
//! has to be positive. `y'(1)` is the path's direction at the point over its cosine with `y`; `y''(1)` is the second
//! derivative of the cubic through both ends with their directions. With independent gradients of the mode's equations,
//! `φ'(1) = 0` is equivalent to the existence of multipliers, and with no pair biactive the point is strongly
//! stationary, hence B-stationary: H. Scheel and S. Scholtes, Math. Oper. Res. 25 (2000),
//! doi:10.1287/moor.25.1.1.15213.
//!
//! A member counts as positive where it exceeds the constraint violation at the point and the rounding of zero. A
//! smaller member counts as positive if it was not negative at the start, decreases at neither end and increases at
//! one: rates are known to more digits than the difference of two nearly equal states. A member that falls to zero at
//! the end itself was positive just before: the certificate then holds for every slightly shorter increment, since all
//! other conditions are strict.
//!
//! The two parts of the slip of an open contact do not matter: there is no force, and only their difference counts.
//!
//! Nothing is certified where any of these conditions fails or is unclear, where a cone is circular (there the
//! integration rule of the path is of higher order than that of the program) or where two contacts of one node are
//! closed (their reactions need not be unique): then the program is solved.

use crate::complementarity::mpec::{Activities, PairActivity, Problem, Settings};
use crate::mechanics::contact::vector::{Vector, dot};
use crate::mechanics::contact::{Frame, Mode};
use crate::mechanics::problem::state::{Rate, State};
use crate::step::increment_mpec::solution_extraction;
use crate::step::increment_mpec::tolerances::{
    LOOSEST_TOLERANCE, MEMBER_TOLERANCE, RATE_ROUND_OFF, SMALLEST_CHORD_COSINE, VIOLATION_MULTIPLE,
};
use crate::step::increment_mpec::{ForeseenModes, InReach, IncrementProgram, Named, tangent_components};
use nalgebra::DVector;

/// A point of the path with its direction.
#[derive(Clone, Copy)]
pub struct Arrived<'s> {
    pub state: &'s State,
    /// The path's direction, of unit arc length, in the mode that led to the point.
    pub rate: &'s Rate,
    /// Distance to the mode's curve (dimensionless).
    pub error: f64,
}

/// One member of a pair along the increment.
#[derive(Debug, Clone, Copy)]
struct PairMember {
    start: f64,
    end: f64,
    /// Rates at both ends, per arc length over the prescribed one.
    rates: [f64; 2],
    /// Rounding of the rates.
    rounding: f64,
    /// Whether the member is a slip, which starts at zero and may reverse on the way.
    is_slip: bool,
}

impl PairMember {
    fn is_positive(&self, clear: f64) -> bool {
        let [first, last] = self.rates;
        let is_small = self.end.abs() <= clear;
        let rises = self.start >= -clear && first.min(last) >= -self.rounding && first.max(last) > self.rounding;
        let arrives = self.start > clear && last < -self.rounding;
        self.end > clear || is_small && (rises || arrives)
    }

    /// The value at the end; for a slip, the part in its own sense.
    fn part(&self) -> f64 {
        if self.is_slip { self.end.max(0.0) } else { self.end }
    }

    /// The fraction of the increment after which a member becomes negative that is negative at the end: from the
    /// parabola through both ends with the rate at the start; for a slip, the fraction at which it reverses, from the
    /// line through both rates.
    fn ends_after(&self) -> f64 {
        let [first, last] = self.rates;
        let part = if self.is_slip {
            first / (first - last)
        } else {
            let bend = self.end - self.start - first;
            2.0 * self.start / ((first * first - 4.0 * bend * self.start).max(0.0).sqrt() - first)
        };
        // A member that starts at zero returns to zero at the other root of the parabola.
        let back = if self.start > 0.0 || self.is_slip { part } else { first / (first - self.end + self.start) };
        if back.is_finite() { back.clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// The result of the certificate for an increment of the prescribed arc length that ends at a point:
/// [`ForeseenModes::Named`] where the point solves the program with `γ1` adapted to it, [`ForeseenModes::EndsAfter`]
/// where the point lies past the end of its mode, [`ForeseenModes::Unclear`] where nothing is certain.
///
/// `forward` is the direction at the start in the mode that leads to the end, and the equations of that mode are
/// regular at the end.
pub fn solved_at(program: &mut IncrementProgram<'_>, end: Arrived<'_>, present: &[Mode]) -> ForeseenModes {
    if program.reach.iter().any(|entry| entry.tangents == 2) || is_any_node_pressed_twice(program, end.state) {
        return ForeseenModes::Unclear;
    }
    let frames: Vec<Frame> =
        program.reach.iter().map(|entry| program.loading.frame(entry.contact, end.state)).collect();
    let x = variables_of(program, end.state, &frames);
    if !x.iter().all(|value| value.is_finite()) {
        return ForeseenModes::Unclear;
    }
    match clear_activities(program, &x, end, &frames) {
        Ok(activities) if is_strict_solution(program, &x, end) => {
            ForeseenModes::Named(Named::of(&solution_extraction::modes_at(program, &x, &activities, present)))
        }
        Ok(_) => ForeseenModes::Unclear,
        Err(refused) => refused,
    }
}

/// The variables of the program at a state where the contacts in reach have these frames.
pub(super) fn variables_of(program: &IncrementProgram<'_>, state: &State, frames: &[Frame]) -> DVector<f64> {
    let structure = program.loading.structure;
    let mut x = DVector::zeros(program.variables);
    for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
        x[unknown] = (state.displacement[*freedom] - program.base.displacement[*freedom]) / program.step;
    }
    x[structure.unknowns()] = (state.load - program.base.load) / program.step;
    for (entry, here) in program.reach.iter().zip(frames) {
        let reaction = &state.reactions[entry.contact];
        x[entry.normal()] = reaction.normal / program.force;
        if entry.tangents == 1 {
            x[entry.tangential(0)] = tangent_components::components(here, &reaction.tangential)[0] / program.force;
            let slip = tangent_components::components(&entry.frame, &chord(program, entry, state))[0] / program.step;
            for (part, side) in entry.parts() {
                x[part] = (side * slip).max(0.0);
            }
        }
    }
    x
}

/// The motion of a contact relative to its obstacle since the start of the increment.
fn chord(program: &IncrementProgram<'_>, entry: &InReach, state: &State) -> Vector {
    program.loading.relative_motion(entry.contact, program.base, state)
}

/// The zero member of each pair, where the variables are feasible and the members are certain.
fn clear_activities(
    program: &IncrementProgram<'_>,
    x: &DVector<f64>,
    end: Arrived<'_>,
    frames: &[Frame],
) -> Result<Activities, ForeseenModes> {
    let mut equality = DVector::zeros(program.equalities());
    program.equality_values(x, &mut equality);
    // Not `max`, which ignores NaN.
    let larger = |most: f64, value: f64| if most.is_nan() || value.abs() <= most { most } else { value.abs() };
    let members = members(program, x, end, frames);
    let rounding = program.rounding(x);
    let left = equality.iter().copied().fold(0.0, larger);
    let clear = MEMBER_TOLERANCE.max(VIOLATION_MULTIPLE * left.max(rounding).max(end.error / program.step));
    let smaller = members.iter().map(|[first, second]| first.end.min(second.part()));
    let feasible = Settings::warm().tolerance.max(rounding).min(LOOSEST_TOLERANCE);
    let is_feasible = smaller.fold(left, larger) <= feasible;
    let is_near = end.error <= LOOSEST_TOLERANCE * program.step;
    if !is_feasible || !is_near {
        // Where no force opposes a slip, the slip may have either sense.
        let is_broken = |[first, second]: &[PairMember; 2]| {
            let turns = second.is_slip && first.end.abs() <= feasible;
            [first.end < -feasible, second.end < -feasible && (turns || !second.is_slip)]
        };
        let broken = members.iter().flat_map(|pair| pair.iter().zip(is_broken(pair)));
        let parts = broken.filter(|(_, is_broken)| *is_broken).map(|(member, _)| member.ends_after());
        let part = parts.fold(f64::INFINITY, f64::min);
        let is_past = is_near && left <= feasible && part > 0.0 && part < 1.0;
        return Err(if is_past { ForeseenModes::EndsAfter(part) } else { ForeseenModes::Unclear });
    }
    let activity = |[first, second]: &[PairMember; 2]| match (first.is_positive(clear), second.is_positive(clear)) {
        (true, false) => PairActivity::SecondZero,
        (false, true) => PairActivity::FirstZero,
        (false, false) => PairActivity::BothZero,
        (true, true) => PairActivity::NeitherZero,
    };
    let pairs: Vec<PairActivity> = members.iter().map(activity).collect();
    let is_clear = |pair: &PairActivity| matches!(pair, PairActivity::FirstZero | PairActivity::SecondZero);
    let mut rest = &pairs[..];
    for entry in &program.reach {
        let (own, others) = rest.split_at(1 + 2 * entry.tangents);
        rest = others;
        let is_apart = own[0] == PairActivity::SecondZero;
        if !is_clear(&own[0]) || !is_apart && !own.iter().all(is_clear) {
            return Err(ForeseenModes::Unclear);
        }
    }
    Ok(Activities { pairs, cones: Vec::new() })
}

/// Both members of every pair, in the order of [`Problem::pair_values`].
fn members(
    program: &IncrementProgram<'_>,
    x: &DVector<f64>,
    end: Arrived<'_>,
    frames: &[Frame],
) -> Vec<[PairMember; 2]> {
    let per_force = program.step / program.force;
    let of_forces = program.forward.largest_reaction().max(end.rate.largest_reaction()) * per_force;
    let member = |start: f64, end: f64, rates: [f64; 2], rounding: f64, is_slip: bool| PairMember {
        start,
        end,
        rates,
        rounding: RATE_ROUND_OFF * rounding,
        is_slip,
    };
    let mut members = Vec::with_capacity(program.pairs());
    for (entry, here) in program.reach.iter().zip(frames) {
        let (contact, friction) = (entry.contact, entry.friction);
        let ends = [(program.forward, &entry.frame), (end.rate, here)];
        let moved = [(program.base, program.forward), (end.state, end.rate)];
        let moved = moved.map(|(state, rate)| program.loading.relative_rate(contact, state, rate));
        let velocities = [dot(&entry.frame.normal, &moved[0]), dot(&here.normal, &moved[1])];
        let pressed = program.base.reactions[contact].normal / program.force;
        let pressed_rates = ends.map(|(rate, _)| rate.reactions[contact].normal * per_force);
        members.push([
            member(entry.frame.gap / program.step, here.gap / program.step, velocities, 1.0, false),
            member(pressed, x[entry.normal()], pressed_rates, of_forces, false),
        ]);
        if entry.tangents == 0 {
            continue;
        }
        let traction_rates = ends.map(|(rate, frame)| {
            tangent_components::components(frame, &rate.reactions[contact].tangential)[0] * per_force
        });
        let slip_rates = ends.map(|(rate, _)| program.motion(entry, rate)[0]);
        let slipped: f64 = entry.parts().map(|(part, side)| side * x[part]).iter().sum();
        for (_, side) in entry.parts() {
            let off_cone =
                |normal: f64, traction: f64| (friction.bound(normal) + side * traction) / (1.0 + friction.coefficient);
            let ends = (off_cone(pressed, entry.traction[0]), off_cone(x[entry.normal()], x[entry.tangential(0)]));
            let rates = [0, 1].map(|k| off_cone(pressed_rates[k], traction_rates[k]));
            members.push([
                member(ends.0, ends.1, rates, of_forces, false),
                member(0.0, side * slipped, slip_rates.map(|rate| side * rate), 1.0, true),
            ]);
        }
    }
    members
}

/// Whether the objective has a strict maximum along the curve at its end, with `γ1` adapted to the end.
fn is_strict_solution(program: &mut IncrementProgram<'_>, x: &DVector<f64>, end: Arrived<'_>) -> bool {
    let load = program.loading.structure.unknowns();
    let (mut along_forward, mut along_end) = (x[load] * program.forward.load, x[load] * end.rate.load);
    for (unknown, freedom) in program.loading.structure.freedom_of.iter().enumerate() {
        along_forward += x[unknown] * program.forward.displacement[*freedom];
        along_end += x[unknown] * end.rate.displacement[*freedom];
    }
    if along_end.is_nan() || along_end < SMALLEST_CHORD_COSINE {
        return false;
    }
    let linear = |rate: &Rate| program.dissipation_along(rate) + program.forward_weight * program.forward.product(rate);
    let at_start = linear(program.forward);
    let at_end = linear(end.rate) / along_end;
    let dissipated: f64 = program.reach.iter().map(|entry| dissipated(program, entry, x)).sum();
    let of_chord = dissipated + program.forward_weight * along_forward;
    // γ1 > 0, φ'' < 0, and the objective is larger than without motion.
    let (arc_weight, curvature) = (at_end, 2.0 * at_start + 3.0 * at_end - 6.0 * of_chord);
    let is_strict = arc_weight > 0.0 && curvature < 0.0 && of_chord > 0.5 * arc_weight;
    if is_strict {
        program.arc_weight = arc_weight;
    }
    is_strict
}

fn dissipated(program: &IncrementProgram<'_>, entry: &InReach, x: &DVector<f64>) -> f64 {
    if entry.tangents == 0 { 0.0 } else { -program.dissipation_of(entry, x) }
}

/// Whether some node is in contact with two obstacles.
fn is_any_node_pressed_twice(program: &IncrementProgram<'_>, state: &State) -> bool {
    program.loading.corners.iter().any(|corner| corner.closed(program.loading, state).len() >= 2)
}
