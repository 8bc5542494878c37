//! Residual and tangent of the structure with regularised contacts.

use crate::algebra::null_space;
use crate::continuation::penalty::law::{Penalties, PenaltyResponse, respond};
use crate::continuation::penalty::tolerances::UNRESISTED_STIFFNESS;
use crate::mechanics::contact::Reaction;
use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, dot};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::equilibrium;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;
use itertools::Itertools;
use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;

/// A converged point.
#[derive(Debug, Clone)]
pub struct PenaltyPoint {
    pub state: State,
    /// One response for each contact.
    pub contacts: Vec<PenaltyResponse>,
}

/// The structure and its regularised contacts in a stage.
#[derive(Clone, Copy)]
pub struct PenaltySystem<'a> {
    pub loading: Loading<'a>,
    pub penalties: Penalties,
}

/// Residual and tangent at a state.
pub struct PenaltyEvaluation {
    /// `G` over all degrees of freedom: the forces that supports have to carry.
    pub unbalanced: Vec<f64>,
    /// `∂G/∂u` for the unknowns.
    pub tangent: DMatrix<f64>,
    pub contacts: Vec<PenaltyResponse>,
    /// Largest force of any element, load or contact.
    pub force_scale: f64,
}

impl PenaltySystem<'_> {
    /// Evaluates residual and tangent at a state, in an increment that began at `from`; the reactions of the state are
    /// not used.
    pub fn evaluate(&self, from: &PenaltyPoint, state: &State) -> PenaltyEvaluation {
        let structure = self.loading.structure;
        let unknowns = structure.unknowns();
        let mut force = vec![0.0; structure.freedoms()];
        let sizes = equilibrium::write_unbalanced(self.loading, state, &mut force);
        let mut force_scale = sizes.carried.max(sizes.applied);
        let mut tangent = DMatrix::zeros(unknowns, unknowns);
        structure.add_tangent(&state.displacement, &mut tangent);
        let mut contacts = Vec::with_capacity(from.contacts.len());
        for (index, (contact, before)) in self.loading.contacts.iter().zip(&from.contacts).enumerate() {
            let relative = self.loading.relative(index, state);
            let moved = self.loading.relative_motion(index, &from.state, state);
            let friction = if contact.tangents() == 0 { CoulombFriction::SMOOTH } else { contact.friction };
            let response =
                respond(self.penalties, friction, &contact.frame(&relative), &before.reaction.tangential, &moved);
            force_scale = force_scale.max(response.reaction.normal);
            let mut columns: SmallVec<[(usize, Vector); 3]> = SmallVec::new();
            self.loading.each_column(index, state, |freedom, column| {
                force[freedom] -= dot(column, &response.force);
                columns.extend(structure.unknown_of[freedom].map(|unknown| (unknown, *column)));
            });
            for ((row, own), (column, motion)) in columns.iter().cartesian_product(&columns) {
                let pushed = response.stiffness.map(|row| dot(&row, motion));
                tangent[(*row, *column)] += dot(own, &pushed);
            }
            let curvature = |row: usize, column: usize, value: f64| {
                if let (Some(row), Some(column)) = (structure.unknown_of[row], structure.unknown_of[column]) {
                    tangent[(row, column)] -= value;
                }
            };
            contact_jacobian::each_curvature(structure, contact, &state.displacement, &response.force, curvature);
            contacts.push(response);
        }
        PenaltyEvaluation { unbalanced: force, tangent, contacts, force_scale }
    }

    /// `-G` for the unknowns.
    pub fn right_hand_side(&self, evaluation: &PenaltyEvaluation) -> DVector<f64> {
        let freedoms = &self.loading.structure.freedom_of;
        DVector::from_iterator(freedoms.len(), freedoms.iter().map(|freedom| -evaluation.unbalanced[*freedom]))
    }

    /// Residual relative to the force scale; not finite where the state is not.
    pub fn relative_residual(&self, evaluation: &PenaltyEvaluation, force_scale: f64) -> f64 {
        let size = |freedom: &usize| {
            let value = evaluation.unbalanced[*freedom].abs();
            if value.is_finite() { value } else { f64::INFINITY }
        };
        let residual = self.loading.structure.freedom_of.iter().map(size).fold(0.0, f64::max);
        let scale = force_scale.max(evaluation.force_scale);
        if residual == 0.0 || scale == 0.0 { residual } else { residual / scale }
    }

    /// `-∂G/∂s` for the unknowns: forces, and the effect of moving supports and obstacles.
    pub fn load_vector(&self, point: &State, contacts: &[PenaltyResponse]) -> DVector<f64> {
        let structure = self.loading.structure;
        let mut vector: Vec<f64> = self.loading.pattern.forces.clone();
        if !self.loading.pattern.supports.is_empty() {
            structure.each_stiffness(&point.displacement, &mut |row, column, value| {
                if structure.unknown_of[column].is_none() {
                    vector[row] -= value * self.loading.support_rate(column);
                }
            });
        }
        for (index, (contact, response)) in self.loading.contacts.iter().zip(contacts).enumerate() {
            let motion = self.loading.driven(index, point);
            let pushed = response.stiffness.map(|row| dot(&row, &motion));
            contact_jacobian::add_force(structure, contact, &point.displacement, &pushed, -1.0, &mut vector);
        }
        let freedoms = &structure.freedom_of;
        DVector::from_iterator(freedoms.len(), freedoms.iter().map(|freedom| vector[*freedom]))
    }

    /// The point of a state and the responses of its contacts.
    pub fn point(&self, mut state: State, contacts: Vec<PenaltyResponse>) -> PenaltyPoint {
        state.reactions = contacts.iter().map(|response| response.reaction).collect::<Vec<Reaction>>();
        PenaltyPoint { state, contacts }
    }

    /// Whether the structure, with its contacts in their present status, has a motion that no element resists.
    pub fn is_mechanism(&self, point: &PenaltyPoint) -> bool {
        let structure = self.loading.structure;
        let tangent = self.evaluate(point, &point.state).tangent;
        let Some(motions) = null_space(&tangent, UNRESISTED_STIFFNESS) else { return false };
        motions.column_iter().any(|motion| {
            let mut rate = vec![0.0; structure.freedoms()];
            for (unknown, value) in motion.iter().enumerate() {
                rate[structure.freedom_of[unknown]] = *value;
            }
            structure.resistance(&point.state.displacement, &rate) < UNRESISTED_STIFFNESS
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Penalties, PenaltyPoint, PenaltySystem};
    use crate::algebra::Factorisation;
    use crate::continuation::penalty::law::PenaltyResponse;
    use crate::continuation::scene::Scene;
    use crate::mechanics::problem::loading::Loading;
    use crate::mechanics::problem::state::State;
    use crate::result::increment::Status;

    /// A scene in its first stage at rest.
    fn with_scene(name: &str, test: impl Fn(&PenaltySystem<'_>, &PenaltyPoint)) {
        let file = format!("{}/src/check/scenes/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).unwrap();
        let scene = Scene::new(&crate::model::decode::decode(text.as_bytes()).unwrap()).unwrap();
        let held = scene.stages[0].pattern.zeroed();
        let loading = Loading {
            structure: &scene.structure,
            contacts: &scene.contacts,
            corners: &scene.corners,
            pattern: &scene.stages[0].pattern,
            held: &held,
        };
        let system = PenaltySystem { loading, penalties: Penalties { normal: 50.0, tangential: 20.0 } };
        let contacts = scene.contacts.len();
        let state = State::at_rest(&scene.structure, contacts);
        test(&system, &PenaltyPoint { state, contacts: vec![PenaltyResponse::default(); contacts] });
    }

    /// The tangent agrees with central differences of the residual by displacements and load, contacts sticking and
    /// sliding, obstacles flat and round, at rest and moving.
    #[test]
    fn the_tangent_is_the_derivative_of_the_residual() {
        for name in ["arch-type-truss", "capstan", "curving-slip", "rising-floor", "lowered-pin", "bowl"] {
            with_scene(name, |system, from| {
                let structure = system.loading.structure;
                let mut state = from.state.clone();
                for freedom in &structure.freedom_of {
                    state.displacement[*freedom] = 1e-3 * (*freedom as f64).sin();
                }
                for (index, contact) in system.loading.contacts.iter().enumerate() {
                    // Pressed, and displaced far enough to slip at every other contact.
                    let frame = system.loading.frame(index, &state);
                    let slide = if index % 2 == 0 { 0.03 } else { 1e-4 };
                    let Some(node) = contact.kinematics.node() else { continue };
                    for (component, freedom) in structure.translations_of(node).enumerate() {
                        if structure.unknown_of[freedom].is_some() {
                            let push = (frame.gap + 0.004) * frame.normal[component];
                            state.displacement[freedom] += slide * frame.tangents[0][component] - push;
                        }
                    }
                }
                state.load = 0.01;
                system.loading.place_supports(&mut state);
                let here = system.evaluate(from, &state);
                let size = here.tangent.amax();
                let at = |change: &dyn Fn(&mut State)| {
                    let mut state = state.clone();
                    change(&mut state);
                    system.loading.place_supports(&mut state);
                    system.right_hand_side(&system.evaluate(from, &state))
                };
                for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
                    let shifted = |shift: f64| at(&move |state| state.displacement[*freedom] += shift);
                    let slope = (shifted(-1e-6) - shifted(1e-6)) / 2e-6;
                    assert!((slope - here.tangent.column(unknown)).amax() < 1e-7 * size, "{name}");
                }
                let loaded = |shift: f64| at(&move |state| state.load += shift);
                let slope = (loaded(1e-6) - loaded(-1e-6)) / 2e-6;
                let found = system.load_vector(&state, &here.contacts);
                assert!((&slope - &found).amax() < 1e-7 * size, "{name}: {slope} {found}");
            });
        }
    }

    /// Newton's method at constant load: once the contacts have settled, each residual is the square of the last.
    #[test]
    fn newton_converges_quadratically() {
        with_scene("arch-type-truss", |system, from| {
            let structure = system.loading.structure;
            let mut state = from.state.clone();
            state.load = 0.006;
            let mut residuals = Vec::new();
            for _ in 0..8 {
                let here = system.evaluate(from, &state);
                residuals.push(system.relative_residual(&here, 0.0));
                let mut step = system.right_hand_side(&here);
                assert!(Factorisation::new(here.tangent).unwrap().solve(&mut step));
                for (freedom, step) in structure.freedom_of.iter().zip(step.iter()) {
                    state.displacement[*freedom] += step;
                }
            }
            let statuses: Vec<Status> =
                system.evaluate(from, &state).contacts.iter().map(|contact| contact.status).collect();
            assert_eq!(statuses, [Status::Slip, Status::Free]);
            let fast = residuals.windows(2).filter(|pair| pair[0] < 1e-2 && pair[0] > 1e-9);
            let mut seen = 0;
            for pair in fast {
                seen += 1;
                assert!(pair[1] < 100.0 * pair[0] * pair[0] + 1e-14, "{residuals:?}");
            }
            assert!(seen >= 2, "{residuals:?}");
        });
    }
}
