//! Draws the curve: axes, lines, dots, marks, letters, and the legend beside them.

use crate::studies::picture::axis::Axis;
use crate::studies::picture::chart::{self, CAPTION, LONGEST, MARGIN, Side, TITLE};
use crate::studies::picture::labels::Map;
use crate::studies::picture::path::curve::{Curve, StageCurve};
use crate::studies::picture::path::legend::{LISTED_EVENTS, Legend};
use crate::studies::picture::path::strokes::{MARKER, Stretch, Stroke, leader, marker};
use crate::studies::picture::shapes::{self, DrawingError, Drawn, FINE, Lettering, Place, Sheet};
use plotters::prelude::{PathElement, RGBColor};
use plotters::style::Color;

/// Widths, in pixels.
const CHART: i32 = 660;
const LEGEND: i32 = 380;
/// The least and the largest height of the chart; the legend may be higher.
const LOWEST: i32 = 480;
const HIGHEST: i32 = 900;
/// The most ticks of an axis.
const TICKS: usize = 10;
/// Half a letter's height, and half its width for each character, in fine units.
const HALF_HEIGHT: i32 = 70;
const HALF_WIDTH: i32 = 60;
/// A letter that is farther from its point than this is connected to it by a line.
const TIED: i32 = 18 * FINE;
/// Dots closer than this to the last one are omitted, in fine units.
const DENSE: i32 = 20;

const ZERO: RGBColor = RGBColor(170, 170, 170);
const LETTER: Lettering = Lettering { size: 14, ..TITLE };

/// The picture as SVG text.
pub fn draw(curve: &Curve) -> Result<String, DrawingError> {
    let across = Axis::showing(curve.places().map(|place| place.0), TICKS);
    let load = Axis::showing(curve.places().map(|place| place.1), TICKS);
    let legend = Legend::new(curve, &load);
    let height = LOWEST.max(legend.height() + CAPTION + 2 * MARGIN);
    shapes::svg(CHART + LEGEND, height, |sheet| {
        draw_chart(sheet, curve, &across, &load, height.min(HIGHEST))?;
        legend.draw(sheet, (CHART * FINE, (CAPTION + MARGIN / 2) * FINE))
    })
}

fn draw_chart(sheet: &Sheet<'_>, curve: &Curve, across: &Axis, load: &Axis, height: i32) -> Drawn {
    let (part, _) = sheet.split_horizontally(CHART * FINE);
    let (part, _) = part.split_vertically(height * FINE);
    let sides = [
        Side {
            name: across.named(&curve.against),
            range: across.range.clone(),
            tick: &|at| across.tick(at),
            ticks: TICKS,
        },
        Side { name: load.named(load_name(curve)), range: load.range.clone(), tick: &|at| load.tick(at), ticks: TICKS },
    ];
    let chart = chart::chart(&part, CHART, curve.title.as_deref(), sides)?;
    let on_sheet = |at: (f64, f64)| chart.backend_coord(&(across.drawn(at.0), load.drawn(at.1)));
    let (across, along) = chart.plotting_area().get_pixel_range();
    let origin = on_sheet((0.0, 0.0));
    sheet.draw(&PathElement::new(vec![(across.start, origin.1), (across.end, origin.1)], ZERO.stroke_width(10)))?;
    sheet.draw(&PathElement::new(vec![(origin.0, along.start), (origin.0, along.end)], ZERO.stroke_width(10)))?;

    let mut map = Map::new((across.start, along.start), (across.end, along.end));
    for (stage, drawn) in curve.stages.iter().enumerate() {
        draw_stage(sheet, stage, drawn, &on_sheet, &mut map)?;
    }
    draw_events(sheet, curve, &on_sheet, &mut map)
}

/// Stages share the axis, and each has a load factor of its own, from 0 on.
fn load_name(curve: &Curve) -> &'static str {
    if curve.stages.len() > 1 { "load factor of each stage" } else { "load factor" }
}

fn draw_stage(
    sheet: &Sheet<'_>,
    stage: usize,
    drawn: &StageCurve,
    on_sheet: &impl Fn((f64, f64)) -> Place,
    map: &mut Map,
) -> Drawn {
    let stroke = |stretch| Stroke { stage, stretch };
    let places: Vec<Place> = drawn.points.iter().map(|point| on_sheet(point.at)).collect();
    let ways: Vec<(Stretch, [Place; 2])> = places
        .windows(2)
        .zip(drawn.stretches())
        .filter_map(|(ends, stretch)| Some((stretch, <[Place; 2]>::try_from(ends).ok()?)))
        .collect();
    for stretch in ways.chunk_by(|before, after| before.0 == after.0) {
        let Some((kind, [first, _])) = stretch.first().copied() else { continue };
        let line = std::iter::once(first).chain(stretch.iter().map(|(_, [_, end])| *end)).collect();
        stroke(kind).line(sheet, line)?;
    }
    for (_, [from, to]) in ways {
        map.add_line(from, to);
    }
    let end = drawn.points.last().map(|point| if point.bifurcation { Stretch::Bifurcation } else { Stretch::Plain });
    let kinds = drawn.stretches().map(|kind| if kind == Stretch::Jump { Stretch::Plain } else { kind });
    let mut last: Option<Place> = None;
    for (place, kind) in places.into_iter().zip(kinds.chain(end)) {
        if last.is_none_or(|last| (place.0 - last.0).abs().max((place.1 - last.1).abs()) >= DENSE) {
            stroke(kind).dot(sheet, place)?;
            last = Some(place);
        }
    }
    Ok(())
}

/// Marks first, so that no letter covers one.
fn draw_events(sheet: &Sheet<'_>, curve: &Curve, on_sheet: &impl Fn((f64, f64)) -> Place, map: &mut Map) -> Drawn {
    for event in &curve.events {
        map.add_marker(on_sheet(event.at), MARKER * FINE);
    }
    let mut letters = Vec::new();
    for event in curve.events.iter().take(LISTED_EVENTS) {
        let place = on_sheet(event.at);
        let characters = i32::try_from(event.label.len()).unwrap_or(1);
        let middle = map.take_room(place, (HALF_WIDTH * characters, HALF_HEIGHT));
        let distance = f64::from(middle.0 - place.0).hypot(f64::from(middle.1 - place.1));
        if distance > f64::from(TIED) {
            // The line ends where the letter begins.
            let short = 1.0 - f64::from(HALF_HEIGHT + 2 * FINE) / distance;
            let along = |from: i32, to: i32| from + (f64::from(to - from) * short).round() as i32;
            leader(sheet, place, (along(place.0, middle.0), along(place.1, middle.1)))?;
        }
        letters.push((middle, event.label.as_str()));
    }
    for event in &curve.events {
        marker(sheet, event.kind, on_sheet(event.at))?;
    }
    for (middle, label) in letters {
        LETTER.write(sheet, middle, label, LONGEST)?;
    }
    Ok(())
}
