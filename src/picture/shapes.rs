//! What the picture is made of. The library places things on whole units, so the picture is drawn in units of a tenth of
//! a pixel, and shown at its size in the end.

use super::curve::EventKind;
use super::labels::Place;
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::{
    Circle, DrawingArea, DrawingAreaErrorKind, IntoFont, PathElement, Polygon, RGBColor, SVGBackend, ShapeStyle, Text,
    TextStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle};

/// Units a pixel.
pub const FINE: i32 = 10;

pub const INK: RGBColor = RGBColor(34, 34, 34);
pub const FAINT_INK: RGBColor = RGBColor(100, 100, 100);
pub const PAPER: RGBColor = RGBColor(255, 255, 255);
const BIFURCATION: RGBColor = RGBColor(230, 120, 0);
const LIMIT: RGBColor = RGBColor(190, 20, 40);
const NONSMOOTH: RGBColor = RGBColor(120, 40, 140);
/// Of the stages, in turn.
const STAGES: [RGBColor; 4] =
    [RGBColor(25, 85, 150), RGBColor(70, 165, 40), RGBColor(125, 75, 30), RGBColor(90, 90, 120)];

/// Half the size of a marker, in pixels.
pub const MARKER: i32 = 5;
/// The library's text sizes count the lines' spacing.
const TEXT_SIZE: f64 = 1.24;

pub type Sheet<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn = Result<(), DrawingError>;
pub type DrawingError = DrawingAreaErrorKind<std::io::Error>;

/// How a stretch of the curve looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stroke {
    /// Place of the stage among the stages.
    pub stage: usize,
    pub bifurcation: bool,
}

impl Stroke {
    /// The colour and the width of the line, and the size of its dots, in fine units.
    fn look(self) -> (RGBColor, u32, i32) {
        if self.bifurcation { (BIFURCATION, 36, 26) } else { (STAGES[self.stage % STAGES.len()], 14, 16) }
    }

    /// Where a later stage covers an earlier one, both show.
    fn dashed(self) -> bool {
        self.stage % 2 == 1 && !self.bifurcation
    }

    pub fn line(self, sheet: &Sheet<'_>, places: Vec<Place>) -> Drawn {
        let (color, width, _) = self.look();
        let style = color.stroke_width(width);
        if self.dashed() {
            sheet.draw(&DashedPathElement::new(places, 7 * FINE, 7 * FINE, style))
        } else {
            sheet.draw(&PathElement::new(places, style))
        }
    }

    pub fn dot(self, sheet: &Sheet<'_>, place: Place) -> Drawn {
        let (color, _, size) = self.look();
        sheet.draw(&Circle::new(place, size, color.filled()))
    }
}

/// The line from a letter to its point, where they stand apart.
pub fn leader(sheet: &Sheet<'_>, from: Place, to: Place) -> Drawn {
    sheet.draw(&PathElement::new(vec![from, to], FAINT_INK.stroke_width(7)))
}

/// The mark of an event: no two kinds have the same shape.
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
        EventKind::End => {
            let reach = size * 9 / 10;
            let corners =
                vec![(x - reach, y - reach), (x + reach, y - reach), (x + reach, y + reach), (x - reach, y + reach)];
            sheet.draw(&Polygon::new(corners, ShapeStyle::from(&INK).filled()))
        }
    }
}

/// How a text stands.
#[derive(Debug, Clone, Copy)]
pub struct Lettering {
    /// In pixels.
    pub size: i32,
    pub color: &'static RGBColor,
    pub bold: bool,
    /// Around its place, rather than to the right of it.
    pub centred: bool,
}

impl Lettering {
    pub fn style(self) -> TextStyle<'static> {
        let style = if self.bold { FontStyle::Bold } else { FontStyle::Normal };
        let across = if self.centred { HPos::Center } else { HPos::Left };
        let size = f64::from(self.size * FINE) * TEXT_SIZE;
        TextStyle::from(("sans-serif", size, style).into_font()).color(self.color).pos(Pos::new(across, VPos::Center))
    }

    /// Writes a text, cut where it is longer than this.
    pub fn write(self, sheet: &Sheet<'_>, place: Place, text: &str, longest: usize) -> Drawn {
        sheet.draw(&Text::new(legible(text, longest), place, self.style()))
    }
}

/// A text of the user's as XML can hold it, on one line.
pub fn legible(text: &str, longest: usize) -> String {
    let stands_in_xml = |character: char| !character.is_control() && !matches!(character, '\u{fffe}' | '\u{ffff}');
    let shown = |character: char| if stands_in_xml(character) { character } else { '\u{fffd}' };
    if text.chars().nth(longest).is_none() {
        return text.chars().map(shown).collect();
    }
    text.chars().take(longest.saturating_sub(1)).map(shown).chain(std::iter::once('…')).collect()
}

#[cfg(test)]
mod tests {
    use super::legible;

    #[test]
    fn texts_are_cut_and_fit_for_xml() {
        assert_eq!(legible("tip\u{1}\n", 10), "tip\u{fffd}\u{fffd}");
        assert_eq!(legible("abcdef", 6), "abcdef");
        assert_eq!(legible("abcdefg", 6), "abcde…");
    }
}
