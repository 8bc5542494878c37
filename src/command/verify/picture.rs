//! A picture of errors over their tolerances, one line per scene or family.

use crate::check::verify::case::CaseRow;
use plotters::coord::Shift;
use plotters::element::PathElement;
use plotters::prelude::{
    Circle, DrawingArea, DrawingAreaErrorKind, IntoDrawingArea, IntoFont, RGBColor, SVGBackend, Text,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, TextStyle};

const INK: RGBColor = RGBColor(34, 34, 34);
const PAPER: RGBColor = RGBColor(255, 255, 255);
const GRID: RGBColor = RGBColor(228, 228, 228);
const BAR: RGBColor = RGBColor(190, 20, 40);
const PASSES: RGBColor = RGBColor(25, 85, 150);

/// In pixels.
const WIDTH: i32 = 900;
const LINE: i32 = 20;
const NAMES: i32 = 170;
const MARGIN: i32 = 20;
const ABOVE: i32 = 50;
const BELOW: i32 = 30;
/// Decades of error over tolerance; values outside are drawn at the edge.
const DECADES: std::ops::RangeInclusive<i32> = -9..=3;

type DrawingError = DrawingAreaErrorKind<std::io::Error>;

/// The picture as SVG text. An error that is not finite is drawn at the right edge.
pub fn svg(rows: &[CaseRow]) -> Result<String, DrawingError> {
    let mut families: Vec<&str> = rows.iter().map(|row| row.family).collect();
    families.dedup();
    let lines = i32::try_from(families.len()).unwrap_or(i32::MAX / LINE - ABOVE);
    let height = ABOVE + LINE * lines + BELOW;
    let mut text = String::new();
    {
        let size = (WIDTH.unsigned_abs(), height.unsigned_abs());
        let sheet = SVGBackend::with_string(&mut text, size).into_drawing_area();
        sheet.fill(&PAPER)?;
        draw(&sheet, rows, &families, height)?;
        sheet.present()?;
    }
    Ok(text)
}

/// The position of an error that is this many decades above its tolerance.
fn across(decades: f64) -> i32 {
    let (first, last) = (f64::from(*DECADES.start()), f64::from(*DECADES.end()));
    let part = (decades.clamp(first, last) - first) / (last - first);
    NAMES + MARGIN + (part * f64::from(WIDTH - NAMES - 2 * MARGIN)).round() as i32
}

fn draw(
    sheet: &DrawingArea<SVGBackend<'_>, Shift>,
    rows: &[CaseRow],
    families: &[&str],
    height: i32,
) -> Result<(), DrawingError> {
    let lettering = |size: i32, horizontal: HPos| -> TextStyle<'_> {
        ("sans-serif", size).into_font().color(&INK).pos(Pos::new(horizontal, VPos::Center))
    };
    sheet.draw(&Text::new("error over its bar", (across(-3.0), MARGIN), lettering(15, HPos::Center)))?;
    for decade in DECADES {
        let x = across(f64::from(decade));
        let style = if decade == 0 { BAR.stroke_width(2) } else { GRID.stroke_width(1) };
        sheet.draw(&PathElement::new(vec![(x, ABOVE - 6), (x, height - BELOW)], style))?;
        let label = if decade == 0 { "1".to_owned() } else { format!("1e{decade}") };
        sheet.draw(&Text::new(label, (x, height - BELOW / 2), lettering(12, HPos::Center)))?;
    }
    for (row, family) in (0..).zip(families) {
        let y = ABOVE + LINE * row + LINE / 2;
        sheet.draw(&Text::new((*family).to_owned(), (NAMES, y), lettering(12, HPos::Right)))?;
        for found in rows.iter().filter(|found| found.family == *family) {
            // A request that is refused as expected has no error.
            let decades = match found.error {
                Some(error) => (error / found.bar).log10(),
                None if found.pass => continue,
                None => f64::INFINITY,
            };
            let color = if found.pass { PASSES } else { BAR };
            sheet.draw(&Circle::new((across(decades), y), 3, color.mix(0.6).filled()))?;
        }
    }
    Ok(())
}
