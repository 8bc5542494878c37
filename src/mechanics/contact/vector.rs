//! Vectors in space; in 2D the third component is 0.
//!
//! Plain arrays, because requests, checkpoints and increments store the same numbers as arrays: a vector type of a
//! library would be converted at each of these places, for the half dozen operations below.

/// A vector with three components.
pub type Vector = [f64; 3];

/// `a·b`
#[inline]
pub fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`
#[inline]
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + factor b`
#[inline]
pub fn add(a: &Vector, factor: f64, b: &Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

/// `factor a`
#[inline]
pub fn scaled(a: &Vector, factor: f64) -> Vector {
    [factor * a[0], factor * a[1], factor * a[2]]
}

/// Euclidean norm.
#[inline]
pub fn size(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a/|a|`; zero for the zero vector.
#[inline]
pub fn unit(a: &Vector) -> Vector {
    let size = size(a);
    if size > 0.0 { [a[0] / size, a[1] / size, a[2] / size] } else { [0.0; 3] }
}

/// Up to three components of any length but 0, made a unit vector in space without overflow.
pub(crate) fn unit_of(values: &[f64]) -> Vector {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let size = values.iter().map(|value| (value / largest).powi(2)).sum::<f64>().sqrt() * largest;
    let mut unit = [0.0; 3];
    unit.iter_mut().zip(values).for_each(|(component, value)| *component = value / size);
    unit
}

/// The unit vector opposite to a traction; `otherwise` for zero traction.
pub(crate) fn direction_of(traction: &Vector, otherwise: &Vector) -> Vector {
    let length = size(traction);
    if length > 0.0 { scaled(traction, -1.0 / length) } else { *otherwise }
}
