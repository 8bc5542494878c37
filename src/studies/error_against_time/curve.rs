//! A stage of the reference as a curve: its vertices and the segments between them.

use crate::check::scenes::exact;
use crate::result::increment::PointKind;
use crate::studies::error_against_time::interpolation::SegmentPolynomial;
use crate::studies::error_against_time::trace::{ScaledPoint, TraceScales, TracedStage, distance};

/// Approximate number of vertices of an exact stage; a piece has at least two.
const VERTICES: usize = 2000;

/// A segment from one vertex to the next.
enum Segment {
    Straight,
    Polynomial(SegmentPolynomial),
    /// The parameters at both ends.
    Exact {
        piece: usize,
        from: f64,
        to: f64,
    },
}

/// A curve with its events.
pub(super) struct Curve {
    pub stage: usize,
    /// Two or more.
    pub vertices: Vec<ScaledPoint>,
    /// Sum of the chords up to each vertex.
    pub arc: Vec<f64>,
    pub events: Vec<(PointKind, ScaledPoint)>,
    segments: Vec<Segment>,
    exact: Option<(Vec<exact::Piece>, TraceScales)>,
}

impl Curve {
    /// The curve through the points of a path, with corners at events.
    pub fn interpolating(traced: TracedStage) -> Self {
        let points = traced.points;
        let is_corner = |kind: PointKind| matches!(kind, PointKind::ContactChange | PointKind::NonsmoothLimit);
        let corners = traced.events.iter().filter(|event| is_corner(event.kind)).map(|event| event.point);
        let mut ends: Vec<usize> = corners.chain([points.len() - 1]).collect();
        ends.dedup();
        let mut segments = Vec::with_capacity(points.len());
        let mut first = 0;
        for last in ends {
            segments.extend(
                (first..last).map(|segment| Segment::Polynomial(SegmentPolynomial::new(&points, segment, first, last))),
            );
            first = last;
        }
        let events = traced.events.iter().map(|event| (event.kind, points[event.point].clone())).collect();
        Self::new(traced.stage, points, segments, events, None)
    }

    /// The curve of a stage in closed form.
    pub fn exact(number: usize, stage: exact::CurveStage, scales: &TraceScales) -> Self {
        let parts = (VERTICES / stage.pieces.len().max(1)).max(2);
        let scaled = |place: exact::CurvePlace| scales.point(number, place.displacements.into_iter(), place.load);
        let (mut vertices, mut segments, mut events) = (Vec::new(), Vec::new(), Vec::new());
        for (index, piece) in stage.pieces.iter().enumerate() {
            if index > 0 {
                segments.push(Segment::Straight);
            }
            let parameter = |part: usize| piece.parameter(part as f64 / parts as f64);
            vertices.extend((0..=parts).map(|part| scaled(piece.at(parameter(part)))));
            segments.extend((0..parts).map(|part| Segment::Exact {
                piece: index,
                from: parameter(part),
                to: parameter(part + 1),
            }));
            events.extend(piece.ends_with.map(|kind| (kind, scaled(piece.at(piece.to)))));
        }
        Self::new(number, vertices, segments, events, Some((stage.pieces, scales.clone())))
    }

    fn new(
        stage: usize,
        mut vertices: Vec<ScaledPoint>,
        mut segments: Vec<Segment>,
        events: Vec<(PointKind, ScaledPoint)>,
        exact: Option<(Vec<exact::Piece>, TraceScales)>,
    ) -> Self {
        if vertices.len() == 1 {
            vertices.push(vertices[0].clone());
            segments.push(Segment::Straight);
        }
        let mut arc = vec![0.0];
        let mut sum = 0.0;
        for ends in vertices.windows(2) {
            sum += distance(&ends[0], &ends[1]);
            arc.push(sum);
        }
        Self { stage, vertices, arc, events, segments, exact }
    }

    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// Largest distance of the curve from the middle of a chord.
    pub fn sag(&self) -> f64 {
        let sags = self.vertices.windows(2).enumerate().map(|(segment, ends)| {
            let middle: ScaledPoint = ends[0].iter().zip(&ends[1]).map(|(from, to)| 0.5 * (from + to)).collect();
            distance(&self.at(segment, 0.5), &middle)
        });
        sags.fold(0.0, f64::max)
    }

    /// The point of a segment at a parameter from 0 to 1.
    pub fn at(&self, segment: usize, part: f64) -> ScaledPoint {
        match (&self.segments[segment], &self.exact) {
            (Segment::Polynomial(polynomial), _) => polynomial.at(&self.vertices, part),
            (Segment::Exact { piece, from, to }, Some((pieces, scales))) => {
                let place = pieces[*piece].at(from + part * (to - from));
                scales.point(self.stage, place.displacements.into_iter(), place.load)
            }
            (Segment::Straight | Segment::Exact { .. }, _) => {
                let ends = self.vertices[segment].iter().zip(&self.vertices[segment + 1]);
                ends.map(|(from, to)| from + part * (to - from)).collect()
            }
        }
    }
}
