//! Simultaneous onset of slip at several touching contacts in space, each in its own unknown direction.
//!
//! For a rising and for a falling load, the velocities are found by sweeps over the contacts, each solved exactly with
//! the others fixed (nonlinear Gauss-Seidel, as in `rates`): with the reaction rate `Ṙ = K v + b` of one node,
//!
//! ```text
//! stick: v = 0, |b_t| <= μ b_n        free: K v = -b, v_n >= 0
//! slip:  v = λ d,  λ = -(μ b_n + d·b_t)/(d·K d + μ n·K d) > 0,  Ṙ_n >= 0,  d⊥·(λ K d + b) = 0
//! ```
//!
//! with the angles of `d` from a scan of the circle. The pattern on which the sweeps settle is solved by Newton's
//! method in the weights and the angles, to round-off, and kept if it satisfies every inequality. Sweeps start from all
//! combinations of the solutions of each contact alone, up to a bound. Where the contacts are uncoupled, these are all
//! directions; otherwise completeness is not claimed. Where no sweeps settle, as where the contacts are those of a solid,
//! the pattern is found by `friction_newton`.

use crate::algebra::Factorisation;
use crate::algebra::scalar_root::find_root;
use crate::complementarity::rate_search::branch_and_bound::Ray;
use crate::complementarity::rate_search::friction_newton::{Behaviour, FrictionEquations, Law};
use crate::complementarity::rate_search::slip_onset_direction::{SECTORS, Touch, Turning};
use crate::complementarity::rate_search::tolerances::{COEFFICIENT_ROUND_OFF, RATE_TOLERANCE, SETTLED_CHANGE};
use crate::complementarity::rates::cartesian_product::{combinations, count};
use crate::complementarity::rates::gauss_seidel::{Local, rising};
use crate::complementarity::rates::rate_problem::{RateProblem, Signed, own_column};
use crate::complementarity::rates::ray_of_combination;
use crate::resources::budget;
use crate::resources::cancel::CancelFlag;
use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector2, Vector3};
use std::f64::consts::TAU;

/// The rays found, and whether they are all.
pub(crate) struct AtOnce {
    pub rays: Vec<Turning>,
    /// Whether these are all rays.
    pub complete: bool,
}

/// Largest number of combinations of the contacts' separate solutions from which the sweeps start.
const MOST_STARTS: u64 = 64;
/// Largest number of sweeps from one start.
const MOST_SWEEPS: usize = 2000;
/// Largest number of Newton iterations.
const MOST_ITERATIONS: usize = 30;

/// The behaviour of a touching node.
#[derive(Clone, Copy, PartialEq)]
enum Own {
    Stick,
    Free,
    Slip { angle: f64 },
}

/// The rays found by the sweeps along which touching entities slip.
pub(crate) fn slips(problem: &RateProblem, touches: &[Touch], cancel: &CancelFlag) -> AtOnce {
    let nothing = AtOnce { rays: Vec::new(), complete: false };
    let Some(rising) = rising(problem) else { return nothing };
    let Some(system) = SlipEquations::new(problem, touches) else { return nothing };
    let mut complete = system.is_decoupled();
    let mut rays: Vec<Turning> = Vec::new();
    for load in [rising, -rising] {
        let mut weights = DVector::zeros(problem.weights());
        weights[problem.weights() - 1] = load;
        let alone: Vec<Vec<NodeSolution>> = system.nodes.iter().map(|node| node.solutions(problem, &weights)).collect();
        let places: Vec<Vec<usize>> = alone.iter().map(|one| (0..one.len().max(1)).collect()).collect();
        complete &= count(&places) <= MOST_STARTS;
        let mut has_settled = false;
        for chosen in combinations(&places, MOST_STARTS) {
            if cancel.is_cancelled() {
                return AtOnce { rays, complete: false };
            }
            let mut start = weights.clone();
            for ((node, solutions), place) in system.nodes.iter().zip(&alone).zip(chosen) {
                if let Some(solution) = solutions.get(place) {
                    node.place(&mut start, solution);
                }
            }
            let found = system.swept(start, cancel).and_then(|(pattern, start)| system.refined(pattern, start));
            let Some(found) = found else {
                complete = false;
                continue;
            };
            has_settled = true;
            keep(&mut rays, found);
        }
        if !has_settled
            && let Some((pattern, start)) = system.by_newton(&weights, cancel)
            && let Some(found) = system.refined(pattern, start)
        {
            keep(&mut rays, found);
        }
    }
    AtOnce { rays, complete }
}

/// Adds a ray with slips that is not yet there.
fn keep(rays: &mut Vec<Turning>, found: Turning) {
    let known =
        |one: &Turning| (&one.ray.weights - &found.ray.weights).amax() <= RATE_TOLERANCE * found.ray.weights.amax();
    if !found.slips.is_empty() && !rays.iter().any(known) {
        rays.push(found);
    }
}

/// A touching node with the columns of its velocities.
struct TouchingNode<'a> {
    touch: &'a Touch,
    columns: [usize; 3],
    /// Reaction rates per unit of the node's own velocities, (normal, first tangent, second tangent).
    stiffness: Matrix3<f64>,
}

/// A solution of one node with the others fixed.
#[derive(Clone, Copy)]
struct NodeSolution {
    own: Own,
    velocity: Vector3<f64>,
}

/// The behaviour of every entity: an option, or that of a touching node.
struct OptionPattern {
    chosen: Vec<usize>,
    own: Vec<Own>,
}

/// The derivatives of an equation: with respect to the weights, and to the angle in a column.
type EquationGradient = (DVector<f64>, Option<(usize, f64)>);

struct SlipEquations<'a> {
    problem: &'a RateProblem,
    nodes: Vec<TouchingNode<'a>>,
    /// The other entities.
    others: Vec<(usize, Local)>,
}

impl<'a> SlipEquations<'a> {
    /// The equations of a problem; `None` where some entity is not a plain contact.
    fn new(problem: &'a RateProblem, touches: &'a [Touch]) -> Option<Self> {
        let node = |touch: &'a Touch| {
            let [normal, first, second] = touch.velocities.map(|form| own_column(problem, form));
            let columns = [normal?, first?, second?];
            let stiffness = Matrix3::from_fn(|row, column| problem.forms[(touch.forces[row], columns[column])]);
            Some(TouchingNode { touch, columns, stiffness })
        };
        let nodes = touches.iter().map(node).collect::<Option<Vec<_>>>()?;
        let is_other = |entity: &usize| touches.iter().all(|touch| touch.entity != *entity);
        let others = (0..problem.entities.len())
            .filter(is_other)
            .map(|entity| Some((entity, Local::of(problem, &problem.entities[entity])?)))
            .collect::<Option<Vec<_>>>()?;
        Some(Self { problem, nodes, others })
    }

    /// Whether there are touching nodes only, uncoupled, and each resists any slip: then nothing moves without the
    /// load, and the solutions of each node alone are all its solutions.
    fn is_decoupled(&self) -> bool {
        let last = self.problem.weights() - 1;
        let apart = |node: &TouchingNode<'_>| {
            let rows = node.touch.forces.map(|form| self.problem.forms.row(form));
            let largest = rows.iter().fold(0.0_f64, |largest, row| largest.max(row.amax()));
            let others = (0..last).filter(|column| !node.columns.contains(column));
            others.into_iter().all(|column| rows.iter().all(|row| row[column].abs() <= COEFFICIENT_ROUND_OFF * largest))
        };
        self.others.is_empty() && self.nodes.iter().all(|node| apart(node) && node.resists())
    }

    /// Sweeps until the velocities settle.
    fn swept(&self, mut weights: DVector<f64>, cancel: &CancelFlag) -> Option<(OptionPattern, DVector<f64>)> {
        let mut pattern =
            OptionPattern { chosen: vec![0; self.problem.entities.len()], own: vec![Own::Stick; self.nodes.len()] };
        for _ in 0..MOST_SWEEPS {
            if cancel.is_cancelled() {
                return None;
            }
            budget::spend(self.problem.forms.len());
            let before = weights.clone();
            for (node, own) in self.nodes.iter().zip(&mut pattern.own) {
                let velocity = node.velocity(&weights);
                let solutions = node.solutions(self.problem, &weights);
                let nearest = solutions
                    .into_iter()
                    .min_by(|a, b| (a.velocity - velocity).norm().total_cmp(&(b.velocity - velocity).norm()))?;
                node.place(&mut weights, &nearest);
                *own = nearest.own;
            }
            for (entity, local) in &self.others {
                pattern.chosen[*entity] = local.solve(&self.problem.forms, &mut weights)?;
            }
            let change = (&weights - &before).amax();
            if !change.is_finite() {
                return None;
            }
            if change <= SETTLED_CHANGE * weights.amax() {
                return Some((pattern, weights));
            }
        }
        None
    }

    /// The pattern by a semismooth Newton method, which strongly coupled nodes do not slow down.
    fn by_newton(&self, weights: &DVector<f64>, cancel: &CancelFlag) -> Option<(OptionPattern, DVector<f64>)> {
        let count = weights.len() - 1;
        let mut forces = vec![usize::MAX; count];
        let mut laws = Vec::with_capacity(self.nodes.len() + self.others.len());
        for node in &self.nodes {
            node.columns.iter().zip(node.touch.forces).for_each(|(column, force)| forces[*column] = force);
            laws.push(Law::Friction(node.columns, node.touch.friction));
        }
        for (_, local) in &self.others {
            let Local::Pair { force, velocity } = *local else { return None };
            forces[velocity] = force;
            laws.push(Law::Frictionless(velocity));
        }
        if forces.contains(&usize::MAX) {
            return None;
        }
        let _held = budget::take::<f64>(2 * count * count);
        let rows = self.problem.forms.select_rows(&forces);
        let load = rows.column(count) * weights[count];
        let equations = FrictionEquations::new(rows.columns(0, count).into_owned(), laws)?;
        let (velocities, behaviours) = equations.solve(&load, cancel)?;
        let mut pattern = OptionPattern { chosen: vec![0; self.problem.entities.len()], own: Vec::new() };
        for (node, behaviour) in self.nodes.iter().zip(&behaviours) {
            pattern.own.push(match behaviour {
                Behaviour::Stick => Own::Stick,
                Behaviour::Free => Own::Free,
                Behaviour::Slip => {
                    let [_, first, second] = node.columns.map(|column| velocities[column]);
                    Own::Slip { angle: second.atan2(first) }
                }
            });
        }
        for ((entity, _), behaviour) in self.others.iter().zip(&behaviours[self.nodes.len()..]) {
            pattern.chosen[*entity] = usize::from(*behaviour == Behaviour::Free);
        }
        let mut found = weights.clone();
        found.rows_mut(0, count).copy_from(&velocities);
        Some((pattern, found))
    }

    /// Applies Newton's method to weights and angles; returns the ray if it satisfies all inequalities.
    fn refined(&self, mut pattern: OptionPattern, mut weights: DVector<f64>) -> Option<Turning> {
        let count = weights.len();
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let (matrix, mut values) = self.equations(&pattern, &weights)?;
            if !Factorisation::new(matrix)?.solve(&mut values) {
                return None;
            }
            weights -= values.rows(0, count);
            let mut next = count;
            for own in &mut pattern.own {
                if let Own::Slip { angle } = own {
                    *angle -= values[next];
                    next += 1;
                }
            }
            let change = values.amax() / weights.amax().max(1.0);
            if change >= 0.5 * smallest && change < RATE_TOLERANCE {
                return self.ray(&pattern, &weights);
            }
            smallest = smallest.min(change);
            if change == 0.0 {
                return self.ray(&pattern, &weights);
            }
        }
        None
    }

    /// Values and derivatives of the equations of a pattern; the last weight is fixed.
    fn equations(&self, pattern: &OptionPattern, weights: &DVector<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let count = weights.len();
        let angles = pattern.own.iter().filter(|own| matches!(own, Own::Slip { .. })).count();
        let _rows = budget::take::<f64>(count * (count + angles));
        budget::spend(4 * count * (count + angles));
        let mut rows: Vec<EquationGradient> = Vec::new();
        let plain = |form: usize| (self.problem.forms.row(form).transpose(), None);
        for (entity, _) in &self.others {
            let zero = &self.problem.entities[*entity].options[pattern.chosen[*entity]].zero;
            rows.extend(zero.iter().map(|form| plain(*form)));
        }
        let mut next = count;
        for (node, own) in self.nodes.iter().zip(&pattern.own) {
            let Touch { velocities, forces, friction, .. } = node.touch;
            match own {
                Own::Stick => rows.extend(velocities.map(plain)),
                Own::Free => rows.extend(forces.map(plain)),
                Own::Slip { angle } => {
                    let (sine, cosine) = angle.sin_cos();
                    let form = |forms: &[usize; 3], parts: [f64; 3]| {
                        (0..3).fold(DVector::zeros(count), |sum, k| {
                            sum + self.problem.forms.row(forms[k]).transpose() * parts[k]
                        })
                    };
                    let (along, across) = ([0.0, cosine, sine], [0.0, -sine, cosine]);
                    let value = |forms: &[usize; 3], parts: [f64; 3]| form(forms, parts).dot(weights);
                    let drag = value(forces, along);
                    rows.push(plain(velocities[0]));
                    rows.push((form(velocities, across), Some((next, -value(velocities, along)))));
                    rows.push((form(forces, [*friction, cosine, sine]), Some((next, value(forces, across)))));
                    rows.push((form(forces, across), Some((next, -drag))));
                    next += 1;
                }
            }
        }
        let size = count + angles;
        if rows.len() + 1 != size {
            return None;
        }
        let _held = budget::take::<f64>(size * size);
        let (mut matrix, mut values) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for (place, (row, by_angle)) in rows.iter().enumerate() {
            matrix.view_mut((place, 0), (1, count)).copy_from(&row.transpose());
            if let Some((column, value)) = by_angle {
                matrix[(place, *column)] = *value;
            }
            values[place] = row.dot(weights);
        }
        matrix[(size - 1, count - 1)] = 1.0;
        Some((matrix, values))
    }

    fn ray(&self, pattern: &OptionPattern, weights: &DVector<f64>) -> Option<Turning> {
        let size = ray_of_combination::size(self.problem, weights);
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        let weights = weights / size;
        let along = ray_of_combination::forms_along(self.problem, &weights);
        let force = along.force_tolerance();
        let mut chosen = pattern.chosen.clone();
        let mut slips = Vec::new();
        let mut weak = false;
        for (node, own) in self.nodes.iter().zip(&pattern.own) {
            let velocity = node.velocity(&weights);
            let forces = node.forces(self.problem, &weights);
            let traction = forces.fixed_rows::<2>(1).norm();
            // The quantity that must not be negative, relative to the tolerance for zero.
            let least = match own {
                Own::Stick => (node.touch.friction * forces[0] - traction) / force,
                Own::Free => velocity[0] / RATE_TOLERANCE,
                Own::Slip { angle } => {
                    (node.touch.motion(self.problem, &weights, *angle) / RATE_TOLERANCE).min(forces[0] / force)
                }
            };
            // A slip within the tolerance is stick, or separation.
            let bound = if matches!(own, Own::Slip { .. }) { 1.0 } else { -1.0 };
            if least < bound {
                return None;
            }
            weak |= least <= 1.0;
            // A slipping node is pressed like a sticking node.
            chosen[node.touch.entity] = usize::from(*own == Own::Free);
            if let Own::Slip { angle } = own {
                slips.push((node.touch.entity, [angle.cos(), angle.sin()]));
            }
        }
        if !along.violated(&chosen).is_empty() {
            return None;
        }
        let slipping = |entity: &usize| slips.iter().any(|(slipping, _)| slipping == entity);
        let own_alone = |mut options: Vec<Vec<usize>>| {
            (0..options.len()).filter(slipping).for_each(|entity| options[entity] = vec![0]);
            options
        };
        let fitting = own_alone(along.fitting(&chosen));
        let in_doubt = own_alone(along.in_doubt(&chosen));
        weak |= self.others.iter().any(|(entity, _)| {
            let bounds = &self.problem.entities[*entity].options[chosen[*entity]].nonnegative;
            let value = |signed: &Signed| signed.sign * self.problem.forms.row(signed.form).transpose().dot(&weights);
            let is_force = &self.problem.is_force;
            let tolerance = |form: usize| if is_force[form] { force } else { along.velocity_tolerance(form) };
            bounds.iter().any(|signed| value(signed) <= tolerance(signed.form))
        });
        Some(Turning { ray: Ray { weights, fitting, in_doubt, weak }, slips })
    }
}

impl TouchingNode<'_> {
    fn velocity(&self, weights: &DVector<f64>) -> Vector3<f64> {
        Vector3::from(self.columns.map(|column| weights[column]))
    }

    fn place(&self, weights: &mut DVector<f64>, solution: &NodeSolution) {
        self.columns.iter().zip(solution.velocity.iter()).for_each(|(column, value)| weights[*column] = *value);
    }

    fn forces(&self, problem: &RateProblem, weights: &DVector<f64>) -> Vector3<f64> {
        Vector3::from(self.touch.forces.map(|form| problem.forms.row(form).transpose().dot(weights)))
    }

    /// The tangential stiffness, and the normal stiffness against tangential motion.
    fn parts(&self) -> (Matrix2<f64>, Vector2<f64>) {
        (self.stiffness.fixed_view::<2, 2>(1, 1).into_owned(), self.stiffness.fixed_view::<1, 2>(0, 1).transpose())
    }

    /// `d·K d + μ n·K d`
    fn resistance(&self, direction: &Vector2<f64>) -> f64 {
        let (tangential, normal) = self.parts();
        direction.dot(&(tangential * direction)) + self.touch.friction * normal.dot(direction)
    }

    /// Whether slip in any direction, and any motion, is resisted.
    fn resists(&self) -> bool {
        let (tangential, normal) = self.parts();
        let least = ((tangential + tangential.transpose()) * 0.5).symmetric_eigenvalues().min();
        let symmetric = (self.stiffness + self.stiffness.transpose()) * 0.5;
        least > self.touch.friction * normal.norm() && symmetric.symmetric_eigenvalues().min() > 0.0
    }

    /// All solutions of the node with the others fixed.
    fn solutions(&self, problem: &RateProblem, weights: &DVector<f64>) -> Vec<NodeSolution> {
        let mut held = weights.clone();
        self.columns.iter().for_each(|column| held[*column] = 0.0);
        let load = self.forces(problem, &held);
        let size = load.amax();
        let friction = self.touch.friction;
        let traction = load.fixed_rows::<2>(1).into_owned();
        let mut found = Vec::new();
        if friction * load[0] - traction.norm() >= -COEFFICIENT_ROUND_OFF * size {
            found.push(NodeSolution { own: Own::Stick, velocity: Vector3::zeros() });
        }
        let at = |angle: f64| {
            let direction = Vector2::new(angle.cos(), angle.sin());
            let across = Vector2::new(-direction[1], direction[0]);
            let (tangential, normal) = self.parts();
            let (resistance, excess) = (self.resistance(&direction), -(friction * load[0] + direction.dot(&traction)));
            let misfit = across.dot(&(tangential * direction)) * excess + across.dot(&traction) * resistance;
            let speed = excess / resistance;
            (misfit, speed, load[0] + speed * normal.dot(&direction))
        };
        let mut before = at(0.0).0;
        for sector in 1..=SECTORS {
            let bounds = [sector - 1, sector].map(|number| TAU * number as f64 / SECTORS as f64);
            let after = at(bounds[1]).0;
            let crosses = before == 0.0 || before * after < 0.0;
            let angle = if before == 0.0 {
                Some(bounds[0])
            } else if crosses {
                find_root(|angle| Some(at(angle).0), (bounds[0], before), (bounds[1], after), 0.0)
            } else {
                None
            };
            before = after;
            let Some(angle) = angle else { continue };
            let (_, speed, pressed) = at(angle);
            if speed > 0.0 && speed.is_finite() && pressed > COEFFICIENT_ROUND_OFF * size {
                let velocity = Vector3::new(0.0, speed * angle.cos(), speed * angle.sin());
                found.push(NodeSolution { own: Own::Slip { angle }, velocity });
            }
        }
        if let Some(velocity) = self.stiffness.lu().solve(&-load)
            && velocity[0] >= -COEFFICIENT_ROUND_OFF * velocity.amax()
        {
            found.push(NodeSolution { own: Own::Free, velocity });
        }
        found
    }
}
