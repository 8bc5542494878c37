//! A stretch of beam in space between two nodes: its strain energy as a function of the chord and of the rotations of
//! its ends.
//!
//! The same energy as that of the plane's [`segment`](crate::mechanics::structure::elements::beam::segment), which it
//! equals for motions in a plane. The material frames `Λ_1`, `Λ_2` of the ends are columns along the beam, axis 1 and
//! axis 2. Let `φ` be the rotation vector of `Λ_1ᵀ Λ_2`, `φ_0` the same undeformed, `Λ_m = Λ_1 exp(φ/2)` the frame
//! halfway, and `c` the deformed chord in it. The force `F` in the beam is constant, as no load acts between nodes;
//! with constant curvature `φ/h` the centre line is a helix, and
//!
//! ```text
//! W = max_F { F·(c - d) - ½ F·P F - h/24 Δm·B⁻¹ Δm } + ½ (φ - φ_0)·B (φ - φ_0)/h
//! d = h (e + F(x) q),    x = φ·φ,    q = φ × (φ × e)       chord of the unstretched helix, e along the beam
//! P = h ∫ exp(ηφ) C exp(ηφ)ᵀ dη,    -½ <= η <= ½           C = diag(1/EA, 1/GA, 1/GA)
//! Δm = c × F + φ × B (φ - φ_0)/h                           B = diag(GJ, EI_1, EI_2)
//! ```
//!
//! `Δm` is the change of the moment, in material axes, from one end to the other: by the force's lever and by the turn
//! of the axes. Its summand is the energy of the linear part of the curvature (R. H. MacNeal, Comput. Struct. 8 (1978)
//! 175, doi:10.1016/0045-7949(78)90020-2, for the first term; by Magnus's expansion of `exp` for the second). What is
//! neglected changes the energy by `O(h⁴)`; shear is no strain to be interpolated, and nothing locks.
//!
//! The frames halfway and between the ends come from sums and products of the nodes' quaternions, which count turns by
//! twos: the ends of a segment may turn against each other by any angle below a full turn.

use crate::algebra::differential::{
    Differential, DifferentialQuaternion, WithGradient, WithHessian, added, cross, dot, scaled,
};
use crate::mechanics::rotation::{polynomial, quaternion, sine_coefficient, sine_of_root};
use nalgebra::{Matrix3, Quaternion, Vector3};

/// Stiffnesses of the cross-section of a beam in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceSectionStiffness {
    /// `EA` (force)
    pub axial: f64,
    /// `EI_1` and `EI_2` against bending about axes 1 and 2 (force times length squared)
    pub bending: [f64; 2],
    /// `GJ` (force times length squared)
    pub torsional: f64,
    /// `GA` of the area in shear (force), along both axes; `None`: the beam does not shear.
    pub shear: Option<f64>,
}

/// A segment's dimensions and stiffnesses.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpaceSegment {
    /// Columns: along the undeformed chord, axis 1, axis 2.
    axes: Matrix3<f64>,
    chord: f64,
    /// `h`
    length: f64,
    /// `φ_0`, across the chord, as the formulas of the deformed segment give it at rest: the strains there are zero, not
    /// round-off.
    turn: [f64; 3],
    /// Half of the turn.
    half: Quaternion<f64>,
    /// `h F q` at rest.
    shortened: [f64; 3],
    pub stiffness: SpaceSectionStiffness,
}

/// Motion of a segment's ends: displacement of the second relative to the first, and for both ends the rotation vector
/// from a reference, with the quaternion of the reference.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpaceEndMotion {
    pub relative: [f64; 3],
    pub rotations: [[f64; 3]; 2],
    pub references: [Quaternion<f64>; 2],
}

/// Number of components of a motion: relative displacement and both rotation vectors.
pub(super) const OF_MOTION: usize = 9;

const TERMS: usize = 14;

/// Squared angles below which the functions of the helix are summed as series.
const SERIES_BELOW: f64 = 1.0;

/// `F`, `G` and `H` of `x = φ·φ`: averages along the helix of the coefficients of `exp(ηφ) e = e + s_1 φ×e + s_2 q`, of
/// `s_2`, of `s_1²` and of `s_2²`.
fn averages<D: Differential>(x: D) -> [D; 3] {
    let value = x.value();
    if value < SERIES_BELOW {
        let of = |coefficient: &dyn Fn(usize) -> f64| {
            let coefficients: [f64; TERMS] = std::array::from_fn(coefficient);
            x.map(polynomial(&coefficients, value))
        };
        let quartered = |k: usize| sine_coefficient(k) * 0.25_f64.powi(k as i32);
        return [
            of(&|k| -quartered(k + 1)),
            of(&|k| -0.5 * sine_coefficient(k + 1)),
            of(&|k| 0.5 * sine_coefficient(k + 2) - 2.0 * quartered(k + 2)),
        ];
    }
    let sine = |factor: f64| {
        let [value, first, second, _] = sine_of_root(factor * value);
        x.map([value, factor * first, factor * factor * second])
    };
    let (half, whole, inverse) = (sine(0.25), sine(1.0), x.reciprocal());
    let one = D::constant(1.0);
    [
        (one - half) * inverse,
        (one - whole).times(0.5) * inverse,
        (whole.times(0.5) - half.times(2.0)).plus(1.5) * inverse * inverse,
    ]
}

/// The quaternion of a rotation vector.
fn turned_by<D: Differential>(vector: &[D; 3]) -> DifferentialQuaternion<D> {
    let quarter = dot(vector, vector).times(0.25);
    let [value, first, second, third] = sine_of_root(quarter.value());
    let x = quarter.value();
    let sine = quarter.map([value, first, second]);
    let cosine = quarter.map([value + 2.0 * x * first, 3.0 * first + 2.0 * x * second, 5.0 * second + 2.0 * x * third]);
    DifferentialQuaternion(cosine, scaled(sine.times(0.5), vector))
}

/// The rotation vector of a quaternion, below a full turn.
fn vector_of<D: Differential>(DifferentialQuaternion(real, vector): &DifferentialQuaternion<D>) -> [D; 3] {
    let squared = dot(vector, vector);
    let (cosine, square) = (real.value(), squared.value());
    if cosine > 0.0 && square < 0.04 * cosine * cosine {
        // `atan √t / √t = Σ (-t)^k/(2k+1)`
        let inverse = real.reciprocal();
        let ratio = squared * inverse * inverse;
        let coefficients: [f64; TERMS] =
            std::array::from_fn(|k| (if k % 2 == 0 { 1.0 } else { -1.0 }) / (2 * k + 1) as f64);
        let factor = ratio.map(polynomial(&coefficients, ratio.value())) * inverse;
        return scaled(factor.times(2.0), vector);
    }
    let sine = squared.root();
    let arc = |ratio: D| {
        let (value, less) = (ratio.value(), 1.0 / (1.0 + ratio.value() * ratio.value()));
        ratio.map([value.atan(), less, -2.0 * value * less * less])
    };
    let half = if cosine.abs() > sine.value() {
        arc(sine * real.reciprocal()).plus(if cosine < 0.0 { std::f64::consts::PI } else { 0.0 })
    } else {
        (-arc(*real * sine.reciprocal())).plus(std::f64::consts::FRAC_PI_2)
    };
    scaled(half.times(2.0) * sine.reciprocal(), vector)
}

impl SpaceSegment {
    /// A segment of the given undeformed chord. `axis`: axis 1 halfway, of unit size and across the chord. `turn`: the
    /// rotation vector from the cross-section of the first end to that of the second, in global axes, across the chord.
    pub fn new(chord: [f64; 3], axis: [f64; 3], turn: [f64; 3], stiffness: SpaceSectionStiffness) -> Self {
        let (chord, axis, turn) = (Vector3::from(chord), Vector3::from(axis), Vector3::from(turn));
        let size = chord.norm();
        let along = chord / size;
        let axes = Matrix3::from_columns(&[along, axis, along.cross(&axis)]);
        let mut own: [f64; 3] = axes.tr_mul(&turn).into();
        own[0] = 0.0;
        let length = size / sine_of_root(0.25 * turn.norm_squared())[0];
        let half = quaternion(&own.map(|part| 0.5 * part));
        let mut segment = Self { axes, chord: size, length, turn: own, half, shortened: [0.0; 3], stiffness };
        if own != [0.0; 3] {
            (_, segment.turn) = segment.strains([0.0; 3], &[[0.0; 3]; 2], &[Quaternion::identity(); 2]);
            segment.shortened = segment.shortening(&segment.turn);
        }
        segment
    }

    pub fn length(&self) -> f64 {
        self.length
    }

    /// The undeformed chord.
    #[cfg(test)]
    pub fn undeformed(&self) -> Vector3<f64> {
        self.axes.column(0) * self.chord
    }

    /// The undeformed frame of an end: columns along the beam, axis 1, axis 2.
    pub fn frame(&self, end: usize) -> Matrix3<f64> {
        let half = if end == 0 { -0.5 } else { 0.5 };
        let turn = nalgebra::Rotation3::new(Vector3::from(self.turn) * half);
        self.axes * turn.matrix()
    }

    fn rigidity(&self) -> [f64; 3] {
        let SpaceSectionStiffness { bending: [first, second], torsional, .. } = self.stiffness;
        [torsional, first, second]
    }

    /// The excess of the chord over the undeformed one, and `φ`, in the material axes halfway.
    #[inline(always)]
    fn strains<D: Differential>(
        &self,
        relative: [D; 3],
        rotations: &[[D; 3]; 2],
        references: &[Quaternion<f64>; 2],
    ) -> ([D; 3], [D; 3]) {
        let constant =
            |quaternion: &Quaternion<f64>| DifferentialQuaternion::constant(quaternion.w, quaternion.imag().into());
        let ends = [0, 1].map(|end| turned_by(&rotations[end]).after(&constant(&references[end])));
        let into_axes = |vector: &[D; 3]| -> [D; 3] {
            std::array::from_fn(|row| {
                let axis = self.axes.column(row);
                vector[0].times(axis[0]) + vector[1].times(axis[1]) + vector[2].times(axis[2])
            })
        };
        let DifferentialQuaternion(real, vector) = ends[0].conjugate().after(&ends[1]);
        let mut between = DifferentialQuaternion(real, into_axes(&vector));
        let mut sum = ends;
        if self.turn != [0.0; 3] {
            let half = self.half;
            between = constant(&half).after(&between).after(&constant(&half));
            let global: [f64; 3] = (self.axes * half.imag()).into();
            let half = DifferentialQuaternion::constant(half.w, global);
            sum = [ends[0].after(&half.conjugate()), ends[1].after(&half)];
        }
        let real = sum[0].0 + sum[1].0;
        let vector = added(&sum[0].1, &sum[1].1);
        let size = (real * real + dot(&vector, &vector)).root().reciprocal();
        let (real, vector) = (real * size, scaled(size, &vector));
        // `Rᵀ v - v` of the rotation halfway.
        let undeformed = Vector3::from(self.axes.column(0)) * self.chord;
        let chord: [D; 3] = std::array::from_fn(|k| relative[k].plus(undeformed[k]));
        let across = cross(&vector, &chord);
        let turned = added(&scaled(-real, &across), &cross(&vector, &across)).map(|part| part.times(2.0));
        (into_axes(&added(&relative, &turned)), vector_of(&between))
    }

    /// `h F q`
    #[inline(always)]
    fn shortening<D: Differential>(&self, turn: &[D; 3]) -> [D; 3] {
        let squares = turn.map(|part| part * part);
        let across = squares[1] + squares[2];
        let [of_second, ..] = averages(squares[0] + across);
        [-across, turn[0] * turn[1], turn[0] * turn[2]].map(|part| (of_second * part).times(self.length))
    }

    /// `W` by the excess of the chord and `φ`.
    #[inline(always)]
    fn energy_of<D: Differential>(&self, excess: [D; 3], turn: [D; 3]) -> D {
        let (h, rigidity) = (self.length, self.rigidity());
        let (axial, shear) = (self.stiffness.axial.recip(), self.stiffness.shear.map_or(0.0, f64::recip));
        let squares = turn.map(|part| part * part);
        let across = squares[1] + squares[2];
        let [of_second, of_first_squared, of_second_squared] = averages(squares[0] + across);
        let zero = D::constant(0.0);
        let (b, q) = ([zero, turn[2], -turn[1]], [-across, turn[0] * turn[1], turn[0] * turn[2]]);
        let chord = [excess[0].plus(self.chord), excess[1], excess[2]];
        let shortening = self.shortening(&turn);
        let error: [D; 3] = std::array::from_fn(|k| (excess[k] - shortening[k]).plus(self.shortened[k]));
        let bent: [D; 3] = std::array::from_fn(|k| turn[k].plus(-self.turn[k]));
        let moment: [D; 3] = std::array::from_fn(|k| bent[k].times(rigidity[k] / h));
        let twisted = cross(&turn, &moment);
        // Axes along the chord and across it: the lever of a force along the chord vanishes, and stiffnesses that
        // differ by any factor are not mixed.
        let size = dot(&chord, &chord).root();
        let first = scaled(size.reciprocal(), &chord);
        let least = (0..3).min_by(|a, b| chord[*a].value().abs().total_cmp(&chord[*b].value().abs())).unwrap_or(2);
        let unit: [D; 3] = std::array::from_fn(|k| D::constant(if k == least { 1.0 } else { 0.0 }));
        let second = cross(&unit, &first);
        let second = scaled(dot(&second, &second).root().reciprocal(), &second);
        let axes = [first, second, cross(&first, &second)];
        let parts = axes.map(|axis| [axis[0], dot(&axis, &b), dot(&axis, &q)]);
        let flexibility = |row: usize, column: usize| {
            let ([a1, b1, q1], [a2, b2, q2]) = (parts[row], parts[column]);
            let average =
                a1 * a2 + of_first_squared * b1 * b2 + of_second_squared * q1 * q2 + of_second * (a1 * q2 + q1 * a2);
            average.times(h * (axial - shear)).plus(if row == column { h * shear } else { 0.0 })
        };
        let softened: [D; 3] = std::array::from_fn(|k| twisted[k].times(rigidity[k].recip()));
        let soft = |a: &[D; 3], b: &[D; 3]| {
            let part = |k: usize| (a[k] * b[k]).times(rigidity[k].recip());
            part(0) + part(1) + part(2)
        };
        let lever = (size * size).times(h / 12.0);
        let (p11, p12, p13) = (flexibility(0, 0), flexibility(0, 1), flexibility(0, 2));
        let p22 = flexibility(1, 1) + lever * soft(&axes[2], &axes[2]);
        let p23 = flexibility(1, 2) - lever * soft(&axes[1], &axes[2]);
        let p33 = flexibility(2, 2) + lever * soft(&axes[1], &axes[1]);
        let by_twist = |axis: &[D; 3]| size.times(h / 12.0) * dot(axis, &softened);
        let (r1, r2, r3) = (
            dot(&axes[0], &error),
            dot(&axes[1], &error) - by_twist(&axes[2]),
            dot(&axes[2], &error) + by_twist(&axes[1]),
        );
        let inverse3 = p33.reciprocal();
        let (l23, l13) = (p23 * inverse3, p13 * inverse3);
        let (d2, r2) = (p22 - l23 * p23, r2 - l23 * r3);
        let (p12, p11, r1) = (p12 - l13 * p23, p11 - l13 * p13, r1 - l13 * r3);
        let inverse2 = d2.reciprocal();
        let l12 = p12 * inverse2;
        let (d1, r1) = (p11 - l12 * p12, r1 - l12 * r2);
        let of_force = r3 * r3 * inverse3 + r2 * r2 * inverse2 + r1 * r1 * d1.reciprocal();
        (of_force + dot(&bent, &moment)).times(0.5) - dot(&twisted, &softened).times(h / 24.0)
    }

    pub fn energy(&self, motion: &SpaceEndMotion) -> f64 {
        let (excess, turn) = self.strains(motion.relative, &motion.rotations, &motion.references);
        self.energy_of(excess, turn)
    }

    /// `∂W` over the motion.
    pub fn gradient(&self, motion: &SpaceEndMotion) -> [f64; OF_MOTION] {
        let variable = |place: usize, value: f64| WithGradient::<OF_MOTION>::variable(value, place);
        let (relative, rotations) = variables(motion, variable);
        let (excess, turn) = self.strains(relative, &rotations, &motion.references);
        let strains = [excess, turn].concat();
        let own =
            |first: usize| std::array::from_fn(|k| WithGradient::<6>::variable(strains[first + k].value, first + k));
        let energy = self.energy_of(own(0), own(3));
        std::array::from_fn(|k| strains.iter().zip(&energy.gradient).map(|(strain, by)| by * strain.gradient[k]).sum())
    }

    /// `∂²W` over the motion.
    pub fn hessian(&self, motion: &SpaceEndMotion) -> [[f64; OF_MOTION]; OF_MOTION] {
        let variable = |place: usize, value: f64| WithHessian::<OF_MOTION>::variable(value, place);
        let (relative, rotations) = variables(motion, variable);
        let (excess, turn) = self.strains(relative, &rotations, &motion.references);
        let strains = [excess, turn].concat();
        let own =
            |first: usize| std::array::from_fn(|k| WithHessian::<6>::variable(strains[first + k].value, first + k));
        let energy = self.energy_of(own(0), own(3));
        let mut matrix = [[0.0; OF_MOTION]; OF_MOTION];
        for (strain, by) in strains.iter().zip(&energy.gradient) {
            for (row, curved) in matrix.iter_mut().zip(&strain.hessian) {
                row.iter_mut().zip(curved).for_each(|(value, curved)| *value += by * curved);
            }
        }
        for (one, of_one) in strains.iter().zip(&energy.hessian) {
            let across: [f64; OF_MOTION] = std::array::from_fn(|column| {
                strains.iter().zip(of_one).map(|(other, by)| by * other.gradient[column]).sum()
            });
            for (row, along) in matrix.iter_mut().zip(&one.gradient) {
                row.iter_mut().zip(&across).for_each(|(value, across)| *value += along * across);
            }
        }
        // Products of the sums above differ by round-off across the diagonal.
        let found = matrix;
        for (row, values) in matrix.iter_mut().enumerate() {
            for (value, across) in values.iter_mut().zip(&found) {
                *value = 0.5 * (*value + across[row]);
            }
        }
        matrix
    }

    /// 1 plus the excess of the chord over that of the unstretched helix, per length: 0 where the segment is crushed.
    pub fn stretch(&self, motion: &SpaceEndMotion) -> f64 {
        let (excess, turn) = self.strains(motion.relative, &motion.rotations, &motion.references);
        let chord = Vector3::from(excess) + Vector3::x() * self.chord;
        let turn = Vector3::from(turn);
        let [of_second, ..] = averages(turn.norm_squared());
        let unstretched = Vector3::x() + turn.cross(&turn.cross(&Vector3::x())) * of_second;
        (chord.norm() / self.length + 1.0 - unstretched.norm()).max(0.0)
    }
}

/// The components of a motion as variables.
fn variables<D>(motion: &SpaceEndMotion, variable: impl Fn(usize, f64) -> D) -> ([D; 3], [[D; 3]; 2]) {
    let of = |first: usize, values: &[f64; 3]| std::array::from_fn(|k| variable(first + k, values[k]));
    (of(0, &motion.relative), [of(3, &motion.rotations[0]), of(6, &motion.rotations[1])])
}
