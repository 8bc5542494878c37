//! Second-order cones in the linear system of a working set.
//!
//! A cone's vector `s = v + V d` is assumed to lie inside the cone (no row), at its apex (`s = 0`, multiplier `ζ ∈ K`)
//! or on its boundary. On the boundary, with `e = s_t/|s_t|` and `ζ = κ (1, -e)`, the conditions `s_0 = |s_t|` and
//! `H d + q = ... + Vᵀζ` are linearised at the last `d`: a row `(1, -e)·s = 0`, and, for the rotation of `e`, a block
//! `κ/|s_t| V_tᵀ (I - e eᵀ) V_t` added to the Hessian. This is Newton's method, which converges in a few solves where
//! linear rows need only one.
//!
//! Source: the treatment of the friction cone by P. W. Christensen, A. Klarbring, J. S. Pang and N. Strömberg,
//! Int. J. Numer. Meth. Engng 42 (1998), carried over to a quadratic program's rows.

use nalgebra::DVector;

use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::quadratic_program::interior_point::{ConeRows, QuadraticProgram, QuadraticSolution};

/// Additional solves for programs with cones, beyond those for changes of the working set.
pub const CORRECTIONS: usize = 6;

/// The assumed position of a cone's vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeState {
    Inside,
    Boundary,
    Apex,
}

impl ConeState {
    /// The state of a vector at zero step, before any multiplier is known.
    pub fn at_rest(values: &[f64], margin: f64) -> Self {
        if values.iter().all(|value| value.abs() <= margin) {
            Self::Apex
        } else if cone::slack(values) <= margin {
            Self::Boundary
        } else {
            Self::Inside
        }
    }

    /// The state from the position of the difference between a vector and its multiplier, both of limited accuracy.
    pub fn of_solution(values: &DVector<f64>, multiplier: &DVector<f64>) -> Self {
        let difference = values - multiplier;
        let size = cone::tangential_size(difference.as_slice());
        if difference[0] >= size {
            Self::Inside
        } else if difference[0] <= -size {
            Self::Apex
        } else {
            Self::Boundary
        }
    }
}

/// The linearisation of a cone on its boundary.
#[derive(Debug, Clone)]
struct Expansion {
    /// `e` after a leading zero.
    direction: DVector<f64>,
    /// `κ/|s_t|`; 0 where `κ` or `s_t` is not known yet.
    stiffness: f64,
}

impl Expansion {
    fn at(direction: DVector<f64>) -> Self {
        Self { direction, stiffness: 0.0 }
    }

    /// `(1, -e)`
    fn normal(&self) -> DVector<f64> {
        let mut normal = -&self.direction;
        normal[0] = 1.0;
        normal
    }

    /// `(I - e eᵀ) w` of the tangential part.
    fn across(&self, vector: &DVector<f64>) -> DVector<f64> {
        let mut across = vector - &self.direction * self.direction.dot(vector);
        across[0] = 0.0;
        across
    }
}

/// The linearisation of every cone at the last step.
#[derive(Debug, Clone)]
pub struct Expansions {
    step: DVector<f64>,
    cones: Vec<Expansion>,
}

impl Expansions {
    /// The linearisation at zero step.
    pub fn new(program: &QuadraticProgram) -> Self {
        let at = |cone: &ConeRows| Expansion::at(cone::direction(cone.values.as_slice()));
        Self { step: DVector::zeros(program.gradient.len()), cones: program.cones.iter().map(at).collect() }
    }

    /// Adds the terms from the rotation of the boundary's normals to the first rows of the system.
    pub fn add_curvature(
        &self,
        program: &QuadraticProgram,
        states: &[ConeState],
        entries: &mut Vec<(usize, usize, f64)>,
        right: &mut DVector<f64>,
    ) {
        for ((rows, state), expansion) in program.cones.iter().zip(states).zip(&self.cones) {
            if *state != ConeState::Boundary || expansion.stiffness == 0.0 {
                continue;
            }
            let moving = |&j: &usize| rows.rows.column(j).iter().any(|value| *value != 0.0);
            let across: Vec<(usize, DVector<f64>)> = (0..self.step.len())
                .filter(moving)
                .map(|j| (j, expansion.across(&rows.rows.column(j).clone_owned())))
                .collect();
            for (i, first) in &across {
                for (j, second) in &across {
                    let entry = expansion.stiffness * first.dot(second);
                    entries.push((*i, *j, entry));
                    right[*i] += entry * self.step[*j];
                }
            }
        }
    }

    /// The rows of cones at their boundary or apex, with their values at zero step.
    pub fn rows(&self, program: &QuadraticProgram, states: &[ConeState]) -> Vec<(DVector<f64>, f64)> {
        let mut found = Vec::new();
        for ((cone, state), expansion) in program.cones.iter().zip(states).zip(&self.cones) {
            match state {
                ConeState::Inside => {}
                ConeState::Boundary => {
                    let normal = expansion.normal();
                    found.push((cone.rows.tr_mul(&normal), normal.dot(&cone.values)));
                }
                ConeState::Apex => {
                    let rows = cone.rows.row_iter().zip(cone.values.iter());
                    found.extend(rows.map(|(row, value)| (row.transpose(), *value)));
                }
            }
        }
        found
    }

    /// The cones' multipliers from those of [`Self::rows`].
    pub fn multipliers(
        &self,
        program: &QuadraticProgram,
        states: &[ConeState],
        mut values: impl Iterator<Item = f64>,
    ) -> Vec<DVector<f64>> {
        let cones = program.cones.iter().zip(states).zip(&self.cones);
        let multiplier = |((cone, state), expansion): ((&ConeRows, &ConeState), &Expansion)| match state {
            ConeState::Inside => DVector::zeros(cone.values.len()),
            ConeState::Boundary => expansion.normal() * values.next().unwrap_or(0.0),
            ConeState::Apex => DVector::from_fn(cone.values.len(), |_, _| values.next().unwrap_or(0.0)),
        };
        cones.map(multiplier).collect()
    }

    /// Moves to the solution's step and revises the states; returns whether the system has to be solved again. If not,
    /// the solution's cone multipliers are those at its own step.
    ///
    /// `force` and `length` are the tolerances below which forces and lengths count as zero.
    pub fn revise(
        &mut self,
        program: &QuadraticProgram,
        solution: &mut QuadraticSolution,
        states: &mut [ConeState],
        force: f64,
        length: f64,
    ) -> bool {
        let mut again = false;
        for (i, cone) in program.cones.iter().enumerate() {
            let vector = cone.at(&solution.step);
            let length = length.max(1e-11 * cone.values.amax());
            let multiplier = &mut solution.cone_multipliers[i];
            let expansion = &mut self.cones[i];
            let next = match states[i] {
                ConeState::Inside if cone::slack(vector.as_slice()) >= -length => ConeState::Inside,
                ConeState::Inside => {
                    *expansion = Expansion::at(cone::direction(vector.as_slice()));
                    if expansion.direction.amax() == 0.0 { ConeState::Apex } else { ConeState::Boundary }
                }
                ConeState::Apex if cone::slack(multiplier.as_slice()) >= -force => ConeState::Apex,
                ConeState::Apex if multiplier[0] <= -cone::tangential_size(multiplier.as_slice()) => ConeState::Inside,
                ConeState::Apex => {
                    *expansion = Expansion::at(-cone::direction(multiplier.as_slice()));
                    ConeState::Boundary
                }
                ConeState::Boundary if multiplier[0] < -force => ConeState::Inside,
                ConeState::Boundary if vector[0] <= 0.0 => ConeState::Apex,
                ConeState::Boundary => {
                    let κ = multiplier[0].max(0.0);
                    let change = &cone.rows * (&solution.step - &self.step);
                    let linear = &*multiplier - expansion.across(&change) * expansion.stiffness;
                    let size = cone::tangential_size(vector.as_slice());
                    let stiffness = if size > length { κ / size } else { 0.0 };
                    *expansion = Expansion { direction: cone::direction(vector.as_slice()), stiffness };
                    *multiplier = expansion.normal() * κ;
                    again |= (&*multiplier - linear).amax() > force || cone::slack(vector.as_slice()).abs() > length;
                    ConeState::Boundary
                }
            };
            again |= next != states[i];
            states[i] = next;
        }
        self.step.copy_from(&solution.step);
        again
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complementarity::mpec::program::sparse_rows::SparseRows;
    use crate::complementarity::mpec::quadratic_program::active_set::{self, WorkingSet};
    use crate::complementarity::mpec::quadratic_program::interior_point::solve_interior;
    use crate::resources::cancel::CancelFlag;
    use nalgebra::DMatrix;

    /// The point of a cone nearest to `target`, in the norm with the given weights.
    fn nearest_in_cone(target: [f64; 3], weights: [f64; 3]) -> QuadraticProgram {
        let hessian = DMatrix::from_diagonal(&DVector::from_column_slice(&weights));
        let gradient = -&hessian * DVector::from_column_slice(&target);
        QuadraticProgram {
            hessian: SparseRows::from(&hessian),
            gradient,
            equality: SparseRows::zeros(0, 3),
            equality_values: DVector::zeros(0),
            inequality: SparseRows::zeros(0, 3),
            inequality_values: DVector::zeros(0),
            lower: DVector::repeat(3, f64::NEG_INFINITY),
            upper: DVector::repeat(3, f64::INFINITY),
            cones: vec![ConeRows { rows: DMatrix::identity(3, 3), values: DVector::zeros(3) }],
        }
    }

    #[test]
    fn the_working_set_gives_the_projection_to_round_off() {
        let mut solved = 0;
        for target in [[2.0, 0.5, 0.3], [-2.0, 0.5, 0.3], [0.3, 1.0, -0.4], [-0.3, 0.2, 1.0], [0.1, 2.0, 2.0]] {
            let program = nearest_in_cone(target, [1.0; 3]);
            let approximate = solve_interior(&program, &CancelFlag::default()).expect("a convex program");
            let expected = cone::projection(&target);
            assert!((&approximate.step - &expected).amax() < 1e-6, "{target:?}");
            let mut set = WorkingSet::of_solution(&program, &approximate);
            let exact = active_set::solve(&program, &mut set, 8).expect("solved");
            assert!((&exact.step - &expected).amax() < 1e-13, "{target:?}: {:e}", (&exact.step - &expected).amax());
            let multiplier = cone::projection(&target.map(|value| -value));
            assert!((&exact.cone_multipliers[0] - multiplier).amax() < 1e-11, "{target:?}");
            solved += 1;
        }
        assert_eq!(solved, 5);
    }

    /// With unequal weights there is no closed form: the Karush-Kuhn-Tucker conditions are checked instead.
    #[test]
    fn the_conditions_hold_with_unequal_weights_and_from_a_bad_guess() {
        let program = nearest_in_cone([0.3, 1.0, -0.4], [1.0, 3.0, 0.2]);
        let mut set = WorkingSet::at_rest(&program, 1e-7);
        assert_eq!(set.cones, [ConeState::Apex]);
        let solution = active_set::solve(&program, &mut set, 8).expect("solved");
        assert_eq!(set.cones, [ConeState::Boundary]);
        let (s, ζ) = (&solution.step, &solution.cone_multipliers[0]);
        assert!((&program.hessian * s + &program.gradient - ζ).amax() < 1e-11);
        assert!(cone::slack(s.as_slice()).abs() < 1e-12 && cone::slack(ζ.as_slice()) > -1e-12);
        assert!(s.dot(ζ).abs() < 1e-11);
    }
}
