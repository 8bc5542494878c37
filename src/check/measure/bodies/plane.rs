//! Contacts between bodies in the plane as posted: the mean gap at a node by Gauss's quadrature between the
//! projected nodes and the mass matrix of the covered part, the nearest point of a smoothed surface by sampling and
//! bisection; derivatives by dual numbers, one degree of freedom at a time.

use crate::check::measure::bodies::itself::{MeasuredOwnFace, Touchable, faces_in_itself};
use crate::check::measure::bodies::surface::{OppositeFace, TouchedSurfaces};
use crate::check::measure::bodies::{BodyPlace, BodyState, COVERED, FAR_BEHIND, ROUNDINGS, STEEP, near};
use crate::check::measure::numbers::{DualNumber, MeasuredVector, largest};
use crate::model::request::{Contact, ContactDiscretisation};
use std::sync::Arc;

/// Samples on each face when a nearest point is sought, and bisections from the best of them.
const SAMPLES: usize = 16;
const BISECTIONS: usize = 60;

/// Positions and weights of Gauss's three points on (0, 1).
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

type PlaneNumber = DualNumber<1>;
type NumberPair = [PlaneNumber; 2];

/// A contact of a node with a surface.
#[derive(Debug, Clone)]
pub(in crate::check::measure) struct MeasuredBodyInPlane {
    /// Faces at the node, each in its order; none where the node itself touches.
    faces: Vec<MeasuredOwnFace>,
    /// Whether the surface touches itself.
    itself: bool,
    node: usize,
    /// Faces of the opposite surface in order, with their coordinates along it and the length of a closed chain.
    opposite: Arc<[OppositeFace]>,
    /// Undeformed places of all nodes.
    places: Arc<[MeasuredVector]>,
    /// Whether the bodies are those of revolution, of which a point counts by its distance from the axis.
    is_revolved: bool,
    /// Gap at the start, where it is negative: the meshes overlap, and the contact is closed.
    overlap: f64,
    /// The largest undeformed coordinate of a node that matters.
    reach: f64,
}

/// What of the opposite surface is in front of a node.
struct OppositePart {
    /// The faces, as indices; the one with the nearest point of a smoothed surface.
    faces: Vec<usize>,
    /// Parameter of the nearest point, and slope there of the product that vanishes.
    place: f64,
    slope: f64,
}

/// Gap, position along the opposite surface, stretch.
struct MeasuredGap {
    gap: PlaneNumber,
    place: PlaneNumber,
    stretch: PlaneNumber,
    period: Option<f64>,
}

impl MeasuredBodyInPlane {
    /// The contact of a checked model: a node, and the surface that it touches.
    pub fn new(contact: &Contact, (node, against): (usize, &str), surfaces: &TouchedSurfaces) -> Option<Self> {
        let lines = contact.surface.as_deref().and_then(|surface| surfaces.lines.get(surface));
        let opposite = Arc::clone(surfaces.faces.get(against)?);
        let places = Arc::clone(&surfaces.places);
        let itself = contact.touches_itself();
        let of_body =
            |nodes: &[usize; 2]| MeasuredOwnFace { nodes: *nodes, is_alone: false, touchable: Touchable::All };
        let faces = match contact.discretisation.unwrap_or_default() {
            ContactDiscretisation::Mortar if itself => faces_in_itself(node, &opposite, &places),
            ContactDiscretisation::Mortar => {
                lines.into_iter().flatten().filter(|line| line.contains(&node)).map(of_body).collect()
            }
            ContactDiscretisation::NodeToSurface => Vec::new(),
        };
        let reach = opposite.iter().flat_map(|face| face.nodes).chain([node]).map(|node| largest(&places[node]));
        let reach = reach.fold(0.0, f64::max);
        let is_revolved = surfaces.is_revolved;
        let mut body = Self { faces, itself, node, opposite, places, is_revolved, overlap: 0.0, reach };
        let still = &surfaces.no_displacements;
        // Past the end of the surface there is no contact yet.
        body.overlap = if body.open_gap(still) > 0.0 { 0.0 } else { body.gap(still).min(0.0) };
        Some(body)
    }

    fn place(&self, node: usize) -> MeasuredVector {
        self.places[node]
    }

    /// The contact at displacements.
    pub fn state(&self, displacements: &[MeasuredVector]) -> BodyState {
        let position = |node: usize| self.place(node) + displacements[node];
        let still = |node: usize| [0, 1].map(|k| PlaneNumber::constant(position(node)[k]));
        let found = self.found(&still);
        let at_rest = self.values(&found, &still);
        let own: Vec<usize> = self.faces.iter().flat_map(|face| face.nodes).chain([self.node]).collect();
        let opposite = found.faces.iter().flat_map(|face| self.nodes_of(*face));
        let mut nodes: Vec<usize> = own.iter().copied().chain(opposite).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut rows = Vec::new();
        for node in nodes {
            let mut row = [MeasuredVector::zeros(); 3];
            for component in 0..2 {
                let values = self.values(&found, &|other| {
                    let mut point = still(other);
                    if other == node {
                        point[component] = PlaneNumber::variable(point[component].0, 0);
                    }
                    point
                });
                row[0][component] = values.gap.1[0];
                row[1][component] = at_rest.stretch.0 * values.place.1[0];
            }
            if row.iter().any(|part| *part != MeasuredVector::zeros()) {
                rows.push((node, row, own.contains(&node)));
            }
        }
        let MeasuredGap { gap, place, stretch, period } = at_rest;
        let place = BodyPlace::Along { place: place.0, stretch: stretch.0, period };
        BodyState { gap: gap.0 - self.overlap, place, rows }
    }

    /// The gap at displacements.
    pub fn gap(&self, displacements: &[MeasuredVector]) -> f64 {
        let still = |node: usize| [0, 1].map(|k| PlaneNumber::constant((self.place(node) + displacements[node])[k]));
        self.values(&self.found(&still), &still).gap.0 - self.overlap
    }

    /// The gap of a contact without reaction: of a node beyond the end of a smoothed surface it is the distance.
    pub fn open_gap(&self, displacements: &[MeasuredVector]) -> f64 {
        let position = |node: usize| self.place(node) + displacements[node];
        let still = |node: usize| [0, 1].map(|k| PlaneNumber::constant(position(node)[k]));
        let found = if self.faces.is_empty() { self.nearest(&still) } else { return self.gap(displacements) };
        let Some(face) = found.faces.first().map(|face| &self.opposite[*face]) else { return self.gap(displacements) };
        let of_chain = self.opposite.iter().filter(|other| other.chain == face.chain);
        let whole = of_chain.map(|other| other.along[1]).fold(0.0, f64::max);
        // The surface goes on straight for half a face.
        let allowed = 0.5 * (face.along[1] - face.along[0]);
        if face.period.is_none() && self.parameter_left(face, &found, whole) < -allowed {
            return self.distance_of(position(self.node), &position);
        }
        self.gap(displacements)
    }

    /// The coordinate by the parameter of the nearest point from the nearer end of the surface.
    fn parameter_left(&self, face: &OppositeFace, found: &OppositePart, whole: f64) -> f64 {
        let place = face.along[0] + found.place * (face.along[1] - face.along[0]);
        place.min(whole - place)
    }

    /// The distance of a point from the opposite faces.
    fn distance_of(&self, point: MeasuredVector, position: &dyn Fn(usize) -> MeasuredVector) -> f64 {
        let from_line = |[first, last]: [usize; 2]| {
            let (first, edge) = (position(first), position(last) - position(first));
            let share = ((point - first).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
            (point - first - edge * share).norm()
        };
        let all = self.opposite.iter().enumerate().filter(|(index, _)| self.is_touchable(*index));
        all.map(|(_, face)| from_line(face.nodes)).fold(self.farthest(), f64::min)
    }

    /// A bound of distances: a node of a surface that touches itself may look at nothing, and is then as far away as the
    /// surface is long.
    fn farthest(&self) -> f64 {
        let length = || self.opposite.iter().map(|face| face.along[1] - face.along[0]).sum();
        if self.itself { length() } else { f64::INFINITY }
    }

    /// The nodes that the shape of an opposite face depends on.
    fn nodes_of(&self, face: usize) -> Vec<usize> {
        let face = &self.opposite[face];
        let beside = face.beside.into_iter().flatten().filter(|_| self.faces.is_empty());
        beside.flat_map(|beside| self.opposite[beside].nodes).chain(face.nodes).collect()
    }

    /// Rounding error of the gap due to the coordinates.
    pub fn rounding(&self, displacements: &[MeasuredVector]) -> f64 {
        ROUNDINGS * f64::EPSILON * self.reach.max(largest(&displacements[self.node]))
    }

    /// What of the opposite surface is in front of the node.
    fn found(&self, point: &dyn Fn(usize) -> NumberPair) -> OppositePart {
        if self.faces.is_empty() {
            return self.nearest(point);
        }
        // Whether a face covers a part of the node's faces: itself, and with what goes on beyond an end of the surface.
        let covers = |index: usize| {
            let face = &self.opposite[index];
            let goes_on = self.goes_on(face);
            let mut found = [false; 2];
            for MeasuredOwnFace { nodes: [first, last], .. } in self.faces.iter().filter(|own| own.touchable.has(index))
            {
                let (start, edge) = (point(*first), minus(point(*last), point(*first)));
                let square = product(edge, edge).0;
                let [high, low] = face.nodes.map(|node| product(minus(point(node), start), edge).0 / square);
                let left = [edge[1].times(-1.0), edge[0]];
                let heights = face.nodes.map(|node| product(minus(point(node), start), left).0 / square);
                if is_aside(high - low, heights, 1.0) {
                    continue;
                }
                found[0] |= high.min(1.0) - low.max(0.0) > COVERED;
                let high = if goes_on[0] { 1.0 } else { high.min(1.0) };
                let low = if goes_on[1] { 0.0 } else { low.max(0.0) };
                found[1] |= high - low > COVERED;
            }
            found
        };
        let in_front = if self.itself { self.nearest_layer(point) } else { self.nearest_chain(point) };
        let found: Vec<(usize, [bool; 2])> = in_front.into_iter().map(|face| (face, covers(face))).collect();
        let is_covered = found.iter().any(|(_, covers)| covers[0]);
        let faces = found.iter().filter(|(_, covers)| is_covered && covers[1]).map(|(face, _)| *face).collect();
        OppositePart { faces, place: 0.0, slope: 1.0 }
    }

    /// Whether an opposite face goes on straight beyond its nodes.
    fn goes_on(&self, face: &OppositeFace) -> [bool; 2] {
        let is_first = self.itself && face.along[0] == 0.0;
        [face.beside[0].is_none() || is_first, face.beside[1].is_none()]
    }

    /// Whether one of the faces at the node may touch a face; all may where there are none.
    fn is_touchable(&self, face: usize) -> bool {
        self.faces.is_empty() || self.faces.iter().any(|own| own.touchable.has(face))
    }

    /// The square of the distance of the node from an opposite face.
    fn square_from(&self, face: &OppositeFace, point: &dyn Fn(usize) -> NumberPair) -> f64 {
        let ([first, last], own) = (face.nodes.map(point), point(self.node));
        let (edge, from) = (minus(last, first), minus(own, first));
        let share = (product(edge, from).0 / product(edge, edge).0).clamp(0.0, 1.0);
        let rest = minus(from, edge.map(|part| part.times(share)));
        product(rest, rest).0
    }

    /// The chain of opposite faces that is nearest to the node.
    fn nearest_chain(&self, point: &dyn Fn(usize) -> NumberPair) -> Vec<usize> {
        let distance = |face: &OppositeFace| self.square_from(face, point);
        let nearest = self.opposite.iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
        let chain = nearest.map_or(0, |face| face.chain);
        (0..self.opposite.len()).filter(|face| self.opposite[*face].chain == chain).collect()
    }

    /// Of a surface that touches itself the faces that follow one another, run against the surface at the node, and are
    /// nearest to it.
    fn nearest_layer(&self, point: &dyn Fn(usize) -> NumberPair) -> Vec<usize> {
        let mut along = MeasuredVector::zeros();
        for [first, last] in self.faces.iter().map(|face| face.nodes.map(point)) {
            along += MeasuredVector::new(last[0].0 - first[0].0, last[1].0 - first[1].0, 0.0).normalize();
        }
        let runs_against = |face: &usize| {
            let [first, last] = self.opposite[*face].nodes.map(point);
            (last[0].0 - first[0].0) * along.x + (last[1].0 - first[1].0) * along.y < 0.0
        };
        let of_rank = |face: &usize| self.opposite[*face].rank;
        let mut facing: Vec<usize> =
            (0..self.opposite.len()).filter(|face| self.is_touchable(*face) && runs_against(face)).collect();
        facing.sort_by_key(of_rank);
        let (mut best, mut layer) = ((f64::INFINITY, Vec::new()), (f64::INFINITY, Vec::<usize>::new()));
        for face in facing {
            let goes_on = layer.1.last().is_some_and(|last| {
                of_rank(last) + 1 == of_rank(&face) && self.opposite[*last].chain == self.opposite[face].chain
            });
            if !goes_on {
                layer = (f64::INFINITY, Vec::new());
            }
            layer.1.push(face);
            layer.0 = layer.0.min(self.square_from(&self.opposite[face], point));
            if layer.0 < best.0 || layer.1.first() == best.1.first() {
                best = layer.clone();
            }
        }
        best.1
    }

    fn values(&self, found: &OppositePart, point: &dyn Fn(usize) -> NumberPair) -> MeasuredGap {
        if self.faces.is_empty() { self.at_nearest(found, point) } else { self.mean(found, point) }
    }

    /// The smallest distance between the faces and the opposite surface.
    pub fn distance(&self, displacements: &[MeasuredVector]) -> f64 {
        let position = |node: usize| self.place(node) + displacements[node];
        if self.faces.is_empty() {
            return self.gap(displacements);
        }
        let from_line = |point: MeasuredVector, [first, last]: [usize; 2]| {
            let (first, edge) = (position(first), position(last) - position(first));
            let share = ((point - first).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
            (point - first - edge * share).norm()
        };
        let mut least = self.farthest();
        for MeasuredOwnFace { nodes: own, touchable, .. } in &self.faces {
            for (_, other) in self.opposite.iter().enumerate().filter(|(index, _)| touchable.has(*index)) {
                least = own.iter().fold(least, |least, node| least.min(from_line(position(*node), other.nodes)));
                least = other.nodes.iter().fold(least, |least, node| least.min(from_line(position(*node), *own)));
            }
        }
        least
    }

    /// The mean over the faces at the node.
    fn mean(&self, found: &OppositePart, point: &dyn Fn(usize) -> NumberPair) -> MeasuredGap {
        let zero = PlaneNumber::constant(0.0);
        let [mut weights, mut gaps, mut places, mut lengths, mut undeformed] = [zero; 5];
        let mut reference: Option<f64> = None;
        let mut period = None;
        for MeasuredOwnFace { nodes: [first, last], is_alone, touchable } in &self.faces {
            let (start, end) = (point(*first), point(*last));
            let edge = minus(end, start);
            let length = root(product(edge, edge));
            let along = edge.map(|part| part.over(length));
            let across = [along[1].times(-1.0), along[0]];
            // Sums over the covered part: of the shape functions, of their products, of their products with the distance
            // and with the position.
            let (mut shares, mut mass, mut heights, mut positions) = ([zero; 2], [zero; 3], [zero; 2], [zero; 2]);
            for face in found.faces.iter().filter(|face| touchable.has(**face)).map(|face| &self.opposite[*face]) {
                let goes_on = self.goes_on(face);
                let ends = face.nodes.map(|node| minus(point(node), start));
                let [high, low] = ends.map(|end| product(end, along));
                let [height_high, height_low] = ends.map(|end| product(end, across));
                // The last face goes on straight beyond an end of the surface.
                // Parts that do not count as covered belong to the face beside them.
                let least = COVERED * length.0;
                let from = if goes_on[1] || low.0 <= least { zero } else { low };
                let to = if goes_on[0] || high.0 >= length.0 - least { length } else { high };
                let is_aside = is_aside(high.0 - low.0, [height_high.0, height_low.0], length.0);
                if is_aside || to.0 - from.0 <= COVERED * length.0 {
                    continue;
                }
                let origin = *reference.get_or_insert(face.along[0]);
                period = face.period;
                let shift = near(face.period, origin, face.along[0]) - face.along[0];
                let width = to.minus(from);
                let reference_length = PlaneNumber::constant(face.along[1] - face.along[0]);
                for (fraction, weight) in GAUSS {
                    let s = from.plus(width.times(fraction));
                    let share = s.minus(low).over(high.minus(low));
                    let height = height_low.plus(share.by(height_high.minus(height_low)));
                    let position =
                        share.times(face.along[0] - face.along[1]).plus(PlaneNumber::constant(face.along[1] + shift));
                    let shape = [PlaneNumber::constant(1.0).minus(s.over(length)), s.over(length)];
                    let radius = shape[0].by(start[0]).plus(shape[1].by(end[0]));
                    let weight = width.times(weight);
                    let weight = if self.is_revolved { weight.by(radius) } else { weight };
                    for k in 0..2 {
                        shares[k] = shares[k].plus(weight.by(shape[k]));
                        mass[2 * k] = mass[2 * k].plus(weight.by(shape[k]).by(shape[k]));
                        heights[k] = heights[k].plus(weight.by(shape[k]).by(height));
                        positions[k] = positions[k].plus(weight.by(shape[k]).by(position));
                    }
                    mass[1] = mass[1].plus(weight.by(shape[0]).by(shape[1]));
                    lengths = lengths.plus(weight);
                    undeformed = undeformed.plus(weight.by(reference_length).over(high.minus(low)));
                }
            }
            if shares[0].0 + shares[1].0 <= 0.0 {
                continue;
            }
            if *is_alone {
                weights = weights.plus(shares[0]).plus(shares[1]);
                gaps = gaps.plus(heights[0]).plus(heights[1]);
                places = places.plus(positions[0]).plus(positions[1]);
                continue;
            }
            let own = usize::from(*last == self.node);
            let determinant = mass[0].by(mass[2]).minus(mass[1].by(mass[1]));
            let fitted = |sums: [PlaneNumber; 2]| {
                let [one, other] = [sums[own], sums[1 - own]];
                one.by(mass[2 - 2 * own]).minus(other.by(mass[1])).over(determinant)
            };
            weights = weights.plus(shares[own]);
            gaps = gaps.plus(shares[own].by(fitted(heights)));
            places = places.plus(shares[own].by(fitted(positions)));
        }
        if weights.0 == 0.0 {
            let apart = self.apart(point);
            return MeasuredGap { gap: apart, place: zero, stretch: PlaneNumber::constant(1.0), period: None };
        }
        MeasuredGap { gap: gaps.over(weights), place: places.over(weights), stretch: lengths.over(undeformed), period }
    }

    /// The distance of the node where nothing is opposite; without derivatives, as nothing acts.
    fn apart(&self, point: &dyn Fn(usize) -> NumberPair) -> PlaneNumber {
        let position = |node: usize| {
            let [x, y] = point(node);
            MeasuredVector::new(x.0, y.0, 0.0)
        };
        PlaneNumber::constant(self.distance_of(position(self.node), &position))
    }

    /// Control points of the smoothed surface at a face, and their coordinates along it.
    fn controls(&self, face: &OppositeFace, point: &dyn Fn(usize) -> NumberPair) -> ([NumberPair; 4], [f64; 4]) {
        let [first, last] = face.nodes.map(point);
        let length = |beside: Option<usize>| {
            let along = beside.map_or(face.along, |beside| self.opposite[beside].along);
            along[1] - along[0]
        };
        let beyond = |near: NumberPair, far: NumberPair| [0, 1].map(|k| near[k].times(2.0).minus(far[k]));
        let before = face.beside[0].map_or_else(|| beyond(first, last), |beside| point(self.opposite[beside].nodes[0]));
        let after = face.beside[1].map_or_else(|| beyond(last, first), |beside| point(self.opposite[beside].nodes[1]));
        let [from, to] = face.along;
        ([before, first, last, after], [from - length(face.beside[0]), from, to, to + length(face.beside[1])])
    }

    /// The way from a point of the smoothed surface to the node, the tangent there, the coordinate along the surface and
    /// its slope.
    fn curve(
        &self,
        face: usize,
        t: PlaneNumber,
        point: &dyn Fn(usize) -> NumberPair,
    ) -> (NumberPair, NumberPair, PlaneNumber, PlaneNumber) {
        let face = &self.opposite[face];
        let (controls, along) = self.controls(face, point);
        let [values, slopes] = weights(t, face.beside.map(|beside| beside.is_none()));
        let sum = |weights: &[PlaneNumber; 4]| {
            [0, 1].map(|k| {
                let terms = weights.iter().zip(&controls).map(|(weight, control)| weight.by(control[k]));
                terms.fold(PlaneNumber::constant(0.0), PlaneNumber::plus)
            })
        };
        let scalar = |weights: &[PlaneNumber; 4]| {
            let terms = weights.iter().zip(along).map(|(weight, place)| weight.times(place));
            terms.fold(PlaneNumber::constant(0.0), PlaneNumber::plus)
        };
        (minus(point(self.node), sum(&values)), sum(&slopes), scalar(&values), scalar(&slopes))
    }

    /// The nearest point of the smoothed surface.
    fn nearest(&self, point: &dyn Fn(usize) -> NumberPair) -> OppositePart {
        let mut best = (f64::INFINITY, 0, 0.0);
        for index in 0..self.opposite.len() {
            for sample in 0..=SAMPLES {
                let t = sample as f64 / SAMPLES as f64;
                let (from, ..) = self.curve(index, PlaneNumber::constant(t), point);
                let distance = product(from, from).0;
                if distance < best.0 {
                    best = (distance, index, t);
                }
            }
        }
        let (_, mut index, t) = best;
        let part = 1.0 / SAMPLES as f64;
        let forward = |index: usize, t: f64| {
            let (from, slope, ..) = self.curve(index, PlaneNumber::constant(t), point);
            product(from, slope).0
        };
        let (mut low, mut high) = (t - part, t + part);
        // The neighbouring face takes over past an end, unless the surface ends there and goes on straight.
        if forward(index, t) < 0.0 {
            high = t;
            if low < 0.0 {
                match self.opposite[index].beside[0] {
                    Some(before) => (index, low, high) = (before, low + 1.0, 1.0),
                    None => low = -1.0,
                }
            }
        } else {
            low = t;
            if high > 1.0 {
                match self.opposite[index].beside[1] {
                    Some(after) => (index, low, high) = (after, 0.0, high - 1.0),
                    None => high = 2.0,
                }
            }
        }
        while low < 0.0 && forward(index, low) < 0.0 && low > -1e9 {
            low *= 2.0;
        }
        while high > 1.0 && forward(index, high) > 0.0 && high < 1e9 {
            high *= 2.0;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if forward(index, middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let t = 0.5 * (low + high);
        // Secant slope of the product, for one step of Newton's method with derivatives.
        let step = 1e-4;
        let slope = (forward(index, t + step) - forward(index, t - step)) / (2.0 * step);
        OppositePart { faces: vec![index], place: t, slope }
    }

    fn at_nearest(&self, found: &OppositePart, point: &dyn Fn(usize) -> NumberPair) -> MeasuredGap {
        let (Some(face), OppositePart { place: t, slope, .. }) = (found.faces.first().copied(), found) else {
            return MeasuredGap {
                gap: PlaneNumber::constant(f64::NAN),
                place: PlaneNumber::constant(0.0),
                stretch: PlaneNumber::constant(1.0),
                period: None,
            };
        };
        let (from, tangent, ..) = self.curve(face, PlaneNumber::constant(*t), point);
        let place = PlaneNumber::constant(*t).minus(product(from, tangent).times(1.0 / slope));
        let (from, tangent, position, advance) = self.curve(face, DualNumber(*t, place.1), point);
        let size = root(product(tangent, tangent));
        let gap = from[1].by(tangent[0]).minus(from[0].by(tangent[1])).over(size);
        MeasuredGap { gap, place: position, stretch: size.over(advance), period: self.opposite[face].period }
    }
}

/// Whether a face that goes back by `advance` along one of a length, between two heights over it, is not in front of it.
fn is_aside(advance: f64, heights: [f64; 2], length: f64) -> bool {
    let is_behind = heights[0].max(heights[1]) < -FAR_BEHIND * length;
    advance <= 0.0 || (heights[1] - heights[0]).abs() > STEEP * advance || is_behind
}

/// Values and slopes of the cubic B-spline's functions on a face; beyond an end of the surface those of a straight line.
fn weights(t: PlaneNumber, ends: [bool; 2]) -> [[PlaneNumber; 4]; 2] {
    let bounded = if ends[0] && t.0 < 0.0 {
        PlaneNumber::constant(0.0)
    } else if ends[1] && t.0 > 1.0 {
        PlaneNumber::constant(1.0)
    } else {
        t
    };
    let one = PlaneNumber::constant(1.0);
    let rest = one.minus(bounded);
    let cube = |a: PlaneNumber| a.by(a).by(a).times(1.0 / 6.0);
    let square = |a: PlaneNumber| a.by(a).times(0.5);
    // The inner functions by what is left of one, so that all four sum to one.
    let second = |a: PlaneNumber| PlaneNumber::constant(2.0 / 3.0).minus(a.by(a)).plus(a.by(a).by(a).times(0.5));
    let values = [cube(rest), second(bounded), second(rest), cube(bounded)];
    let second_slope = |a: PlaneNumber| a.times(-2.0).plus(a.by(a).times(1.5));
    let slopes = [square(rest).times(-1.0), second_slope(bounded), second_slope(rest).times(-1.0), square(bounded)];
    let beyond = t.minus(bounded);
    [std::array::from_fn(|k| values[k].plus(beyond.by(slopes[k]))), slopes]
}

fn minus(a: NumberPair, b: NumberPair) -> NumberPair {
    [a[0].minus(b[0]), a[1].minus(b[1])]
}

fn product(a: NumberPair, b: NumberPair) -> PlaneNumber {
    a[0].by(b[0]).plus(a[1].by(b[1]))
}

fn root(a: PlaneNumber) -> PlaneNumber {
    let root = a.0.sqrt();
    a.map(root, 0.5 / root)
}
