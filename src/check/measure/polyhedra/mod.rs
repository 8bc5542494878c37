//! Polyhedra as posted, for the measure only: the point of the rounded surface closest to a place.
//!
//! The filled share of a ball is stated otherwise than in the solver: the solid angles are those of whole triangles by the
//! formula of A. van Oosterom and J. Strackee (IEEE Trans. Biomed. Eng. 30 (1983) 125, doi:10.1109/TBME.1983.325207), what
//! is then left of the integrals is smooth, and is summed by quadrature along the sides of the triangles. How the normal
//! turns is taken from differences.

mod shares;

use crate::check::measure::numbers::{MeasuredVector, padded};
use crate::model::request::{Side, TriangleMesh};
use nalgebra::{Matrix2, Vector2};
use shares::BallShares;

/// Steps of the iterations for the closest point.
const MOST_STEPS: usize = 100;
/// Steps along the normal are no longer than this, and steps along the surface no longer than twice this.
const LONGEST: f64 = 0.25;
/// Steps below this, relative to the coordinates, end an iteration; between this and the next one they may be round-off.
const NO_STEP: f64 = 1e-15;
const SMALL_STEP: f64 = 1e-12;
/// Over which the turn of the normal is taken.
const DIFFERENCE: f64 = 1e-4;
/// A place nearer to a triangle than this is searched from farther inside, from the other distance.
const ON_TRIANGLE: f64 = 1e-9;
const INSIDE: f64 = 0.05;

/// A polyhedron relative to its first point, its lengths in multiples of the rounding.
#[derive(Debug, Clone)]
pub(super) struct MeasuredPolyhedron {
    shares: BallShares,
    rounding: f64,
    /// 1 where the outside is free, otherwise -1.
    sign: f64,
    /// The largest coordinate of the points.
    pub size: f64,
}

/// A point of the surface with its outward normal.
struct MeasuredFoot {
    point: MeasuredVector,
    normal: MeasuredVector,
}

impl MeasuredPolyhedron {
    pub fn new(posted: &TriangleMesh) -> Self {
        let origin = posted.points.first().map_or_else(MeasuredVector::zeros, |point| padded(point));
        let corner = |number: u32| (padded(&posted.points[number as usize]) - origin) / posted.rounding;
        let triangles = posted.triangles.iter().map(|corners| corners.map(corner)).collect();
        Self {
            shares: BallShares::new(triangles),
            rounding: posted.rounding,
            sign: if posted.side == Side::Outside { 1.0 } else { -1.0 },
            size: posted.points.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs())),
        }
    }

    /// The gap at a place relative to the first point, and the unit normal into the free side.
    pub fn gap(&self, place: &MeasuredVector) -> (f64, MeasuredVector) {
        let place = place / self.rounding;
        let nearest = self.shares.nearest(&place);
        let mut start = if (place - nearest).norm() < 2.0 * LONGEST { place } else { nearest };
        if (start - nearest).norm() < ON_TRIANGLE {
            start -= self.normal(&start) * INSIDE;
        }
        let mut foot = self.on_surface(&start);
        for _ in 0..MOST_STEPS {
            let from = place - foot.point;
            let distance = from.dot(&foot.normal);
            let along = from - foot.normal * distance;
            if along.norm() <= SMALL_STEP * place.amax().max(1.0) {
                break;
            }
            let first = foot.normal.cross(&MeasuredVector::ith(foot.normal.iamin(), 1.0)).normalize();
            let tangents = [first, foot.normal.cross(&first)];
            let turned = tangents.map(|tangent| {
                let [after, before] = [DIFFERENCE, -DIFFERENCE].map(|by| self.normal(&(foot.point + tangent * by)));
                (after - before) / (2.0 * DIFFERENCE)
            });
            let second = Matrix2::from_fn(|row, column| {
                let unit = if row == column { 1.0 } else { 0.0 };
                unit + distance * tangents[row].dot(&turned[column])
            });
            let right = Vector2::new(tangents[0].dot(&along), tangents[1].dot(&along));
            let step = second.try_inverse().map_or(right, |inverse| inverse * right);
            // Uphill, or too far: as far as the place itself is along the surface.
            let step = if step.dot(&right) > 0.0 { step } else { right };
            let step = step * (2.0 * LONGEST / step.norm()).min(1.0);
            foot = self.on_surface(&(foot.point + tangents[0] * step[0] + tangents[1] * step[1]));
        }
        let distance = (place - foot.point).dot(&foot.normal);
        (self.sign * distance * self.rounding, foot.normal * self.sign)
    }

    fn normal(&self, place: &MeasuredVector) -> MeasuredVector {
        (-self.shares.gradient(place)).try_normalize(0.0).unwrap_or_else(MeasuredVector::z)
    }

    /// The point of the surface that is reached from a place along the normal.
    fn on_surface(&self, start: &MeasuredVector) -> MeasuredFoot {
        let mut point = *start;
        let towards = (self.shares.nearest(&point) - point).try_normalize(0.0).unwrap_or_else(MeasuredVector::z);
        let mut longest = LONGEST;
        let mut before = 0.0_f64;
        for _ in 0..MOST_STEPS {
            let gradient = self.shares.gradient(&point);
            let slope = gradient.norm();
            if slope < 1e-6 {
                // The ball is full or empty.
                point += towards * LONGEST;
                continue;
            }
            let step = (self.shares.share(&point, &(gradient / slope)) - 0.5) / slope;
            if step * before < 0.0 {
                longest = (0.5 * longest).max(step.abs().min(before.abs()));
            }
            let step = step.clamp(-longest, longest);
            point -= gradient * (step / slope);
            let reach = point.amax().max(1.0);
            if step.abs() <= NO_STEP * reach || (step.abs() >= before.abs() && step.abs() <= SMALL_STEP * reach) {
                break;
            }
            before = step;
        }
        MeasuredFoot { point, normal: self.normal(&point) }
    }
}
