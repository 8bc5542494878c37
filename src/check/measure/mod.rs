//! The measure of error, independent of the solver. The measure reads the posted model and the streamed increments, in
//! the units of the user, and shares no code with the solver.
//!
//! ```text
//! equilibrium     max |Σ N d + K Δu - s f - f_held - Σ n r_n - Σ t r_t| / F   free components; F: largest force so far
//!                 |moment| / (F ℓ) of free rotations, by the formulas of `beams`
//! support         max |u - s u_given - u_held| / ℓ                           supported components, rotations
//!                 |u_m - (u_a + u_b)/2| / ℓ                              middles of edges that follow their ends
//! contact         max |min(g/ℓ, r_n/F)|                                      natural map of 0 <= g ⊥ r_n >= 0
//! friction        max |t - P(t - x)|,   t = r_t/F,   x = Tᵀ(Δu - Δd)/ℓ        natural map of Coulomb's law;
//!                 P: projection onto the disc of radius μ r_n/F;  d: the obstacle's translation
//! cone            max (|r_t| - μ r_n)/F
//! reported        |gap - g|/ℓ, |slip - Tᵀ(Δu - Δd)|/ℓ, |slip_total - sum of slips|/ℓ;
//!                 free: max(|r_n|, |r_t|)/F;   stick: |x|;   slip: ||r_t| - μ r_n|/F;
//!                 |force - force of the displacements|/F of contacts in global axes, elements, loads, free components
//!                 of supports;  |σ - stress of the displacements| V/(ℓ_e F) of a solid of volume V and size ℓ_e
//! global_equilibrium  |Σ F|/F, |Σ (x - c) × F|/(F × extent) over supports, loads, contacts and springs
//! arc_length      |a - step| / max(1, a),  a = ‖(Δu/ℓ, Δs/σ)‖;   |arc_length - A| / max(1, A),
//!                 A = arc_length before + step
//! energy          |W - E - D| / largest energy so far (at least 1e-10 F ℓ, and 1e6 times the rounding of forces
//!                 times the way: six digits of less do not exist)
//! strain_energy   |E - E(u) + E(0)| / the same
//! slip_direction  3D: angle between the slip and the sum of the unit directions -r_t/|r_t| at its two ends
//! ```
//!
//! Errors of a gap, a slip or a balance of forces that are due to the rounding of the published numbers do not count.
//! With the machine epsilon `ε`, this rounding error is `16 ε` times the largest coordinate, displacement or radius for
//! a gap or a slip, `16 ε` times `EA/L0 max(1, L/L0)²` times the largest displacement for a bar, and `16 ε` times the
//! largest row sum of `|K|` times the largest displacement for a spring, `64 ε` times a bound on the row sums for a solid. The rounding errors of forces matter only for
//! large motions of stiff elements.
//!
//! Reactions in global axes, sums of slips, forces of elements, supports and loads are judged where the increment has them;
//! without the reactions of the supports the balance of the whole structure is not known.
//!
//! `ℓ` and `σ` are the displacement scale and the load scale of the plan. (Natural map: F. Facchinei, J.-S. Pang,
//! *Finite-Dimensional Variational Inequalities and Complementarity Problems*, Springer 2003, section 1.5; of Coulomb's
//! law: P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353, doi:10.1016/0045-7825(91)90022-X.) `W`
//! and `D` are the reported values: these are integrals along the path, which cannot be computed from two increments.
//!
//! In 3D the slip of an increment is the chord of a curve. The traction opposes the velocity, and the chord of a curve
//! with unit end directions `d0`, `d1` is along `d0 + d1` up to an angle of second order in the step. On the friction
//! cone, the natural map of friction therefore includes only the part of the chord along the traction. The angle of the
//! chord is the separate error `slip_direction`: the angle decreases with the step and is not an error of the state.
//! `slip_direction` is 0 if the contact was not on the friction cone at the start of the increment (for example, at the
//! first contact), since no direction is known there.
//!
//! | file | contents |
//! |---|---|
//! | `errors` | the errors and their maxima |
//! | `posted`, `elements`, `beams`, `space_beams`, `solids`, `obstacles`, `middles`, `turning`, `polylines`, `polyhedra`, `bodies`, `numbers` | the posted model, with indices instead of names |
//! | `contacts` | the check of one contact |
//! | `global` | the balance of the whole structure, and the forces as reported |
//! | `rows`, `apart` | the contacts with a row in an increment, and the contacts without a row |
//! | `history` | the history of a judge, for checkpoints |

pub(crate) mod apart;
pub(crate) mod beams;
mod bodies;
pub(crate) mod contacts;
pub(crate) mod elements;
pub(crate) mod errors;
pub(crate) mod global;
pub(crate) mod history;
mod middles;
mod numbers;
pub(crate) mod obstacles;
mod polyhedra;
mod polylines;
pub(crate) mod posted;
pub(crate) mod rows;
pub(crate) mod solids;
pub(crate) mod space_beams;
mod turning;

pub use errors::{Errors, Largest, Maxima};
pub use history::{HistoryError, JudgeHistory};

use crate::model::JobRequest;
use crate::result::increment::{ContactState, Increment, PointKind};
use apart::Apart;
use contacts::Seen;
use elements::{MeasuredElement, MeasuredResponse};
use errors::worse;
use global::Balance;
use history::PreviousPoint;
use numbers::{MeasuredVector, largest, padded};
use obstacles::MeasuredFrame;
use posted::{Counterpart, Posted, PostedContact, PostedLoading};
use rows::{ContactRows, RowChange};
use std::f64::consts::TAU;

/// Forces below this fraction of the force that stretches the stiffest element by the displacement scale count as zero.
const NO_FORCE: f64 = 1e-20;
/// Energies below this fraction of the largest force times the displacement scale count as rounding errors.
const NO_ENERGY: f64 = 1e-10;
/// Energies are compared with at least this multiple of the rounding of forces times the length of the path.
const ENERGY_DIGITS: f64 = 1e6;

/// Checks the increments of a path, in order.
#[derive(Debug, Clone)]
pub struct Judge {
    posted: Posted,
    /// The displacement scale of the plan.
    length: f64,
    /// Forces below this value are rounding errors of an unloaded state and count as zero.
    no_force: f64,
    stage: usize,
    /// Load factors at which the previous stages ended.
    reached: Vec<f64>,
    held: PostedLoading,
    before: PreviousPoint,
    /// Stiffness of the stiffest element.
    stiffest: f64,
    largest_force: f64,
    largest_energy: f64,
    initial_strain: f64,
    rows: ContactRows,
    apart: Apart,
    /// Work space for the current increment.
    work: Workspace,
}

#[derive(Debug, Clone)]
struct Workspace {
    loading: PostedLoading,
    displacements: Vec<MeasuredVector>,
    /// Rotation vectors of nodes that have one, otherwise 0 (in the plane about the third axis); then those of released ends.
    rotations: Vec<MeasuredVector>,
    /// Unbalanced force of each node.
    balance: Vec<MeasuredVector>,
    /// The forces of pressures that follow surfaces, in the order of their faces.
    pressed: Vec<(usize, MeasuredVector)>,
    /// Rounding error of the unbalanced force.
    rounding: Vec<f64>,
    /// Unbalanced moment of each node, and its rounding error.
    moments: Vec<(MeasuredVector, f64)>,
    frames: Vec<MeasuredFrame>,
    /// Of the elements whose forces the increment reports, in order.
    responses: Vec<MeasuredResponse>,
}

impl Workspace {
    /// Adds the forces and moments of a beam, a rotational spring or a solid to its nodes; returns the largest, as a force.
    fn add_nodal(&mut self, response: &MeasuredResponse, outside: &mut Balance, length: f64) -> f64 {
        let mut most = 0.0_f64;
        let add_moment =
            |moments: &mut Vec<(MeasuredVector, f64)>, node: usize, moment: MeasuredVector, rounding: f64| {
                moments[node].0 += moment;
                moments[node].1 += rounding;
                largest(&moment) / length
            };
        match response {
            MeasuredResponse::Forces(_) => {}
            MeasuredResponse::Solid(response) => {
                for (node, force) in response.nodes.iter().zip(&response.forces) {
                    self.balance[*node] += force;
                    self.rounding[*node] += response.rounding;
                    outside.between(force);
                    if response.is_small {
                        // In equilibrium where it was drawn: at the deformed places a couple remains.
                        outside.add_moment(-self.displacements[*node].cross(force));
                    }
                    most = most.max(largest(force));
                }
            }
            MeasuredResponse::Beam(response) => {
                self.rotations.extend(response.released.iter().flatten().map(|turn| MeasuredVector::z() * *turn));
                for share in response.nodes.iter().flatten() {
                    self.balance[share.node] += share.force;
                    self.rounding[share.node] += share.force_rounding;
                    outside.between(&share.force);
                    most = most.max(largest(&share.force));
                    let of_moment = add_moment(&mut self.moments, share.node, share.moment, share.moment_rounding);
                    most = most.max(of_moment);
                }
            }
            MeasuredResponse::Moment { node, other, moment, rounding, .. } => {
                most = add_moment(&mut self.moments, *node, *moment, *rounding);
                match other {
                    Some(other) => drop(add_moment(&mut self.moments, *other, -*moment, *rounding)),
                    None => outside.add_moment(-*moment),
                }
            }
        }
        most
    }

    /// Gives half of the force on each middle that follows to either end of its edge.
    fn share_among_ends(&mut self, following: &[[usize; 3]]) {
        for [middle, ends @ ..] in following {
            let (force, rounding) = (self.balance[*middle], self.rounding[*middle]);
            (self.balance[*middle], self.rounding[*middle]) = (MeasuredVector::zeros(), 0.0);
            for end in ends {
                self.balance[*end] += force * 0.5;
                self.rounding[*end] += rounding;
            }
        }
    }

    /// Adds the forces of a contact to the nodes it acts on.
    fn add_contact(
        &mut self,
        posted: &Posted,
        contact: &PostedContact,
        state: &ContactState,
        frame: &MeasuredFrame,
        outside: &mut Balance,
    ) {
        match &contact.counterpart {
            Counterpart::Obstacle(_) => {
                let force = posted.placement(contact, &self.loading).in_space(contacts::force(state, frame));
                for (node, share) in &contact.point.shares {
                    let part = force * *share;
                    self.balance[*node] -= part;
                    outside.add(posted, *node, &self.displacements[*node], &part);
                }
            }
            Counterpart::Body(body) if state.normal_reaction != 0.0 => {
                let here = body.state(&self.displacements);
                for (node, force) in here.forces(state.normal_reaction, &state.tangential_reaction).0 {
                    self.balance[node] -= force;
                    outside.between(&force);
                }
            }
            Counterpart::Body(_) => {}
        }
    }
}

impl Judge {
    /// The judge of a checked request. The scales are those of the plan: `displacement_scale` makes lengths
    /// dimensionless, `load_scales` makes the load factor of each stage dimensionless.
    pub fn new(request: &JobRequest, displacement_scale: f64, load_scales: &[f64]) -> Self {
        let posted = Posted::new(request, load_scales);
        let none = PostedLoading::none(&posted);
        let nodes = posted.nodes.len();
        let (displacements, balance, rounding) =
            (vec![MeasuredVector::zeros(); nodes], vec![MeasuredVector::zeros(); nodes], vec![0.0; nodes]);
        let frames = Vec::new();
        let stiffest = posted.elements.iter().map(MeasuredElement::stiffness).fold(0.0, f64::max);
        let no_force = (NO_FORCE * stiffest * displacement_scale).max(f64::MIN_POSITIVE);
        let mut apart = Apart::new(&posted, displacement_scale);
        apart.begin(&posted, &none, &displacements);
        let rotations = vec![MeasuredVector::zeros(); nodes];
        let at_rest = posted.elements.iter().map(|element| element.response(&displacements, &rotations).energy());
        let initial_strain = at_rest.sum();
        Self {
            length: displacement_scale,
            no_force,
            stage: 0,
            reached: Vec::new(),
            held: none.clone(),
            before: PreviousPoint::at_rest(&posted),
            stiffest,
            largest_force: 0.0,
            largest_energy: 0.0,
            initial_strain,
            rows: ContactRows::new(request),
            apart,
            work: Workspace {
                loading: none,
                displacements,
                rotations,
                balance,
                pressed: Vec::new(),
                rounding,
                moments: vec![(MeasuredVector::zeros(), 0.0); nodes],
                frames,
                responses: Vec::new(),
            },
            posted,
        }
    }

    /// The errors of the next increment.
    pub fn judge(&mut self, increment: &Increment) -> Errors {
        let mut errors = Errors::default();
        if !self.read(increment) {
            errors.reported = f64::MAX;
        }
        let (strain, mut balance) = self.forces(increment);
        let force = self.largest_force.max(self.no_force);
        // What is out of balance in a motion is the force of damping and inertia.
        let moves = increment.point.kind == PointKind::Motion;
        errors.equilibrium = if moves { 0.0 } else { worse(0.0, self.unbalanced() / force) };
        self.reported_forces(increment, force, &mut balance, &mut errors);
        errors.support = self.off_support();
        let distance = self.distance(increment);
        // The rounding error of a step grows with the length of the step.
        let of_step = (distance - increment.step).abs() / distance.max(1.0);
        let sum = self.before.arc_length + increment.step;
        let of_sum = (increment.arc_length - sum).abs() / sum.max(1.0);
        errors.arc_length = worse(worse(0.0, of_step), of_sum);
        for ((state, index), frame) in increment.contacts.iter().zip(self.rows.contacts()).zip(&self.work.frames) {
            let contact = &self.posted.contacts[*index];
            let (motion, on_node) = match &contact.counterpart {
                Counterpart::Obstacle(_) => {
                    let (point, place) = (&contact.point, &contact.point.place);
                    let here = self.posted.placement(contact, &self.work.loading);
                    let before = self.posted.placed_at(contact, &self.before.shifts, &self.before.turns);
                    let (moved, _) = here.relative(place, &point.displacement(&self.work.displacements));
                    let (moved_before, _) = before.relative(place, &point.displacement(&self.before.displacements));
                    (moved - moved_before, here.in_space(contacts::force(state, frame)))
                }
                Counterpart::Body(body) => {
                    let here = body.state(&self.work.displacements);
                    let motion = here.motion_since(&body.state(&self.before.displacements));
                    (motion, here.forces(state.normal_reaction, &state.tangential_reaction).1)
                }
            };
            let seen = Seen {
                state,
                frame,
                friction: contact.friction,
                motion,
                force: on_node,
                direction_before: self.before.directions.get(index).copied(),
                slipped_before: self.before.slips.get(index).copied().unwrap_or_default(),
                dimension: self.posted.dimension,
                is_motion: matches!(increment.point.kind, PointKind::Jump | PointKind::Motion),
            };
            match seen.judge(self.length, force, &mut errors) {
                Some(direction) => self.before.directions.insert(*index, direction),
                None => self.before.directions.remove(index),
            };
            if let Some(total) = contacts::slipped(state) {
                self.before.slips.insert(*index, total);
            }
        }
        self.apart.judge(&self.posted, &self.work.loading, &self.work.displacements, distance, &mut errors);
        self.energy(increment, strain, &mut errors);
        std::mem::swap(&mut self.before.displacements, &mut self.work.displacements);
        std::mem::swap(&mut self.before.rotations, &mut self.work.rotations);
        self.before.shifts.copy_from_slice(&self.work.loading.shifts);
        self.before.turns.copy_from_slice(&self.work.loading.turns);
        self.before.load = increment.load_factor;
        self.before.arc_length = increment.arc_length;
        errors
    }

    /// The errors of a state by itself, before any increment has been judged: of what a path says of its way to the state
    /// nothing is judged. `stage_ends` are the load factors at which the stages before ended.
    pub fn judge_state(&mut self, increment: &Increment, stage_ends: &[f64]) -> Errors {
        for load in stage_ends.iter().take(self.posted.stages.len() - 1) {
            self.before.load = *load;
            self.next_stage();
        }
        self.read(increment);
        self.before.displacements.clone_from(&self.work.displacements);
        self.before.rotations.clone_from(&self.work.rotations);
        self.before.shifts.copy_from_slice(&self.work.loading.shifts);
        self.before.turns.copy_from_slice(&self.work.loading.turns);
        self.before.load = increment.load_factor;
        Errors { energy: 0.0, strain_energy: 0.0, ..self.judge(increment) }
    }

    /// Holds the load of the last increment and goes on to the next stage.
    fn next_stage(&mut self) {
        self.work.loading.set(&self.held, &self.posted.stages[self.stage], self.before.load);
        std::mem::swap(&mut self.held, &mut self.work.loading);
        self.reached.push(self.before.load);
        self.stage += 1;
        self.before.load = 0.0;
    }

    /// Sets the stage, displacements and load of an increment; returns `false` if the increment does not fit the model.
    fn read(&mut self, increment: &Increment) -> bool {
        let posted = &self.posted;
        self.work.rotations.resize(posted.nodes.len(), MeasuredVector::zeros());
        let known = posted.stages[self.stage..].iter().position(|stage| stage.name == *increment.stage);
        for _ in 0..known.unwrap_or(0) {
            self.next_stage();
        }
        let posted = &self.posted;
        self.work.loading.set(&self.held, &posted.stages[self.stage], increment.load_factor);
        let mut fits = known.is_some();
        match self.rows.read(&increment.contacts) {
            RowChange::None => {}
            RowChange::Others => self.apart.rows_are(self.rows.contacts()),
            RowChange::Unknown => fits = false,
        }
        for (index, (node, displacement)) in posted.nodes.iter().zip(&mut self.work.displacements).enumerate() {
            let in_place = increment.displacements.get_index(index).filter(|(name, _)| ***name == node.name);
            let found = in_place.map(|(_, values)| values).or_else(|| increment.displacements.get(node.name.as_str()));
            let count = posted.components_of(node);
            let found = found.filter(|values| values.len() == count);
            *displacement = found.map_or_else(MeasuredVector::zeros, |values| padded(&values[..posted.dimension]));
            self.work.rotations[index] = found.map_or_else(MeasuredVector::zeros, |values| posted.rotation(values));
            fits &= found.is_some();
        }
        fits
    }

    /// Sums the forces on every node; returns the strain energy, and the forces from outside on the whole structure,
    /// those of the supports apart.
    fn forces(&mut self, increment: &Increment) -> (f64, Balance) {
        let (posted, work) = (&self.posted, &mut self.work);
        let (mut most, mut outside) = (self.largest_force, Balance::default());
        work.rounding.fill(0.0);
        work.responses.clear();
        for (node, (balance, load)) in work.balance.iter_mut().zip(&work.loading.forces).enumerate() {
            *balance = -load;
            most = most.max(largest(load));
            let moment = work.loading.moments[node];
            work.moments[node] = (-moment, 0.0);
            most = most.max(largest(&moment) / self.length);
            outside.add_moment(moment);
            outside.add(posted, node, &work.displacements[node], load);
        }
        work.pressed.clear();
        for (faces, pressure) in posted.pressed.iter().zip(&work.loading.pressures).filter(|(_, size)| **size != 0.0) {
            work.pressed.extend(faces.iter().flat_map(|face| face.pressed(&work.displacements, *pressure)));
        }
        for (node, force) in &work.pressed {
            work.balance[*node] -= force;
            most = most.max(largest(force));
            outside.add(posted, *node, &work.displacements[*node], force);
        }
        let mut strain = 0.0;
        let mut recorded = increment.elements.iter().peekable();
        for (index, element) in posted.elements.iter().enumerate() {
            let response = element.response(&work.displacements, &work.rotations);
            strain += response.energy();
            let is_recorded = recorded.next_if(|state| state.element == index as u64).is_some();
            let response = match response {
                MeasuredResponse::Forces(response) => {
                    if is_recorded {
                        work.responses.push(MeasuredResponse::Forces(response));
                    }
                    response
                }
                turning => {
                    most = most.max(work.add_nodal(&turning, &mut outside, self.length));
                    if is_recorded {
                        work.responses.push(turning);
                    }
                    continue;
                }
            };
            match response.axial {
                Some(_) => outside.between(&response.force),
                None => {
                    let (first, second) = (response.first, response.second);
                    outside.add(posted, second, &work.displacements[second], &-response.force);
                    if let Some(first) = first {
                        outside.add(posted, first, &work.displacements[first], &response.force);
                    }
                }
            }
            most = most.max(largest(&response.force));
            if let Some(first) = response.first {
                work.balance[first] -= response.force;
                work.rounding[first] += response.rounding;
            }
            work.balance[response.second] += response.force;
            work.rounding[response.second] += response.rounding;
        }
        work.frames.clear();
        let rows = self.rows.contacts().iter().map(|index| &posted.contacts[*index]);
        for (contact, state) in rows.zip(&increment.contacts) {
            let mut frame = posted.frame(contact, &work.loading, &work.displacements);
            if let (Counterpart::Body(body), true) = (&contact.counterpart, state.normal_reaction <= 0.0) {
                frame.gap = body.open_gap(&work.displacements);
            }
            work.frames.push(frame);
            work.add_contact(posted, contact, state, &frame, &mut outside);
            most = most.max(state.normal_reaction.abs());
        }
        work.share_among_ends(&posted.following);
        // A force that is not finite already gives an unbounded error; the scale of the other errors stays finite.
        if most.is_finite() {
            self.largest_force = most;
        }
        (strain, outside)
    }

    /// The forces that the increment reports, and with the reactions of its supports the balance of the whole structure.
    fn reported_forces(&self, increment: &Increment, force: f64, balance: &mut Balance, errors: &mut Errors) {
        let (posted, work) = (&self.posted, &self.work);
        if work.responses.len() != increment.elements.len() {
            errors.reported = f64::MAX;
        }
        for (state, response) in increment.elements.iter().zip(&work.responses) {
            global::judge_element(state, response, posted.dimension, (force, self.length), errors);
        }
        let pressed = work.pressed.iter().map(|(_, force)| force);
        let loads = work.loading.forces.iter().chain(pressed);
        global::judge_loads(increment, loads, posted.dimension, force, errors);
        if increment.supports.is_empty() && !posted.supports.is_empty() {
            return;
        }
        let Some(reactions) = global::reactions(posted, increment) else {
            errors.reported = f64::MAX;
            return;
        };
        for (node, reaction, moment) in reactions {
            balance.add_moment(moment);
            if !posted.nodes[node].is_turn_held() {
                errors.reported = worse(errors.reported, largest(&moment) / (force * self.length));
            }
            balance.add(posted, node, &work.displacements[node], &reaction);
            let held = posted.nodes[node].held;
            let along_free = (0..posted.dimension).filter(|k| !held[*k]).map(|k| reaction[k].abs());
            errors.reported = worse(errors.reported, along_free.fold(0.0, worse) / force);
        }
        let rounding = work.rounding.iter().sum();
        if increment.point.kind != PointKind::Motion {
            errors.global_equilibrium = worse(0.0, balance.error(posted, self.length, force, rounding));
        }
    }

    /// The largest unbalanced force on a free component.
    fn unbalanced(&self) -> f64 {
        let sums = self.work.balance.iter().zip(&self.work.rounding);
        let components = self.posted.nodes.iter().zip(sums).flat_map(|(node, (balance, rounding))| {
            let beyond = |k: usize| balance[k].abs() - rounding.min(balance[k].abs());
            (0..self.posted.dimension).filter(|k| !node.held[*k]).map(beyond)
        });
        let turning = self.posted.nodes.iter().zip(&self.work.moments).zip(&self.work.rotations);
        let turning = turning.filter(|((node, _), _)| node.has_rotation);
        let moments = turning.flat_map(|((node, (moment, rounding)), rotation)| {
            // Where some components of the rotation vector are held, the moment is along the others as it does work there.
            let moment = if node.is_turn_held() { space_beams::along_components(rotation, moment) } else { *moment };
            let beyond = move |k: usize| (moment[k].abs() - rounding.min(moment[k].abs())) / self.length;
            (0..3).filter(|k| !node.rotation_held[*k]).map(beyond)
        });
        moments.chain(components).fold(0.0, worse)
    }

    fn off_support(&self) -> f64 {
        let given = self.work.displacements.iter().zip(&self.work.loading.displacements);
        let components = self.posted.nodes.iter().zip(given).flat_map(|(node, (found, given))| {
            (0..self.posted.dimension).filter(|k| node.held[*k]).map(|k| (found[k] - given[k]).abs())
        });
        let found = &self.work.displacements;
        let off_chord = |[m, a, b]: &[usize; 3]| largest(&(found[*m] - (found[*a] + found[*b]) * 0.5));
        let components = components.chain(self.posted.following.iter().map(off_chord));
        let turned = self.work.rotations.iter().zip(&self.work.loading.rotations);
        let rotations = self.posted.nodes.iter().zip(turned).flat_map(|(node, (found, given))| {
            (0..3).filter(|k| node.rotation_held[*k]).map(|k| (found[k] - given[k]).abs())
        });
        let off_rotation = rotations.fold(0.0, worse);
        worse(off_rotation, components.fold(0.0, worse) / self.length)
    }

    /// The dimensionless distance from the previous increment.
    fn distance(&self, increment: &Increment) -> f64 {
        let mut squared =
            ((increment.load_factor - self.before.load) / self.posted.stages[self.stage].load_scale).powi(2);
        for (after, before) in self.work.displacements.iter().zip(&self.before.displacements) {
            squared += ((after - before) * (1.0 / self.length)).norm_squared();
        }
        for (place, (after, before)) in self.work.rotations.iter().zip(&self.before.rotations).enumerate() {
            let turned = after - before;
            // Of a released end whole turns are not known. In space the angle between both rotations counts, or where
            // a component is held the rotation vector.
            squared += match self.posted.nodes.get(place) {
                None => (turned.z - (turned.z / TAU).round() * TAU).powi(2),
                Some(node) if self.posted.dimension == 3 && node.has_rotation && !node.is_turn_held() => {
                    space_beams::angle_between(before, after).powi(2)
                }
                Some(_) => turned.norm_squared(),
            };
        }
        squared.sqrt()
    }

    fn energy(&mut self, increment: &Increment, strain: f64, errors: &mut Errors) {
        let energy = increment.energy;
        let most = [energy.external_work, energy.strain, energy.dissipated, energy.released].map(f64::abs);
        let most = most.into_iter().fold(self.largest_energy, f64::max);
        if most.is_finite() {
            self.largest_energy = most;
        }
        let of_force = NO_ENERGY * self.largest_force.max(self.no_force) * self.length;
        let reach = self.work.displacements.iter().map(largest).fold(0.0, f64::max);
        let rounding = f64::EPSILON * self.stiffest * reach * increment.arc_length * self.length;
        let size = self.largest_energy.max(of_force).max(ENERGY_DIGITS * rounding);
        let imbalance = energy.external_work - energy.strain - energy.dissipated - energy.released;
        errors.energy = worse(0.0, imbalance.abs() / size);
        // A motion gives energy off, and gets none.
        if increment.point.kind != PointKind::Motion {
            let gained = self.before.released - energy.released;
            errors.energy = worse(errors.energy, gained.max(0.0) / size);
            self.before.released = energy.released;
        }
        errors.strain_energy = worse(0.0, (energy.strain - (strain - self.initial_strain)).abs() / size);
    }
}
