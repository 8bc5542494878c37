//! The functions of the increment and their derivatives, in the form that the MPEC solver requires.

use crate::complementarity::mpec::{Problem, SparseRows};
use crate::mechanics::contact::Frame;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::equilibrium;
use crate::mechanics::problem::state::State;
use crate::step::increment_mpec::{InReach, IncrementProgram, tangent_components};
use nalgebra::{DMatrix, DVector};

/// Contacts with friction.
fn rough<'a>(program: &'a IncrementProgram<'_>) -> impl Iterator<Item = &'a InReach> {
    program.reach.iter().filter(|entry| entry.friction.is_rough())
}

/// Contacts with friction whose cone is a second-order cone.
fn coned<'a>(program: &'a IncrementProgram<'_>) -> impl Iterator<Item = &'a InReach> {
    program.reach.iter().filter(|entry| entry.tangents == 2)
}

/// Contacts with friction whose cone is polyhedral.
fn split<'a>(program: &'a IncrementProgram<'_>) -> impl Iterator<Item = &'a InReach> {
    program.reach.iter().filter(|entry| entry.tangents == 1)
}

/// Slip along each tangent as a combination of variables: `(variable, factor)`.
fn slip_terms(entry: &InReach, tangent: usize) -> impl Iterator<Item = (usize, f64)> {
    let terms = if entry.tangents == 2 { [Some((entry.slip(tangent), 1.0)), None] } else { entry.parts().map(Some) };
    terms.into_iter().flatten()
}

/// Writes an entry, unless it is zero.
fn put(rows: &mut SparseRows, place: (usize, usize), value: f64) {
    if value != 0.0 {
        rows[place] = value;
    }
}

impl Problem for IncrementProgram<'_> {
    fn variables(&self) -> usize {
        self.variables
    }

    fn equalities(&self) -> usize {
        self.loading.structure.unknowns() + self.reach.iter().map(|entry| entry.tangents).sum::<usize>()
    }

    fn inequalities(&self) -> usize {
        0
    }

    fn pairs(&self) -> usize {
        self.reach.len() + 2 * split(self).count()
    }

    fn cone_sizes(&self) -> Vec<usize> {
        coned(self).map(|_| 3).collect()
    }

    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let mut lower = DVector::repeat(self.variables, f64::NEG_INFINITY);
        for entry in &self.reach {
            lower[entry.normal()] = 0.0;
        }
        for entry in split(self) {
            for (part, _) in entry.parts() {
                lower[part] = 0.0;
            }
        }
        let mut upper = DVector::repeat(self.variables, f64::INFINITY);
        for unknown in 0..=self.loading.structure.unknowns() {
            (lower[unknown], upper[unknown]) = (-self.most_motion, self.most_motion);
        }
        (lower, upper)
    }

    fn objective(&self, x: &DVector<f64>) -> f64 {
        let structure = self.loading.structure;
        let (mut squared, mut forward) = (0.0, 0.0);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            squared += x[unknown] * x[unknown];
            forward += x[unknown] * self.forward.displacement[*freedom];
        }
        let load = x[structure.unknowns()];
        squared += load * load;
        forward += load * self.forward.load;
        let dissipated: f64 = rough(self).map(|entry| self.dissipation_of(entry, x)).sum();
        0.5 * self.arc_weight * squared - self.forward_weight * forward + dissipated
    }

    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>) {
        let structure = self.loading.structure;
        gradient.fill(0.0);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            gradient[unknown] =
                self.arc_weight * x[unknown] - self.forward_weight * self.forward.displacement[*freedom];
        }
        let load = structure.unknowns();
        gradient[load] = self.arc_weight * x[load] - self.forward_weight * self.forward.load;
        for entry in rough(self) {
            for tangent in 0..entry.tangents {
                for (variable, factor) in slip_terms(entry, tangent) {
                    gradient[variable] = factor * entry.traction[tangent];
                }
            }
        }
    }

    fn equality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        let structure = self.loading.structure;
        let state = self.state(x);
        let mut force = vec![0.0; structure.freedoms()];
        equilibrium::write_unbalanced(self.loading, &state, &mut force);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            values[unknown] = force[*freedom] / self.force;
        }
        let mut row = structure.unknowns();
        for entry in &self.reach {
            let frame = self.loading.frame(entry.contact, &state);
            let tangents = entry.tangents_at(&frame);
            let motion = self.motion_at(entry, &state, x);
            for (unknown, column) in self.columns_of(entry, &state) {
                values[unknown] -= x[entry.normal()] * dot(&frame.normal, &column);
                for t in 0..entry.tangents {
                    values[unknown] -= x[entry.tangential(t)] * dot(&tangents[t], &column);
                }
            }
            for (t, motion) in motion.into_iter().enumerate().take(entry.tangents) {
                values[row] = slip_terms(entry, t).fold(motion, |rest, (variable, factor)| rest - factor * x[variable]);
                row += 1;
            }
        }
    }

    fn equality_jacobian(&self, x: &DVector<f64>, jacobian: &mut SparseRows) {
        let structure = self.loading.structure;
        let state = self.state(x);
        let unknowns = structure.unknowns();
        let scale = self.step / self.force;
        let support_rate = |freedom: usize| self.loading.support_rate(freedom);
        {
            let mut add = structure.over_unknowns(support_rate, |row, column, value| jacobian[(row, column)] += value);
            structure.each_stiffness(&state.displacement, &mut |row, column, value| add(row, column, scale * value));
        }
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            let force = self.loading.pattern.forces[*freedom];
            if force != 0.0 {
                jacobian[(unknown, unknowns)] -= force * scale;
            }
        }
        let mut row = unknowns;
        for entry in &self.reach {
            let frame = self.loading.frame(entry.contact, &state);
            let tangents = entry.tangents_at(&frame);
            let driven = tangent_components::components(&entry.frame, &self.loading.driven(entry.contact, &state));
            for (unknown, column) in self.columns_of(entry, &state) {
                put(jacobian, (unknown, entry.normal()), -dot(&frame.normal, &column));
                for (t, (here, held)) in tangents.iter().zip(&entry.frame.tangents).enumerate().take(entry.tangents) {
                    put(jacobian, (unknown, entry.tangential(t)), -dot(here, &column));
                    put(jacobian, (row + t, unknown), dot(held, &column));
                }
            }
            for (t, driven) in driven.into_iter().enumerate().take(entry.tangents) {
                put(jacobian, (row, unknowns), driven);
                for (variable, factor) in slip_terms(entry, t) {
                    jacobian[(row, variable)] = -factor;
                }
                row += 1;
            }
            if !frame.curvature.is_zero() {
                add_turn_of_reaction(self, entry, (&frame, &state), x, jacobian);
            }
            add_curvature_of_motion(self, entry, (&frame, &state), x, jacobian);
        }
    }

    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        let state = self.state(x);
        let mut pair = 0;
        for entry in &self.reach {
            first[pair] = self.loading.gap(entry.contact, &state) / self.step;
            second[pair] = x[entry.normal()];
            pair += 1;
            if entry.tangents == 1 {
                let bound = entry.friction.bound(x[entry.normal()]);
                for (part, side) in entry.parts() {
                    first[pair] = (bound + side * x[entry.tangential(0)]) / (1.0 + entry.friction.coefficient);
                    second[pair] = x[part];
                    pair += 1;
                }
            }
        }
    }

    fn pair_jacobians(&self, x: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows) {
        let state = self.state(x);
        let load = self.loading.structure.unknowns();
        let mut pair = 0;
        for entry in &self.reach {
            let normal = self.loading.frame(entry.contact, &state).normal;
            for (unknown, column) in self.columns_of(entry, &state) {
                put(first, (pair, unknown), dot(&normal, &column));
            }
            put(first, (pair, load), dot(&self.loading.driven(entry.contact, &state), &normal));
            second[(pair, entry.normal())] = 1.0;
            pair += 1;
            if entry.tangents == 1 {
                for (part, side) in entry.parts() {
                    first[(pair, entry.normal())] = entry.friction.coefficient / (1.0 + entry.friction.coefficient);
                    first[(pair, entry.tangential(0))] = side / (1.0 + entry.friction.coefficient);
                    second[(pair, part)] = 1.0;
                    pair += 1;
                }
            }
        }
    }

    fn cone_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        for (place, entry) in coned(self).enumerate() {
            let (a, b) = entry.cone_members(x);
            first.rows_mut(3 * place, 3).copy_from_slice(&a);
            second.rows_mut(3 * place, 3).copy_from_slice(&b);
        }
    }

    fn cone_jacobians(&self, _x: &DVector<f64>, first: &mut DMatrix<f64>, second: &mut DMatrix<f64>) {
        for (place, entry) in coned(self).enumerate() {
            let row = 3 * place;
            first[(row, entry.normal())] = entry.friction.coefficient / (1.0 + entry.friction.coefficient);
            second[(row, entry.bound())] = 1.0;
            for k in 0..2 {
                first[(row + 1 + k, entry.tangential(k))] = 1.0 / (1.0 + entry.friction.coefficient);
                second[(row + 1 + k, entry.slip(k))] = 1.0;
            }
        }
    }

    fn quadratic_model(&self, _x: &DVector<f64>) -> Option<SparseRows> {
        let mut model = SparseRows::zeros(self.variables, self.variables);
        for unknown in 0..=self.loading.structure.unknowns() {
            model[(unknown, unknown)] = self.arc_weight;
        }
        Some(model)
    }
}

/// Adds the turning of the reaction with the node's position on a curved obstacle.
fn add_turn_of_reaction(
    program: &IncrementProgram<'_>,
    entry: &InReach,
    (frame, state): (&Frame, &State),
    x: &DVector<f64>,
    jacobian: &mut SparseRows,
) {
    let tangents = entry.tangents_at(frame);
    let turn = |motion: &Vector| {
        let of_normal = scaled(&frame.normal_change(motion), x[entry.normal()] * program.step);
        (0..entry.tangents).fold(of_normal, |sum, t| {
            add(&sum, x[entry.tangential(t)] * program.step, &entry.tangent_change(frame, &tangents[t], motion))
        })
    };
    let load = program.loading.structure.unknowns();
    let driven = turn(&program.loading.driven(entry.contact, state));
    let columns = program.columns_of(entry, state);
    for (row, own) in &columns {
        jacobian[(*row, load)] -= dot(own, &driven);
        for (column, motion) in &columns {
            jacobian[(*row, *column)] -= dot(own, &turn(motion));
        }
    }
}

/// Adds the turning of the force of a contact that several nodes move.
fn add_curvature_of_motion(
    program: &IncrementProgram<'_>,
    entry: &InReach,
    (frame, state): (&Frame, &State),
    x: &DVector<f64>,
    jacobian: &mut SparseRows,
) {
    let structure = program.loading.structure;
    let tangents = entry.tangents_at(frame);
    let of_normal = scaled(&frame.normal, x[entry.normal()] * program.step);
    let force =
        (0..entry.tangents).fold(of_normal, |sum, t| add(&sum, x[entry.tangential(t)] * program.step, &tangents[t]));
    let contact = &program.loading.contacts[entry.contact];
    contact_jacobian::each_curvature(structure, contact, &state.displacement, &force, |row, column, value| {
        let Some(row) = structure.unknown_of[row] else { return };
        match structure.unknown_of[column] {
            Some(column) => jacobian[(row, column)] -= value,
            None => jacobian[(row, structure.unknowns())] -= value * program.loading.support_rate(column),
        }
    });
}
