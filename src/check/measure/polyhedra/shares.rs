//! The share of a ball of radius 1 that a polyhedron fills, weighed by `w = (1 - r²)²`, for the measure only.
//!
//! Each triangle adds `∫ d m dA - 8/105 Ω` to `105/32π` of the share, with the distance `d` of the centre behind it and the
//! solid angle `Ω` of the whole triangle; `m(r) = 1/3 - 2r²/5 + r⁴/7` in the ball and `8/(105 r³)` beyond. In polar
//! coordinates about the foot of the centre the integral is one along the sides of the triangle.

use crate::check::measure::numbers::MeasuredVector;
use std::f64::consts::PI;

/// `∫ w` over the ball.
const WHOLE: f64 = 32.0 * PI / 105.0;
const OVER_SPHERE: f64 = 8.0 / 105.0;
/// A centre nearer to a side of a triangle than this has no reliable solid angles; the share is then the mean of those at the
/// other distance to either side.
const ON_SIDE: f64 = 1e-6;
const ASIDE: f64 = 1e-5;

/// Places and weights of the quadrature of Gauss and Legendre with eight points on [-1, 1], of which half are listed.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

#[derive(Debug, Clone)]
pub(super) struct BallShares {
    triangles: Vec<MeasuredFacet>,
}

#[derive(Debug, Clone)]
struct MeasuredFacet {
    corners: [MeasuredVector; 3],
    /// Outwards.
    normal: MeasuredVector,
    /// A ball around it.
    center: MeasuredVector,
    radius: f64,
}

/// A side of a triangle as seen from the foot of a place in the plane of the triangle.
struct SeenSide {
    /// Distance of its line, positive out of the triangle.
    across: f64,
    /// Where it begins and ends along this line.
    along: [f64; 2],
}

impl BallShares {
    pub fn new(mut triangles: Vec<[MeasuredVector; 3]>) -> Self {
        let origin = triangles.first().map_or_else(MeasuredVector::zeros, |corners| corners[0]);
        let volume: f64 = triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| corner - origin);
                a.cross(&b).dot(&c)
            })
            .sum();
        if volume < 0.0 {
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        Self { triangles: triangles.into_iter().map(MeasuredFacet::new).collect() }
    }

    /// The point of the triangles nearest to a place.
    pub fn nearest(&self, place: &MeasuredVector) -> MeasuredVector {
        let mut best = (f64::INFINITY, *place);
        for triangle in &self.triangles {
            if (place - triangle.center).norm() - triangle.radius < best.0 {
                let point = triangle.nearest(place);
                let distance = (place - point).norm();
                if distance < best.0 {
                    best = (distance, point);
                }
            }
        }
        best.1
    }

    fn near(&self, center: &MeasuredVector) -> impl Iterator<Item = &MeasuredFacet> {
        self.triangles.iter().filter(move |triangle| (center - triangle.center).norm() < triangle.radius + 1.0)
    }

    /// The filled share of the ball about a centre; `normal`: the direction in which it changes.
    pub fn share(&self, center: &MeasuredVector, normal: &MeasuredVector) -> f64 {
        if self.near(center).any(|triangle| triangle.has_side_near(center)) {
            // Any direction along the surface but those of sides.
            let aside = normal.cross(&MeasuredVector::new(0.48, -0.6, 0.64)).normalize() * ASIDE;
            return 0.5 * (self.share_off_sides(&(center + aside)) + self.share_off_sides(&(center - aside)));
        }
        self.share_off_sides(center)
    }

    fn share_off_sides(&self, center: &MeasuredVector) -> f64 {
        let sum: f64 = self.near(center).map(|triangle| triangle.of_share(center)).sum();
        sum / WHOLE + if sum < 0.0 { 1.0 } else { 0.0 }
    }

    /// The gradient of the share with respect to the centre.
    pub fn gradient(&self, center: &MeasuredVector) -> MeasuredVector {
        let mut sum = MeasuredVector::zeros();
        self.near(center).for_each(|triangle| sum -= triangle.normal * triangle.of_weight(center));
        sum / WHOLE
    }
}

impl MeasuredFacet {
    fn new(corners: [MeasuredVector; 3]) -> Self {
        let [a, b, c] = &corners;
        let center = (a + b + c) / 3.0;
        let radius = corners.iter().map(|corner| (corner - center).norm()).fold(0.0, f64::max);
        Self { normal: (b - a).cross(&(c - b)).normalize(), center, radius, corners }
    }

    fn sides(&self) -> [[MeasuredVector; 2]; 3] {
        let [a, b, c] = self.corners;
        [[a, b], [b, c], [c, a]]
    }

    fn nearest(&self, place: &MeasuredVector) -> MeasuredVector {
        let foot = place - self.normal * (place - self.corners[0]).dot(&self.normal);
        let sides = self.sides();
        if sides.iter().all(|[from, to]| (to - from).cross(&(foot - from)).dot(&self.normal) >= 0.0) {
            return foot;
        }
        let on_side = |[from, to]: [MeasuredVector; 2]| {
            let way = to - from;
            from + way * ((place - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0)
        };
        let [a, b, c] = sides.map(on_side);
        let nearer =
            |a: MeasuredVector, b: MeasuredVector| if (place - a).norm() <= (place - b).norm() { a } else { b };
        nearer(nearer(a, b), c)
    }

    fn has_side_near(&self, place: &MeasuredVector) -> bool {
        self.sides().iter().any(|[from, to]| {
            let way = to - from;
            let part = ((place - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            (place - (from + way * part)).norm() < ON_SIDE
        })
    }

    fn seen(&self, [from, to]: [MeasuredVector; 2], place: &MeasuredVector) -> SeenSide {
        let direction = (to - from).normalize();
        let [begin, end] = [from - place, to - place];
        SeenSide {
            across: direction.cross(&self.normal).dot(&begin),
            along: [begin.dot(&direction), end.dot(&direction)],
        }
    }

    /// `∫ d m dA - 8/105 Ω`
    fn of_share(&self, center: &MeasuredVector) -> f64 {
        let depth = (self.corners[0] - center).dot(&self.normal);
        let smooth: f64 = self.sides().iter().map(|side| self.seen(*side, center).of_smooth_kernel(depth)).sum();
        depth * smooth - OVER_SPHERE * self.solid_angle(center)
    }

    fn solid_angle(&self, center: &MeasuredVector) -> f64 {
        let [a, b, c] = self.corners.map(|corner| corner - center);
        let [p, q, r] = [a.norm(), b.norm(), c.norm()];
        2.0 * a.dot(&b.cross(&c)).atan2(p * q * r + a.dot(&b) * r + b.dot(&c) * p + c.dot(&a) * q)
    }

    /// `∫ w dA`
    fn of_weight(&self, center: &MeasuredVector) -> f64 {
        let depth = (self.corners[0] - center).dot(&self.normal);
        if depth.abs() >= 1.0 {
            return 0.0;
        }
        self.sides().iter().map(|side| self.seen(*side, center).of_weight(depth)).sum()
    }
}

impl SeenSide {
    /// The part of the side within a distance from the foot.
    fn within(&self, distance: f64) -> Option<[f64; 2]> {
        let half = (distance * distance - self.across * self.across).max(0.0).sqrt();
        let [from, to] = [self.along[0].max(-half), self.along[1].min(half)];
        (from < to).then_some([from, to])
    }

    /// The parts of the side that are not in another part of it.
    fn beyond(&self, inner: Option<[f64; 2]>) -> [[f64; 2]; 2] {
        let [from, to] = self.along;
        inner.map_or([[from, to], [to, to]], |[low, high]| [[from, low], [high, to]])
    }

    fn angle(&self, [from, to]: [f64; 2]) -> f64 {
        (to / self.across).atan() - (from / self.across).atan()
    }

    /// `∫∫ m r dr dθ` over the triangle between the foot and the side.
    fn of_smooth_kernel(&self, depth: f64) -> f64 {
        let square = depth * depth;
        let inner = self.within((1.0 - square).max(0.0).sqrt());
        // Over the square of the distance from the foot.
        let in_ball = |along: f64| {
            let distance = self.across * self.across + along * along;
            1.0 / 6.0 - (2.0 * square + distance) / 10.0
                + (3.0 * square * square + 3.0 * square * distance + distance * distance) / 42.0
        };
        let power = |square: f64| square * (1.0 / 6.0 - square * (0.1 - square / 42.0));
        let up_to_ball =
            if square < 1.0 { power(1.0) - power(square) } else { OVER_SPHERE * (1.0 / depth.abs() - 1.0) };
        let beyond = |along: f64| {
            let distance = self.across * self.across + along * along;
            (up_to_ball + OVER_SPHERE * (1.0 - 1.0 / (square + distance).sqrt())) / distance
        };
        let mut sum = inner.map_or(0.0, |inner| gauss(inner, in_ball));
        for part in self.beyond(inner) {
            let mut from = part[0];
            while from < part[1] {
                // Longer panels farther off.
                let to = part[1].min(if from < 0.0 {
                    (from + 0.5 * from.abs().max(self.across.abs())).min(-0.0).max(from + 0.02)
                } else {
                    from + 0.5 * from.max(self.across.abs()).max(0.04)
                });
                sum += gauss([from, to], beyond);
                from = to;
            }
        }
        sum * self.across
    }

    /// `∫∫ w r dr dθ`
    fn of_weight(&self, depth: f64) -> f64 {
        if self.across == 0.0 {
            return 0.0;
        }
        let within = 1.0 - depth * depth;
        let inner = self.within(within.sqrt());
        let in_ball = |along: f64| {
            let distance = self.across * self.across + along * along;
            (within * within - within * distance) * 0.5 + distance * distance / 6.0
        };
        let beyond: f64 = self.beyond(inner).iter().map(|part| self.angle(*part)).sum();
        inner.map_or(0.0, |inner| gauss(inner, in_ball)) * self.across + within.powi(3) / 6.0 * beyond
    }
}

/// An integral by quadrature.
fn gauss([from, to]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    half * GAUSS
        .iter()
        .map(|(place, weight)| weight * (value(middle - half * place) + value(middle + half * place)))
        .sum::<f64>()
}
