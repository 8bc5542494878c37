//! The reactions of least norm, by which contacts share the force on the node that they hold.

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::least_norm_projection::{Cone, least_reactions};
use crate::mechanics::contact::vector::{Vector, add, dot, unit};
use crate::mechanics::contact::{Frame, Mode};
use crate::mechanics::multi_contact::planar::{rays_in, turn};
use crate::mechanics::multi_contact::spatial::ContactGroup;
use crate::mechanics::multi_contact::tolerances::ONE_MOTION_COSINE;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::{Corner, free_directions, is_in_plane, taken_apart, total_force};
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::OPPOSITE_RAY_ANGLE;

/// Whether two lists of modes continue each other. In 2D two active contacts hold their node, so that neither can slip
/// and their modes are not compared; nor are they in space, unless the contacts slip in one motion.
pub fn agree(loading: Loading<'_>, first: &[Mode], second: &[Mode]) -> bool {
    let held = |modes: &[Mode], corner: &Corner| {
        let active: Vec<Mode> =
            corner.contacts.iter().map(|contact| modes[*contact]).filter(|mode| mode.is_active()).collect();
        active.len() >= 2 && (loading.structure.dimension == 2 || !slip_as_one(&active))
    };
    let free_of_corners = |contact: &usize| {
        !loading
            .corners
            .iter()
            .any(|corner| corner.contacts.contains(contact) && held(first, corner) && held(second, corner))
    };
    (0..first.len()).filter(free_of_corners).all(|contact| first[contact].continues(second[contact]))
}

/// Whether the active contacts of a node in space slip along one line, so that the node slides along an edge.
pub(crate) fn slip_as_one(active: &[Mode]) -> bool {
    let slips: Vec<Vector> = active
        .iter()
        .filter_map(|mode| match mode {
            Mode::Slip { direction } => Some(*direction),
            Mode::Free | Mode::Stick => None,
        })
        .collect();
    let rough: Vec<&Vector> = slips.iter().filter(|direction| **direction != [0.0; 3]).collect();
    slips.len() == active.len()
        && slips.len() == 2
        && rough.windows(2).all(|pair| dot(pair[0], pair[1]) >= ONE_MOTION_COSINE)
}

/// Replaces the reaction of the first holding contact, which has the total force, by reactions of least norm of all.
pub fn share(loading: Loading<'_>, corners: &[Corner], modes: &[Mode], state: &mut State) {
    for corner in corners {
        let holding: Vec<usize> = corner.holding(modes).collect();
        if holding.is_empty() {
            continue;
        }
        if !is_in_plane(loading, corner) {
            let group = ContactGroup::new(loading, &holding, state);
            let force = group.force(loading, state);
            for (place, part) in group.share(&force).into_iter().flatten().enumerate() {
                state.reactions[holding[place]] = taken_apart(&part, &group.frames[place], group.frictions[place]);
            }
            continue;
        }
        let force = total_force(loading, holding.iter().copied(), state);
        let frames: Vec<Frame> = holding.iter().map(|contact| loading.frame(*contact, state)).collect();
        let cones: Vec<Cone> = holding
            .iter()
            .zip(&frames)
            .map(|(contact, frame)| match modes[*contact] {
                // A slip reduces the cone to one ray.
                Mode::Slip { direction } => {
                    let ray = loading.contacts[*contact].friction.force_direction(&frame.normal, &direction);
                    Cone { normal: unit(&ray), friction: CoulombFriction::SMOOTH, line: None }
                }
                Mode::Stick | Mode::Free => {
                    Cone { normal: frame.normal, friction: loading.contacts[*contact].friction, line: None }
                }
            })
            .collect();
        let free = free_directions(loading, holding[0]);
        // On a bound of the sum of the cones the reactions of least norm may not be found: two rays carry the force.
        let parts =
            least_reactions(&cones, &free, &force).or_else(|| along_rays(loading, &holding, modes, &force, state));
        // Outside the sum of the cones the event that ends the mode has been passed; the point is discarded.
        let Some(parts) = parts else { continue };
        for ((contact, frame), part) in holding.iter().zip(&frames).zip(parts) {
            state.reactions[*contact] = taken_apart(&part, frame, loading.contacts[*contact].friction);
        }
    }
}

/// Reactions along two of the rays that bound the friction cones in 2D, with the smallest sum of squares.
pub(crate) fn along_rays(
    loading: Loading<'_>,
    holding: &[usize],
    modes: &[Mode],
    force: &Vector,
    state: &State,
) -> Option<Vec<Vector>> {
    let all: Vec<(usize, Vector)> = holding
        .iter()
        .enumerate()
        .flat_map(|(place, contact)| {
            rays_in(loading, *contact, modes[*contact], state).into_iter().map(move |ray| (place, ray))
        })
        .collect();
    let mut best: Option<(f64, Vec<Vector>)> = None;
    for (index, (first, a)) in all.iter().enumerate() {
        for (second, b) in &all[index + 1..] {
            let determinant = turn(a, b);
            if determinant.abs() <= OPPOSITE_RAY_ANGLE {
                continue;
            }
            // The part along `a` takes the remainder, so that the sum is the force however close the rays are.
            let y = turn(a, force) / determinant;
            let x = dot(a, &add(force, -y, b));
            let round_off = -OPPOSITE_RAY_ANGLE * dot(force, force).sqrt();
            if x < round_off || y < round_off {
                continue;
            }
            let mut parts = vec![[0.0; 3]; holding.len()];
            parts[*first] = add(&parts[*first], x.max(0.0), a);
            parts[*second] = add(&parts[*second], y.max(0.0), b);
            let squares = parts.iter().map(|part| dot(part, part)).sum();
            if best.as_ref().is_none_or(|(least, _)| squares < *least) {
                best = Some((squares, parts));
            }
        }
    }
    best.map(|(_, parts)| parts)
}
