//! Smooth curves in the plane: cubic pieces with continuous tangent and curvature, and the point of a curve closest to a
//! place.
//!
//! | module | content |
//! |---|---|
//! | `make` | curves through points (cubic splines), and polygons with rounded corners (cubic B-splines) |
//! | `closest` | the closest point, by a tree of boxes and the roots of quintic polynomials |
//! | `crossing` | whether a curve crosses itself |
//!
//! A gap measured from a curve has continuous second derivatives near the curve, which Newton's method and the location
//! of events require. All lengths have one unit.

mod closest;
mod crossing;
pub(crate) mod make;
#[cfg(test)]
mod tests;

pub type Point = [f64; 2];

/// A curve of cubic pieces. An open curve continues along its end tangents to infinity, so that every curve divides the
/// plane.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneCurve {
    /// Bézier points of the pieces, in order.
    pieces: Vec<[Point; 4]>,
    /// The boxes of a binary tree over the pieces, root first; see [`closest`].
    boxes: Vec<Bounds>,
    /// Start and unit direction of the rays before and after an open curve, outwards.
    rays: Option<[Ray; 2]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Ray {
    start: Point,
    outwards: Point,
}

/// An axis-parallel box.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bounds {
    low: Point,
    high: Point,
}

/// A curve at its point closest to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The signed distance of the place, positive to the left of the curve.
    pub distance: f64,
    /// The unit normal to the left.
    pub normal: Point,
    /// The curvature of the curve (1/length), positive where it turns left.
    pub curvature: f64,
}

/// Why points give no curve; the numbers count the points from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CurveMistake {
    /// An open curve needs 2 points, a closed one 3.
    TooFew { needed: usize },
    /// A point coincides with the one before it.
    Coincident { point: usize },
    /// The curve turns back at a point.
    TurnsBack { point: usize },
    /// The rounding of a corner is longer than half of a neighbouring edge.
    NoRoom { point: usize, most: f64 },
    /// The curve crosses itself near a place.
    Crosses { near: Point },
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// `a + factor b`
fn plus(a: Point, factor: f64, b: Point) -> Point {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn size(a: Point) -> f64 {
    a[0].hypot(a[1])
}

/// A Bézier piece at a parameter: place, first and second derivatives.
fn at(piece: &[Point; 4], t: f64) -> [Point; 3] {
    let between = |a: Point, b: Point| plus(a, t, minus(b, a));
    let [a, b, c] = [0, 1, 2].map(|k| between(piece[k], piece[k + 1]));
    let [d, e] = [between(a, b), between(b, c)];
    let slope = minus(e, d).map(|part| 3.0 * part);
    let bend = minus(minus(c, b), minus(b, a)).map(|part| 6.0 * part);
    [between(d, e), slope, bend]
}

impl Bounds {
    fn of(points: &[Point]) -> Self {
        let mut all = Self { low: points[0], high: points[0] };
        points.iter().for_each(|point| all = all.joined(&Self { low: *point, high: *point }));
        all
    }

    fn joined(&self, other: &Self) -> Self {
        Self {
            low: [0, 1].map(|k| self.low[k].min(other.low[k])),
            high: [0, 1].map(|k| self.high[k].max(other.high[k])),
        }
    }

    /// The distance of a place from the box; 0 inside.
    fn distance(&self, place: Point) -> f64 {
        size([0, 1].map(|k| (self.low[k] - place[k]).max(place[k] - self.high[k]).max(0.0)))
    }

    fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}
