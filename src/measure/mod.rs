//! The measure of error, apart from the solver that it judges: it reads the posted model and the streamed increments,
//! in the user's units, and shares no code with what produced them.
//!
//! ```text
//! equilibrium     max |Σ N d + K Δu - s f - f_held - n r_n - t r_t| / F       F: largest force so far
//! contact         max |min(g/ℓ, r_n/F)|                                       natural map of 0 <= g ⊥ r_n >= 0
//! cone            max (|r_t| - μ r_n)/F
//! friction        stick: |slip|/ℓ;   slip: |r_t + μ r_n slip/|slip||/F;   free: |r|/F
//! energy          |W - E - D| / largest energy so far (at least 1e-12 F ℓ)
//! ```
//!
//! (Natural map: F. Facchinei, J.-S. Pang, *Finite-Dimensional Variational Inequalities and Complementarity Problems*,
//! Springer 2003, section 1.5.)

use crate::model::request::{Element, JobRequest, Model, Obstacle, Strain};
use crate::path::increment::{ContactState, Increment, Status};

/// Errors of one increment, all dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    pub equilibrium: f64,
    pub contact: f64,
    pub cone: f64,
    pub friction: f64,
    pub energy: f64,
    /// Reported against recomputed strain energy, over the largest energy so far.
    pub strain_energy: f64,
}

impl Errors {
    /// The largest of equilibrium, contact, cone and friction.
    pub fn largest_of_state(&self) -> f64 {
        self.equilibrium.max(self.contact).max(self.cone).max(self.friction)
    }
}

/// Judges the increments of one path, in order.
#[derive(Debug, Clone)]
pub struct Judge<'m> {
    model: &'m Model,
    length: f64,
    stage: usize,
    last_load: f64,
    held: Vec<Vec<f64>>,
    largest_force: f64,
    largest_energy: f64,
    initial_strain: f64,
}

impl<'m> Judge<'m> {
    /// `length` makes gaps and slips dimensionless (the plan's displacement scale).
    pub fn new(request: &'m JobRequest, length: f64) -> Self {
        let model = &request.model;
        let rest = vec![vec![0.0; model.dimension]; model.nodes.len()];
        Self {
            model,
            length,
            stage: 0,
            last_load: 0.0,
            held: rest.clone(),
            largest_force: 0.0,
            largest_energy: 0.0,
            initial_strain: strain_energy(model, &rest),
        }
    }

    /// Errors of the next increment.
    pub fn judge(&mut self, increment: &Increment) -> Errors {
        while self.model.stages[self.stage].name != *increment.stage && self.stage + 1 < self.model.stages.len() {
            let load = self.last_load;
            self.for_each_load(|held, force| *held += load * force);
            self.stage += 1;
            self.last_load = 0.0;
        }
        self.last_load = increment.load_factor;
        let displacements: Vec<Vec<f64>> =
            self.model.nodes.keys().map(|name| increment.displacements[name.as_str()].clone()).collect();
        let mut errors = Errors { equilibrium: self.equilibrium(increment, &displacements), ..Errors::default() };
        for (contact, state) in self.model.contacts.iter().zip(&increment.contacts) {
            self.contact(contact.friction, state, &mut errors);
        }
        let energy = increment.energy;
        for value in [energy.external_work, energy.strain, energy.dissipated] {
            self.largest_energy = self.largest_energy.max(value.abs());
        }
        let size = self.largest_energy.max(1e-12 * self.largest_force * self.length);
        if size > 0.0 {
            let imbalance = energy.external_work - energy.strain - energy.dissipated;
            errors.energy = imbalance.abs() / size;
            let strain = strain_energy(self.model, &displacements) - self.initial_strain;
            errors.strain_energy = (energy.strain - strain).abs() / size;
        }
        errors
    }

    fn for_each_load(&mut self, mut change: impl FnMut(&mut f64, f64)) {
        for (name, forces) in &self.model.stages[self.stage].forces {
            if let Some(node) = self.model.nodes.get_index_of(name) {
                self.held[node].iter_mut().zip(forces).for_each(|(held, force)| change(held, *force));
            }
        }
    }

    fn equilibrium(&mut self, increment: &Increment, displacements: &[Vec<f64>]) -> f64 {
        let model = self.model;
        let mut balance = vec![vec![0.0; model.dimension]; model.nodes.len()];
        let mut largest = 0.0_f64;
        for element in &model.elements {
            for (node, force) in element_forces(model, element, displacements) {
                for (sum, value) in balance[node].iter_mut().zip(force) {
                    *sum += value;
                    largest = largest.max(value.abs());
                }
            }
        }
        let stage = &model.stages[self.stage];
        for (node, name) in model.nodes.keys().enumerate() {
            for component in 0..model.dimension {
                let pattern = stage.forces.get(name).map_or(0.0, |forces| forces[component]);
                let load = increment.load_factor * pattern + self.held[node][component];
                balance[node][component] -= load;
                largest = largest.max(load.abs());
            }
        }
        for (contact, state) in model.contacts.iter().zip(&increment.contacts) {
            let Some(node) = model.nodes.get_index_of(&contact.node) else { continue };
            let Some(Obstacle::Plane { normal, .. }) = model.obstacles.get(&contact.obstacle) else { continue };
            let size = normal.iter().map(|value| value * value).sum::<f64>().sqrt();
            for component in 0..model.dimension {
                balance[node][component] -= state.normal_reaction * normal[component] / size;
            }
            if model.dimension == 2 {
                balance[node][0] -= state.tangential_reaction[0] * normal[1] / size;
                balance[node][1] += state.tangential_reaction[0] * normal[0] / size;
            }
            largest = largest.max(state.normal_reaction.abs());
        }
        self.largest_force = self.largest_force.max(largest);
        let mut error = 0.0_f64;
        for (node, name) in model.nodes.keys().enumerate() {
            for (component, value) in balance[node].iter().enumerate() {
                let supported = model.supports.get(name).is_some_and(|s| s.iter().any(|c| c.index() == component));
                if !supported {
                    error = error.max(value.abs());
                }
            }
        }
        if self.largest_force > 0.0 { error / self.largest_force } else { error }
    }

    fn contact(&self, friction: f64, state: &ContactState, errors: &mut Errors) {
        let force = if self.largest_force > 0.0 { self.largest_force } else { 1.0 };
        let normal = state.normal_reaction / force;
        let tangential = state.tangential_reaction.iter().map(|value| value * value).sum::<f64>().sqrt() / force;
        let slip = state.slip.iter().map(|value| value * value).sum::<f64>().sqrt();
        errors.contact = errors.contact.max((state.gap / self.length).min(normal).abs());
        errors.cone = errors.cone.max(tangential - friction * normal);
        let friction_error = match state.status {
            Status::Free => tangential.max(normal.abs()),
            Status::Stick => slip / self.length,
            Status::Slip if slip == 0.0 => 0.0,
            Status::Slip => state
                .tangential_reaction
                .iter()
                .zip(&state.slip)
                .map(|(traction, motion)| (traction / force + friction * normal * motion / slip).abs())
                .fold(0.0, f64::max),
        };
        errors.friction = errors.friction.max(friction_error);
    }
}

/// `L`, `L0` and the unit direction of a bar.
fn bar_geometry(
    model: &Model,
    nodes: &[String],
    rest: Option<f64>,
    u: &[Vec<f64>],
) -> (f64, f64, Vec<f64>, [usize; 2]) {
    let index = |name: &String| model.nodes.get_index_of(name).unwrap_or(0);
    let ends = [index(&nodes[0]), index(&nodes[1])];
    let reference: Vec<f64> = (0..model.dimension).map(|k| model.nodes[ends[1]][k] - model.nodes[ends[0]][k]).collect();
    let deformed: Vec<f64> = (0..model.dimension).map(|k| reference[k] + u[ends[1]][k] - u[ends[0]][k]).collect();
    let norm = |vector: &[f64]| vector.iter().map(|value| value * value).sum::<f64>().sqrt();
    let length = norm(&deformed);
    let direction = deformed.iter().map(|value| value / length).collect();
    (length, rest.unwrap_or_else(|| norm(&reference)), direction, ends)
}

fn element_forces(model: &Model, element: &Element, u: &[Vec<f64>]) -> Vec<(usize, Vec<f64>)> {
    match element {
        Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
            let (length, rest, direction, ends) = bar_geometry(model, nodes, *rest_length, u);
            let stretch = length / rest;
            let elastic = match strain {
                Strain::Engineering => stretch - 1.0,
                Strain::Green => 0.5 * (stretch * stretch - 1.0) * stretch,
                Strain::Log => stretch.ln() / stretch,
            };
            let axial = axial_stiffness * elastic + prestress;
            let force: Vec<f64> = direction.iter().map(|value| axial * value).collect();
            vec![(ends[0], force.iter().map(|value| -value).collect()), (ends[1], force)]
        }
        Element::Spring { nodes, stiffness } => {
            let ends: Vec<usize> = nodes.iter().map(|name| model.nodes.get_index_of(name).unwrap_or(0)).collect();
            let force: Vec<f64> = stiffness
                .iter()
                .map(|row| {
                    let relative = |k: usize| u[ends[0]][k] - ends.get(1).map_or(0.0, |other| u[*other][k]);
                    row.iter().enumerate().map(|(k, value)| value * relative(k)).sum()
                })
                .collect();
            let mut forces = vec![(ends[0], force.clone())];
            forces.extend(ends.get(1).map(|other| (*other, force.iter().map(|value| -value).collect())));
            forces
        }
    }
}

fn strain_energy(model: &Model, u: &[Vec<f64>]) -> f64 {
    let energy = |element: &Element| match element {
        Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
            let (length, rest, _, _) = bar_geometry(model, nodes, *rest_length, u);
            let stretch = length / rest;
            let measure = match strain {
                Strain::Engineering => stretch - 1.0,
                Strain::Green => 0.5 * (stretch * stretch - 1.0),
                Strain::Log => stretch.ln(),
            };
            0.5 * axial_stiffness * rest * measure * measure + prestress * (length - rest)
        }
        Element::Spring { .. } => {
            let forces = element_forces(model, element, u);
            0.5 * forces.iter().flat_map(|(node, f)| f.iter().zip(&u[*node]).map(|(f, u)| f * u)).sum::<f64>()
        }
    };
    model.elements.iter().map(energy).sum()
}
