//! Exact plane beams: Reissner's equations along a member, integrated to rounding error.
//!
//! A member carries the constant internal force `F` (exerted by the part beyond a section on the part before it). With
//! the tangent's angle `θ`, `N = F·t`, `Q = F·n`, and the stress-free curvature `κ0`
//!
//! ```text
//! x' = (1 + N/EA) cos θ - Q/GA sin θ    θ' = κ0 + M/EI
//! y' = (1 + N/EA) sin θ + Q/GA cos θ    M' = y' Fx - x' Fy
//! ```
//!
//! (E. Reissner, J. Appl. Math. Phys. 23 (1972) 795, doi 10.1007/BF01602645). Gauss's collocation with four stages, of
//! order eight, integrates the equations (E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, Springer
//! 1996, section IV.5).

/// Number of steps along a member; the error of a member is then some 1e-15.
const STEPS: u32 = 40;
/// Largest number of fixed-point iterations of a step.
const ITERATIONS: usize = 60;

/// Stiffnesses of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamSection {
    /// EA, a force.
    pub axial: f64,
    /// EI, a force times a length squared.
    pub bending: f64,
    /// 1/GA; 0 without shear.
    pub shear_flexibility: f64,
}

impl BeamSection {
    /// `EI = 1`, without shear.
    pub fn slender(axial: f64) -> Self {
        Self { axial, bending: 1.0, shear_flexibility: 0.0 }
    }
}

/// A section's place, the angle of its tangent (radians) and its bending moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionState {
    pub x: f64,
    pub y: f64,
    pub angle: f64,
    pub moment: f64,
}

/// A member of constant section and constant stress-free curvature, without loads between its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamMember {
    pub section: BeamSection,
    pub length: f64,
    /// Stress-free curvature, positive where the angle grows.
    pub curvature: f64,
}

impl BeamMember {
    /// The last section of the member, from the first one and the internal force.
    pub fn end(&self, start: SectionState, force: [f64; 2]) -> SectionState {
        let rule = Collocation::new();
        let step = self.length / f64::from(STEPS);
        let mut state = [start.x, start.y, start.angle, start.moment];
        for _ in 0..STEPS {
            state = rule.step(state, step, |state| self.derivative(state, force));
        }
        let [x, y, angle, moment] = state;
        SectionState { x, y, angle, moment }
    }

    fn derivative(&self, [_, _, angle, moment]: [f64; 4], [fx, fy]: [f64; 2]) -> [f64; 4] {
        let (sine, cosine) = angle.sin_cos();
        let stretch = 1.0 + (fx * cosine + fy * sine) / self.section.axial;
        let shear = (fy * cosine - fx * sine) * self.section.shear_flexibility;
        let (x, y) = (stretch * cosine - shear * sine, stretch * sine + shear * cosine);
        [x, y, self.curvature + moment / self.section.bending, y * fx - x * fy]
    }
}

/// Gauss's collocation with four stages.
struct Collocation {
    weights: [f64; 4],
    stages: [[f64; 4]; 4],
}

impl Collocation {
    fn new() -> Self {
        let outer = (3.0 / 7.0 + 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt();
        let inner = (3.0 / 7.0 - 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt();
        let places = [-outer, -inner, inner, outer].map(|place| 0.5 + 0.5 * place);
        let root = 30.0_f64.sqrt();
        let weights = [-root, root, root, -root].map(|root| (18.0 + root) / 72.0);
        // The integral of each Lagrange polynomial up to each place; the rule itself integrates it exactly.
        let lagrange = |j: usize, at: f64| {
            (0..4).filter(|k| *k != j).map(|k| (at - places[k]) / (places[j] - places[k])).product::<f64>()
        };
        let integral = |i: usize, j: usize| {
            places[i] * (0..4).map(|k| weights[k] * lagrange(j, places[i] * places[k])).sum::<f64>()
        };
        Self { weights, stages: std::array::from_fn(|i| std::array::from_fn(|j| integral(i, j))) }
    }

    fn step(&self, state: [f64; 4], step: f64, derivative: impl Fn([f64; 4]) -> [f64; 4]) -> [f64; 4] {
        let moved = |slopes: &[[f64; 4]; 4], weights: &[f64; 4]| -> [f64; 4] {
            std::array::from_fn(|k| state[k] + step * (0..4).map(|j| weights[j] * slopes[j][k]).sum::<f64>())
        };
        let mut slopes = [derivative(state); 4];
        for _ in 0..ITERATIONS {
            let next = self.stages.map(|weights| derivative(moved(&slopes, &weights)));
            let change = |(new, old): (&f64, &f64)| (new - old).abs() / (1.0 + new.abs());
            let most = next.iter().flatten().zip(slopes.iter().flatten()).map(change).fold(0.0, f64::max);
            slopes = next;
            if most <= 4.0 * f64::EPSILON {
                break;
            }
        }
        moved(&slopes, &self.weights)
    }
}
