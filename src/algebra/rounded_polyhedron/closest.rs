//! The point of a rounded polyhedron closest to a place: Newton's method in the surface. All lengths are multiples of the
//! rounding.

use crate::algebra::rounded_polyhedron::filling::{Filling, filling};
use crate::algebra::rounded_polyhedron::polyhedron::Polyhedron;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Steps of an iteration.
const MOST_STEPS: usize = 100;
/// Halvings of a step that does not lead closer.
const MOST_HALVINGS: usize = 30;
/// A place nearer to the polyhedron than this is searched from, otherwise the nearest point of the polyhedron.
const NEAR: f64 = 0.5;
/// The longest step along the normal.
const LONGEST: f64 = 0.25;
/// Where the filled share changes by less than this per length, the ball is full or empty but for round-off.
const LEAST_SLOPE: f64 = 1e-6;
/// Steps below this part of the coordinates change nothing.
const NO_STEP: f64 = 4.0 * f64::EPSILON;
/// Steps and distances that differ by less than this part of the coordinates may be equal.
const ROUND_OFF: f64 = 1e-13;
/// A place nearer to the polyhedron than this may be on an edge, where the share is undetermined: the search begins this
/// much farther inside.
const ON_POLYHEDRON: f64 = 1e-9;
const INWARDS: f64 = 0.05;
/// Least value of `1 + κ d` (curvature and distance), which is 0 at a centre of curvature: there the closest point is not
/// unique, and no contact is closed.
const NEAR_CENTRE: f64 = 1e-9;

/// A surface at its point closest to a place.
#[derive(Debug, Clone, Copy)]
pub struct FootPoint {
    /// The signed distance of the place, positive outside (length).
    pub distance: f64,
    /// The unit normal, outwards.
    pub normal: Vector3<f64>,
    /// The principal curvatures of the parallel surface through the place (1/length), positive where it is convex, with
    /// unit vectors along them.
    pub curvatures: [(f64, Vector3<f64>); 2],
}

impl FootPoint {
    /// The same with all lengths so many times as long.
    pub(super) fn times(self, factor: f64) -> Self {
        let curvatures = self.curvatures.map(|(curvature, along)| (curvature / factor, along));
        Self { distance: self.distance * factor, normal: self.normal, curvatures }
    }
}

/// See [`super::RoundedPolyhedron::closest`].
pub(super) fn closest(polyhedron: &Polyhedron, place: &Vector3<f64>) -> FootPoint {
    let Some(nearest) = Nearest::of(polyhedron, place) else {
        return FootPoint { distance: f64::INFINITY, normal: Vector3::z(), curvatures: [(0.0, Vector3::zeros()); 2] };
    };
    let from_place = || nearest.surface_near(polyhedron, place);
    let from_polyhedron = || nearest.surface_near(polyhedron, &nearest.point);
    let is_near = (place - nearest.point).norm() < NEAR;
    let found = if is_near { from_place().or_else(from_polyhedron) } else { from_polyhedron() };
    let Some(mut at) = found else {
        // The rounding leaves no surface here, which a check finds: the plane of the nearest face.
        let distance = (place - nearest.point).dot(&nearest.normal);
        return FootPoint { distance, normal: nearest.normal, curvatures: [(0.0, Vector3::zeros()); 2] };
    };
    for _ in 0..MOST_STEPS {
        if at.offset(place).norm() <= ROUND_OFF * reach(place) {
            break;
        }
        let Some(closer) = at.closer(polyhedron, place) else { break };
        at = closer;
    }
    at.foot(place)
}

/// Whether there is a surface next to a point of the polyhedron.
pub(super) fn has_surface(polyhedron: &Polyhedron, point: &Vector3<f64>) -> bool {
    Nearest::of(polyhedron, point).is_some_and(|nearest| nearest.surface_near(polyhedron, point).is_some())
}

/// The size that round-off of coordinates is relative to.
fn reach(place: &Vector3<f64>) -> f64 {
    place.amax().max(1.0)
}

/// The point of the polyhedron nearest to a place.
struct Nearest {
    point: Vector3<f64>,
    /// Of the face.
    normal: Vector3<f64>,
}

impl Nearest {
    fn of(polyhedron: &Polyhedron, place: &Vector3<f64>) -> Option<Self> {
        let (face, point) = polyhedron.triangles.nearest(place)?;
        Some(Self { point, normal: polyhedron.faces[face].normal })
    }

    /// A point of the surface next to a place.
    fn surface_near(&self, polyhedron: &Polyhedron, place: &Vector3<f64>) -> Option<LevelSetPoint> {
        let mut start = *place;
        if (place - self.point).norm() < ON_POLYHEDRON {
            let inwards = filling(polyhedron, place).gradient.try_normalize(LEAST_SLOPE).unwrap_or(-self.normal);
            start += inwards * INWARDS;
        }
        let is_outside = (start - self.point).dot(&self.normal) > 0.0;
        LevelSetPoint::along_gradient(polyhedron, &start, if is_outside { -self.normal } else { self.normal })
    }
}

/// A point of the surface, a level set of the filled share.
struct LevelSetPoint {
    point: Vector3<f64>,
    /// Outwards.
    normal: Vector3<f64>,
    /// How the normal turns along the surface, `dn = W dy`.
    turn: Matrix3<f64>,
}

impl LevelSetPoint {
    /// The point of the surface that is reached along the gradient of the filled share, by Newton's method with bounded
    /// steps; `towards` leads to where the share changes. `None` where no ball is half filled.
    fn along_gradient(polyhedron: &Polyhedron, start: &Vector3<f64>, towards: Vector3<f64>) -> Option<Self> {
        let mut point = *start;
        let (mut before, mut longest) = (0.0_f64, LONGEST);
        for _ in 0..MOST_STEPS {
            let found = filling(polyhedron, &point);
            let slope = found.gradient.norm();
            if slope <= LEAST_SLOPE {
                point += towards * LONGEST;
                continue;
            }
            let normal = found.gradient / -slope;
            let whole = (found.share - 0.5) / slope;
            if whole * before < 0.0 {
                longest = (0.5 * longest).max(whole.abs().min(before.abs()));
            }
            let step = whole.clamp(-longest, longest);
            let is_stagnant = step.abs() >= before.abs() && step.abs() <= ROUND_OFF * reach(&point);
            if is_stagnant || step.abs() <= NO_STEP * reach(&point) {
                return Some(Self::new(point, normal, &found));
            }
            before = step;
            point += normal * step;
        }
        None
    }

    fn new(point: Vector3<f64>, normal: Vector3<f64>, filling: &Filling) -> Self {
        let across = Matrix3::identity() - normal * normal.transpose();
        Self { point, normal, turn: across * filling.second * across / -filling.gradient.norm() }
    }

    /// The part along the surface of the vector to a place.
    fn offset(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let from = place - self.point;
        from - self.normal * from.dot(&self.normal)
    }

    /// How the normal turns, in components along tangents.
    fn entries(&self, tangents: &[Vector3<f64>; 2]) -> Matrix2<f64> {
        Matrix2::from_fn(|row, column| tangents[row].dot(&(self.turn * tangents[column])))
    }

    /// A point of the surface closer to a place, by a step of Newton's method for the least distance; `None` where none is.
    fn closer(&self, polyhedron: &Polyhedron, place: &Vector3<f64>) -> Option<Self> {
        let (from, offset) = (place - self.point, self.offset(place));
        let (distance, before) = (from.dot(&self.normal), from.norm());
        let tangents = tangents(&self.normal);
        let right = Vector2::from(tangents.map(|tangent| tangent.dot(&offset)));
        let second = Matrix2::identity() + self.entries(&tangents) * distance;
        let newton = second.cholesky().map(|factors| factors.solve(&right));
        let mut step = newton.unwrap_or(right / (1.0 + distance.abs() * self.turn.norm()));
        let is_closer = |next: &Self| {
            let distance = (place - next.point).norm();
            // At the solution distances differ by less than round-off.
            let may_be = distance < before * (1.0 + ROUND_OFF) && next.offset(place).norm() < 0.5 * offset.norm();
            distance < before * (1.0 - ROUND_OFF) || may_be
        };
        for _ in 0..MOST_HALVINGS {
            if step.norm() <= NO_STEP * reach(place) {
                return None;
            }
            let start = self.point + tangents[0] * step[0] + tangents[1] * step[1];
            let next = Self::along_gradient(polyhedron, &start, self.normal).filter(is_closer);
            if next.is_some() {
                return next;
            }
            step *= 0.5;
        }
        None
    }

    fn foot(&self, place: &Vector3<f64>) -> FootPoint {
        let distance = (place - self.point).dot(&self.normal);
        let tangents = tangents(&self.normal);
        let principal = self.entries(&tangents).symmetric_eigen();
        let curvatures = [0, 1].map(|k| {
            let (curvature, along) = (principal.eigenvalues[k], principal.eigenvectors.column(k));
            let at_place = curvature / (1.0 + curvature * distance).max(NEAR_CENTRE);
            (at_place, tangents[0] * along[0] + tangents[1] * along[1])
        });
        FootPoint { distance, normal: self.normal, curvatures }
    }
}

/// Two unit vectors perpendicular to a normal and to each other.
fn tangents(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[normal.iamin()] = 1.0;
    let first = (axis - normal * normal.dot(&axis)).normalize();
    [first, normal.cross(&first)]
}
