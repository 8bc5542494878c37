//! A path in closed form: stages made of smooth pieces.

use crate::check::scenes::exact::zeros::zero;
use crate::model::Model;
use crate::model::request::{self, DisplacementBound};
use crate::result::increment::PointKind;

/// A point of a path, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePlace {
    /// `dimension` components for each node, in the order of the model (length).
    pub displacements: Vec<f64>,
    pub load: f64,
}

/// The extent to which unbounded branches are given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Largest absolute value of the load factor.
    pub load: f64,
    /// Largest absolute value of a displacement component (length).
    pub displacement: f64,
}

/// A function that is negative before a bound and 0 at the bound.
type Bound = Box<dyn Fn(&CurvePlace) -> f64>;
type CurveFunction = Box<dyn Fn(f64) -> CurvePlace + Send + Sync>;

/// A smooth part of a path.
pub struct Piece {
    /// The parameter where the piece begins.
    pub from: f64,
    /// The parameter where the piece ends; less than `from` if the parameter decreases.
    pub to: f64,
    at: CurveFunction,
    /// The event at the end of the piece, if there is one.
    pub ends_with: Option<PointKind>,
}

/// A stage of a path.
pub struct CurveStage {
    pub name: String,
    pub pieces: Vec<Piece>,
}

/// Number of intervals of a stage in which a bound is searched for; a piece has at least four.
const PARTS: usize = 1000;

impl Piece {
    pub fn new(from: f64, to: f64, at: impl Fn(f64) -> CurvePlace + Send + Sync + 'static) -> Self {
        Self { from, to, at: Box::new(at), ends_with: None }
    }

    pub fn ending(mut self, kind: PointKind) -> Self {
        self.ends_with = Some(kind);
        self
    }

    /// The point at a parameter between `from` and `to`.
    pub fn at(&self, parameter: f64) -> CurvePlace {
        (self.at)(parameter)
    }

    /// The parameter at a fraction of the piece, from 0 to 1.
    pub fn parameter(&self, part: f64) -> f64 {
        self.from + part * (self.to - self.from)
    }

    /// The first parameter at which a quantity that is negative at the start becomes zero.
    fn reaches(&self, quantity: impl Fn(&CurvePlace) -> f64, parts: usize) -> Option<f64> {
        let value = |part: f64| quantity(&self.at(self.parameter(part)));
        let mut before = 0.0;
        for part in 1..=parts {
            let here = part as f64 / parts as f64;
            if value(here) >= 0.0 {
                return Some(self.parameter(zero(value, before, here)));
            }
            before = here;
        }
        None
    }
}

impl CurveStage {
    /// Divides a curve into pieces at the limit points of its load; `slope` is the derivative of the load with respect
    /// to the parameter.
    pub(super) fn turning(
        name: &str,
        (from, to): (f64, f64),
        slope: impl Fn(f64) -> f64,
        at: impl Fn(f64) -> CurvePlace + Clone + Send + Sync + 'static,
    ) -> Self {
        let mut pieces = Vec::new();
        let mut begins = from;
        for turn in crate::check::scenes::exact::zeros::zeros(slope, from, to) {
            pieces.push(Piece::new(begins, turn, at.clone()).ending(PointKind::SmoothLimit));
            begins = turn;
        }
        pieces.push(Piece::new(begins, to, at));
        Self { name: name.to_owned(), pieces }
    }

    /// Sets the event at the end of the stage.
    pub(super) fn ending(mut self, kind: PointKind) -> Self {
        if let Some(last) = self.pieces.last_mut() {
            last.ends_with = Some(kind);
        }
        self
    }

    /// Ends the stage at the first bound that the curve reaches.
    pub(super) fn end_at(&mut self, model: &Model, stage: &request::Stage) {
        let Some(until) = &stage.until else { return };
        let mut bounds: Vec<Bound> = Vec::new();
        if let Some(bound) = until.load_above {
            bounds.push(Box::new(move |place| place.load - bound));
        }
        if let Some(bound) = until.load_below {
            bounds.push(Box::new(move |place| bound - place.load));
        }
        if let Some(DisplacementBound { node, component, above, below }) = &until.displacement
            && let Some(number) = model.nodes.get_index_of(node)
        {
            let freedom = number * model.dimension + component.index();
            if let Some(bound) = *above {
                bounds.push(Box::new(move |place| place.displacements[freedom] - bound));
            }
            if let Some(bound) = *below {
                bounds.push(Box::new(move |place| bound - place.displacements[freedom]));
            }
        }
        let parts = (PARTS / self.pieces.len().max(1)).max(4);
        for index in 0..self.pieces.len() {
            let piece = &self.pieces[index];
            let met = bounds.iter().filter_map(|bound| piece.reaches(bound, parts));
            let first = met.min_by(|a, b| (a - piece.from).abs().total_cmp(&(b - piece.from).abs()));
            if let Some(first) = first {
                // An event exactly at the bound is kept.
                let kind = piece.ends_with.filter(|_| first == piece.to).unwrap_or(PointKind::End);
                self.pieces[index].to = first;
                self.pieces[index].ends_with = Some(kind);
                self.pieces.truncate(index + 1);
                return;
            }
        }
    }
}
