//! Drawing primitives. The library uses integer coordinates, so that pictures are drawn in units of a tenth of a pixel, and scaled
//! at the end.

use plotters::coord::Shift;
use plotters::prelude::{
    DrawingArea, DrawingAreaErrorKind, IntoDrawingArea, IntoFont, RGBColor, SVGBackend, Text, TextStyle,
};
use plotters::style::FontStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Units per pixel.
pub const FINE: i32 = 10;

pub const INK: RGBColor = RGBColor(34, 34, 34);
pub const FAINT_INK: RGBColor = RGBColor(100, 100, 100);
pub const PAPER: RGBColor = RGBColor(255, 255, 255);
/// Text sizes of the library include the line spacing.
const TEXT_SIZE: f64 = 1.24;

/// A place on the sheet, in fine units.
pub type Place = (i32, i32);
pub type Sheet<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn = Result<(), DrawingError>;
pub type DrawingError = DrawingAreaErrorKind<std::io::Error>;

/// A picture of this size in pixels as SVG text.
pub fn svg(width: i32, height: i32, draw: impl FnOnce(&Sheet<'_>) -> Drawn) -> Result<String, DrawingError> {
    let shown = (width.unsigned_abs(), height.unsigned_abs());
    let fine = (shown.0 * FINE.unsigned_abs(), shown.1 * FINE.unsigned_abs());
    let mut text = String::new();
    {
        let sheet = SVGBackend::with_string(&mut text, fine).into_drawing_area();
        sheet.fill(&PAPER)?;
        draw(&sheet)?;
        sheet.present()?;
    }
    let size = |(width, height): (u32, u32)| format!("width=\"{width}\" height=\"{height}\"");
    Ok(text.replacen(&size(fine), &size(shown), 1))
}

/// The style of a text.
#[derive(Debug, Clone, Copy)]
pub struct Lettering {
    /// In pixels.
    pub size: i32,
    pub color: &'static RGBColor,
    pub bold: bool,
    /// Centred at its place, rather than to the right of it.
    pub centred: bool,
}

impl Lettering {
    pub fn style(self) -> TextStyle<'static> {
        let style = if self.bold { FontStyle::Bold } else { FontStyle::Normal };
        let across = if self.centred { HPos::Center } else { HPos::Left };
        let size = f64::from(self.size * FINE) * TEXT_SIZE;
        TextStyle::from(("sans-serif", size, style).into_font()).color(self.color).pos(Pos::new(across, VPos::Center))
    }

    /// Writes a text, truncated to a length.
    pub fn write(self, sheet: &Sheet<'_>, place: Place, text: &str, longest: usize) -> Drawn {
        sheet.draw(&Text::new(legible(text, longest), place, self.style()))
    }
}

/// A text of the user on one line, without characters that XML does not allow.
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
