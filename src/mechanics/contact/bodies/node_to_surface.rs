//! A node in front of a smoothed surface, in the plane.
//!
//! The surface is the uniform cubic B-spline whose control points are the nodes of the faces, continued in a straight line
//! at its ends: it has continuous curvature, so that the gap of a node that slides from face to face has continuous second
//! derivatives. It runs through the ends and through points on a straight line, and passes other nodes on the inner side
//! by a sixth of the second difference of their positions. A node carries its force alone: the method fails the patch
//! test on meshes that do not match.

use crate::algebra::differential::{Differential, WithHessian};
use crate::mechanics::contact::bodies::opposite_surface::{OppositeSurface, distance_from_segment};
use crate::mechanics::contact::bodies::tolerances::{CLOSEST_POINT, CLOSEST_POINT_ITERATIONS, SAMPLES, SMALL_STEP};
use crate::mechanics::contact::bodies::{PlaneVector, difference, product, turned_left};
use crate::mechanics::contact::kinematics::{CoupledKinematics, LocalDisplacements};
use crate::mechanics::contact::vector::Vector;
use smallvec::SmallVec;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// A node in front of a surface.
#[derive(Debug, Clone)]
pub struct NodeToSurface {
    /// The node, then the nodes of the opposite surface.
    nodes: Vec<usize>,
    place: PlaneVector,
    opposite: Arc<OppositeSurface>,
    /// Gap and position along the opposite surface without displacements.
    start: (f64, f64),
}

/// Coordinates of the node and of up to four control points.
const VARIABLES: usize = 10;

/// A piece of the smoothed surface, between the two nodes of a face.
struct SplinePiece {
    face: usize,
    /// The control points, as indices into the nodes of the opposite surface; beyond an end there is none.
    controls: [Option<usize>; 4],
}

/// The closest point of the smoothed surface.
struct ClosestSurfacePoint {
    piece: SplinePiece,
    /// Parameter on the piece, from 0 to 1, beyond it on the continuation of an end.
    parameter: f64,
}

/// Values and first two derivatives of the four basis functions; beyond the ends those of the straight continuation.
fn basis<D: Differential>(t: D, [is_first, is_last]: [bool; 2]) -> [[D; 4]; 2] {
    let at = |t: D| {
        let rest = t.times(-1.0).plus(1.0);
        let (square, cube) = (t * t, t * t * t);
        let sixth = 1.0 / 6.0;
        [
            [
                (rest * rest * rest).times(sixth),
                (cube.times(3.0) - square.times(6.0)).plus(4.0).times(sixth),
                (square.times(3.0) + t.times(3.0) - cube.times(3.0)).plus(1.0).times(sixth),
                cube.times(sixth),
            ],
            [
                (rest * rest).times(-0.5),
                square.times(1.5) - t.times(2.0),
                (t - square.times(1.5)).plus(0.5),
                square.times(0.5),
            ],
        ]
    };
    let end = if is_first && t.value() < 0.0 {
        0.0
    } else if is_last && t.value() > 1.0 {
        1.0
    } else {
        return at(t);
    };
    let [values, slopes] = at(D::constant(end));
    let beyond = t.plus(-end);
    [std::array::from_fn(|k| values[k] + beyond * slopes[k]), slopes]
}

/// The control points with those beyond an end, which continue it in a straight line.
fn continued<D: Differential>(controls: [Option<[D; 2]>; 4]) -> [[D; 2]; 4] {
    let inner = [controls[1], controls[2]].map(|point| point.unwrap_or([D::constant(0.0); 2]));
    let beyond = |near: [D; 2], far: [D; 2]| [0, 1].map(|k| near[k].times(2.0) - far[k]);
    [
        controls[0].unwrap_or_else(|| beyond(inner[0], inner[1])),
        inner[0],
        inner[1],
        controls[3].unwrap_or_else(|| beyond(inner[1], inner[0])),
    ]
}

fn combined<D: Differential>(weights: &[D; 4], points: &[[D; 2]; 4]) -> [D; 2] {
    [0, 1].map(|k| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|at| weights[at] * points[at][k]);
        a + b + c + d
    })
}

impl NodeToSurface {
    /// The kinematics of a node in front of a surface; `place` is the node's undeformed position.
    pub fn new(own: usize, place: PlaneVector, opposite: Arc<OppositeSurface>) -> Self {
        let nodes = std::iter::once(own).chain(opposite.nodes.iter().copied()).collect();
        let mut node = Self { nodes, place, opposite, start: (0.0, 0.0) };
        let (gap, place, _) = node.values(&|_| 0.0);
        node.start = (gap, place);
        node
    }

    /// The gap without displacements.
    pub fn initial_gap(&self) -> f64 {
        self.start.0
    }

    fn own(&self, displacement: LocalDisplacements<'_>) -> PlaneVector {
        [self.place[0] + displacement(0), self.place[1] + displacement(1)]
    }

    fn control(&self, displacement: LocalDisplacements<'_>, node: usize) -> PlaneVector {
        let place = self.opposite.places[node];
        [place[0] + displacement(2 * node + 2), place[1] + displacement(2 * node + 3)]
    }

    fn piece(&self, face: usize) -> SplinePiece {
        let surface = &self.opposite;
        let chain = surface.chains[surface.faces[face].chain];
        let [first, last] = surface.faces[face].nodes;
        let at = face - chain.first;
        let beside = |end: bool| {
            let other = if end { at + 1 } else { at + chain.count - 1 };
            let inside = chain.period.is_some() || (if end { other < chain.count } else { at > 0 });
            inside.then(|| surface.faces[chain.first + other % chain.count].nodes[usize::from(end)])
        };
        SplinePiece { face, controls: [beside(false), Some(first), Some(last), beside(true)] }
    }

    fn points(&self, displacement: LocalDisplacements<'_>, piece: &SplinePiece) -> [PlaneVector; 4] {
        continued(piece.controls.map(|node| node.map(|node| self.control(displacement, node))))
    }

    /// The closest point.
    fn closest(&self, displacement: LocalDisplacements<'_>) -> ClosestSurfacePoint {
        let own = self.own(displacement);
        let mut best = (f64::INFINITY, 0, 0.0);
        for face in 0..self.opposite.faces.len() {
            let piece = self.piece(face);
            let points = self.points(displacement, &piece);
            // The piece lies within the hull of its control points.
            let lines = points.windows(2).map(|ends| distance_from_segment(own, [ends[0], ends[1]]));
            let spread = points.windows(2).map(|ends| difference(ends[1], ends[0]));
            let size = spread.map(|edge| product(edge, edge).sqrt()).fold(0.0, f64::max);
            if lines.fold(f64::INFINITY, f64::min) - size > best.0 {
                continue;
            }
            for sample in 0..=SAMPLES {
                let parameter = sample as f64 / SAMPLES as f64;
                let from = difference(own, combined(&basis(parameter, [false; 2])[0], &points));
                let distance = product(from, from).sqrt();
                if distance < best.0 {
                    best = (distance, face, parameter);
                }
            }
        }
        self.refined(displacement, best.1, best.2)
    }

    /// The point near a sample at which the distance is stationary: by Newton's method, with steps halved that do not
    /// come nearer.
    fn refined(&self, displacement: LocalDisplacements<'_>, face: usize, parameter: f64) -> ClosestSurfacePoint {
        let own = self.own(displacement);
        let (mut face, mut parameter) = (face, parameter);
        for _ in 0..CLOSEST_POINT_ITERATIONS {
            let piece = self.piece(face);
            let points = self.points(displacement, &piece);
            let ends = ends(&piece);
            let at = |t: f64| {
                let [values, slopes] = basis(t, ends);
                let (from, slope) = (difference(own, combined(&values, &points)), combined(&slopes, &points));
                (product(from, from), product(from, slope), from, slope)
            };
            let (square, along, from, slope) = at(parameter);
            let bend = second(parameter, ends, &points);
            let stiffness = product(slope, slope) - product(from, bend);
            // Where the distance has no minimum nearby, the step of a straight surface leads nearer.
            let denominator = if stiffness > 0.0 { stiffness } else { product(slope, slope) };
            if denominator <= 0.0 {
                break;
            }
            let mut step = (along / denominator).clamp(-1.0, 1.0);
            // Of a small step the round-off of the distance decides nothing.
            while step.abs() > SMALL_STEP && at(parameter + step).0 > square {
                step *= 0.5;
            }
            parameter += step;
            // On to the piece beside, unless the surface ends.
            if parameter < 0.0 && !ends[0] {
                (face, parameter) = (self.beside(face, false), parameter + 1.0);
            } else if parameter > 1.0 && !ends[1] {
                (face, parameter) = (self.beside(face, true), parameter - 1.0);
            }
            if step.abs() <= CLOSEST_POINT {
                break;
            }
        }
        ClosestSurfacePoint { piece: self.piece(face), parameter }
    }

    fn beside(&self, face: usize, after: bool) -> usize {
        let chain = self.opposite.chains[self.opposite.faces[face].chain];
        let at = face - chain.first + if after { 1 } else { chain.count - 1 };
        chain.first + at % chain.count
    }

    /// Coordinates of the control points along the undeformed surface.
    fn along<D: Differential>(&self, piece: &SplinePiece) -> [D; 4] {
        let face = self.opposite.faces[piece.face];
        let length = |face: usize| {
            let [first, last] = self.opposite.faces[face].along;
            last - first
        };
        let [first, last] = face.along;
        let before = piece.controls[0].map_or(last - first, |_| length(self.beside(piece.face, false)));
        let after = piece.controls[3].map_or(last - first, |_| length(self.beside(piece.face, true)));
        [first - before, first, last, last + after].map(D::constant)
    }

    /// Gap, position along the opposite surface and stretch.
    fn values(&self, displacement: LocalDisplacements<'_>) -> (f64, f64, f64) {
        let ClosestSurfacePoint { piece, parameter } = self.closest(displacement);
        let points = self.points(displacement, &piece);
        let [values, slopes] = basis(parameter, ends(&piece));
        let (from, slope) =
            (difference(self.own(displacement), combined(&values, &points)), combined(&slopes, &points));
        let size = product(slope, slope).sqrt();
        let along = self.along::<f64>(&piece);
        let sum = |weights: &[f64; 4]| weights.iter().zip(&along).map(|(weight, place)| weight * place).sum::<f64>();
        (product(turned_left(slope), from) / size, sum(&values), size / sum(&slopes))
    }

    /// Gap, position along the opposite surface and stretch with their derivatives, and the degrees of freedom of the
    /// variables.
    fn derivatives(&self, displacement: LocalDisplacements<'_>) -> ([WithHessian<VARIABLES>; 3], [usize; VARIABLES]) {
        let ClosestSurfacePoint { piece, parameter } = self.closest(displacement);
        let mut freedoms = [usize::MAX; VARIABLES];
        (freedoms[0], freedoms[1]) = (0, 1);
        let own = self.own(displacement);
        let own = [0, 1].map(|k| WithHessian::<VARIABLES>::variable(own[k], k));
        let controls = std::array::from_fn(|at| {
            let node = piece.controls[at]?;
            let place = self.control(displacement, node);
            Some([0, 1].map(|k| {
                freedoms[2 + 2 * at + k] = 2 * node + 2 + k;
                WithHessian::<VARIABLES>::variable(place[k], 2 + 2 * at + k)
            }))
        });
        let points = continued(controls);
        let ends = ends(&piece);
        let plain = points.map(|point| point.map(WithHessian::<VARIABLES>::value));
        let (slope, from) = {
            let [values, slopes] = basis(parameter, ends);
            let own = own.map(WithHessian::<VARIABLES>::value);
            (combined(&slopes, &plain), difference(own, combined(&values, &plain)))
        };
        let stiffness = product(slope, slope) - product(from, second(parameter, ends, &plain));
        // Each step of Newton's method with the slope at the solution makes one more derivative exact.
        let mut place = WithHessian::<VARIABLES>::constant(parameter);
        for _ in 0..2 {
            let [values, slopes] = basis(place, ends);
            let (at, slope) = (combined(&values, &points), combined(&slopes, &points));
            let along = (own[0] - at[0]) * slope[0] + (own[1] - at[1]) * slope[1];
            place = place + along.times(1.0 / stiffness);
        }
        let [values, slopes] = basis(place, ends);
        let (at, slope) = (combined(&values, &points), combined(&slopes, &points));
        let size = (slope[0] * slope[0] + slope[1] * slope[1]).root();
        let gap = ((own[1] - at[1]) * slope[0] - (own[0] - at[0]) * slope[1]) * size.reciprocal();
        let along = self.along::<WithHessian<VARIABLES>>(&piece);
        let sum = |weights: &[WithHessian<VARIABLES>; 4]| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| weights[k] * along[k]);
            a + b + c + d
        };
        ([gap, sum(&values), size * sum(&slopes).reciprocal()], freedoms)
    }
}

/// Whether the piece is the first and the last of its surface.
fn ends(piece: &SplinePiece) -> [bool; 2] {
    [piece.controls[0].is_none(), piece.controls[3].is_none()]
}

/// The second derivative of a piece.
fn second(t: f64, [is_first, is_last]: [bool; 2], points: &[PlaneVector; 4]) -> PlaneVector {
    if (is_first && t < 0.0) || (is_last && t > 1.0) {
        return [0.0; 2];
    }
    combined(&[1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t], points)
}

impl CoupledKinematics for NodeToSurface {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector {
        let (gap, place, _) = self.values(displacement);
        [place - self.start.1, gap - self.start.0, 0.0]
    }

    fn motion(&self, from: LocalDisplacements<'_>, to: LocalDisplacements<'_>) -> Vector {
        let ((gap, place, stretch), (last_gap, last_place, last_stretch)) = (self.values(from), self.values(to));
        let way = self.opposite.way(0, place, last_place);
        [0.5 * (stretch + last_stretch) * way, last_gap - gap, 0.0]
    }

    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector)) {
        let ([gap, place, stretch], freedoms) = self.derivatives(displacement);
        for (k, freedom) in present(&freedoms) {
            each(freedom, &[stretch.value * place.gradient[k], gap.gradient[k], 0.0]);
        }
    }

    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let ([gap, place, stretch], freedoms) = self.derivatives(displacement);
        for (k, row) in present(&freedoms) {
            for (l, column) in present(&freedoms) {
                let along = stretch.value * place.hessian[k][l] + place.gradient[k] * stretch.gradient[l];
                add(row, column, force[1] * gap.hessian[k][l] + force[0] * along);
            }
        }
    }

    fn rounding(&self) -> f64 {
        let all = self.opposite.places.iter().chain([&self.place]).flatten();
        f64::EPSILON * all.fold(0.0_f64, |most, value| most.max(value.abs()))
    }

    fn beyond_end(&self, displacement: LocalDisplacements<'_>) -> Option<f64> {
        let left = self.distance_to_end(displacement);
        let own = self.own(displacement);
        let faces = self.opposite.faces.iter();
        let distances =
            faces.map(|face| distance_from_segment(own, face.nodes.map(|node| self.control(displacement, node))));
        (left < 0.0).then(|| distances.fold(f64::INFINITY, f64::min))
    }

    fn distance_to_end(&self, displacement: LocalDisplacements<'_>) -> f64 {
        let ClosestSurfacePoint { piece, parameter } = self.closest(displacement);
        let surface = &self.opposite;
        let face = surface.faces[piece.face];
        let chain = surface.chains[face.chain];
        if chain.period.is_some() {
            return f64::INFINITY;
        }
        // The surface goes on straight for half a face, so that a node may touch its very end.
        let whole = surface.faces[chain.first..chain.first + chain.count].last().map_or(0.0, |last| last.along[1]);
        let length = face.along[1] - face.along[0];
        let place = face.along[0] + parameter * length;
        (place.min(whole - place) + 0.5 * length).max(-length)
    }

    fn clearance(&self, displacement: LocalDisplacements<'_>) -> Option<(f64, f64)> {
        Some((self.values(displacement).0, SQRT_2))
    }
}

/// The variables that stand for a degree of freedom, with it.
fn present(freedoms: &[usize; VARIABLES]) -> SmallVec<[(usize, usize); VARIABLES]> {
    let all = freedoms.iter().copied().enumerate();
    all.filter(|(_, freedom)| *freedom != usize::MAX).collect()
}
