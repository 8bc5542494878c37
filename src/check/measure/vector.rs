//! Vectors of the measure, with three components; in two dimensions the last component is 0.

use nalgebra::Vector3;

pub(super) type MeasuredVector = Vector3<f64>;

/// A vector of two or three components; a missing component is 0.
pub(super) fn padded(values: &[f64]) -> MeasuredVector {
    let mut vector = MeasuredVector::zeros();
    vector.iter_mut().zip(values).for_each(|(to, from)| *to = *from);
    vector
}

/// The largest absolute value of a component; NaN is ignored.
pub(super) fn largest(a: &MeasuredVector) -> f64 {
    a.x.abs().max(a.y.abs()).max(a.z.abs())
}

/// Angle between two vectors, accurate for small angles (W. Kahan, *How Futile are Mindless Assessments of Roundoff*,
/// 2006, section 12).
pub(super) fn angle(a: &MeasuredVector, b: &MeasuredVector) -> f64 {
    let (a, b) = (a * (1.0 / a.norm()), b * (1.0 / b.norm()));
    2.0 * (a - b).norm().atan2((a + b).norm())
}
