//! Tensors of second and fourth order in three dimensions, as arrays.

/// A tensor of second order; first index: the row.
pub type Tensor2 = [[f64; 3]; 3];

/// A tensor of second order as a vector: the component `(i, J)` stands at `3 i + J`.
pub type Flat = [f64; 9];

/// A tensor of fourth order: the component `(i, J, k, L)` stands in row `3 i + J` and column `3 k + L`.
pub type Tensor4 = [[f64; 9]; 9];

/// The identity of second order.
pub const IDENTITY: Tensor2 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The components row by row.
#[inline(always)]
pub fn flat(a: &Tensor2) -> Flat {
    std::array::from_fn(|place| a[place / 3][place % 3])
}

/// The tensor of components row by row.
#[inline(always)]
pub fn unflat(a: &Flat) -> Tensor2 {
    std::array::from_fn(|row| std::array::from_fn(|column| a[3 * row + column]))
}

/// `a + factor b`.
#[inline(always)]
pub fn sum(a: &Tensor2, factor: f64, b: &Tensor2) -> Tensor2 {
    std::array::from_fn(|row| std::array::from_fn(|column| a[row][column] + factor * b[row][column]))
}

/// `factor a`.
#[inline(always)]
pub fn scaled(factor: f64, a: &Tensor2) -> Tensor2 {
    a.map(|row| row.map(|value| factor * value))
}

/// `a b`.
#[inline(always)]
pub fn product(a: &Tensor2, b: &Tensor2) -> Tensor2 {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| a[row][0] * b[0][column] + a[row][1] * b[1][column] + a[row][2] * b[2][column])
    })
}

/// `aᵀ`.
#[inline(always)]
pub fn transpose(a: &Tensor2) -> Tensor2 {
    std::array::from_fn(|row| std::array::from_fn(|column| a[column][row]))
}

/// `tr a`.
#[inline(always)]
pub fn trace(a: &Tensor2) -> f64 {
    a[0][0] + a[1][1] + a[2][2]
}

/// `a : b`, the sum of the products of the components.
#[inline(always)]
pub fn contraction(a: &Tensor2, b: &Tensor2) -> f64 {
    a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).sum()
}

/// The cofactors `∂(det a)/∂a`, which are `(det a) a⁻ᵀ`.
#[inline(always)]
pub fn cofactor(a: &Tensor2) -> Tensor2 {
    let minor = |r: usize, s: usize, c: usize, d: usize| a[r][c] * a[s][d] - a[r][d] * a[s][c];
    [
        [minor(1, 2, 1, 2), minor(1, 2, 2, 0), minor(1, 2, 0, 1)],
        [minor(2, 0, 1, 2), minor(2, 0, 2, 0), minor(2, 0, 0, 1)],
        [minor(0, 1, 1, 2), minor(0, 1, 2, 0), minor(0, 1, 0, 1)],
    ]
}

/// The second invariant `½ (tr² a - tr a²)`.
#[inline(always)]
pub fn second_invariant(a: &Tensor2) -> f64 {
    trace(&cofactor(a))
}

/// `det a`.
#[inline(always)]
pub fn determinant(a: &Tensor2) -> f64 {
    let cofactor = cofactor(a);
    a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2]
}

/// `det(1 + h) - 1`, which keeps its digits where `h` is small.
#[inline(always)]
pub fn volume_change(gradient: &Tensor2) -> f64 {
    trace(gradient) + (second_invariant(gradient) + determinant(gradient))
}

/// Green's strain `½ (h + hᵀ + hᵀ h)` of a displacement gradient, which keeps its digits where `h` is small.
#[inline(always)]
pub fn green_strain(gradient: &Tensor2) -> Tensor2 {
    let square = product(&transpose(gradient), gradient);
    std::array::from_fn(|row| {
        std::array::from_fn(|column| 0.5 * (gradient[row][column] + gradient[column][row] + square[row][column]))
    })
}

/// The deviator `a - ⅓ (tr a) 1`.
#[inline(always)]
pub fn deviator(a: &Tensor2) -> Tensor2 {
    sum(a, -trace(a) / 3.0, &IDENTITY)
}

/// Adds `factor a_iJ b_kL`.
#[inline(always)]
pub fn add_dyad(tensor: &mut Tensor4, factor: f64, a: &Flat, b: &Flat) {
    for (row, a) in tensor.iter_mut().zip(a) {
        for (value, b) in row.iter_mut().zip(b) {
            *value += factor * a * b;
        }
    }
}

/// Adds `factor a_iL b_kJ`.
#[inline(always)]
pub fn add_crossed(tensor: &mut Tensor4, factor: f64, a: &Tensor2, b: &Tensor2) {
    for (place, row) in tensor.iter_mut().enumerate() {
        let (i, j) = (place / 3, place % 3);
        for (k, values) in row.chunks_exact_mut(3).enumerate() {
            let scale = factor * b[k][j];
            values.iter_mut().zip(&a[i]).for_each(|(value, a)| *value += scale * a);
        }
    }
}

/// Adds `factor a_ik b_JL`.
#[inline(always)]
pub fn add_product(tensor: &mut Tensor4, factor: f64, a: &Tensor2, b: &Tensor2) {
    for (place, row) in tensor.iter_mut().enumerate() {
        let (i, j) = (place / 3, place % 3);
        for (k, values) in row.chunks_exact_mut(3).enumerate() {
            let scale = factor * a[i][k];
            values.iter_mut().zip(&b[j]).for_each(|(value, b)| *value += scale * b);
        }
    }
}

/// `tensor : a`, contracted over the last two indices.
#[inline(always)]
pub fn applied(tensor: &Tensor4, a: &Flat) -> Flat {
    std::array::from_fn(|row| tensor[row].iter().zip(a).map(|(value, a)| value * a).sum())
}

/// Below this size the functions of this file take the power series.
const SERIES_BELOW: f64 = 0.05;

/// `ln(1 + x) - x`, which keeps its digits where `x` is small.
pub fn logarithm_remainder(x: f64) -> f64 {
    if x.abs() >= SERIES_BELOW {
        return x.ln_1p() - x;
    }
    // -x²/2 + x³/3 - ...; the last term is below 1e-17 of the first.
    let sum = (2..=14).rev().fold(0.0, |sum, power| 1.0 / f64::from(power) - x * sum);
    -x * x * sum
}

/// `exp(x) - 1 - x`, which keeps its digits where `x` is small.
pub fn exponential_remainder(x: f64) -> f64 {
    if x.abs() >= SERIES_BELOW {
        return x.exp_m1() - x;
    }
    let sum = (3..=11).rev().fold(0.0, |sum, power| (1.0 + sum) * x / f64::from(power));
    0.5 * x * x * (1.0 + sum)
}
