//! Lines, dots and marks of a path.

use crate::studies::picture::path::curve::EventKind;
use crate::studies::picture::shapes::{Drawn, FAINT_INK, FINE, INK, PAPER, Place, Sheet};
use plotters::element::DashedPathElement;
use plotters::prelude::{Circle, PathElement, Polygon, RGBColor, ShapeStyle};
use plotters::style::Color;

const BIFURCATION: RGBColor = RGBColor(230, 120, 0);
const LIMIT: RGBColor = RGBColor(190, 20, 40);
const NONSMOOTH: RGBColor = RGBColor(120, 40, 140);
/// Colours of the stages, in turn.
const STAGES: [RGBColor; 4] =
    [RGBColor(25, 85, 150), RGBColor(70, 165, 40), RGBColor(125, 75, 30), RGBColor(90, 90, 120)];

/// Half the size of a marker, in pixels.
pub const MARKER: i32 = 5;

/// The style of a part of the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stroke {
    /// Index of the stage.
    pub stage: usize,
    pub stretch: Stretch,
}

/// What is between two points of the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stretch {
    /// States of equilibrium with one way on.
    Plain,
    /// States of equilibrium with several ways on.
    Bifurcation,
    /// A jump: the structure moves.
    Jump,
}

impl Stroke {
    /// The colour and the width of the line, and the size of its dots, in fine units.
    fn look(self) -> (RGBColor, u32, i32) {
        match self.stretch {
            Stretch::Plain => (STAGES[self.stage % STAGES.len()], 14, 16),
            Stretch::Bifurcation => (BIFURCATION, 36, 26),
            Stretch::Jump => (FAINT_INK, 10, 10),
        }
    }

    /// The dashes of a line and what is between them, in pixels. Every second stage is dashed, so that a stage remains visible
    /// under a later one.
    fn dashes(self) -> Option<(i32, i32)> {
        match self.stretch {
            Stretch::Plain => (self.stage % 2 == 1).then_some((7, 7)),
            Stretch::Bifurcation => None,
            Stretch::Jump => Some((3, 4)),
        }
    }

    pub fn line(self, sheet: &Sheet<'_>, places: Vec<Place>) -> Drawn {
        let (color, width, _) = self.look();
        let style = color.stroke_width(width);
        match self.dashes() {
            Some((dash, gap)) => sheet.draw(&DashedPathElement::new(places, dash * FINE, gap * FINE, style)),
            None => sheet.draw(&PathElement::new(places, style)),
        }
    }

    pub fn dot(self, sheet: &Sheet<'_>, place: Place) -> Drawn {
        let (color, _, size) = self.look();
        sheet.draw(&Circle::new(place, size, color.filled()))
    }
}

/// The line from a letter to its point, if they are apart.
pub fn leader(sheet: &Sheet<'_>, from: Place, to: Place) -> Drawn {
    sheet.draw(&PathElement::new(vec![from, to], FAINT_INK.stroke_width(7)))
}

/// The mark of an event; every kind has its own shape.
pub fn marker(sheet: &Sheet<'_>, kind: EventKind, (x, y): Place) -> Drawn {
    let size = MARKER * FINE;
    let outline = |color: RGBColor| color.stroke_width(16);
    match kind {
        EventKind::SmoothLimit => sheet.draw(&Circle::new((x, y), size, LIMIT.filled())),
        EventKind::NonsmoothLimit => {
            let reach = size * 13 / 10;
            let corners = vec![(x - reach, y), (x, y - reach), (x + reach, y), (x, y + reach)];
            sheet.draw(&Polygon::new(corners, NONSMOOTH.filled()))
        }
        EventKind::ContactChange => {
            sheet.draw(&Circle::new((x, y), size, PAPER.filled()))?;
            sheet.draw(&Circle::new((x, y), size * 8 / 10, outline(INK)))
        }
        EventKind::Jump => {
            let reach = size * 12 / 10;
            let corners = vec![(x - reach, y + reach), (x, y - reach), (x + reach, y + reach)];
            sheet.draw(&Polygon::new(corners, ShapeStyle::from(&INK).filled()))
        }
        EventKind::End => {
            let reach = size * 9 / 10;
            let corners =
                vec![(x - reach, y - reach), (x + reach, y - reach), (x + reach, y + reach), (x - reach, y + reach)];
            sheet.draw(&Polygon::new(corners, ShapeStyle::from(&INK).filled()))
        }
    }
}
