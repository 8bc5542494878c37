//! One contact: penalty reaction, return mapping of friction, and the derivative of both.

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, add, dot, size};
use crate::mechanics::contact::{Frame, Reaction};
use crate::result::increment::Status;

type Matrix = [[f64; 3]; 3];

/// Stiffnesses of the regularisation (dimensionless).
#[derive(Debug, Clone, Copy)]
pub struct Penalties {
    pub normal: f64,
    pub tangential: f64,
}

/// The response of the obstacle to the motion of a node.
#[derive(Debug, Clone, Copy)]
pub struct PenaltyResponse {
    pub status: Status,
    /// `r_n` and `t`.
    pub reaction: Reaction,
    /// Slip part of the tangential motion since the start of the increment, a vector in space.
    pub slip: Vector,
    /// The force on the node, `r_n n + t`.
    pub force: Vector,
    /// `-∂force/∂x`
    pub stiffness: Matrix,
}

impl Default for PenaltyResponse {
    fn default() -> Self {
        Self {
            status: Status::Free,
            reaction: Reaction::default(),
            slip: [0.0; 3],
            force: [0.0; 3],
            stiffness: [[0.0; 3]; 3],
        }
    }
}

/// The response at a frame, where the increment began with the tangential reaction `before` and the node has moved by
/// `moved` since. A gap of exactly zero is closed: a path may start there.
pub fn respond(
    penalties: Penalties,
    friction: CoulombFriction,
    frame: &Frame,
    before: &Vector,
    moved: &Vector,
) -> PenaltyResponse {
    if frame.gap > 0.0 {
        return PenaltyResponse::default();
    }
    let n = &frame.normal;
    let project = across(n);
    let turn = frame.shape_operator();
    let normal = penalties.normal * -frame.gap + 0.0;
    let reaction = Reaction { normal, tangential: [0.0; 3] };
    let mut response = PenaltyResponse { status: Status::Slip, reaction, ..PenaltyResponse::default() };
    // -∂(r_n n)/∂x
    let normal_part = |row: usize, column: usize| penalties.normal * n[row] * n[column] - normal * turn[row][column];
    response.stiffness = matrix(normal_part);
    response.force = vector(|k| normal * n[k]);
    if !friction.is_rough() {
        response.slip = times(&project, moved);
        return response;
    }
    let unprojected = add(before, -penalties.tangential, moved);
    let trial = times(&project, &unprojected);
    let size = size(&trial);
    let along_normal = dot(n, &unprojected);
    let turned = times(&turn, &unprojected);
    // ∂(trial)/∂x, including the rotation of the tangent plane
    let trial_slope = matrix(|row, column| {
        -penalties.tangential * project[row][column] - (along_normal * turn[row][column] + n[row] * turned[column])
    });
    let bound = friction.bound(normal);
    let slope = if size <= bound {
        response.status = Status::Stick;
        response.reaction.tangential = trial;
        trial_slope
    } else {
        let direction = vector(|k| trial[k] / size);
        let turning = across(&direction);
        response.reaction.tangential = vector(|k| bound * direction[k]);
        response.slip = vector(|k| (bound - size) / penalties.tangential * direction[k]);
        matrix(|row, column| {
            let turned: f64 = (0..3).map(|k| turning[row][k] * trial_slope[k][column]).sum();
            bound / size * turned - friction.bound(penalties.normal) * direction[row] * n[column]
        })
    };
    response.force = vector(|k| normal * n[k] + response.reaction.tangential[k]);
    response.stiffness = matrix(|row, column| normal_part(row, column) - slope[row][column]);
    response
}

fn vector(entry: impl Fn(usize) -> f64) -> Vector {
    std::array::from_fn(entry)
}

fn matrix(entry: impl Fn(usize, usize) -> f64) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)))
}

/// `I - n nᵀ`
fn across(n: &Vector) -> Matrix {
    matrix(|row, column| if row == column { 1.0 - n[row] * n[column] } else { -n[row] * n[column] })
}

fn times(matrix: &Matrix, values: &Vector) -> Vector {
    vector(|row| dot(&matrix[row], values))
}

#[cfg(test)]
mod tests {
    use super::{Frame, Penalties, PenaltyResponse, dot, respond};
    use crate::mechanics::contact::coulomb::CoulombFriction;
    use crate::mechanics::contact::obstacle::RigidSurface;
    use crate::mechanics::contact::{ContactPair, Sliding};
    use crate::result::increment::Status;

    const FRICTION: CoulombFriction = CoulombFriction { coefficient: 0.4 };
    const PENALTIES: Penalties = Penalties { normal: 300.0, tangential: 70.0 };

    #[derive(Clone, Copy, PartialEq)]
    enum Shape {
        /// `z = 0`
        Plane,
        /// Of radius 2 around the origin.
        Ball,
        /// Of radius 2 about an axis in the plane `z = 0`.
        Cylinder,
    }

    fn frame(place: &[f64; 3], shape: Shape) -> Frame {
        let offset = [0.0, 0.0, 2.0];
        let from_top = [place[0], place[1], place[2] - 2.0];
        let (obstacle, relative) = match shape {
            Shape::Plane => (RigidSurface::Plane { normal: [0.0, 0.0, 1.0] }, *place),
            Shape::Ball => (RigidSurface::Ball { offset, side: 1.0 }, from_top),
            Shape::Cylinder => (RigidSurface::Cylinder { axis: [0.6, 0.8, 0.0], offset, side: 1.0 }, from_top),
        };
        ContactPair {
            kinematics: crate::mechanics::contact::kinematics::Kinematics::Node(0),
            obstacle,
            initial_gap: 0.0,
            friction: FRICTION,
            sliding: Sliding::Plane,
        }
        .frame(&relative)
    }

    fn response(place: &[f64; 3], start: &[f64; 3], shape: Shape) -> PenaltyResponse {
        let before = if shape == Shape::Plane { [0.02, 0.03, 0.0] } else { [0.02, 0.03, -0.01] };
        let moved = std::array::from_fn(|k| place[k] - start[k]);
        respond(PENALTIES, FRICTION, &frame(place, shape), &before, &moved)
    }

    /// The stiffness agrees with central differences of the force: sticking and slipping, flat and curved.
    #[test]
    fn the_stiffness_is_the_derivative_of_the_force() {
        let flat = [0.0, 0.0, -0.01];
        let curved = [0.6, 1.1, (1.99_f64.powi(2) - 0.36 - 1.21).sqrt()];
        let beside_axis = [0.46, 0.28, (1.99_f64.powi(2) - 0.04).sqrt()];
        for (start, shape) in [(flat, Shape::Plane), (curved, Shape::Ball), (beside_axis, Shape::Cylinder)] {
            for (motion, status) in [([1e-4, -2e-4, -1e-4], Status::Stick), ([0.05, -0.03, -0.01], Status::Slip)] {
                let place: [f64; 3] = std::array::from_fn(|k| start[k] + motion[k]);
                let here = response(&place, &start, shape);
                assert_eq!(here.status, status);
                for column in 0..3 {
                    let shifted = |sign: f64| {
                        let mut place = place;
                        place[column] += sign * 1e-6;
                        response(&place, &start, shape).force
                    };
                    let (ahead, behind) = (shifted(1.0), shifted(-1.0));
                    for row in 0..3 {
                        let slope = (behind[row] - ahead[row]) / 2e-6;
                        let found = here.stiffness[row][column];
                        assert!((slope - found).abs() < 1e-4, "{row} {column}: {slope} {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn slip_lies_on_the_cone_and_runs_against_friction() {
        let slipping = response(&[0.05, 0.03, -0.02], &[0.0, 0.0, -0.01], Shape::Plane);
        let tangential = slipping.reaction.tangential;
        let size = dot(&tangential, &tangential).sqrt();
        assert!((size - 0.4 * slipping.reaction.normal).abs() < 1e-14);
        assert!((slipping.reaction.normal - 6.0).abs() < 1e-14);
        let slip = dot(&slipping.slip, &slipping.slip).sqrt();
        assert!((dot(&slipping.slip, &tangential) + slip * size).abs() < 1e-14);
        // Slip and change of the elastic part make up the whole motion.
        let elastic = [0.02, 0.03, 0.0].map(|t| -t / PENALTIES.tangential);
        for k in 0..2 {
            let change = -tangential[k] / PENALTIES.tangential - elastic[k];
            assert!((slipping.slip[k] + change - [0.05, 0.03][k]).abs() < 1e-14);
        }
    }

    #[test]
    fn an_open_contact_does_nothing_and_forgets() {
        let open = response(&[0.05, 0.03, 1e-9], &[0.0, 0.0, -0.01], Shape::Plane);
        assert_eq!((open.status, open.force, open.reaction.tangential), (Status::Free, [0.0; 3], [0.0; 3]));
        let closed = respond(PENALTIES, FRICTION, &frame(&[0.0; 3], Shape::Plane), &[0.0; 3], &[0.0; 3]);
        assert_eq!(closed.status, Status::Stick);
        assert_eq!(closed.stiffness[2][2], PENALTIES.normal);
    }
}
