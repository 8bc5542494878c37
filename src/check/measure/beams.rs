//! Forces, moments and strain energy of the posted beams, for the measure only.
//!
//! A stretch of beam between two nodes turns evenly along its arc, and the force in it is the same everywhere. With the
//! deformed chord `c` and half the angle `a` between the end cross-sections, in axes that turn with the mean rotation,
//! the energy is
//!
//! ```text
//! W = ½ e·P⁻¹ e + 2 EI (a - a_0)²/h,    e = c - h ∫ (cos a t, 0) dt,    t from 0 to 1
//! P = h ∫ diag(cos²(at)/EA + sin²(at)/GA, sin²(at)/EA + cos²(at)/GA) dt + h/(12 EI) v vᵀ,    v = (-c_2, c_1)
//! ```
//!
//! The integrals are taken numerically, the derivatives of `W` by numbers that carry them. At a release the rotation of
//! the beam's end is the one without a moment.

use crate::check::measure::numbers::DualNumber;
use crate::check::measure::numbers::{MeasuredVector, padded};
use crate::model::request::{BendingStiffness, Element as Posted, Model};

/// Error of a difference of two rounded numbers that were computed from rounded numbers, in units of the machine
/// epsilon.
pub(super) const ROUNDINGS: f64 = 16.0;

/// Points and weights of Gauss's rule of five points on (-1, 1).
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];
/// Number of intervals, each with the rule: exact to round-off for an arc of a full turn.
const INTERVALS: u32 = 4;

/// Steps of the secant method for the rotation of a released end.
const MOST_STEPS: usize = 40;

/// A beam with its nodes numbered.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeasuredBeam {
    /// As many as there are segments, and one more.
    nodes: [usize; 3],
    segments: [Option<MeasuredSegment>; 2],
    /// Whether the ends are hinged.
    released: [bool; 2],
}

#[derive(Debug, Clone, Copy)]
struct MeasuredSegment {
    chord: [f64; 2],
    /// `a_0`
    half_turn: f64,
    /// `h`
    length: f64,
    axial: f64,
    bending: f64,
    /// `1/GA`
    shear_flexibility: f64,
}

/// What a beam does to its nodes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BeamResponse {
    /// For each node its number, the force and the moment of the node on the beam, and their rounding errors.
    pub nodes: [Option<NodeShare>; 3],
    /// Axial force, shear force and bending moment at both ends.
    pub ends: [[f64; 6]; 2],
    /// How many of these there are: three; in space six, the forces first.
    pub of_end: usize,
    /// Rotations of the ends that are released.
    pub released: [Option<f64>; 2],
    pub energy: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NodeShare {
    pub node: usize,
    pub force: MeasuredVector,
    pub moment: MeasuredVector,
    pub force_rounding: f64,
    pub moment_rounding: f64,
}

/// Forces on the ends of a segment.
#[derive(Debug, Clone, Copy)]
struct SegmentResponse {
    /// On the second end; opposite on the first.
    force: [f64; 2],
    moments: [f64; 2],
    energy: f64,
    force_rounding: f64,
    moment_rounding: f64,
}

/// The integral from 0 to 1.
fn integral(of: impl Fn(f64) -> f64) -> f64 {
    let mut sum = 0.0;
    integral_of(|point, weight| sum += weight * of(point));
    sum
}

/// Calls `add` with the points and weights of an integral from 0 to 1.
pub(super) fn integral_of(mut add: impl FnMut(f64, f64)) {
    let width = 1.0 / f64::from(INTERVALS);
    for interval in 0..INTERVALS {
        for (point, weight) in GAUSS {
            add(width * (f64::from(interval) + 0.5 + 0.5 * point), 0.5 * width * weight);
        }
    }
}

impl MeasuredSegment {
    /// The forces at a motion of the second end relative to the first and rotations of both.
    fn response(&self, relative: [f64; 2], rotations: [f64; 2], moved: f64) -> SegmentResponse {
        let size = self.chord[0].hypot(self.chord[1]);
        let [cos, sin] = self.chord.map(|part| part / size);
        let (along, across) = (cos * relative[0] + sin * relative[1], cos * relative[1] - sin * relative[0]);
        let mean = 0.5 * (rotations[0] + rotations[1]);
        let bent = 0.5 * (rotations[1] - rotations[0]);
        let a = self.half_turn + bent;
        let (sine, cosine) = mean.sin_cos();
        let chord = [cosine * (size + along) + sine * across, cosine * across - sine * (size + along)];
        // `h ∫ cos a_0 t - cos a t dt`, and the chord's own change.
        let shorter = integral(|t| 2.0 * (0.5 * (a + self.half_turn) * t).sin() * (0.5 * bent * t).sin());
        let stretched =
            cosine * along + sine * across - 2.0 * (0.5 * mean).sin().powi(2) * size + self.length * shorter;
        // Change of the chord of the unstretched arc with the bending.
        let slope = integral(|t| t * (a * t).sin());
        let first = DualNumber(stretched, [1.0, 0.0, self.length * slope]);
        let second = DualNumber::variable(chord[1], 1);
        let squares =
            DualNumber(integral(|t| (a * t).sin().powi(2)), [0.0, 0.0, integral(|t| t * (2.0 * a * t).sin())]);
        let (axial, shear) = (self.axial.recip(), self.shear_flexibility);
        let of_axial = DualNumber::constant(axial).plus(squares.times(shear - axial)).times(self.length);
        let of_shear = DualNumber::constant(shear).plus(squares.times(axial - shear)).times(self.length);
        let linear = self.length / (12.0 * self.bending);
        let (c1, c2) = (DualNumber::variable(chord[0], 0), second);
        // P⁻¹ over the determinant without the products that cancel.
        let weighted = of_axial.by(c1).by(c1).plus(of_shear.by(c2).by(c2)).times(linear);
        let determinant = of_axial.by(of_shear).plus(weighted);
        let lever = c1.by(first).plus(c2.by(second));
        let squared = of_shear.by(first).by(first).plus(of_axial.by(second).by(second));
        let work = squared.plus(lever.by(lever).times(linear));
        let turned = DualNumber(bent, [0.0, 0.0, 1.0]);
        let of_bending = turned.by(turned).times(2.0 * self.bending / self.length);
        let energy = work.over(determinant).times(0.5).plus(of_bending);
        let [g1, g2, by_bending] = energy.1;
        let (sine, cosine) = (sine * cos + cosine * sin, cosine * cos - sine * sin);
        let couple = 0.5 * (chord[1] * g1 - chord[0] * g2);
        // Rounding errors of the strains, times the stiffness against each.
        let lateral = 12.0 * self.bending / self.length.powi(3);
        let of_length = ROUNDINGS * f64::EPSILON * moved;
        let turns = rotations[0].abs().max(rotations[1].abs());
        SegmentResponse {
            force: [cosine * g1 - sine * g2, sine * g1 + cosine * g2],
            moments: [couple - 0.5 * by_bending, couple + 0.5 * by_bending],
            energy: energy.0,
            force_rounding: of_length * (self.axial / self.length + lateral),
            moment_rounding: of_length * (lateral * self.length + self.axial / self.length * chord[1].abs())
                + of_length * self.axial * slope.abs()
                + ROUNDINGS * f64::EPSILON * turns * self.bending / self.length,
        }
    }

    /// Rotation of the chord that is nearest to a rotation.
    fn chord_turn(&self, relative: [f64; 2], near: f64) -> f64 {
        let ([x, y], now) = (self.chord, [self.chord[0] + relative[0], self.chord[1] + relative[1]]);
        let turn = (x * now[1] - y * now[0]).atan2(x * now[0] + y * now[1]);
        turn + std::f64::consts::TAU * ((near - turn) / std::f64::consts::TAU).round()
    }
}

impl MeasuredBeam {
    /// `None` if a node is unknown.
    pub fn new(model: &Model, posted: &Posted) -> Option<Self> {
        let Posted::Beam { nodes, axial_stiffness, bending_stiffness, shear_stiffness, .. } = posted else {
            return None;
        };
        let BendingStiffness::Plane(bending) = *bending_stiffness else { return None };
        let places = nodes.iter().map(|node| model.nodes.get(node)).collect::<Option<Vec<_>>>()?;
        let mut numbers = [0; 3];
        for (number, name) in numbers.iter_mut().zip(nodes) {
            *number = model.nodes.get_index_of(name)?;
        }
        let chord = |place: usize| {
            let (from, to) = (places.get(place)?, places.get(place + 1)?);
            Some([to.first()? - from.first()?, to.get(1)? - from.get(1)?])
        };
        let segment = |chord: [f64; 2], half_turn: f64| MeasuredSegment {
            chord,
            half_turn,
            length: chord[0].hypot(chord[1]) / integral(|t| (half_turn * t).cos()),
            axial: *axial_stiffness,
            bending,
            shear_flexibility: shear_stiffness.map_or(0.0, f64::recip),
        };
        let first = chord(0)?;
        let segments = match chord(1) {
            None => [Some(segment(first, 0.0)), None],
            Some(second) => {
                // The angles at the circumference over both chords: half the arcs' own.
                let across = [first[0] + second[0], first[1] + second[1]];
                let angle = |from: [f64; 2], to: [f64; 2]| {
                    (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1])
                };
                [Some(segment(first, angle(across, second))), Some(segment(second, angle(first, across)))]
            }
        };
        let released = [nodes.first()?, nodes.last()?].map(|node| !posted.turns_with(node));
        Some(Self { nodes: numbers, segments, released })
    }

    /// Approximately the largest stiffness in any direction.
    pub fn stiffness(&self) -> f64 {
        self.segments.iter().flatten().map(|segment| segment.axial / segment.length).fold(0.0, f64::max)
    }

    /// Number of ends that are released.
    pub fn releases(&self) -> usize {
        self.released.iter().filter(|released| **released).count()
    }

    fn last(&self) -> usize {
        self.segments.iter().flatten().count()
    }

    /// The response to the given displacements and rotations of the nodes.
    pub fn response(&self, u: &[MeasuredVector], rotations: &[MeasuredVector]) -> BeamResponse {
        let last = self.last();
        let mut turns = self.nodes.map(|node| rotations[node].z);
        let relative = |place: usize| {
            let moved = u[self.nodes[place + 1]] - u[self.nodes[place]];
            [moved.x, moved.y]
        };
        self.turn_released_ends(&mut turns, relative);
        let mut response = BeamResponse { of_end: 3, ..BeamResponse::default() };
        for (share, node) in response.nodes.iter_mut().zip(self.nodes).take(last + 1) {
            *share = Some(NodeShare { node, ..NodeShare::default() });
        }
        for (place, segment) in self.segments.iter().flatten().enumerate() {
            let own = [turns[place], turns[place + 1]];
            let ends = [u[self.nodes[place]], u[self.nodes[place + 1]]];
            let swept = own[0].abs().max(own[1].abs()).min(1.0) * segment.length;
            let moved = ends.iter().map(|end| end.amax()).fold(swept, f64::max);
            let of_segment = segment.response(relative(place), own, moved);
            response.energy += of_segment.energy;
            let force = padded(&of_segment.force);
            for (end, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(share) = &mut response.nodes[place + end] {
                    share.force += force * sign;
                    share.moment.z += of_segment.moments[end];
                    share.force_rounding += of_segment.force_rounding;
                    share.moment_rounding += of_segment.moment_rounding;
                }
                if place + end == if end == 0 { 0 } else { last } {
                    let turned = turns[place + end] + sign * segment.half_turn;
                    let normal = segment.chord[1].atan2(segment.chord[0]) + turned;
                    let (sine, cosine) = normal.sin_cos();
                    let [x, y] = of_segment.force;
                    let moment = sign * of_segment.moments[end];
                    response.ends[end][..3].copy_from_slice(&[cosine * x + sine * y, cosine * y - sine * x, moment]);
                }
            }
        }
        // What is left of the moment at a release is the secant method's rounding.
        for (end, released) in [0, last].into_iter().zip(self.released) {
            if let (true, Some(share)) = (released, &mut response.nodes[end]) {
                response.released[usize::from(end > 0)] = Some(turns[end]);
                (share.moment, share.moment_rounding) = (MeasuredVector::zeros(), 0.0);
            }
        }
        response
    }

    /// Sets the rotations of released ends to those without a moment.
    fn turn_released_ends(&self, turns: &mut [f64; 3], relative: impl Fn(usize) -> [f64; 2]) {
        let last = self.last();
        if let ([true, true], [Some(only), None]) = (self.released, &self.segments) {
            // A straight beam without moments stays straight.
            turns[..2].fill(only.chord_turn(relative(0), 0.0));
            return;
        }
        for (end, place) in [(0, 0), (1, last - 1)] {
            let (Some(segment), true) = (&self.segments[place], self.released[end]) else { continue };
            let (own, other) = (place + end, place + 1 - end);
            let moment = |turn: f64| {
                let both = if end == 0 { [turn, turns[other]] } else { [turns[other], turn] };
                segment.response(relative(place), both, 0.0).moments[end]
            };
            let mut one = 1.5 * segment.chord_turn(relative(place), turns[other]) - 0.5 * turns[other];
            let mut next = one + 1e-4;
            let mut of_one = moment(one);
            if of_one == 0.0 {
                // As at the start, where a rotation that is zero but for rounding would be the largest force.
                turns[own] = one;
                continue;
            }
            for _ in 0..MOST_STEPS {
                let of_next = moment(next);
                let step = of_next * (next - one) / (of_next - of_one);
                if !step.is_finite() || of_next == 0.0 {
                    break;
                }
                (one, of_one) = (next, of_next);
                next -= step;
                if step.abs() <= f64::EPSILON * (1.0 + next.abs()) {
                    break;
                }
            }
            turns[own] = next;
        }
    }
}
