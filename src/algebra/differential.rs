//! Numbers that carry their derivatives by `N` variables: of first order ([`WithGradient`]) or up to second order
//! ([`WithHessian`]), forward and exact. A plain number carries none.

use std::ops::{Add, Mul, Neg, Sub};

/// A number, with or without derivatives.
pub(crate) trait Differential:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    fn times(self, factor: f64) -> Self;
    /// A function of the number, by the function's value and its first two derivatives there.
    fn map(self, function: [f64; 3]) -> Self;

    fn plus(self, value: f64) -> Self {
        self + Self::constant(value)
    }

    fn reciprocal(self) -> Self {
        let inverse = self.value().recip();
        self.map([inverse, -inverse * inverse, 2.0 * inverse.powi(3)])
    }

    fn root(self) -> Self {
        let root = self.value().sqrt();
        self.map([root, 0.5 / root, -0.25 / root.powi(3)])
    }
}

impl Differential for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn times(self, factor: f64) -> Self {
        self * factor
    }
    fn map(self, function: [f64; 3]) -> Self {
        function[0]
    }
}

/// A number with its gradient.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WithGradient<const N: usize> {
    pub value: f64,
    pub gradient: [f64; N],
}

/// A number with its gradient and its Hessian.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WithHessian<const N: usize> {
    pub value: f64,
    pub gradient: [f64; N],
    pub hessian: [[f64; N]; N],
}

/// `a x + b y` of vectors.
#[inline(always)]
fn combined<const N: usize>(a: f64, x: &[f64; N], b: f64, y: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a * x[k] + b * y[k])
}

impl<const N: usize> WithGradient<N> {
    pub fn variable(value: f64, which: usize) -> Self {
        Self { value, gradient: std::array::from_fn(|k| if k == which { 1.0 } else { 0.0 }) }
    }

    fn sum(self, factor: f64, other: Self) -> Self {
        Self {
            value: self.value + factor * other.value,
            gradient: combined(1.0, &self.gradient, factor, &other.gradient),
        }
    }
}

impl<const N: usize> WithHessian<N> {
    pub fn variable(value: f64, which: usize) -> Self {
        let WithGradient { value, gradient } = WithGradient::variable(value, which);
        Self { value, gradient, hessian: [[0.0; N]; N] }
    }

    fn sum(mut self, factor: f64, other: &Self) -> Self {
        self.value += factor * other.value;
        self.gradient = combined(1.0, &self.gradient, factor, &other.gradient);
        self.hessian.iter_mut().zip(&other.hessian).for_each(|(row, other)| *row = combined(1.0, row, factor, other));
        self
    }
}

impl<const N: usize> Differential for WithGradient<N> {
    fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, gradient: self.gradient.map(|part| factor * part) }
    }
    fn map(self, function: [f64; 3]) -> Self {
        Self { value: function[0], gradient: self.gradient.map(|part| function[1] * part) }
    }
}

impl<const N: usize> Differential for WithHessian<N> {
    fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N], hessian: [[0.0; N]; N] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn times(mut self, factor: f64) -> Self {
        self.value *= factor;
        self.gradient.iter_mut().chain(self.hessian.iter_mut().flatten()).for_each(|part| *part *= factor);
        self
    }
    fn map(mut self, [value, first, second]: [f64; 3]) -> Self {
        for (row, along) in self.hessian.iter_mut().zip(&self.gradient) {
            *row = combined(first, row, second * along, &self.gradient);
        }
        self.value = value;
        self.gradient.iter_mut().for_each(|part| *part *= first);
        self
    }
}

impl<const N: usize> Mul for WithGradient<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let gradient = combined(other.value, &self.gradient, self.value, &other.gradient);
        Self { value: self.value * other.value, gradient }
    }
}

impl<const N: usize> Mul for WithHessian<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut hessian = [[0.0; N]; N];
        for (row, values) in hessian.iter_mut().enumerate() {
            let (one, two) = (&self.hessian[row], &other.hessian[row]);
            let (a, b) = (self.gradient[row], other.gradient[row]);
            for (column, value) in values.iter_mut().enumerate() {
                *value = (other.value * one[column] + self.value * two[column])
                    + (a * other.gradient[column] + b * self.gradient[column]);
            }
        }
        let gradient = combined(other.value, &self.gradient, self.value, &other.gradient);
        Self { value: self.value * other.value, gradient, hessian }
    }
}

macro_rules! sums {
    ($kind:ident, $($reference:tt)?) => {
        impl<const N: usize> Add for $kind<N> {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                self.sum(1.0, $($reference)? other)
            }
        }
        impl<const N: usize> Sub for $kind<N> {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                self.sum(-1.0, $($reference)? other)
            }
        }
        impl<const N: usize> Neg for $kind<N> {
            type Output = Self;
            fn neg(self) -> Self {
                self.times(-1.0)
            }
        }
    };
}
sums!(WithGradient,);
sums!(WithHessian, &);

/// `a · b`
pub(crate) fn dot<D: Differential>(a: &[D; 3], b: &[D; 3]) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`
pub(crate) fn cross<D: Differential>(a: &[D; 3], b: &[D; 3]) -> [D; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `f a`
pub(crate) fn scaled<D: Differential>(factor: D, a: &[D; 3]) -> [D; 3] {
    a.map(|part| factor * part)
}

/// `a + b`
pub(crate) fn added<D: Differential>(a: &[D; 3], b: &[D; 3]) -> [D; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// A quaternion: the real part, then the vector.
#[derive(Clone, Copy)]
pub(crate) struct DifferentialQuaternion<D>(pub D, pub [D; 3]);

impl<D: Differential> DifferentialQuaternion<D> {
    pub fn constant(real: f64, vector: [f64; 3]) -> Self {
        Self(D::constant(real), vector.map(D::constant))
    }

    pub fn conjugate(self) -> Self {
        Self(self.0, self.1.map(|part| -part))
    }

    pub fn after(&self, other: &Self) -> Self {
        let vector = added(&added(&scaled(self.0, &other.1), &scaled(other.0, &self.1)), &cross(&self.1, &other.1));
        Self(self.0 * other.0 - dot(&self.1, &other.1), vector)
    }
}
