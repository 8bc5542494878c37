//! The increment's functions and derivatives, as the MPEC solver asks for them.

use super::InReach;
use super::IncrementProgram;
use crate::contact::Frame;
use crate::contact::vector::{Vector, add, dot, scaled};
use crate::mpec::Problem;
use nalgebra::{DMatrix, DVector};

impl Problem for IncrementProgram<'_> {
    fn variables(&self) -> usize {
        self.variables
    }

    fn equalities(&self) -> usize {
        self.loading.structure.unknowns() + self.reach.iter().filter(|entry| entry.friction > 0.0).count()
    }

    fn inequalities(&self) -> usize {
        0
    }

    fn pairs(&self) -> usize {
        self.reach.iter().map(|entry| if entry.friction > 0.0 { 3 } else { 1 }).sum()
    }

    fn bounds(&self) -> (DVector<f64>, DVector<f64>) {
        let mut lower = DVector::repeat(self.variables, f64::NEG_INFINITY);
        for entry in &self.reach {
            lower[entry.first] = 0.0;
            if entry.friction > 0.0 {
                lower[entry.first + 2] = 0.0;
                lower[entry.first + 3] = 0.0;
            }
        }
        (lower, DVector::repeat(self.variables, f64::INFINITY))
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
        let slip = |entry: &InReach| entry.traction * (x[entry.first + 2] - x[entry.first + 3]);
        let dissipated: f64 = self.reach.iter().filter(|entry| entry.friction > 0.0).map(slip).sum();
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
        for entry in self.reach.iter().filter(|entry| entry.friction > 0.0) {
            gradient[entry.first + 2] = entry.traction;
            gradient[entry.first + 3] = -entry.traction;
        }
    }

    fn equality_values(&self, x: &DVector<f64>, values: &mut DVector<f64>) {
        let structure = self.loading.structure;
        let state = self.state(x);
        let mut force = vec![0.0; structure.freedoms()];
        structure.internal_force(&state.displacement, &mut force);
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            let load = state.load * self.loading.pattern.forces[*freedom] + self.loading.held.forces[*freedom];
            values[unknown] = (force[*freedom] - load) / self.force;
        }
        let load = structure.unknowns();
        let mut row = load;
        for entry in &self.reach {
            let frame = self.loading.frame(entry.contact, &state);
            let mut motion = x[load] * dot(&self.driven(entry), &entry.tangent);
            for (unknown, k) in self.node_of(entry) {
                values[unknown] -= x[entry.first] * frame.normal[k];
                if entry.friction > 0.0 {
                    values[unknown] -= x[entry.first + 1] * frame.tangents[0][k];
                    motion += entry.tangent[k] * x[unknown];
                }
            }
            if entry.friction > 0.0 {
                values[row] = motion - x[entry.first + 2] + x[entry.first + 3];
                row += 1;
            }
        }
    }

    fn equality_jacobian(&self, x: &DVector<f64>, jacobian: &mut DMatrix<f64>) {
        let structure = self.loading.structure;
        let state = self.state(x);
        let unknowns = structure.unknowns();
        let scale = self.step / self.force;
        structure.each_stiffness(&state.displacement, &mut |row, column, value| {
            let Some(row) = structure.unknown_of[row] else { return };
            match structure.unknown_of[column] {
                Some(column) => jacobian[(row, column)] += scale * value,
                None => jacobian[(row, unknowns)] += scale * value * self.loading.support_rate(column),
            }
        });
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            jacobian[(unknown, unknowns)] -= self.loading.pattern.forces[*freedom] * scale;
        }
        let mut row = unknowns;
        for entry in &self.reach {
            let frame = self.loading.frame(entry.contact, &state);
            for (unknown, k) in self.node_of(entry) {
                jacobian[(unknown, entry.first)] = -frame.normal[k];
                if entry.friction > 0.0 {
                    jacobian[(unknown, entry.first + 1)] = -frame.tangents[0][k];
                    jacobian[(row, unknown)] = entry.tangent[k];
                }
            }
            if entry.friction > 0.0 {
                jacobian[(row, unknowns)] = dot(&self.driven(entry), &entry.tangent);
            }
            if frame.curvature != 0.0 {
                self.add_turn_of_reaction(entry, &frame, x, jacobian);
            }
            if entry.friction > 0.0 {
                jacobian[(row, entry.first + 2)] = -1.0;
                jacobian[(row, entry.first + 3)] = 1.0;
                row += 1;
            }
        }
    }

    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>) {
        let state = self.state(x);
        let mut pair = 0;
        for entry in &self.reach {
            first[pair] = self.loading.gap(entry.contact, &state) / self.step;
            second[pair] = x[entry.first];
            pair += 1;
            if entry.friction > 0.0 {
                let bound = entry.friction * x[entry.first];
                for (side, offset) in [(1.0, 2), (-1.0, 3)] {
                    first[pair] = (bound + side * x[entry.first + 1]) / (1.0 + entry.friction);
                    second[pair] = x[entry.first + offset];
                    pair += 1;
                }
            }
        }
    }

    fn pair_jacobians(&self, x: &DVector<f64>, first: &mut DMatrix<f64>, second: &mut DMatrix<f64>) {
        let state = self.state(x);
        let load = self.loading.structure.unknowns();
        let mut pair = 0;
        for entry in &self.reach {
            let normal = self.loading.frame(entry.contact, &state).normal;
            for (unknown, k) in self.node_of(entry) {
                first[(pair, unknown)] = normal[k];
            }
            first[(pair, load)] = dot(&self.driven(entry), &normal);
            second[(pair, entry.first)] = 1.0;
            pair += 1;
            if entry.friction > 0.0 {
                for (side, offset) in [(1.0, 2), (-1.0, 3)] {
                    first[(pair, entry.first)] = entry.friction / (1.0 + entry.friction);
                    first[(pair, entry.first + 1)] = side / (1.0 + entry.friction);
                    second[(pair, entry.first + offset)] = 1.0;
                    pair += 1;
                }
            }
        }
    }

    fn quadratic_model(&self, _x: &DVector<f64>) -> Option<DMatrix<f64>> {
        let mut model = DMatrix::zeros(self.variables, self.variables);
        for unknown in 0..=self.loading.structure.unknowns() {
            model[(unknown, unknown)] = self.arc_weight;
        }
        Some(model)
    }
}

impl IncrementProgram<'_> {
    /// On a curved obstacle the reaction turns with the node's place.
    fn add_turn_of_reaction(&self, entry: &InReach, frame: &Frame, x: &DVector<f64>, jacobian: &mut DMatrix<f64>) {
        let normal = x[entry.first];
        let tangential = if entry.friction > 0.0 { x[entry.first + 1] } else { 0.0 };
        let turn = |motion: &Vector| {
            let of_normal = scaled(&frame.normal_change(motion), normal * self.step);
            add(&of_normal, tangential * self.step, &frame.tangent_change(motion))
        };
        let load = self.loading.structure.unknowns();
        let driven = turn(&self.driven(entry));
        for (row, k) in self.node_of(entry) {
            jacobian[(row, load)] -= driven[k];
            for (column, l) in self.node_of(entry) {
                let mut motion = [0.0; 3];
                motion[l] = 1.0;
                jacobian[(row, column)] -= turn(&motion)[k];
            }
        }
    }
}
