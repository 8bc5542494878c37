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

pub use closest::ClosestPoint;

/// Coordinates in the plane (length).
pub type PlanePoint = [f64; 2];

/// A curve of cubic pieces. An open curve continues along its end tangents to infinity, so that every curve divides the
/// plane.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneCurve {
    /// Bézier points of the pieces, in order.
    pieces: Vec<[PlanePoint; 4]>,
    /// The boxes of a binary tree over the pieces, root first; see [`closest`].
    boxes: Vec<PlaneBox>,
    /// Start and unit direction of the rays before and after an open curve, outwards.
    rays: Option<[EndRay; 2]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct EndRay {
    start: PlanePoint,
    outwards: PlanePoint,
}

/// An axis-parallel box.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PlaneBox {
    low: PlanePoint,
    high: PlanePoint,
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
    Crosses { near: PlanePoint },
}

impl PlaneCurve {
    /// The curve of a polyline: with [rounded](Self::rounded) corners, or [through](Self::through) its points where no
    /// rounding is given.
    ///
    /// # Errors
    /// As those two.
    pub fn of_polyline(points: &[PlanePoint], closed: bool, rounding: Option<f64>) -> Result<Self, CurveMistake> {
        match rounding {
            Some(rounding) => Self::rounded(points, closed, rounding),
            None => Self::through(points, closed),
        }
    }

    /// The cubic spline through points, its parameter the length of the chords: natural at the ends of an open curve,
    /// so that the curvature is 0 there; periodic where the curve is closed.
    ///
    /// # Errors
    /// Too few points, coincident neighbours, a turn back, a curve that crosses itself.
    pub fn through(points: &[PlanePoint], closed: bool) -> Result<Self, CurveMistake> {
        Self::of_pieces(make::through(points, closed)?, closed)
    }

    /// The straight edges between points, each corner rounded off from the given distance before it to the same distance
    /// behind it, by two pieces of a uniform cubic B-spline.
    ///
    /// # Errors
    /// Too few points, coincident neighbours, a turn back, a rounding longer than half an edge, a curve that crosses
    /// itself.
    pub fn rounded(points: &[PlanePoint], closed: bool, rounding: f64) -> Result<Self, CurveMistake> {
        Self::of_pieces(make::rounded(points, closed, rounding)?, closed)
    }

    fn of_pieces(pieces: Vec<[PlanePoint; 4]>, closed: bool) -> Result<Self, CurveMistake> {
        let ray = |place: [PlanePoint; 3], sign: f64| {
            let length = sign * size(place[1]);
            EndRay { start: place[0], outwards: place[1].map(|part| part / length) }
        };
        let ends = || [ray(at(&pieces[0], 0.0), -1.0), ray(at(&pieces[pieces.len() - 1], 1.0), 1.0)];
        let rays = (!closed).then(ends);
        let boxes = closest::boxes(&pieces);
        let curve = Self { pieces, boxes, rays };
        crossing::crossing(&curve).map_or(Ok(curve), |near| Err(CurveMistake::Crosses { near }))
    }

    /// The same curve in multiples of a unit of length.
    pub fn in_units_of(&self, unit: f64) -> Self {
        let scaled = |point: PlanePoint| point.map(|part| part / unit);
        let pieces: Vec<[PlanePoint; 4]> = self.pieces.iter().map(|piece| piece.map(scaled)).collect();
        let rays = self.rays.map(|rays| rays.map(|ray| EndRay { start: scaled(ray.start), ..ray }));
        Self { boxes: closest::boxes(&pieces), pieces, rays }
    }

    /// The curve at its point closest to a place; of equally close points, one that follows from the place alone.
    pub fn closest(&self, place: PlanePoint) -> ClosestPoint {
        closest::closest(self, place)
    }
}

fn minus(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

/// `a + factor b`
fn plus(a: PlanePoint, factor: f64, b: PlanePoint) -> PlanePoint {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

fn dot(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn size(a: PlanePoint) -> f64 {
    a[0].hypot(a[1])
}

/// A Bézier piece at a parameter: place, first and second derivatives.
fn at(piece: &[PlanePoint; 4], t: f64) -> [PlanePoint; 3] {
    let between = |a: PlanePoint, b: PlanePoint| plus(a, t, minus(b, a));
    let [a, b, c] = [0, 1, 2].map(|k| between(piece[k], piece[k + 1]));
    let [d, e] = [between(a, b), between(b, c)];
    let slope = minus(e, d).map(|part| 3.0 * part);
    let bend = minus(minus(c, b), minus(b, a)).map(|part| 6.0 * part);
    [between(d, e), slope, bend]
}

impl PlaneBox {
    fn of(points: &[PlanePoint]) -> Self {
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
    fn distance(&self, place: PlanePoint) -> f64 {
        size([0, 1].map(|k| (self.low[k] - place[k]).max(place[k] - self.high[k]).max(0.0)))
    }

    fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}
