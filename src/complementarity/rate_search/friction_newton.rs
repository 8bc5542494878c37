//! A semismooth Newton method for the velocities of nodes that touch without reaction, with Coulomb friction in space.
//!
//! With the reaction rates `Ṙ = K v + b`, stick, slip and separation of a node are one equation with any `ρ > 0`,
//!
//! ```text
//! Ṙ = proj(Ṙ - ρ (v + μ |v_t| n))
//! ```
//!
//! where `proj` is the projection on the friction cone (G. De Saxcé, Z.-Q. Feng, Math. Comput. Model. 28 (1998) 225,
//! doi:10.1016/S0895-7177(98)00119-8). Newton's method with a line search solves it (P. Alart, A. Curnier, Comput. Methods
//! Appl. Mech. Eng. 92 (1991) 353, doi:10.1016/0045-7825(91)90022-X); where it halts, some fixed-point iterations of the
//! same equation lead to another start. Other than sweeps over the nodes, this does not slow down where the nodes are
//! strongly coupled, as those of a solid are.

use crate::algebra::Factorisation;
use crate::resources::budget::{self, Taken};
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Largest number of Newton iterations from one start.
const MOST_ITERATIONS: usize = 60;
/// Largest number of halvings of one Newton step.
const MOST_HALVINGS: usize = 25;
/// Number of starts, the first without reactions.
const STARTS: usize = 4;
/// Fixed-point iterations from one start to the next.
const ITERATIONS_BETWEEN: usize = 100;
/// Least decrease of the residual by a Newton step, relative to that of the linearised equations.
const LEAST_DECREASE: f64 = 1e-4;
/// Residual, relative to the load, at which what each contact does is read off.
const RESIDUAL: f64 = 1e-9;
/// Distance from the border of the cone, and of its polar cone, up to which a node counts as inside.
const BORDER: f64 = 1e-9;

/// The law of some of the velocities.
pub(super) enum Law {
    /// A contact without friction, by its velocity.
    Frictionless(usize),
    /// A contact with friction, by its velocities (normal, first tangent, second tangent) and its coefficient.
    Friction([usize; 3], f64),
}

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Behaviour {
    Stick,
    Slip,
    Free,
}

/// Reaction rates over velocities, with their laws.
pub(super) struct FrictionEquations {
    stiffness: DMatrix<f64>,
    compliance: DMatrix<f64>,
    /// Each law with its `ρ`.
    laws: Vec<(Law, f64)>,
    _held: Taken,
}

/// A projection with its derivative.
struct ConeProjection {
    value: Vector3<f64>,
    derivative: Matrix3<f64>,
    behaviour: Behaviour,
}

impl FrictionEquations {
    /// `None` where the stiffness is singular.
    pub fn new(stiffness: DMatrix<f64>, laws: Vec<Law>) -> Option<Self> {
        let size = stiffness.nrows();
        // The stiffness, its inverse, and what the inversion works on.
        let held = budget::take::<f64>(3 * size * size);
        budget::spend(size * size * size);
        let compliance = stiffness.clone().try_inverse()?;
        let own = |law: &Law| match law {
            Law::Frictionless(column) => compliance[(*column, *column)].abs(),
            Law::Friction(columns, _) => {
                Matrix3::from_fn(|row, column| compliance[(columns[row], columns[column])]).norm()
            }
        };
        let steps: Vec<f64> = laws.iter().map(|law| 1.0 / own(law)).collect();
        let laws: Vec<(Law, f64)> = laws.into_iter().zip(steps).collect();
        laws.iter().all(|(_, step)| step.is_finite()).then_some(Self { stiffness, compliance, laws, _held: held })
    }

    /// The velocities under a load, the reaction rates at rest, with what each law's contact does.
    pub fn solve(&self, load: &DVector<f64>, cancel: &CancelFlag) -> Option<(DVector<f64>, Vec<Behaviour>)> {
        let small = RESIDUAL * load.norm();
        let mut velocities = -&self.compliance * load;
        for _ in 0..STARTS {
            if self.newton(&mut velocities, load, small, cancel)? {
                let reactions = &self.stiffness * &velocities + load;
                let of = |(law, step): &(Law, f64)| law.projected(&reactions, &velocities, *step).behaviour;
                return Some((velocities.clone(), self.laws.iter().map(of).collect()));
            }
            self.iterate(&mut velocities, load, cancel);
        }
        None
    }

    /// Newton's method; whether the equations hold at its end. `None` once cancelled.
    fn newton(
        &self,
        velocities: &mut DVector<f64>,
        load: &DVector<f64>,
        small: f64,
        cancel: &CancelFlag,
    ) -> Option<bool> {
        let size = load.len();
        let _held = budget::take::<f64>(2 * size * size);
        let mut residual = self.residual(velocities, load);
        for _ in 0..MOST_ITERATIONS {
            if cancel.is_cancelled() {
                return None;
            }
            if residual.norm() <= small {
                return Some(true);
            }
            budget::spend(size * size * size);
            let mut step = residual.clone();
            let Some(factorisation) = Factorisation::new(self.derivative(velocities, load)) else { return Some(false) };
            if !factorisation.solve(&mut step) {
                return Some(false);
            }
            let shorter = (0..MOST_HALVINGS).map(|halvings| 0.5_f64.powi(halvings as i32)).find_map(|share| {
                let next = &*velocities - &step * share;
                let left = self.residual(&next, load);
                (left.norm() <= (1.0 - LEAST_DECREASE * share) * residual.norm()).then_some((next, left))
            });
            let Some((next, left)) = shorter else { return Some(false) };
            (*velocities, residual) = (next, left);
        }
        Some(false)
    }

    /// Fixed-point iterations, with one `ρ` for all contacts; fewer once cancelled.
    fn iterate(&self, velocities: &mut DVector<f64>, load: &DVector<f64>, cancel: &CancelFlag) {
        let step = 1.0 / self.compliance.norm();
        let mut reactions = &self.stiffness * &*velocities + load;
        for _ in 0..ITERATIONS_BETWEEN {
            if cancel.is_cancelled() {
                return;
            }
            budget::spend(self.compliance.len());
            let before = reactions.clone();
            for (law, _) in &self.laws {
                law.set(&mut reactions, &law.projected(&before, velocities, step).value);
            }
            *velocities = &self.compliance * (&reactions - load);
        }
    }

    fn residual(&self, velocities: &DVector<f64>, load: &DVector<f64>) -> DVector<f64> {
        let reactions = &self.stiffness * velocities + load;
        let mut residual = reactions.clone();
        for (law, step) in &self.laws {
            let left = law.values(&reactions) - law.projected(&reactions, velocities, *step).value;
            law.set(&mut residual, &left);
        }
        residual
    }

    fn derivative(&self, velocities: &DVector<f64>, load: &DVector<f64>) -> DMatrix<f64> {
        let reactions = &self.stiffness * velocities + load;
        let mut derivative = self.stiffness.clone();
        for (law, step) in &self.laws {
            let projection = law.projected(&reactions, velocities, *step).derivative;
            let by_velocity = projection * law.corrected_derivative(velocities) * *step;
            let columns = law.columns();
            for (row, own) in columns.iter().enumerate() {
                for (part, other) in columns.iter().enumerate() {
                    let share = projection[(row, part)];
                    if share != 0.0 {
                        let taken = self.stiffness.row(*other) * share;
                        derivative.row_mut(*own).zip_apply(&taken, |value, taken| *value -= taken);
                    }
                    derivative[(*own, *other)] += by_velocity[(row, part)];
                }
            }
        }
        derivative
    }
}

impl Law {
    fn columns(&self) -> &[usize] {
        match self {
            Self::Frictionless(column) => std::slice::from_ref(column),
            Self::Friction(columns, _) => columns,
        }
    }

    fn values(&self, of: &DVector<f64>) -> Vector3<f64> {
        let mut values = Vector3::zeros();
        self.columns().iter().enumerate().for_each(|(place, column)| values[place] = of[*column]);
        values
    }

    fn set(&self, of: &mut DVector<f64>, values: &Vector3<f64>) {
        self.columns().iter().enumerate().for_each(|(place, column)| of[*column] = values[place]);
    }

    /// `v + μ |v_t| n`
    fn corrected(&self, velocities: &DVector<f64>) -> Vector3<f64> {
        let mut velocity = self.values(velocities);
        if let Self::Friction(_, friction) = self {
            velocity[0] += friction * velocity[1].hypot(velocity[2]);
        }
        velocity
    }

    fn corrected_derivative(&self, velocities: &DVector<f64>) -> Matrix3<f64> {
        let mut derivative = Matrix3::identity();
        let velocity = self.values(velocities);
        let speed = velocity[1].hypot(velocity[2]);
        if let Self::Friction(_, friction) = self
            && speed > 0.0
        {
            (derivative[(0, 1)], derivative[(0, 2)]) = (friction * velocity[1] / speed, friction * velocity[2] / speed);
        }
        derivative
    }

    /// The projection of `Ṙ - ρ (v + μ |v_t| n)` on the cone.
    fn projected(&self, reactions: &DVector<f64>, velocities: &DVector<f64>, step: f64) -> ConeProjection {
        let point = self.values(reactions) - self.corrected(velocities) * step;
        let of = |value, derivative, behaviour| ConeProjection { value, derivative, behaviour };
        let Self::Friction(_, friction) = self else {
            return if point[0] > 0.0 {
                of(point, Matrix3::identity(), Behaviour::Stick)
            } else {
                of(Vector3::zeros(), Matrix3::zeros(), Behaviour::Free)
            };
        };
        let traction = point[1].hypot(point[2]);
        let border = BORDER * point.norm();
        let behaviour = if traction - friction * point[0] <= border {
            Behaviour::Stick
        } else if friction * traction + point[0] <= border {
            Behaviour::Free
        } else {
            Behaviour::Slip
        };
        if traction <= friction * point[0] {
            return of(point, Matrix3::identity(), behaviour);
        }
        if friction * traction <= -point[0] {
            return of(Vector3::zeros(), Matrix3::zeros(), behaviour);
        }
        let (first, second) = (point[1] / traction, point[2] / traction);
        let share = 1.0 / (1.0 + friction * friction);
        let normal = share * (point[0] + friction * traction);
        let edge = Vector3::new(1.0, friction * first, friction * second);
        let around = Vector3::new(0.0, -second, first);
        let derivative = edge * edge.transpose() * share + around * around.transpose() * (friction * normal / traction);
        of(edge * normal, derivative, behaviour)
    }
}

#[cfg(test)]
mod tests {
    use super::{Behaviour, FrictionEquations, Law};
    use crate::complementarity::rate_search::tests::Random;
    use crate::resources::cancel::CancelFlag;
    use nalgebra::{DMatrix, DVector};

    /// Two equal nodes that move easily together and hardly against each other: each slips as one node on the soft spring.
    #[test]
    fn equal_nodes_slip_together() {
        let (friction, soft, stiff) = (0.3, 1.0, 1e7);
        let stiffness = DMatrix::from_fn(6, 6, |row, column| match (row % 3 == column % 3, row / 3 == column / 3) {
            (true, true) => 0.5 * (soft + stiff),
            (true, false) => 0.5 * (soft - stiff),
            (false, _) => 0.0,
        });
        let laws = vec![Law::Friction([0, 1, 2], friction), Law::Friction([3, 4, 5], friction)];
        let equations = FrictionEquations::new(stiffness, laws).expect("regular");
        let load = DVector::from_vec(vec![2.0, 0.6, 0.8, 2.0, 0.6, 0.8]);
        let (velocities, behaviours) = equations.solve(&load, &CancelFlag::default()).expect("a solution");
        assert_eq!(behaviours, [Behaviour::Slip; 2]);
        let speed = (1.0 - friction * 2.0) / soft;
        for (found, exact) in velocities.iter().zip([0.0, -0.6, -0.8].into_iter().cycle()) {
            assert!((found - speed * exact).abs() <= 1e-8, "{velocities}");
        }
        let pressed = DVector::from_vec(vec![4.0, 0.06, 0.08, -1.0, 0.06, 0.08]);
        let (velocities, behaviours) = equations.solve(&pressed, &CancelFlag::default()).expect("a solution");
        assert_eq!(behaviours, [Behaviour::Stick, Behaviour::Free], "{velocities}");
    }

    /// The laws of contact and friction for random stiffnesses with condition numbers up to 1e5.
    #[test]
    fn random_nodes_keep_the_laws() {
        let (mut solved, mut behaved) = (0, [0; 3]);
        for seed in 0..60 {
            let mut random = Random::new(seed);
            let (nodes, pairs) = (2 + random.below(6) as usize, random.below(3) as usize);
            let size = 3 * nodes + pairs;
            let (modes, _) = DMatrix::from_fn(size, size, |_, _| random.value()).qr().unpack();
            let own = DVector::from_fn(size, |_, _| 10.0_f64.powf(2.5 * random.value()));
            let stiffness = &modes * DMatrix::from_diagonal(&own) * modes.transpose();
            let load = DVector::from_fn(size, |row, _| if row % 3 == 0 { 10.0 } else { 0.0 } + 10.0 * random.value());
            let friction = [0.1, 0.3, 0.6][seed as usize % 3];
            let mut laws: Vec<Law> =
                (0..nodes).map(|node| Law::Friction([3 * node, 3 * node + 1, 3 * node + 2], friction)).collect();
            laws.extend((3 * nodes..size).map(Law::Frictionless));
            let equations = FrictionEquations::new(stiffness.clone(), laws).expect("regular");
            let Some((velocities, behaviours)) = equations.solve(&load, &CancelFlag::default()) else { continue };
            solved += 1;
            let reactions = &stiffness * &velocities + &load;
            let [force, speed] = [load.norm(), velocities.norm()].map(|scale| 1e-7 * scale);
            for (node, behaviour) in behaviours[..nodes].iter().enumerate() {
                behaved[*behaviour as usize] += 1;
                let [reaction, velocity] =
                    [&reactions, &velocities].map(|of| of.fixed_rows::<3>(3 * node).into_owned());
                let traction = reaction.fixed_rows::<2>(1).norm();
                assert!(friction * reaction[0] - traction >= -force, "seed {seed}, node {node}");
                assert!(velocity[0] >= -speed, "seed {seed}, node {node}");
                let (slip, drag) = (velocity.fixed_rows::<2>(1), reaction.fixed_rows::<2>(1));
                match behaviour {
                    Behaviour::Stick => assert!(velocity.norm() <= speed, "seed {seed}, node {node}"),
                    Behaviour::Free => assert!(reaction.norm() <= force, "seed {seed}, node {node}"),
                    Behaviour::Slip => {
                        assert!(velocity[0] <= speed && (traction - friction * reaction[0]).abs() <= force);
                        assert!(
                            (slip.dot(&drag) + slip.norm() * drag.norm()).abs() <= force * slip.norm() + speed * force
                        );
                    }
                }
            }
            for pair in 3 * nodes..size {
                assert!(reactions[pair] >= -force && velocities[pair] >= -speed, "seed {seed}, pair {pair}");
                assert!(reactions[pair] <= force || velocities[pair] <= speed, "seed {seed}, pair {pair}");
            }
        }
        assert!(solved >= 57, "{solved} of 60");
        assert!(behaved.iter().all(|count| *count >= 15), "{behaved:?}");
    }
}
