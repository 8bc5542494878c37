//! The violation of the laws of contact and friction by a state.
//!
//! ```text
//! 0 <= g ⊥ r_n >= 0,      |r_t| <= μ r_n
//! ```

use crate::mechanics::contact::Reaction;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::{
    ACCEPTED_VIOLATION, LARGEST_ROUNDING_OF_GAP, NEGLIGIBLE_FORCE, ROUND_OFF_MULTIPLE,
};

/// The largest violation over the contacts; gaps dimensionless, reactions over the force scale at their nodes.
pub fn violation(loading: Loading<'_>, state: &State, force_scale: f64) -> f64 {
    let of_contact = |(index, reaction): (usize, &Reaction)| {
        let rounding = (ROUND_OFF_MULTIPLE * loading.contacts[index].rounding()).min(LARGEST_ROUNDING_OF_GAP);
        let gap = beyond(loading.gap(index, state), rounding);
        let friction = loading.contacts[index].friction;
        let traction = reaction.tangential_size();
        // The forces at the node are at most the force scale, so that they often need not be computed.
        let obeys = reaction.normal >= 0.0 && traction <= friction.bound(reaction.normal);
        if obeys && gap <= reaction.normal / force_scale.max(NEGLIGIBLE_FORCE) {
            return gap.abs();
        }
        let scaled = 1.0 / loading.force_scale_at(index, state, force_scale).max(NEGLIGIBLE_FORCE);
        let normal = reaction.normal * scaled;
        let cone = traction * scaled - friction.bound(normal);
        (-gap).max(-normal).max(gap.min(normal).abs()).max(cone)
    };
    state.reactions.iter().enumerate().map(of_contact).fold(0.0, f64::max)
}

/// What of a value is beyond a rounding.
fn beyond(value: f64, rounding: f64) -> f64 {
    value - value.clamp(-rounding, rounding)
}

/// Whether a state may be a point of the path.
pub fn holds(loading: Loading<'_>, state: &State, force_scale: f64) -> bool {
    violation(loading, state, force_scale) <= ACCEPTED_VIOLATION
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::scene::Scene;

    /// A node on a floor with μ = 1/2: the violation of each law in a few states.
    #[test]
    fn a_breach_of_any_law_is_seen() {
        let request = crate::model::decode::decode(
            br#"{"model": {"dimension": 2, "nodes": {"node": [0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.5}],
                "stages": [{"name": "press", "forces": {"node": [0, -1]}}]}}"#,
        )
        .expect("a request");
        let scene = Scene::new(&request).expect("a scene");
        let held = scene.stages[0].pattern.zeroed();
        let loading = Loading {
            structure: &scene.structure,
            contacts: &scene.contacts,
            corners: &scene.corners,
            pattern: &scene.stages[0].pattern,
            held: &held,
        };
        let of = |height: f64, normal: f64, traction: f64| {
            let mut state = State::at_rest(&scene.structure, 1);
            state.displacement[1] = height;
            state.reactions[0] = Reaction { normal, tangential: [traction, 0.0, 0.0] };
            violation(loading, &state, 1.0)
        };
        assert_eq!(of(0.0, 1.0, 0.5), 0.0);
        assert_eq!(of(0.25, 0.0, 0.0), 0.0);
        assert_eq!(of(0.0, -1.0, 0.0), 1.0);
        assert_eq!(of(0.0, 1.0, 1.0), 0.5);
        assert_eq!(of(-0.25, 0.0, 0.0), 0.25);
        assert_eq!(of(0.25, 1.0, 0.0), 0.25);
    }
}
