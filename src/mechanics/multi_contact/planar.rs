//! Nodes in contact with several obstacles at once in the plane.
//!
//! In 2D a node pressed against two obstacles that are not parallel cannot move: equilibrium determines only the sum
//! `R` of their reactions, and the node is held as long as `R` lies in the sum of their friction cones. This sum is a
//! cone itself, between two of the rays `n_i ± μ_i t_i`: a sector of less than a half-plane, a half-plane with one
//! bound, or the whole plane; in the last case the node is jammed and does not move. For two smooth walls that face
//! each other the sum is a line.
//!
//! For nodes in space, and nodes guided by supports, see `spatial`; for nodes between planes that move against each
//! other, `moving_planes`. Smooth obstacles with independent normals need none of this: equilibrium determines the
//! reaction of each, in the plane and in space, and the obstacles may move against each other. The reported reactions
//! are those of least norm (`reaction_split::share`).

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, add, scaled, unit};
use crate::mechanics::contact::{Frame, Mode};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::OPPOSITE_RAY_ANGLE;
use std::f64::consts::{PI, TAU};

/// The sum of friction cones in 2D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Inward unit normals of the two bounds: the same vector twice for a half-plane; `None` where the sum is the whole
    /// plane.
    pub inward: Option<[Vector; 2]>,
}

/// The two rays that bound the friction cone of a contact in 2D, the clockwise one last.
pub fn rays(frame: &Frame, friction: CoulombFriction) -> [Vector; 2] {
    let tangent = [frame.normal[1], -frame.normal[0], 0.0];
    [friction.force_direction(&frame.normal, &tangent), add(&frame.normal, friction.coefficient, &tangent)]
}

pub(crate) fn turn(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The rays that bound the admissible reactions of a contact in a mode in 2D.
pub(crate) fn rays_in(loading: Loading<'_>, contact: usize, mode: Mode, state: &State) -> Vec<Vector> {
    let (frame, friction) = (loading.frame(contact, state), loading.contacts[contact].friction);
    match mode {
        Mode::Slip { direction } => vec![unit(&friction.force_direction(&frame.normal, &direction))],
        Mode::Stick | Mode::Free => rays(&frame, friction).iter().map(unit).collect(),
    }
}

/// The sum of the admissible reactions of some contacts of a node in 2D: of their cones, or of a ray for each slip.
pub fn sector(loading: Loading<'_>, contacts: &[usize], modes: impl Fn(usize) -> Mode, state: &State) -> Sector {
    sum_of(contacts.iter().flat_map(|contact| rays_in(loading, *contact, modes(*contact), state)).collect())
}

/// The sum of rays: the plane without the widest angle that contains no ray, if this angle is at least half a turn.
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
        [(widest, last, first), ref others @ ..] if widest >= PI - OPPOSITE_RAY_ANGLE => {
            let across = [-first[1], first[0], 0.0];
            // Half a turn is free on the other side, too: the sum is a line.
            let is_line = widest <= PI + OPPOSITE_RAY_ANGLE
                && others.first().is_some_and(|(second, ..)| *second >= PI - OPPOSITE_RAY_ANGLE);
            Some([across, if is_line { scaled(&across, -1.0) } else { [last[1], -last[0], 0.0] }])
        }
        _ => None,
    };
    Sector { inward }
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
        // Across the jump of the angle at half a turn.
        assert!(near(sum_of_angles(&[-170.0, 160.0]), [-110.0, 100.0]));
        // A half-plane.
        assert!(near(sum_of_angles(&[-45.0, 45.0, 60.0, 135.0]), [45.0, 45.0]));
        // More than a half-plane.
        assert_eq!(sum_of_angles(&[-45.0, 45.0, 45.0, 136.0]), None);
        assert_eq!(sum_of_angles(&[0.0, 120.0, -120.0]), None);
        // One ray, and two opposite ones: a line.
        assert!(near(sum_of_angles(&[90.0, 90.0]), [-180.0, 0.0]) || near(sum_of_angles(&[90.0, 90.0]), [180.0, 0.0]));
        let [one, other] = sum_of_angles(&[90.0, 90.0, -90.0, -90.0]).expect("a line");
        assert!(((one - other).abs() - 180.0).abs() < 1e-9);
    }
}
