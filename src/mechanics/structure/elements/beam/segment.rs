//! A stretch of beam between two nodes: its strain energy as a function of the chord and of the rotations of its ends.
//!
//! Undeformed, the segment is an arc of length `h` that turns by `2 a_0` (a straight line with `a_0 = 0`). In axes that
//! lie along the undeformed chord and turn with the mean rotation `θ = (θ_1 + θ_2)/2` of the ends, let `c` be the
//! deformed chord and `2a = 2 a_0 + θ_2 - θ_1` the angle between the end cross-sections. No load acts between nodes, so
//! that the force `F` in the beam is the same along the whole segment, and the complementary energy of Hellinger and
//! Reissner,
//!
//! ```text
//! W = max_F { F·(c - d) - ½ F·P F } + ½ EI (θ_2 - θ_1)²/h = ½ e·P⁻¹ e + 2 EI (a - a_0)²/h,    e = c - d
//! ```
//!
//! leaves no strain to be interpolated but the curvature. With the curvature constant, cross-sections turn linearly
//! along the arc, and
//!
//! ```text
//! d = h S(a) (1, 0),    S(a) = sin(a)/a                  chord of the unstretched arc
//! P = h diag(k_1, k_2) + h/(12 EI) v vᵀ,    v = (-c_2, c_1)
//! k_1,2 = ½ (1/EA + 1/GA) ± ½ S(2a) (1/EA - 1/GA)        averages of cos² and sin² along the arc
//! ```
//!
//! `v·F` is the difference of the moments at the ends. The summand of `P` with `v` is the flexibility of the curvature's
//! linear part that goes with this difference (the residual bending flexibility of R. H. MacNeal, Comput. Struct. 8
//! (1978) 175, doi:10.1016/0045-7949(78)90020-2). It takes the place of a shear strain: with `1/GA = 0`, a beam that
//! does not shear, nothing degenerates, no penalty stands for the constraint, and there is nothing that could lock.
//!
//! For small rotations the stiffness is the exact one of a beam with shear (of cubic deflection). Constant curvature is
//! exact for any rotation and any length. What is neglected (the change of the curvature's slope, and the square of
//! this slope in the chord) changes the energy by `O(h⁴)`, whatever the slenderness.

use crate::mechanics::structure::elements::beam::cardinal_sine;

/// A segment's dimensions and stiffnesses.
#[derive(Debug, Clone, Copy)]
pub(super) struct BeamSegment {
    /// Unit vector of the undeformed chord.
    direction: [f64; 2],
    chord: f64,
    /// `a_0`
    half_turn: f64,
    /// `h`
    length: f64,
    pub stiffness: SectionStiffness,
}

/// Stiffnesses of a beam's cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionStiffness {
    /// `EA` (force)
    pub axial: f64,
    /// `EI` (force times length squared)
    pub bending: f64,
    /// `GA` of the area in shear (force); `None`: the beam does not shear.
    pub shear: Option<f64>,
}

/// Motion of a segment's ends: displacement of the second relative to the first, and both rotations.
#[derive(Debug, Clone, Copy)]
pub(super) struct EndMotion {
    pub relative: [f64; 2],
    pub rotations: [f64; 2],
}

/// `P`
#[derive(Debug, Clone, Copy)]
struct Flexibility {
    /// The first and second diagonal entry, and the one beside the diagonal.
    entries: [f64; 3],
    /// Summed without the products that cancel.
    determinant: f64,
}

/// A segment deformed.
#[derive(Debug, Clone, Copy)]
pub(super) struct DeformedSegment {
    segment: BeamSegment,
    /// `c`, in the turned axes.
    chord: [f64; 2],
    /// `a`
    half_turn: f64,
    /// `a - a_0`
    bent: f64,
    /// Cosine and sine of the turned axes in global axes.
    axes: [f64; 2],
    /// `F`, in the turned axes.
    force: [f64; 2],
    error: [f64; 2],
    flexibility: Flexibility,
    /// `S'` and `S''` of `a`.
    sine: [f64; 2],
    /// `k_1'` and `k_1''`; those of `k_2` have the other sign.
    average: [f64; 2],
}

/// Force and moments at the ends of a segment, in global axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct EndForces {
    /// On the second end; opposite on the first.
    pub force: [f64; 2],
    /// On both ends.
    pub moments: [f64; 2],
}

impl BeamSegment {
    /// A segment that joins two points by `chord` and turns by `2 half_turn` along its way.
    pub fn new(chord: [f64; 2], half_turn: f64, stiffness: SectionStiffness) -> Self {
        let size = chord[0].hypot(chord[1]);
        let length = size / cardinal_sine::with_derivatives(half_turn)[0];
        Self { direction: chord.map(|part| part / size), chord: size, half_turn, length, stiffness }
    }

    pub fn length(&self) -> f64 {
        self.length
    }

    /// Half the angle between the undeformed end cross-sections.
    pub fn half_turn(&self) -> f64 {
        self.half_turn
    }

    /// Unit vector of the undeformed chord.
    pub fn direction(&self) -> [f64; 2] {
        self.direction
    }

    /// The undeformed chord.
    #[cfg(test)]
    pub fn chord(&self) -> [f64; 2] {
        self.direction.map(|part| part * self.chord)
    }

    /// The segment with its ends moved.
    #[inline(always)]
    pub fn deformed(&self, motion: &EndMotion) -> DeformedSegment {
        let ([cos, sin], [first, second]) = (self.direction, motion.rotations);
        let [x, y] = motion.relative;
        let moved = [cos * x + sin * y, cos * y - sin * x];
        let (mean, bent) = (0.5 * (first + second), 0.5 * (second - first));
        let half_turn = self.half_turn + bent;
        let (half_sine, (sine, cosine)) = ((0.5 * mean).sin(), mean.sin_cos());
        let along = cosine * moved[0] + sine * moved[1];
        let across = cosine * moved[1] - sine * (self.chord + moved[0]);
        // `c_1 - h S(a)` without cancellation: the chord's own shortening by the turn and by the bending.
        let shortened = cardinal_sine::difference(half_turn, self.half_turn, bent);
        let stretched = along - 2.0 * half_sine * half_sine * self.chord - self.length * shortened;
        let chord = [cosine * self.chord + along, across];
        let error = [stretched, across];
        let [_, first_of_sine, second_of_sine] = cardinal_sine::with_derivatives(half_turn);
        let [_, first_of_double, second_of_double] = cardinal_sine::with_derivatives(2.0 * half_turn);
        let stiffness = &self.stiffness;
        let (axial, shear) = (stiffness.axial.recip(), stiffness.shear.map_or(0.0, f64::recip));
        let less = -0.5 * cardinal_sine::difference(2.0 * half_turn, 0.0, 2.0 * half_turn);
        let linear = self.length / (12.0 * stiffness.bending);
        let of_strains =
            [self.length * (axial + less * (shear - axial)), self.length * (shear + less * (axial - shear))];
        let [x2, y2] = chord.map(|part| linear * part * part);
        let flexibility = Flexibility {
            entries: [of_strains[0] + y2, of_strains[1] + x2, -linear * chord[0] * chord[1]],
            determinant: of_strains[0] * of_strains[1] + of_strains[0] * x2 + of_strains[1] * y2,
        };
        let force = flexibility.solve(error);
        let difference = axial - shear;
        DeformedSegment {
            segment: *self,
            chord,
            half_turn,
            bent,
            axes: [cosine * cos - sine * sin, sine * cos + cosine * sin],
            force,
            error,
            flexibility,
            sine: [first_of_sine, second_of_sine],
            average: [first_of_double * difference, 2.0 * second_of_double * difference],
        }
    }
}

impl Flexibility {
    /// `P⁻¹ r`
    #[inline(always)]
    fn solve(&self, right: [f64; 2]) -> [f64; 2] {
        let [first, second, beside] = self.entries;
        [
            (second * right[0] - beside * right[1]) / self.determinant,
            (first * right[1] - beside * right[0]) / self.determinant,
        ]
    }
}

impl DeformedSegment {
    pub fn energy(&self) -> f64 {
        let of_force = 0.5 * (self.force[0] * self.error[0] + self.force[1] * self.error[1]);
        of_force + 2.0 * self.segment.stiffness.bending * self.bent * self.bent / self.segment.length
    }

    /// 1 plus the excess of the chord over that of the unstretched arc, per length of arc: 0 where the segment is
    /// crushed to a point.
    pub fn stretch(&self) -> f64 {
        let unstretched = self.segment.length * cardinal_sine::with_derivatives(self.half_turn)[0].abs();
        let chord = self.chord[0].hypot(self.chord[1]);
        (chord / self.segment.length + 1.0 - unstretched / self.segment.length).max(0.0)
    }

    /// `F`, in axes that turn with the segment.
    pub fn force(&self) -> [f64; 2] {
        self.force
    }

    /// The segment with a force that is a variable of the iteration.
    #[must_use]
    pub fn with_force(self, force: [f64; 2]) -> Self {
        Self { force, ..self }
    }

    /// `P⁻¹ e - F`: what the force lacks.
    fn lacking(&self) -> [f64; 2] {
        let whole = self.flexibility.solve(self.error);
        [whole[0] - self.force[0], whole[1] - self.force[1]]
    }

    /// The force after a correction by which the ends move so far.
    pub fn advanced_force(&self, change: &EndMotion) -> [f64; 2] {
        let [cos, sin] = self.axes;
        let [x, y] = change.relative;
        let (mean, bent) =
            (0.5 * (change.rotations[0] + change.rotations[1]), 0.5 * (change.rotations[1] - change.rotations[0]));
        let chord = [cos * x + sin * y + mean * self.chord[1], cos * y - sin * x - mean * self.chord[0]];
        let [first, second, turned] = self.columns();
        let along = [0, 1].map(|k| first[k] * chord[0] + second[k] * chord[1] + turned[k] * bent);
        let (lacking, by_motion) = (self.lacking(), self.flexibility.solve(along));
        [0, 1].map(|k| self.force[k] + lacking[k] + by_motion[k])
    }

    /// The forces and moments on the ends in the mixed form, where the force need not be that of the displacements.
    pub fn mixed_end_forces(&self) -> EndForces {
        let (chord, bending) = self.gradient();
        let lacking = self.lacking();
        let [first, second, turned] = self.columns().map(|column| column[0] * lacking[0] + column[1] * lacking[1]);
        self.at_ends([chord[0] + first, chord[1] + second], bending + turned)
    }

    /// `∂(e - P F)` by `c_1`, `c_2` and `a`.
    #[inline(always)]
    fn columns(&self) -> [[f64; 2]; 3] {
        let ([c1, c2], [first, second]) = (self.chord, self.force);
        let length = self.segment.length;
        let linear = length / (12.0 * self.segment.stiffness.bending);
        let jump = c1 * second - c2 * first;
        [
            [1.0 + linear * c2 * second, -linear * (jump + c1 * second)],
            [linear * (jump - c2 * first), 1.0 + linear * c1 * first],
            [-length * (self.sine[0] + self.average[0] * first), length * self.average[0] * second],
        ]
    }

    /// `∂L/∂c` and `∂L/∂a`, those of `W` where the force is that of the displacements.
    #[inline(always)]
    fn gradient(&self) -> ([f64; 2], f64) {
        let [first, second] = self.force;
        let length = self.segment.length;
        let linear = length / (12.0 * self.segment.stiffness.bending);
        let jump = linear * (self.chord[0] * second - self.chord[1] * first);
        let of_chord = [first - jump * second, second + jump * first];
        let of_force = self.sine[0] * first + 0.5 * self.average[0] * (first * first - second * second);
        let bending = 4.0 * self.segment.stiffness.bending * self.bent / length;
        (of_chord, bending - length * of_force)
    }

    /// The forces and moments on the ends.
    #[inline(always)]
    pub fn end_forces(&self) -> EndForces {
        let (chord, bending) = self.gradient();
        self.at_ends(chord, bending)
    }

    /// Forces and moments on the ends from the derivatives by `c` and `a`.
    #[inline(always)]
    fn at_ends(&self, [along, across]: [f64; 2], bending: f64) -> EndForces {
        let [cos, sin] = self.axes;
        // The rotation of the axes alone.
        let turning = 0.5 * (along * self.chord[1] - across * self.chord[0]);
        EndForces {
            force: [cos * along - sin * across, sin * along + cos * across],
            moments: [turning - 0.5 * bending, turning + 0.5 * bending],
        }
    }

    /// `∂²W` over `c_1`, `c_2` and `a`.
    #[inline(always)]
    fn curvature(&self) -> [[f64; 3]; 3] {
        let [first, second] = self.force;
        let (length, bending) = (self.segment.length, self.segment.stiffness.bending);
        let linear = length / (12.0 * bending);
        let columns = self.columns();
        let solved = columns.map(|column| self.flexibility.solve(column));
        let mut matrix = [[0.0; 3]; 3];
        for (row, column) in matrix.iter_mut().zip(&columns) {
            for (value, solved) in row.iter_mut().zip(&solved) {
                *value = column[0] * solved[0] + column[1] * solved[1];
            }
        }
        matrix[0][0] -= linear * second * second;
        matrix[0][1] += linear * first * second;
        matrix[1][0] += linear * first * second;
        matrix[1][1] -= linear * first * first;
        let of_force = self.sine[1] * first + 0.5 * self.average[1] * (first * first - second * second);
        matrix[2][2] += 4.0 * bending / length - length * of_force;
        matrix
    }

    /// The tangent over the relative displacement, in global axes, and both rotations.
    #[inline(always)]
    pub fn tangent(&self) -> [[f64; 4]; 4] {
        let ([along, across], _) = self.gradient();
        let (curvature, [c1, c2]) = (self.curvature(), self.chord);
        // Motion of the chord in the turned axes per mean rotation.
        let swept = [c2, -c1];
        let by = |row: &[f64; 3]| row[0] * swept[0] + row[1] * swept[1];
        // ∂²W over the relative displacement in the turned axes, the mean rotation and `a`.
        let (of_first, of_second, of_bending) = (by(&curvature[0]), by(&curvature[1]), by(&curvature[2]));
        let turned = [of_first - across, of_second + along];
        let turning = swept[0] * of_first + swept[1] * of_second - along * c1 - across * c2;
        let [cos, sin] = self.axes;
        let global = |[along, across]: [f64; 2]| [cos * along - sin * across, sin * along + cos * across];
        let rows = [0, 1].map(|row| global([curvature[row][0], curvature[row][1]]));
        let [first, second] = [0, 1].map(|column| global([rows[0][column], rows[1][column]]));
        let turned = global(turned);
        let bent = global([curvature[0][2], curvature[1][2]]);
        let of_rotation = |sign: f64| [0, 1].map(|k| 0.5 * (turned[k] + sign * bent[k]));
        let (one, other) = (of_rotation(-1.0), of_rotation(1.0));
        let (sum, across) = (0.25 * (turning + curvature[2][2]), 0.25 * (turning - curvature[2][2]));
        let half = 0.5 * of_bending;
        [
            [first[0], second[0], one[0], other[0]],
            [first[1], second[1], one[1], other[1]],
            [one[0], one[1], sum - half, across],
            [other[0], other[1], across, sum + half],
        ]
    }
}
