//! Nodes that several obstacles hold at once.
//!
//! In 2D a node pressed by two obstacles that are not parallel cannot move: equilibrium gives only the sum `R` of their
//! reactions, and the node is held as long as `R` lies in the sum of their friction cones. That is a cone itself, between
//! two of the rays `n_i ± μ_i t_i`; where it covers a half-plane or more, the node is jammed and stays.
//! The reactions that are reported are those of least norm (`contact::share`).

use super::loading::Loading;
use super::standing::ZERO;
use super::state::State;
use crate::contact::share::{Cone, least_reactions};
use crate::contact::vector::{Vector, add, dot};
use crate::contact::{Frame, Mode, Reaction};

/// A node with several contacts.
#[derive(Debug, Clone)]
pub struct Corner {
    pub contacts: Vec<usize>,
}

/// The sum of friction cones in 2D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Unit vectors across its two bounding rays, pointing in; `None` where it has no bound.
    pub inward: Option<[Vector; 2]>,
}

/// Rays closer to opposite than this (sine of the angle) span a half-plane.
const FLAT: f64 = 1e-12;

impl Corner {
    /// The contacts that hold the node together in these modes; none where fewer than two do.
    pub fn holding<'a>(&'a self, modes: &'a [Mode]) -> impl Iterator<Item = usize> + 'a {
        let sticking = |contact: &&usize| modes[**contact] == Mode::Stick;
        let together = self.contacts.iter().filter(sticking).count() >= 2;
        self.contacts.iter().filter(move |contact| together && sticking(contact)).copied()
    }
}

/// Whether two lists of modes continue each other. Where two contacts press a node in 2D it is held, whatever is said of
/// the slip that none of them can have.
pub fn agree(loading: Loading<'_>, first: &[Mode], second: &[Mode]) -> bool {
    let held = |modes: &[Mode], corner: &Corner| {
        let active = corner.contacts.iter().filter(|contact| modes[**contact].is_active()).count();
        loading.structure.dimension == 2 && active >= 2
    };
    let free_of_corners = |contact: &usize| {
        !loading
            .corners
            .iter()
            .any(|corner| corner.contacts.contains(contact) && held(first, corner) && held(second, corner))
    };
    (0..first.len()).filter(free_of_corners).all(|contact| first[contact].continues(second[contact]))
}

/// Whether a node is closed against several obstacles that the running stage moves against each other, or in space with
/// friction: the bounds of such a hold are not known.
pub fn is_not_available(loading: Loading<'_>, state: &State) -> bool {
    let shifts = &loading.pattern.shifts;
    let circular = |contact: &usize| loading.contacts[*contact].tangents() == 2;
    loading.corners.iter().any(|corner| {
        let closed: Vec<usize> =
            corner.contacts.iter().copied().filter(|contact| loading.gap(*contact, state) <= ZERO).collect();
        let moving = closed.iter().skip(1).any(|other| shifts[closed[0]] != shifts[*other]);
        closed.len() > 1 && (moving || closed.iter().any(circular))
    })
}

/// The whole force of an obstacle on its node.
pub fn force(frame: &Frame, reaction: &Reaction) -> Vector {
    add(&reaction.tangential, reaction.normal, &frame.normal)
}

/// Sum of the forces of some contacts on their node.
pub fn total_force(loading: Loading<'_>, contacts: impl Iterator<Item = usize>, state: &State) -> Vector {
    contacts.fold([0.0; 3], |sum, contact| {
        add(&sum, 1.0, &force(&loading.frame(contact, state), &state.reactions[contact]))
    })
}

/// The two rays of a contact's cone in 2D, clockwise last.
pub fn rays(frame: &Frame, friction: f64) -> [Vector; 2] {
    let tangent = [frame.normal[1], -frame.normal[0], 0.0];
    [add(&frame.normal, -friction, &tangent), add(&frame.normal, friction, &tangent)]
}

fn turn(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The sum of the cones of some contacts of a node in 2D.
pub fn sector(loading: Loading<'_>, contacts: &[usize], state: &State) -> Sector {
    let all: Vec<Vector> = contacts
        .iter()
        .flat_map(|contact| rays(&loading.frame(*contact, state), loading.contacts[*contact].friction))
        .map(|ray| crate::contact::vector::unit(&ray))
        .collect();
    // A ray bounds the sector where all others lie on one side of it.
    let bounds = |side: f64| {
        all.iter().find(|ray| {
            all.iter().all(|other| {
                let sine = side * turn(ray, other);
                sine > FLAT || (sine >= -FLAT && dot(ray, other) > 0.0)
            })
        })
    };
    let inward = match (bounds(1.0), bounds(-1.0)) {
        (Some(first), Some(last)) => Some([[-first[1], first[0], 0.0], [last[1], -last[0], 0.0]]),
        _ => None,
    };
    Sector { inward }
}

/// Puts the reactions of least norm in the place of those of the first holding contact, which has the whole force.
pub fn share(loading: Loading<'_>, corners: &[Corner], modes: &[Mode], state: &mut State) {
    for corner in corners {
        let holding: Vec<usize> = corner.holding(modes).collect();
        if holding.is_empty() {
            continue;
        }
        let force = total_force(loading, holding.iter().copied(), state);
        let frames: Vec<Frame> = holding.iter().map(|contact| loading.frame(*contact, state)).collect();
        let cones: Vec<Cone> = holding
            .iter()
            .zip(&frames)
            .map(|(contact, frame)| Cone { normal: frame.normal, friction: loading.contacts[*contact].friction })
            .collect();
        // Just at a bound of the cones together the least reactions may not be found: two rays make up the force.
        let parts = least_reactions(&cones, &force).or_else(|| along_rays(loading, &holding, &force, state));
        // Outside the cones the event that ends the mode was passed; the point is not kept.
        let Some(parts) = parts else { continue };
        for ((contact, frame), part) in holding.iter().zip(&frames).zip(parts) {
            let normal = dot(&part, &frame.normal);
            state.reactions[*contact] = Reaction { normal, tangential: add(&part, -normal, &frame.normal) };
        }
    }
}

/// Reactions along two of the rays that bound the friction cones in 2D, with the smallest sum of squares.
fn along_rays(loading: Loading<'_>, holding: &[usize], force: &Vector, state: &State) -> Option<Vec<Vector>> {
    let all: Vec<(usize, Vector)> = holding
        .iter()
        .enumerate()
        .flat_map(|(place, contact)| {
            rays(&loading.frame(*contact, state), loading.contacts[*contact].friction).map(|ray| (place, ray))
        })
        .collect();
    let mut best: Option<(f64, Vec<Vector>)> = None;
    for (index, (first, a)) in all.iter().enumerate() {
        for (second, b) in &all[index + 1..] {
            let determinant = turn(a, b);
            if determinant.abs() <= FLAT {
                continue;
            }
            let (x, y) = (turn(force, b) / determinant, turn(a, force) / determinant);
            let round_off = -FLAT * dot(force, force).sqrt();
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
