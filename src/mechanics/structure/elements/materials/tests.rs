//! Materials against hyper-dual numbers, whose derivatives are exact, and against closed forms.

use super::linear_elastic::LinearElastic;
use super::mooney_rivlin::MooneyRivlin;
use super::neo_hookean::NeoHookean;
use super::saint_venant_kirchhoff::SaintVenantKirchhoff;
use super::tensor::{
    IDENTITY, contraction, exponential_remainder, logarithm_remainder, product, scaled, sum, transpose,
};
use super::*;
use std::ops::{Add, Mul, Sub};

/// `a + b ε₁ + c ε₂ + d ε₁ε₂` with `ε₁² = ε₂² = 0` (J. A. Fike, J. J. Alonso, AIAA 2011-886): `d` is a second derivative.
#[derive(Clone, Copy)]
struct HyperDual([f64; 4]);

impl HyperDual {
    /// A function from its value and its first two derivatives.
    fn of(self, value: f64, first: f64, second: f64) -> Self {
        let [_, b, c, d] = self.0;
        Self([value, first * b, first * c, first * d + second * b * c])
    }

    fn ln(self) -> Self {
        let a = self.0[0];
        self.of(a.ln(), 1.0 / a, -1.0 / (a * a))
    }

    fn powf(self, power: f64) -> Self {
        let a = self.0[0];
        let slope = power * a.powf(power - 1.0);
        self.of(a.powf(power), slope, (power - 1.0) * slope / a)
    }
}

impl From<f64> for HyperDual {
    fn from(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0])
    }
}

impl Add for HyperDual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for HyperDual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self::from(-1.0) * other
    }
}

impl Mul for HyperDual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self([a * p, a * q + b * p, a * r + c * p, a * s + b * r + c * q + d * p])
    }
}

type Gradient = [[HyperDual; 3]; 3];

fn number(value: f64) -> HyperDual {
    value.into()
}

/// `C = Fᵀ F`, `I₁`, `I₂`, `J` as the textbook has them.
fn invariants(f: &Gradient) -> (Gradient, HyperDual, HyperDual, HyperDual) {
    let total = |of: &dyn Fn(usize) -> HyperDual| of(0) + of(1) + of(2);
    let right: Gradient = std::array::from_fn(|i| std::array::from_fn(|j| total(&|k| f[k][i] * f[k][j])));
    let one = total(&|i| right[i][i]);
    let square = total(&|i| total(&|j| right[i][j] * right[j][i]));
    let two = number(0.5) * (one * one - square);
    let minor = |a: usize, b: usize| f[1][a] * f[2][b] - f[1][b] * f[2][a];
    let volume = f[0][0] * minor(1, 2) + f[0][1] * minor(2, 0) + f[0][2] * minor(0, 1);
    (right, one, two, volume)
}

const MODULI: ElasticModuli = ElasticModuli { shear: 1.3, lame: 2.9 };
const NEARLY_INCOMPRESSIBLE: ElasticModuli = ElasticModuli { shear: 1.0, lame: 4999.0 };
const CONSTANTS: [f64; 3] = [0.7, 0.4, 5.0];

type Energy = Box<dyn Fn(&Gradient) -> HyperDual>;

fn neo_hookean_energy(moduli: ElasticModuli) -> Energy {
    Box::new(move |f| {
        let (_, one, _, volume) = invariants(f);
        let change = volume - number(1.0);
        number(0.5 * moduli.shear) * (one - number(3.0)) - number(moduli.shear) * volume.ln()
            + number(0.5 * moduli.lame) * change * change
    })
}

/// Every material with its energy written anew.
fn materials() -> Vec<(Box<dyn ElasticMaterial>, Energy)> {
    let quadratic = |strain: Gradient| {
        let trace = strain[0][0] + strain[1][1] + strain[2][2];
        let square = strain.iter().flatten().fold(number(0.0), |total, value| total + *value * *value);
        number(0.5 * MODULI.lame) * trace * trace + number(MODULI.shear) * square
    };
    let kronecker = |i: usize, j: usize| number(if i == j { 1.0 } else { 0.0 });
    let mooney: Energy = Box::new(|f| {
        let (_, one, two, volume) = invariants(f);
        let [first, second, bulk] = CONSTANTS;
        number(first) * (volume.powf(-2.0 / 3.0) * one - number(3.0))
            + number(second) * (volume.powf(-4.0 / 3.0) * two - number(3.0))
            + number(0.25 * bulk) * (volume * volume - number(1.0) - number(2.0) * volume.ln())
    });
    let [first, second, bulk] = CONSTANTS;
    let mooney_rivlin = MooneyRivlin::new(first, second, bulk).unwrap();
    vec![
        (
            Box::new(LinearElastic { moduli: MODULI }),
            Box::new(move |f: &Gradient| {
                quadratic(std::array::from_fn(|i| {
                    std::array::from_fn(|j| number(0.5) * (f[i][j] + f[j][i]) - kronecker(i, j))
                }))
            }),
        ),
        (
            Box::new(SaintVenantKirchhoff { moduli: MODULI }),
            Box::new(move |f: &Gradient| {
                let (right, ..) = invariants(f);
                quadratic(std::array::from_fn(|i| {
                    std::array::from_fn(|j| number(0.5) * (right[i][j] - kronecker(i, j)))
                }))
            }),
        ),
        (Box::new(NeoHookean { moduli: MODULI }), neo_hookean_energy(MODULI)),
        (Box::new(NeoHookean { moduli: NEARLY_INCOMPRESSIBLE }), neo_hookean_energy(NEARLY_INCOMPRESSIBLE)),
        (Box::new(mooney_rivlin), mooney),
    ]
}

const GRADIENTS: [Tensor2; 4] = [
    [[0.1, -0.3, 0.2], [0.25, -0.15, 0.05], [-0.4, 0.3, 0.35]],
    [[1.2, 0.4, -0.1], [-0.3, 0.7, 0.2], [0.5, -0.6, 1.5]],
    [[-0.5, 0.1, 0.05], [0.02, -0.4, 0.1], [0.0, 0.2, -0.3]],
    [[-1.6, 0.7, 0.1], [-0.8, -1.7, 0.3], [0.1, 0.2, 0.1]],
];

#[test]
fn stress_and_tangent_are_the_derivatives_of_the_energy() {
    for (material, energy) in materials() {
        for gradient in GRADIENTS {
            assert!(tensor::volume_change(&gradient) > -0.9);
            let (stress, tangent) = (material.stress(&gradient), material.tangent(&gradient));
            let largest = tangent.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
            for row in 0..9 {
                for column in 0..9 {
                    let mut f = sum(&gradient, 1.0, &IDENTITY).map(|row| row.map(number));
                    f[row / 3][row % 3].0[1] = 1.0;
                    f[column / 3][column % 3].0[2] = 1.0;
                    let [value, first, _, second] = energy(&f).0;
                    let scale = 1e-12 * largest;
                    assert!((material.energy_density(&gradient) - value).abs() <= scale, "{material:?}");
                    assert!((stress[row / 3][row % 3] - first).abs() <= scale, "{material:?} {row}");
                    assert!((tangent[row][column] - second).abs() <= scale, "{material:?} {row} {column}");
                }
            }
        }
    }
}

#[test]
fn at_rest_there_is_no_stress_and_the_tangent_is_that_of_linear_elasticity() {
    for (material, _) in materials() {
        let rest = [[0.0; 3]; 3];
        assert_eq!(material.energy_density(&rest), 0.0);
        assert_eq!(material.stress(&rest), rest);
        let linear = LinearElastic { moduli: material.moduli() }.tangent(&rest);
        for (row, of_linear) in material.tangent(&rest).iter().zip(&linear) {
            for (value, of_linear) in row.iter().zip(of_linear) {
                assert!((value - of_linear).abs() <= 1e-14 * linear[0][0], "{material:?} {value} {of_linear}");
            }
        }
    }
}

#[test]
fn tiny_strains_keep_their_digits() {
    for (material, _) in materials() {
        let linear = LinearElastic { moduli: material.moduli() };
        let tiny = scaled(1e-13, &GRADIENTS[0]);
        let (stress, of_linear) = (material.stress(&tiny), linear.stress(&tiny));
        let largest = of_linear.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (value, of_linear) in stress.iter().flatten().zip(of_linear.iter().flatten()) {
            assert!((value - of_linear).abs() <= 1e-11 * largest, "{material:?}: {value:e} {of_linear:e}");
        }
        let (energy, of_linear) = (material.energy_density(&tiny), linear.energy_density(&tiny));
        assert!((energy - of_linear).abs() <= 1e-11 * of_linear, "{material:?}: {energy:e} {of_linear:e}");
    }
}

/// The rotation by an angle about `(1, 2, 2)/3`, by Rodrigues' formula.
fn rotation(angle: f64) -> Tensor2 {
    let [x, y, z] = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    let spin = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    sum(&sum(&IDENTITY, angle.sin(), &spin), 1.0 - angle.cos(), &product(&spin, &spin))
}

#[test]
fn a_rotation_turns_the_stress_and_keeps_the_energy() {
    let turn = rotation(2.1);
    for (material, _) in materials().iter().filter(|(material, _)| !material.is_linear()) {
        for gradient in GRADIENTS {
            let deformation = sum(&gradient, 1.0, &IDENTITY);
            let turned = |f: &Tensor2| sum(f, -1.0, &IDENTITY);
            let scale = 1e-13 * material.tangent(&gradient)[0][0].abs().max(1.0) * 10.0;
            let energy = material.energy_density(&gradient);
            let ahead = turned(&product(&turn, &deformation));
            assert!((material.energy_density(&ahead) - energy).abs() <= scale);
            let difference = sum(&material.stress(&ahead), -1.0, &product(&turn, &material.stress(&gradient)));
            assert!(contraction(&difference, &difference).sqrt() <= scale);
            // Isotropy: the body is turned before it is deformed.
            let before = turned(&product(&deformation, &transpose(&turn)));
            assert!((material.energy_density(&before) - energy).abs() <= scale);
        }
    }
}

#[test]
fn homogeneous_states_meet_their_closed_forms() {
    let ElasticModuli { shear, lame } = MODULI;
    let near =
        |value: f64, exact: f64| assert!((value - exact).abs() <= 1e-12 * exact.abs().max(1.0), "{value} {exact}");
    let [one, two, three] = [1.7, 0.8, 1.1_f64];
    let stretched = [[one - 1.0, 0.0, 0.0], [0.0, two - 1.0, 0.0], [0.0, 0.0, three - 1.0]];
    let sheared = |by: f64| [[0.0, by, 0.0], [0.0; 3], [0.0; 3]];
    let by = 0.9;
    // Saint Venant-Kirchhoff: P_11 = λ₁ S_11; in simple shear E_12 = γ/2, E_22 = γ²/2.
    let material = SaintVenantKirchhoff { moduli: MODULI };
    let green = |stretch: f64| 0.5 * (stretch * stretch - 1.0);
    let second = lame * (green(one) + green(two) + green(three)) + 2.0 * shear * green(one);
    near(material.stress(&stretched)[0][0], one * second);
    let normal = 0.5 * by * by * (lame + 2.0 * shear);
    near(material.stress(&sheared(by))[0][1], shear * by + by * normal);
    // Neo-Hooke: P_11 = G (λ₁ - 1/λ₁) + λ (J - 1) J/λ₁; in simple shear P_12 = G γ, no volume change.
    let material = NeoHookean { moduli: MODULI };
    let volume = one * two * three;
    near(material.stress(&stretched)[0][0], shear * (one - 1.0 / one) + lame * (volume - 1.0) * volume / one);
    near(material.stress(&sheared(by))[0][1], shear * by);
    // Mooney-Rivlin: principal Cauchy stress; in simple shear σ_12 = 2 (C₁ + C₂) γ.
    let [first, other, bulk] = CONSTANTS;
    let material = MooneyRivlin::new(first, other, bulk).unwrap();
    let (squares, fourths) = (volume.powf(-2.0 / 3.0), volume.powf(-4.0 / 3.0));
    let [a, b, c] = [one, two, three].map(|stretch| stretch * stretch);
    let deviatoric = |own: f64, all: [f64; 3]| own - all.iter().sum::<f64>() / 3.0;
    let distortion = 2.0 * first * squares * deviatoric(a, [a, b, c])
        + 2.0 * other * fourths * deviatoric(a * (b + c), [a * (b + c), b * (a + c), c * (a + b)]);
    near(material.stress(&stretched)[0][0], (distortion + 0.5 * bulk * (volume * volume - 1.0)) / one);
    near(material.stress(&sheared(by))[0][1], 2.0 * (first + other) * by);
}

#[test]
fn remainders_agree_on_both_sides_of_the_series() {
    for x in [-0.0501, -0.0499, 0.0499, 0.0501_f64] {
        assert!((logarithm_remainder(x) - (x.ln_1p() - x)).abs() <= 1e-13 * x * x);
        assert!((exponential_remainder(x) - (x.exp_m1() - x)).abs() <= 1e-13 * x * x);
    }
    assert!((logarithm_remainder(1e-9) + 0.5e-18).abs() <= 1e-27);
    assert!((exponential_remainder(1e-9) - 0.5e-18).abs() <= 1e-27);
}

#[test]
fn constants_out_of_range_are_refused() {
    assert_eq!(ElasticModuli::from_young(0.0, 0.3), Err(MaterialError::Young(0.0)));
    assert_eq!(ElasticModuli::from_young(1.0, 0.5), Err(MaterialError::Poisson(0.5)));
    assert!(MooneyRivlin::new(0.0, 0.0, 1.0).is_err() && MooneyRivlin::new(1.0, 0.0, -1.0).is_err());
    let moduli = ElasticModuli::from_young(2.0, 0.4999).unwrap();
    assert!((moduli.young() - 2.0).abs() < 1e-12 && (moduli.poisson() - 0.4999).abs() < 1e-12);
}
