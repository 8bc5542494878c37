//! Rotations in space: unit quaternions and rotation vectors.
//!
//! A rotation vector `θ` turns by the angle `|θ|` about its direction, `R = exp(θ)`; it is not bounded by a turn. The
//! quaternion of `θ` is `(cos |θ|/2, sin |θ|/2 θ/|θ|)`: quaternions of opposite sign are the same rotation, one turn
//! apart. A quaternion that follows a motion thus counts turns by twos, and a rotation vector near another counts all.

use nalgebra::{Quaternion, Vector3};

/// Arguments below which the power series of the cardinal sine are used.
const SERIES_BELOW: f64 = 1.0;
const TERMS: usize = 14;

/// `Z(x) = sin √x / √x`, `Z'`, `Z''` and `Z'''`, for `x >= 0`, with all digits at small arguments.
pub(crate) fn sine_of_root(x: f64) -> [f64; 4] {
    if x >= SERIES_BELOW {
        let root = x.sqrt();
        let value = root.sin() / root;
        let first = (root.cos() - value) / (2.0 * x);
        let second = -(0.5 * value + 3.0 * first) / (2.0 * x);
        let third = -(0.5 * first + 5.0 * second) / (2.0 * x);
        return [value, first, second, third];
    }
    let coefficients: [f64; TERMS] = std::array::from_fn(sine_coefficient);
    let [value, first, second] = polynomial(&coefficients, x);
    let derived: [f64; TERMS] =
        std::array::from_fn(|k| if k < TERMS - 1 { (k + 1) as f64 * coefficients[k + 1] } else { 0.0 });
    [value, first, second, polynomial(&derived, x)[2]]
}

/// `(-1)^k/(2k+1)!`, the coefficients of [`sine_of_root`].
pub(crate) fn sine_coefficient(k: usize) -> f64 {
    (1..=k).fold(1.0, |product, j| -product / (((2 * j) * (2 * j + 1)) as f64))
}

/// A polynomial with its first two derivatives.
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> [f64; 3] {
    let (mut value, mut first, mut second) = (0.0, 0.0, 0.0);
    for coefficient in coefficients.iter().rev() {
        second = second * x + 2.0 * first;
        first = first * x + value;
        value = value * x + coefficient;
    }
    [value, first, second]
}

/// The quaternion of a rotation vector.
pub fn quaternion(vector: &[f64; 3]) -> Quaternion<f64> {
    let vector = Vector3::from(*vector);
    let quarter = 0.25 * vector.norm_squared();
    let [sine, slope, ..] = sine_of_root(quarter);
    Quaternion::from_parts(sine + 2.0 * quarter * slope, vector * (0.5 * sine))
}

/// The rotation vector of a unit quaternion that is nearest to another rotation vector.
pub fn vector_near(quaternion: &Quaternion<f64>, near: &[f64; 3]) -> [f64; 3] {
    use std::f64::consts::PI;
    let (near, vector) = (Vector3::from(*near), quaternion.imag());
    let sine = vector.norm();
    let half = sine.atan2(quaternion.w);
    // Close to a whole number of turns the direction is round-off, and that of the other vector serves.
    let (axis, angle) = if sine > f64::MIN_POSITIVE.sqrt() { (vector / sine, 2.0 * half) } else { (near, 2.0 * half) };
    let size = axis.norm();
    if size == 0.0 {
        return [0.0; 3];
    }
    let axis = axis / size;
    let turns = ((near.dot(&axis) - angle) / (4.0 * PI)).round();
    if turns == 0.0 && sine <= 0.5 && quaternion.w > 0.0 {
        // `2 asin |v| / |v|`, without loss of the digits of a small vector.
        let ratio = if sine > 1e-8 { 2.0 * sine.asin() / sine } else { 2.0 };
        return (vector * ratio).into();
    }
    (axis * (angle + 4.0 * PI * turns)).into()
}

/// `T(ψ) v`: the spin of `exp(ψ)` where `ψ` changes by `v`.
pub fn spin(vector: &[f64; 3], change: &[f64; 3]) -> [f64; 3] {
    let (vector, change) = (Vector3::from(*vector), Vector3::from(*change));
    let square = vector.norm_squared();
    let half = sine_of_root(0.25 * square)[0];
    let across = vector.cross(&change);
    (change + across * (0.5 * half * half) + vector.cross(&across) * less_than_one(square)).into()
}

/// `T(ψ)⁻¹ ω`: the change of `ψ` where `exp(ψ)` spins with `ω`; for `|ψ| < 2π`.
pub fn change_by_spin(vector: &[f64; 3], spin: &[f64; 3]) -> [f64; 3] {
    let (vector, spin) = (Vector3::from(*vector), Vector3::from(*spin));
    let square = vector.norm_squared();
    let [sine, slope, ..] = sine_of_root(0.25 * square);
    // `(1 - (a/2) cot(a/2))/a²` of the angle `a`; the cosine of the half angle is `Z + 2 x Z'`.
    let factor =
        if square < 1e-6 { 1.0 / 12.0 + square / 720.0 } else { (1.0 - (sine + 0.5 * square * slope) / sine) / square };
    let across = vector.cross(&spin);
    (spin - across * 0.5 + vector.cross(&across) * factor).into()
}

/// `(1 - Z(x))/x`
fn less_than_one(x: f64) -> f64 {
    if x >= SERIES_BELOW {
        return (1.0 - sine_of_root(x)[0]) / x;
    }
    let coefficients: [f64; TERMS] = std::array::from_fn(|k| -sine_coefficient(k + 1));
    polynomial(&coefficients, x)[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_vector_near_another_counts_turns() {
        for vector in [[0.0; 3], [1e-9, 0.0, 2e-9], [0.3, -0.2, 0.9], [4.0 * PI, 1e-3, 0.0], [20.0, -3.0, 1.0]] {
            let near = vector.map(|part| part + 0.2);
            let found = vector_near(&quaternion(&vector), &near);
            (0..3).for_each(|k| assert!((found[k] - vector[k]).abs() < 1e-13, "{vector:?}: {found:?}"));
        }
        // Past a whole turn.
        let steps = (0..400).fold(([0.0; 3], Quaternion::identity()), |(total, turned), _| {
            let turned = quaternion(&[0.0, 0.1, 0.0]) * turned;
            (vector_near(&turned, &total), turned)
        });
        assert!((steps.0[1] - 40.0).abs() < 1e-12, "{steps:?}");
    }

    #[test]
    fn the_spin_is_the_derivative_of_the_rotation() {
        for scale in [1e-4, 0.3, 2.0] {
            let (vector, change) = ([0.3 * scale, -0.8 * scale, 0.5 * scale], [0.2, 0.7, -0.4]);
            let step = 1e-6;
            let moved = |sign: f64| quaternion(&std::array::from_fn(|k| vector[k] + sign * step * change[k]));
            let turned = vector_near(&(moved(1.0) * moved(-1.0).conjugate()), &[0.0; 3]);
            let found = spin(&vector, &change);
            let back = change_by_spin(&vector, &found);
            for k in 0..3 {
                assert!((turned[k] / (2.0 * step) - found[k]).abs() < 1e-9, "{scale}: {turned:?} {found:?}");
                assert!((back[k] - change[k]).abs() < 1e-13, "{scale}: {back:?}");
            }
        }
    }
}
