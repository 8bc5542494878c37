//! The forces of a row in the user's units: elements, supports, applied loads.
//!
//! ```text
//! reaction of the supports  f_int(u) - s p - h - Σ_c B_cᵀ r_c   at supported components, in the notation of `equilibrium`
//! applied forces            Σ (s p + h + p_f(u))                over the nodes; p_f: loads that follow the structure
//! ```

use crate::continuation::path_state::row_conversion::RowSource;
use crate::continuation::scene::Scene;
use crate::mechanics::problem::node_contact_forces;
use crate::mechanics::structure::elements::Resultants;
use crate::mechanics::structure::following_loads;
use crate::result::increment::{BeamEndForces, ElementState, SpaceVector};
use crate::result::nodal_values::NodalValues;
use std::sync::Arc;

/// The forces of the elements that are recorded.
pub(crate) fn element_rows(scene: &Scene, row: &RowSource<'_>) -> Vec<ElementState> {
    let (force, length) = (scene.plan().force_scale, scene.plan().displacement_scale);
    let dimension = scene.structure.dimension;
    let recorded = scene.recorded_forces.elements.iter();
    recorded
        .map(|(place, name)| {
            let mut state = ElementState {
                element: *place as u64,
                name: name.as_ref().map(Arc::clone),
                axial_force: None,
                force: None,
                ends: None,
                moment: None,
                stress: None,
                von_mises: None,
            };
            match row.loading.structure.resultants(*place, &row.state.displacement) {
                Some(Resultants::Axial(axial)) => state.axial_force = Some(axial * force),
                Some(Resultants::Force(of_spring)) => {
                    state.force = Some(of_spring[..dimension].iter().map(|value| value * force).collect());
                }
                Some(Resultants::Ends(ends)) => {
                    state.ends = Some(ends.map(|end| {
                        let moment = end.bending_moment * force * length;
                        BeamEndForces::in_plane(end.axial_force * force, end.shear_force * force, moment)
                    }));
                }
                Some(Resultants::SpaceEnds(ends)) => {
                    state.ends = Some(ends.map(|end| {
                        BeamEndForces::in_space(
                            end.axial_force * force,
                            end.shear_forces.map(|value| value * force),
                            end.torsional_moment * force * length,
                            end.bending_moments.map(|value| value * force * length),
                        )
                    }));
                }
                Some(Resultants::Moment(moment)) => state.moment = Some(moment * force * length),
                Some(Resultants::Stress { stress, von_mises }) => {
                    let unit = force / length / length;
                    state.stress =
                        Some(stress[..if dimension == 2 { 4 } else { 6 }].iter().map(|value| value * unit).collect());
                    state.von_mises = Some(von_mises * unit);
                }
                None => {}
            }
            state
        })
        .collect()
}

/// The forces of the supports on the structure: what equilibrium lacks at supported components.
pub(crate) fn support_reactions(scene: &Scene, row: &RowSource<'_>) -> NodalValues {
    let recorded = &scene.recorded_forces;
    if recorded.supported_nodes.is_empty() {
        return NodalValues::default();
    }
    let (structure, loading) = (row.loading.structure, row.loading);
    let mut unbalanced = vec![0.0; structure.freedoms()];
    node_contact_forces::write_out_of_balance(loading, row.state, &mut unbalanced);
    scene.basis.forces_on_nodes(&structure.numbering, &mut unbalanced);
    let in_space = structure.dimension == 3;
    let mut moments = vec![0.0; if in_space { structure.freedoms() } else { 0 }];
    if in_space {
        structure.internal_forces_in_global_axes(&row.state.displacement, &mut moments);
    }
    let held = |freedom: usize| structure.unknown_of[freedom].is_none();
    let (force, length) = (scene.plan().force_scale, scene.plan().displacement_scale);
    let mut components = Vec::new();
    for (node, reactions) in recorded.supported_nodes.iter().zip(recorded.no_reactions.values()) {
        let turns_freely = structure.numbering.rotations_of(*node).all(|freedom| !held(freedom));
        for (place, freedom) in structure.freedoms_of(*node).enumerate().take(reactions.len()) {
            if in_space && place >= structure.dimension {
                // A moment in global axes, on a node none of whose rotations is held none.
                components.push(if turns_freely { 0.0 } else { moments[freedom] * force * length });
                continue;
            }
            let unit = if place < structure.dimension { force } else { force * length };
            components.push(if held(freedom) { unbalanced[freedom] * unit } else { 0.0 });
        }
    }
    recorded.no_reactions.with_components(components)
}

/// The sum of the applied forces over the nodes.
pub(crate) fn applied_forces(scene: &Scene, row: &RowSource<'_>) -> SpaceVector {
    let (structure, loading) = (row.loading.structure, row.loading);
    let following = following_loads::forces(structure, &row.state.displacement);
    let force = |freedom: usize| {
        let dead = row.state.load * loading.pattern.forces[freedom] + loading.held.forces[freedom];
        dead + following.get(freedom).copied().unwrap_or(0.0)
    };
    let mut sum = [0.0; 3];
    for node in 0..structure.numbering.nodes() {
        sum.iter_mut().zip(structure.translations_of(node)).for_each(|(sum, freedom)| *sum += force(freedom));
    }
    // The ends of their edges have the forces of middles that follow.
    for node in scene.basis.following() {
        sum.iter_mut().zip(structure.translations_of(node)).for_each(|(sum, freedom)| *sum -= force(freedom));
    }
    sum[..structure.dimension].iter().map(|value| value * scene.plan().force_scale).collect()
}
