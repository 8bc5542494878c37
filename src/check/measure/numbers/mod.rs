//! Vectors of the measure, with three components (in two dimensions the last one is 0), and numbers that carry their first
//! derivatives.

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

/// A number with its derivatives by `N` variables.
#[derive(Debug, Clone, Copy)]
pub(super) struct DualNumber<const N: usize = 3>(pub f64, pub [f64; N]);

impl<const N: usize> DualNumber<N> {
    pub fn constant(value: f64) -> Self {
        Self(value, [0.0; N])
    }

    pub fn variable(value: f64, which: usize) -> Self {
        Self(value, std::array::from_fn(|k| if k == which { 1.0 } else { 0.0 }))
    }

    pub fn times(self, factor: f64) -> Self {
        Self(self.0 * factor, self.1.map(|part| part * factor))
    }

    pub fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0, std::array::from_fn(|k| self.1[k] + other.1[k]))
    }

    pub fn minus(self, other: Self) -> Self {
        self.plus(other.times(-1.0))
    }

    pub fn by(self, other: Self) -> Self {
        Self(self.0 * other.0, std::array::from_fn(|k| self.0 * other.1[k] + self.1[k] * other.0))
    }

    pub fn over(self, other: Self) -> Self {
        let value = self.0 / other.0;
        Self(value, std::array::from_fn(|k| (self.1[k] - value * other.1[k]) / other.0))
    }

    /// A function of the number, by its value and its derivative there.
    pub fn map(self, value: f64, slope: f64) -> Self {
        Self(value, self.1.map(|part| part * slope))
    }

    /// The angle of the point (`self`, `other`), from the first axis.
    pub fn angle(self, other: Self) -> Self {
        let squared = self.0 * self.0 + other.0 * other.0;
        Self(other.0.atan2(self.0), std::array::from_fn(|k| (self.0 * other.1[k] - other.0 * self.1[k]) / squared))
    }
}
