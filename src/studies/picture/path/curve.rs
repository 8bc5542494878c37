//! Extracts the curve and its events from the increments of a path.

use crate::model::Model;
use crate::result::increment::{Increment, PointKind};
use crate::studies::picture::path::Against;
use crate::studies::picture::path::strokes::Stretch;
use std::sync::Arc;

/// Load factor against a quantity.
#[derive(Debug)]
pub struct Curve {
    /// The model's name.
    pub title: Option<String>,
    quantity: Against,
    /// The quantity's name, with its unit.
    pub against: String,
    pub stages: Vec<StageCurve>,
    /// In order of appearance.
    pub events: Vec<Event>,
}

#[derive(Debug)]
pub struct StageCurve {
    pub name: Arc<str>,
    pub points: Vec<CurvePoint>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// The quantity and the load factor.
    pub at: (f64, f64),
    /// The path has several continuations here.
    pub bifurcation: bool,
    /// The structure has moved here from the point before.
    pub is_moved: bool,
}

impl StageCurve {
    /// What is between each two points, in order; the flag of a bifurcation is about the continuation of its point.
    pub fn stretches(&self) -> impl Iterator<Item = Stretch> {
        self.points.windows(2).map(|pair| match (pair[1].is_moved, pair[0].bifurcation) {
            (true, _) => Stretch::Jump,
            (false, true) => Stretch::Bifurcation,
            (false, false) => Stretch::Plain,
        })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// A, B, ... Z, AA, AB, ...
    pub label: String,
    pub kind: EventKind,
    /// The quantity and the load factor.
    pub at: (f64, f64),
    /// The event, as in the increment.
    pub words: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    SmoothLimit,
    NonsmoothLimit,
    ContactChange,
    End,
    Jump,
}

impl Curve {
    /// A curve without points.
    pub fn new(model: &Model, quantity: Against) -> Self {
        let unit = quantity.unit(model.units.as_ref()).map_or_else(String::new, |unit| format!(" [{unit}]"));
        let against = format!("{}{unit}", quantity.name());
        Self { title: model.name.clone(), quantity, against, stages: Vec::new(), events: Vec::new() }
    }

    /// Adds the point of an increment, if it has the quantity.
    pub fn push(&mut self, increment: &Increment) {
        let Some(value) = self.quantity.of(increment) else { return };
        let at = (value, increment.load_factor);
        if value.is_finite() && increment.load_factor.is_finite() {
            self.add_point(increment, at);
            self.add_event(increment, at);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.stages.is_empty()
    }

    /// All points of the curve.
    pub fn places(&self) -> impl Iterator<Item = (f64, f64)> {
        self.stages.iter().flat_map(|stage| stage.points.iter().map(|point| point.at))
    }

    fn add_point(&mut self, increment: &Increment, at: (f64, f64)) {
        let is_moved = matches!(increment.point.kind, PointKind::Jump | PointKind::Motion);
        let point = CurvePoint { at, bifurcation: increment.point.bifurcation, is_moved };
        match self.stages.last_mut() {
            Some(stage) if stage.name == increment.stage => stage.points.push(point),
            _ => self.stages.push(StageCurve { name: Arc::clone(&increment.stage), points: vec![point] }),
        }
    }

    fn add_event(&mut self, increment: &Increment, at: (f64, f64)) {
        let kind = match increment.point.kind {
            PointKind::SmoothLimit => EventKind::SmoothLimit,
            PointKind::NonsmoothLimit => EventKind::NonsmoothLimit,
            PointKind::ContactChange => EventKind::ContactChange,
            PointKind::End => EventKind::End,
            PointKind::Jump => EventKind::Jump,
            PointKind::Motion | PointKind::Start | PointKind::Regular | PointKind::SmoothBifurcation => return,
        };
        let label = letters(self.events.len());
        self.events.push(Event { label, kind, at, words: increment.point.event.clone() });
    }
}

impl EventKind {
    pub fn words(self) -> &'static str {
        match self {
            Self::SmoothLimit => "smooth limit",
            Self::NonsmoothLimit => "nonsmooth limit",
            Self::ContactChange => "contact change",
            Self::End => "end",
            Self::Jump => "at rest after a jump",
        }
    }
}

/// 0 is A, 25 is Z, 26 is AA.
fn letters(index: usize) -> String {
    let mut letters = Vec::new();
    let mut rest = index + 1;
    while rest > 0 {
        rest -= 1;
        // A remainder by 26 fits in a byte.
        letters.push(char::from(b'A' + (rest % 26) as u8));
        rest /= 26;
    }
    letters.iter().rev().collect()
}

#[cfg(test)]
mod tests {
    use super::letters;

    #[test]
    fn letters_go_on_after_z() {
        let some = [0, 1, 25, 26, 51, 52, 701, 702].map(letters);
        assert_eq!(some, ["A", "B", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }
}
