//! Nodes that several obstacles hold at once.
//!
//! In 2D a node pressed by two obstacles that are not parallel cannot move: equilibrium gives only the sum `R` of their
//! reactions, and the node is held as long as `R` lies in the sum of their friction cones. That is a cone itself, between
//! two of the rays `n_i ± μ_i t_i`: a sector of less than a half-plane, or a half-plane with one bound, or all of the
//! plane, and then the node is jammed and stays. Two smooth walls that face each other leave just a line.
//! In space, and where supports guide the node, see `pocket`; between planes that move against each other, `carried`.
//! Smooth obstacles whose normals are independent need none of this: each has a reaction of its own, in the plane and in
//! space, and they may move against each other.
//! The reactions that are reported are those of least norm (`contact::share`).

use super::carried::Carried;
use super::energy::reaction_in_space;
use super::loading::Loading;
use super::pocket::{Pocket, free_directions};
use super::standing::ZERO;
use super::state::{Rate, State};
use crate::contact::share::{Cone, least_reactions};
use crate::contact::vector::{Vector, add, dot, scaled, size, unit};
use crate::contact::{Frame, Mode, Reaction, Sliding};
use std::f64::consts::{PI, TAU};

/// A node with several contacts.
#[derive(Debug, Clone)]
pub struct Corner {
    pub contacts: Vec<usize>,
}

/// The sum of friction cones in 2D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Unit vectors across its two bounds, pointing in: the same one twice for a half-plane; `None` where it is all of
    /// the plane.
    pub inward: Option<[Vector; 2]>,
}

/// Rays closer to opposite than this (angle) are opposite. A force that is taken as held then lies outside the true cone
/// by no more than this part of its size.
const FLAT: f64 = 1e-12;

/// A normal is independent of others where more than this part of it (sine of an angle) is across them.
const INDEPENDENT: f64 = 1e-6;

impl Corner {
    /// The contacts without a gap.
    pub fn closed(&self, loading: Loading<'_>, state: &State) -> Vec<usize> {
        self.contacts.iter().copied().filter(|contact| loading.gap(*contact, state) <= ZERO).collect()
    }

    /// The contacts that hold the node together in these modes, one that sticks first; none where fewer than two do. A node
    /// that sticks to an obstacle may be carried along others, against which it slips.
    pub fn holding<'a>(&'a self, modes: &'a [Mode]) -> impl Iterator<Item = usize> + 'a {
        let sticks = move |contact: &&usize| modes[**contact] == Mode::Stick;
        let slips = move |contact: &&usize| matches!(modes[**contact], Mode::Slip { .. });
        let active = self.contacts.iter().filter(|contact| modes[**contact].is_active()).count();
        let together = active >= 2 && self.contacts.iter().any(|contact| sticks(&contact));
        let sticking = self.contacts.iter().filter(move |contact| together && sticks(contact));
        sticking.chain(self.contacts.iter().filter(move |contact| together && slips(contact))).copied()
    }
}

/// Whether a node is free in the plane, so that the sum of its friction cones is a sector.
pub fn is_in_plane(loading: Loading<'_>, corner: &Corner) -> bool {
    loading.structure.dimension == 2
        && corner.contacts.iter().all(|contact| loading.contacts[*contact].sliding != Sliding::None)
}

/// Whether two lists of modes continue each other. Where two contacts press a node in 2D it is held, whatever is said of
/// the slip that none of them can have; so it is in space where they do not slip as one.
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

/// Cosine of the angle between slips that are those of one motion.
const ONE_MOTION: f64 = 1.0 - 1e-6;

/// Whether active contacts of a node in space slip along one line: their node slides along an edge.
fn slip_as_one(active: &[Mode]) -> bool {
    let slips: Vec<Vector> = active
        .iter()
        .filter_map(|mode| match mode {
            Mode::Slip { direction } => Some(*direction),
            Mode::Free | Mode::Stick => None,
        })
        .collect();
    let rough: Vec<&Vector> = slips.iter().filter(|direction| **direction != [0.0; 3]).collect();
    slips.len() == active.len() && slips.len() == 2 && rough.windows(2).all(|pair| dot(pair[0], pair[1]) >= ONE_MOTION)
}

/// Whether a node is closed against several obstacles in a way whose bounds are not known: where it is driven against
/// them or they move against each other, with friction or with more reactions than equilibrium tells apart; and where more
/// obstacles than an edge has bear a slide.
pub fn is_not_available(loading: Loading<'_>, state: &State) -> bool {
    loading.corners.iter().any(|corner| {
        let closed = corner.closed(loading, state);
        let is_known = || {
            if is_in_plane(loading, corner) {
                return !is_driven(loading, &closed) || Carried::of(loading, &closed, state).is_some();
            }
            Pocket::new(loading, &closed, state).is_determinate_when_sliding()
        };
        closed.len() > 1 && !are_determinate(loading, &closed, state) && !is_known()
    })
}

/// Whether the running stage drives a node against some closed obstacles by its supports, or them against each other.
pub fn is_driven(loading: Loading<'_>, closed: &[usize]) -> bool {
    let dimension = loading.structure.dimension;
    let first = loading.contacts[closed[0]].node * dimension;
    let shift = &loading.pattern.shifts[closed[0]];
    let by_support = |component: usize| {
        let freedom = first + component;
        loading.structure.unknown_of[freedom].is_none() && loading.support_rate(freedom) != shift[component]
    };
    move_apart(loading, closed) || (0..dimension).any(by_support)
}

/// Whether closed contacts of a node are best taken one by one: its equilibrium gives all reactions, and in the plane no
/// hold together is at rest.
pub fn stand_alone(loading: Loading<'_>, closed: &[usize], state: &State) -> bool {
    let apart = loading.structure.dimension == 3 || move_apart(loading, closed);
    apart && are_determinate(loading, closed, state)
}

/// Whether the running stage moves the obstacles of some contacts against each other.
fn move_apart(loading: Loading<'_>, contacts: &[usize]) -> bool {
    let shifts = &loading.pattern.shifts;
    contacts.iter().skip(1).any(|other| shifts[contacts[0]] != shifts[*other])
}

/// Whether the reactions of some contacts of a node follow from its equilibrium: none has friction, and their normals
/// are independent as far as the node is free to move.
fn are_determinate(loading: Loading<'_>, contacts: &[usize], state: &State) -> bool {
    let dimension = loading.structure.dimension;
    let mut basis: Vec<Vector> = Vec::new();
    contacts.iter().all(|contact| {
        let data = &loading.contacts[*contact];
        let mut rest = loading.frame(*contact, state).normal;
        for (component, part) in rest.iter_mut().enumerate() {
            let is_free =
                component < dimension && loading.structure.unknown_of[data.node * dimension + component].is_some();
            *part = if is_free { *part } else { 0.0 };
        }
        for known in &basis {
            rest = add(&rest, -dot(&rest, known), known);
        }
        let is_independent = size(&rest) > INDEPENDENT;
        basis.push(if is_independent { unit(&rest) } else { rest });
        data.tangents() == 0 && is_independent
    })
}

/// The whole force of an obstacle on its node.
pub fn force(frame: &Frame, reaction: &Reaction) -> Vector {
    add(&reaction.tangential, reaction.normal, &frame.normal)
}

/// Rates of the forces of the contacts on their nodes; for a node with several the sum, with the first of them: how it is
/// shared is not part of a motion.
pub fn whole_rates(loading: Loading<'_>, state: &State, rate: &Rate) -> Vec<Vector> {
    let mut rates: Vec<Vector> =
        (0..loading.contacts.len()).map(|contact| reaction_in_space(loading, contact, (state, rate)).1).collect();
    for corner in loading.corners {
        if let [first, others @ ..] = &corner.contacts[..] {
            for other in others {
                let part = std::mem::take(&mut rates[*other]);
                rates[*first] = add(&rates[*first], 1.0, &part);
            }
        }
    }
    rates
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

/// The rays that bound what a contact in a mode may bear in 2D.
fn rays_in(loading: Loading<'_>, contact: usize, mode: Mode, state: &State) -> Vec<Vector> {
    let (frame, friction) = (loading.frame(contact, state), loading.contacts[contact].friction);
    match mode {
        Mode::Slip { direction } => vec![unit(&add(&frame.normal, -friction, &direction))],
        Mode::Stick | Mode::Free => rays(&frame, friction).iter().map(unit).collect(),
    }
}

/// The sum of what some contacts of a node may bear in 2D: their cones, or a ray of those that slip.
pub fn sector(loading: Loading<'_>, contacts: &[usize], modes: impl Fn(usize) -> Mode, state: &State) -> Sector {
    sum_of(contacts.iter().flat_map(|contact| rays_in(loading, *contact, modes(*contact), state)).collect())
}

/// The sum of rays: what is left of the plane where the widest angle free of them, at least half a turn, is cut out.
fn sum_of(mut rays: Vec<Vector>) -> Sector {
    let angle = |ray: &Vector| ray[1].atan2(ray[0]);
    rays.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    // Each ray, the next one counterclockwise, and the angle between them.
    let mut free: Vec<(f64, &Vector, &Vector)> =
        rays.windows(2).map(|pair| (angle(&pair[1]) - angle(&pair[0]), &pair[0], &pair[1])).collect();
    if let [first, .., last] = &rays[..] {
        free.push((angle(first) + TAU - angle(last), last, first));
    }
    free.sort_by(|a, b| b.0.total_cmp(&a.0));
    let inward = match free[..] {
        [(widest, last, first), ref others @ ..] if widest >= PI - FLAT => {
            let across = [-first[1], first[0], 0.0];
            // Half a turn on the other side, too: only a line is left.
            let is_line = widest <= PI + FLAT && others.first().is_some_and(|(second, ..)| *second >= PI - FLAT);
            Some([across, if is_line { scaled(&across, -1.0) } else { [last[1], -last[0], 0.0] }])
        }
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
        if !is_in_plane(loading, corner) {
            let pocket = Pocket::new(loading, &holding, state);
            let force = pocket.force(loading, state);
            for (place, part) in pocket.share(&force).into_iter().flatten().enumerate() {
                state.reactions[holding[place]] = taken_apart(&part, &pocket.frames[place], pocket.frictions[place]);
            }
            continue;
        }
        let force = total_force(loading, holding.iter().copied(), state);
        let frames: Vec<Frame> = holding.iter().map(|contact| loading.frame(*contact, state)).collect();
        let cones: Vec<Cone> = holding
            .iter()
            .zip(&frames)
            .map(|(contact, frame)| match modes[*contact] {
                // One ray is left of the cone.
                Mode::Slip { direction } => {
                    let ray = add(&frame.normal, -loading.contacts[*contact].friction, &direction);
                    Cone { normal: unit(&ray), friction: 0.0, line: None }
                }
                Mode::Stick | Mode::Free => {
                    Cone { normal: frame.normal, friction: loading.contacts[*contact].friction, line: None }
                }
            })
            .collect();
        let free = free_directions(loading, loading.contacts[holding[0]].node);
        // Just at a bound of the cones together the least reactions may not be found: two rays make up the force.
        let parts =
            least_reactions(&cones, &free, &force).or_else(|| along_rays(loading, &holding, modes, &force, state));
        // Outside the cones the event that ends the mode was passed; the point is not kept.
        let Some(parts) = parts else { continue };
        for ((contact, frame), part) in holding.iter().zip(&frames).zip(parts) {
            state.reactions[*contact] = taken_apart(&part, frame, loading.contacts[*contact].friction);
        }
    }
}

/// Normal and tangential parts of a force in the cone of a contact. With much friction the normal part may be lost in the
/// rounding of the whole: it is then what the cone makes of the tangential one.
pub fn taken_apart(force: &Vector, frame: &Frame, friction: f64) -> Reaction {
    if friction == 0.0 {
        return Reaction::along(force, &frame.normal);
    }
    let Reaction { normal, tangential } = Reaction::of(force, &frame.normal);
    // A little more, so that the cone holds in spite of rounding, however large the force.
    let least = size(&tangential) / friction * (1.0 + 4.0 * f64::EPSILON);
    let is_round_off = least - normal <= FLAT * size(force);
    Reaction { normal: if is_round_off { normal.max(least) } else { normal }, tangential }
}

/// Reactions along two of the rays that bound the friction cones in 2D, with the smallest sum of squares.
fn along_rays(
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
            if determinant.abs() <= FLAT {
                continue;
            }
            // However close the rays are, the parts make up the force: the one takes what the other leaves.
            let y = turn(a, force) / determinant;
            let x = dot(a, &add(force, -y, b));
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

#[cfg(test)]
mod tests {
    use super::*;

    fn sum_of_angles(degrees: &[f64]) -> Option<[f64; 2]> {
        let ray = |degrees: &f64| [degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0];
        let inward = sum_of(degrees.iter().map(ray).collect()).inward?;
        Some(inward.map(|across| across[1].atan2(across[0]).to_degrees()))
    }

    #[test]
    fn a_sum_of_rays_has_two_bounds_or_one_or_none() {
        let near = |found: Option<[f64; 2]>, expected: [f64; 2]| {
            let found = found.expect("bounds");
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9)
        };
        assert!(near(sum_of_angles(&[10.0, 60.0, 100.0, 20.0]), [100.0, 10.0]));
        // Across the place where the angle jumps.
        assert!(near(sum_of_angles(&[-170.0, 160.0]), [-110.0, 100.0]));
        // A half-plane.
        assert!(near(sum_of_angles(&[-45.0, 45.0, 60.0, 135.0]), [45.0, 45.0]));
        // More.
        assert_eq!(sum_of_angles(&[-45.0, 45.0, 45.0, 136.0]), None);
        assert_eq!(sum_of_angles(&[0.0, 120.0, -120.0]), None);
        // One ray, and two opposite ones: a line.
        assert!(near(sum_of_angles(&[90.0, 90.0]), [-180.0, 0.0]) || near(sum_of_angles(&[90.0, 90.0]), [180.0, 0.0]));
        let [one, other] = sum_of_angles(&[90.0, 90.0, -90.0, -90.0]).expect("a line");
        assert!(((one - other).abs() - 180.0).abs() < 1e-9);
    }
}
