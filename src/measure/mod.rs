//! The measure of error, apart from the solver that it judges: it reads the posted model and the streamed increments,
//! in the user's units, and shares no code with what produced them.
//!
//! ```text
//! equilibrium     max |Σ N d + K Δu - s f - f_held - Σ n r_n - Σ t r_t| / F    free components; F: largest force so far
//! support         max |u - s u_given - u_held| / ℓ                            supported components
//! contact         max |min(g/ℓ, r_n/F)|                                       natural map of 0 <= g ⊥ r_n >= 0
//! cone            max (|r_t| - μ r_n)/F
//! friction        stick: |slip|/ℓ;   free: |r|/F;
//!                 slip in 2D: |r_t + μ r_n slip/|slip||/F;   in 3D: ||r_t| - μ r_n|/F and (r_t·slip/|slip|)₊/F
//! reported        |gap - g|/ℓ, |slip - Tᵀ(Δu - Δd)|/ℓ                         d: the obstacle's translation
//! energy          |W - E - D| / largest energy so far (at least 1e-12 F ℓ)
//! slip_direction  3D: angle between the slip and the sum of the unit directions -r_t/|r_t| at its two ends
//! ```
//!
//! What the rounding of the numbers that are given puts into a gap or a balance of forces is no error of the state: of a
//! bar, unit round-off times `EA/L0` times its displacements and places; of a spring, times `|K|` and its displacements.
//! Both count only where stiff elements move far.
//!
//! (Natural map: F. Facchinei, J.-S. Pang, *Finite-Dimensional Variational Inequalities and Complementarity Problems*,
//! Springer 2003, section 1.5.)
//!
//! In 3D the slip of an increment is the chord of a curve. Traction opposes the velocity, and the chord of a curve with
//! unit end directions `d0`, `d1` is along `d0 + d1` up to an angle of second order in the step. So the end is judged
//! exactly on the cone and the chord by that angle, which is a figure of its own: it falls with the step and is not
//! an error of the state. It is 0 where the slip began off the cone (a first touch), where no direction is known.

mod elements;
mod obstacles;

use crate::model::request::{JobRequest, Model};
use crate::path::increment::{ContactState, Increment, Status};
use elements::{element_forces, element_rounding, strain_energy};
use obstacles::{Frame, dot, norm};

/// Errors of one increment, all dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    pub equilibrium: f64,
    pub support: f64,
    pub contact: f64,
    pub cone: f64,
    pub friction: f64,
    /// Gaps and slips as reported against those of the reported displacements.
    pub reported: f64,
    pub energy: f64,
    /// Reported against recomputed strain energy, over the largest energy so far.
    pub strain_energy: f64,
    /// Radians.
    pub slip_direction: f64,
}

impl Errors {
    /// The largest of equilibrium, support, contact, cone, friction and reported.
    pub fn largest_of_state(&self) -> f64 {
        let parts = [self.equilibrium, self.support, self.contact, self.cone, self.friction, self.reported];
        parts.into_iter().fold(0.0, worse)
    }
}

/// One vector a node, or one an obstacle.
type Vectors = Vec<Vec<f64>>;

/// The point before, as far as slip needs it.
#[derive(Debug, Clone)]
struct Before {
    displacements: Vectors,
    shifts: Vectors,
    /// `-r_t/|r_t|` in space of each contact that is on its cone.
    directions: Vec<Option<Vec<f64>>>,
}

/// Judges the increments of one path, in order.
#[derive(Debug, Clone)]
pub struct Judge<'m> {
    model: &'m Model,
    length: f64,
    stage: usize,
    last_load: f64,
    held_forces: Vectors,
    held_displacements: Vectors,
    held_shifts: Vectors,
    before: Before,
    largest_force: f64,
    largest_energy: f64,
    initial_strain: f64,
}

/// A traction within this part of `μ r_n` of the cone is on it.
const ON_THE_CONE: f64 = 1e-6;

impl<'m> Judge<'m> {
    /// `length` makes gaps and slips dimensionless (the plan's displacement scale).
    pub fn new(request: &'m JobRequest, length: f64) -> Self {
        let model = &request.model;
        let rest = vec![vec![0.0; model.dimension]; model.nodes.len()];
        let still = vec![vec![0.0; model.dimension]; model.obstacles.len()];
        Self {
            model,
            length,
            stage: 0,
            last_load: 0.0,
            held_forces: rest.clone(),
            held_displacements: rest.clone(),
            held_shifts: still.clone(),
            before: Before { displacements: rest.clone(), shifts: still, directions: vec![None; model.contacts.len()] },
            largest_force: 0.0,
            largest_energy: 0.0,
            initial_strain: strain_energy(model, &rest),
        }
    }

    /// Errors of the next increment.
    pub fn judge(&mut self, increment: &Increment) -> Errors {
        while self.model.stages[self.stage].name != *increment.stage && self.stage + 1 < self.model.stages.len() {
            (self.held_forces, self.held_displacements, self.held_shifts) = self.loading(self.last_load);
            self.stage += 1;
            self.last_load = 0.0;
        }
        self.last_load = increment.load_factor;
        let (forces, given, shifts) = self.loading(increment.load_factor);
        let displacements: Vectors =
            self.model.nodes.keys().map(|name| increment.displacements[name.as_str()].clone()).collect();
        let frames = self.frames(&displacements, &shifts);
        let mut errors = Errors {
            equilibrium: self.equilibrium(&increment.contacts, &displacements, &forces, &frames),
            support: self.support(&displacements, &given),
            ..Errors::default()
        };
        let mut after = Before { displacements, shifts, directions: vec![None; self.model.contacts.len()] };
        for (index, state) in increment.contacts.iter().enumerate() {
            let Some(frame) = frames.get(index).and_then(Option::as_ref) else { continue };
            self.contact(index, state, frame, &mut after, &mut errors);
        }
        self.energy(increment, &after.displacements, &mut errors);
        self.before = after;
        errors
    }

    /// Forces on nodes, displacements of supports and translations of obstacles under a load factor of the stage.
    fn loading(&self, load: f64) -> (Vectors, Vectors, Vectors) {
        let stage = &self.model.stages[self.stage];
        let add = |held: &Vectors, patterns: &indexmap::IndexMap<String, Vec<f64>>, number: &dyn Fn(&str) -> _| {
            let mut sums = held.clone();
            for (name, pattern) in patterns {
                if let Some(index) = number(name) {
                    let sum: &mut Vec<f64> = &mut sums[index];
                    sum.iter_mut().zip(pattern).for_each(|(sum, value)| *sum += load * value);
                }
            }
            sums
        };
        let node = |name: &str| self.model.nodes.get_index_of(name);
        let obstacle = |name: &str| self.model.obstacles.get_index_of(name);
        (
            add(&self.held_forces, &stage.forces, &node),
            add(&self.held_displacements, &stage.displacements, &node),
            add(&self.held_shifts, &stage.obstacle_motion, &obstacle),
        )
    }

    fn frames(&self, displacements: &Vectors, shifts: &Vectors) -> Vec<Option<Frame>> {
        let frame = |contact: &crate::model::request::Contact| {
            let (node, _, place) = self.model.nodes.get_full(&contact.node)?;
            let (number, _, obstacle) = self.model.obstacles.get_full(&contact.obstacle)?;
            Some(Frame::new(obstacle, &shifts[number], place, &displacements[node]))
        };
        self.model.contacts.iter().map(frame).collect()
    }

    fn supported(&self, node: &str, component: usize) -> bool {
        self.model.supports.get(node).is_some_and(|held| held.iter().any(|c| c.index() == component))
    }

    fn support(&self, displacements: &Vectors, given: &Vectors) -> f64 {
        let mut error = 0.0_f64;
        for (node, name) in self.model.nodes.keys().enumerate() {
            for component in (0..self.model.dimension).filter(|component| self.supported(name, *component)) {
                error = worse(error, (displacements[node][component] - given[node][component]).abs() / self.length);
            }
        }
        error
    }

    fn equilibrium(
        &mut self,
        contacts: &[ContactState],
        displacements: &Vectors,
        forces: &Vectors,
        frames: &[Option<Frame>],
    ) -> f64 {
        let model = self.model;
        let mut balance = vec![vec![0.0; model.dimension]; model.nodes.len()];
        let mut rounding = vec![0.0; model.nodes.len()];
        let mut largest = 0.0_f64;
        for element in &model.elements {
            let room = element_rounding(model, element, displacements);
            room.into_iter().for_each(|(node, size)| rounding[node] += size);
            for (node, force) in element_forces(model, element, displacements) {
                for (sum, value) in balance[node].iter_mut().zip(force) {
                    *sum += value;
                    largest = largest.max(value.abs());
                }
            }
        }
        for (sums, loads) in balance.iter_mut().zip(forces) {
            for (sum, load) in sums.iter_mut().zip(loads) {
                *sum -= load;
                largest = largest.max(load.abs());
            }
        }
        for ((contact, state), frame) in model.contacts.iter().zip(contacts).zip(frames) {
            let (Some(node), Some(frame)) = (model.nodes.get_index_of(&contact.node), frame) else { continue };
            let tangential = frame.in_space(&state.tangential_reaction);
            for (component, sum) in balance[node].iter_mut().enumerate() {
                *sum -= state.normal_reaction * frame.normal[component] + tangential[component];
            }
            largest = largest.max(state.normal_reaction.abs());
        }
        self.largest_force = self.largest_force.max(largest);
        let mut error = 0.0_f64;
        for (node, name) in model.nodes.keys().enumerate() {
            for (component, value) in balance[node].iter().enumerate() {
                if !self.supported(name, component) {
                    error = worse(error, value.abs() - rounding[node].min(value.abs()));
                }
            }
        }
        if self.largest_force > 0.0 { error / self.largest_force } else { error }
    }

    fn contact(&self, index: usize, state: &ContactState, frame: &Frame, after: &mut Before, errors: &mut Errors) {
        let (model, length) = (self.model, self.length);
        let contact = &model.contacts[index];
        let friction = contact.friction;
        let force = if self.largest_force > 0.0 { self.largest_force } else { 1.0 };
        let normal = state.normal_reaction / force;
        let traction: Vec<f64> = state.tangential_reaction.iter().map(|value| value / force).collect();
        let size = norm(&traction);
        let beyond_rounding =
            |error: f64| if error.abs() <= frame.rounding { 0.0 } else { (error.abs() - frame.rounding) / length };
        let apart = state.gap / length;
        // Written out: `min` passes over what is not a number.
        errors.contact = worse(errors.contact, if normal < apart { normal.abs() } else { apart.abs() });
        errors.contact = worse(errors.contact, if normal.is_nan() { normal } else { 0.0 });
        errors.cone = worse(errors.cone, size - friction * normal);
        errors.reported = worse(errors.reported, beyond_rounding(state.gap - frame.gap));

        let node = model.nodes.get_index_of(&contact.node).unwrap_or_default();
        let obstacle = model.obstacles.get_index_of(&contact.obstacle).unwrap_or_default();
        let motion = |k: usize| {
            let moved = after.displacements[node][k] - self.before.displacements[node][k];
            moved - (after.shifts[obstacle][k] - self.before.shifts[obstacle][k])
        };
        let motion: Vec<f64> = (0..model.dimension).map(motion).collect();
        let slip = frame.along(&motion);
        let expected = if state.status == Status::Free { vec![0.0; slip.len()] } else { slip.clone() };
        for (reported, expected) in state.slip.iter().zip(&expected) {
            errors.reported = worse(errors.reported, beyond_rounding(reported - expected));
        }
        let distance = norm(&slip);
        // Motion within the rounding of the coordinates has no direction.
        let moves = distance > frame.rounding;
        let friction_error = match state.status {
            Status::Free => size.max(normal.abs()),
            Status::Stick => beyond_rounding(distance),
            Status::Slip if friction == 0.0 || !moves => 0.0,
            Status::Slip if model.dimension == 2 => (traction[0] + friction * normal * slip[0] / distance).abs(),
            Status::Slip => {
                let against = dot(&traction, &slip) / distance;
                (size - friction * normal).abs().max(against)
            }
        };
        errors.friction = worse(errors.friction, friction_error);

        let on_the_cone = size > 0.0 && size >= (1.0 - ON_THE_CONE) * friction * normal;
        if model.dimension == 3 && friction > 0.0 && on_the_cone {
            let direction: Vec<f64> = frame.in_space(&traction).iter().map(|value| -value / size).collect();
            if let (Status::Slip, true, Some(before)) = (state.status, moves, &self.before.directions[index]) {
                let middle: Vec<f64> = before.iter().zip(&direction).map(|(a, b)| a + b).collect();
                errors.slip_direction = worse(errors.slip_direction, angle(&motion, &middle));
            }
            after.directions[index] = Some(direction);
        }
    }

    fn energy(&mut self, increment: &Increment, displacements: &Vectors, errors: &mut Errors) {
        let energy = increment.energy;
        for value in [energy.external_work, energy.strain, energy.dissipated] {
            self.largest_energy = self.largest_energy.max(value.abs());
        }
        let size = self.largest_energy.max(1e-12 * self.largest_force * self.length);
        if size > 0.0 {
            let imbalance = energy.external_work - energy.strain - energy.dissipated;
            errors.energy = worse(0.0, imbalance.abs() / size);
            let strain = strain_energy(self.model, displacements) - self.initial_strain;
            errors.strain_energy = worse(0.0, (energy.strain - strain).abs() / size);
        }
    }
}

/// The larger error; one that is not a number is without bound.
fn worse(error: f64, other: f64) -> f64 {
    if other.is_nan() { f64::INFINITY } else { error.max(other) }
}

/// Angle between two vectors in space, exact for small ones (W. Kahan, *How Futile are Mindless Assessments of
/// Roundoff*, 2006, section 12).
fn angle(a: &[f64], b: &[f64]) -> f64 {
    let (a_size, b_size) = (norm(a), norm(b));
    let scaled = |sign: f64| -> f64 {
        let parts: Vec<f64> = a.iter().zip(b).map(|(a, b)| a / a_size + sign * b / b_size).collect();
        norm(&parts)
    };
    2.0 * scaled(-1.0).atan2(scaled(1.0))
}
