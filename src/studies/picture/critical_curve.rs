//! The picture of a curve of limit points, bifurcation points or contact changes: their load against the parameter.

use crate::model::InputError;
use crate::result::increment::PointKind;
use crate::studies::critical_curves::{CurveFound, CurveRow};
use crate::studies::picture::PlotError;
use crate::studies::picture::axis::Axis;
use crate::studies::picture::chart::{self, CAPTION, MARGIN, Side};
use crate::studies::picture::shapes::{self, Drawn, FINE, INK, Lettering, PAPER, Place, Sheet};
use plotters::prelude::{Circle, PathElement, RGBColor};
use plotters::style::Color;

/// Widths and heights, in pixels.
const CHART: i32 = 640;
const LEGEND: i32 = 240;
const HEIGHT: i32 = 480;
const DOT: i32 = 3;
const CHANGE: i32 = 6;
const ROW: i32 = 22;
const TICKS: usize = 9;
const LONGEST_NAME: usize = 32;

/// The kinds of points, their names and colours.
const KINDS: [(PointKind, &str, RGBColor); 4] = [
    (PointKind::SmoothLimit, "smooth limit point", RGBColor(25, 85, 150)),
    (PointKind::NonsmoothLimit, "nonsmooth limit point", RGBColor(190, 20, 40)),
    (PointKind::SmoothBifurcation, "bifurcation point", RGBColor(150, 90, 0)),
    (PointKind::ContactChange, "contact change", RGBColor(60, 60, 60)),
];
const PLAIN: Lettering = Lettering { size: 12, color: &INK, bold: false, centred: false };

fn color(kind: PointKind) -> RGBColor {
    KINDS.iter().find(|(other, ..)| *other == kind).map_or(KINDS[0].2, |(.., color)| *color)
}

/// The picture as SVG text: the same for the same rows.
///
/// # Errors
/// The curve has no points.
pub fn svg(found: &CurveFound) -> Result<String, PlotError> {
    // Points that are on no path are told of, not drawn.
    let found = &found.known_on_path();
    if found.rows.is_empty() {
        return Err(PlotError::NoPoints);
    }
    let across = Axis::spanning(found.rows.iter().map(|row| row.value), TICKS);
    let load = Axis::spanning(found.rows.iter().map(|row| row.load_factor), TICKS);
    let drawn = shapes::svg(CHART + LEGEND, HEIGHT, |sheet| {
        draw_chart(sheet, found, &across, &load)?;
        legend(sheet, found)
    });
    drawn.map_err(|error| PlotError::Drawing(error.to_string()))
}

fn draw_chart(sheet: &Sheet<'_>, found: &CurveFound, across: &Axis, load: &Axis) -> Drawn {
    let (part, _) = sheet.split_horizontally(CHART * FINE);
    let parameter = InputError::new(found.curve.parameter.as_str(), "").place();
    let parameter = parameter.strip_prefix("model.").unwrap_or(&parameter);
    let sides = [
        Side { name: across.named(parameter), range: across.range.clone(), tick: &|at| across.tick(at), ticks: TICKS },
        Side { name: load.named("load factor"), range: load.range.clone(), tick: &|at| load.tick(at), ticks: TICKS },
    ];
    let chart = chart::chart(&part, CHART, Some(found.name.as_deref().unwrap_or("curve of limit points")), sides)?;
    let place =
        |row: &CurveRow| -> Place { chart.backend_coord(&(across.drawn(row.value), load.drawn(row.load_factor))) };
    for pair in found.rows.windows(2) {
        // A point where the kind changes belongs to both sides.
        let kind = if pair[0].codimension_two { pair[1].kind } else { pair[0].kind };
        sheet.draw(&PathElement::new(vec![place(&pair[0]), place(&pair[1])], color(kind).stroke_width(14)))?;
    }
    for row in &found.rows {
        if row.codimension_two {
            sheet.draw(&Circle::new(place(row), CHANGE * FINE, PAPER.filled()))?;
            sheet.draw(&Circle::new(place(row), CHANGE * FINE, INK.stroke_width(14)))?;
        } else {
            sheet.draw(&Circle::new(place(row), DOT * FINE, color(row.kind).filled()))?;
        }
    }
    Ok(())
}

fn legend(sheet: &Sheet<'_>, found: &CurveFound) -> Drawn {
    let left = CHART + MARGIN / 2;
    let kinds = KINDS.iter().filter(|(kind, ..)| found.rows.iter().any(|row| row.kind == *kind));
    let entries = kinds.map(|(_, words, color)| (*words, Some(*color)));
    for (number, (words, color)) in (0..).zip(entries.chain([("change of kind or path", None)])) {
        let middle = CAPTION + number * ROW + ROW / 2;
        let at = ((left + 8) * FINE, middle * FINE);
        match color {
            Some(color) => sheet.draw(&Circle::new(at, DOT * FINE, color.filled()))?,
            None => sheet.draw(&Circle::new(at, CHANGE * FINE, INK.stroke_width(14)))?,
        }
        PLAIN.write(sheet, ((left + 22) * FINE, middle * FINE), words, LONGEST_NAME)?;
    }
    Ok(())
}
