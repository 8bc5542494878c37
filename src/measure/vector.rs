//! Vectors of the measure: three components, the last of them 0 in two dimensions.

pub(super) type Vector = [f64; 3];

pub(super) const ZERO: Vector = [0.0; 3];

/// Of two or three components; what is missing is 0.
pub(super) fn padded(values: &[f64]) -> Vector {
    let mut vector = ZERO;
    vector.iter_mut().zip(values).for_each(|(to, from)| *to = *from);
    vector
}

/// `a + factor b`
pub(super) fn add(a: &Vector, factor: f64, b: &Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

pub(super) fn scaled(a: &Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn norm(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The largest component; one that is not a number is passed over.
pub(super) fn largest(a: &Vector) -> f64 {
    a[0].abs().max(a[1].abs()).max(a[2].abs())
}

/// Angle between two vectors, exact for small ones (W. Kahan, *How Futile are Mindless Assessments of Roundoff*, 2006,
/// section 12).
pub(super) fn angle(a: &Vector, b: &Vector) -> f64 {
    let (a, b) = (scaled(a, 1.0 / norm(a)), scaled(b, 1.0 / norm(b)));
    2.0 * norm(&add(&a, -1.0, &b)).atan2(norm(&add(&a, 1.0, &b)))
}
