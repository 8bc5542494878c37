//! The picture of a sweep: its first response, or the first limit load where it asks for none, against the first parameter, one
//! line for each set of values of the others.

use crate::model::InputError;
use crate::studies::picture::PlotError;
use crate::studies::picture::axis::Axis;
use crate::studies::picture::chart::{self, CAPTION, MARGIN, Side};
use crate::studies::picture::shapes::{self, Drawn, FAINT_INK, FINE, INK, Lettering, PAPER, Place, Sheet};
use crate::studies::sweeps::{Found, Row, shown};
use plotters::prelude::{Circle, PathElement, RGBColor};
use plotters::style::Color;
use serde_json::Value;
use std::ops::Range;

/// Widths and heights, in pixels.
const CHART: i32 = 600;
const LEGEND: i32 = 260;
const HEIGHT: i32 = 480;
const DOT: i32 = 4;
const ROW: i32 = 20;
const TICKS: usize = 9;
/// The most lines in the legend; further ones are drawn and counted.
const NAMED: usize = 18;
/// The most characters of the name of a line.
const LONGEST_NAME: usize = 34;
const LONGEST_TICK: usize = 12;
/// Positive values whose ratio exceeds this have a logarithmic axis.
const FAR_APART: f64 = 100.0;

/// Colours of the first and of the last line.
const FIRST: RGBColor = RGBColor(25, 85, 150);
const LAST: RGBColor = RGBColor(190, 20, 40);
const PLAIN: Lettering = Lettering { size: 12, color: &INK, bold: false, centred: false };
const FAINT: Lettering = Lettering { size: 11, color: &FAINT_INK, bold: false, centred: false };

/// The axis of the first parameter.
enum Across {
    Linear(Axis),
    /// Powers of ten at both ends.
    Logarithmic(Range<f64>),
    /// Values that are no numbers, side by side.
    Named(Vec<String>),
}

impl Across {
    fn of(values: &[Value]) -> Self {
        let Some(numbers) = values.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>() else {
            let mut names: Vec<String> = Vec::new();
            for name in values.iter().map(shown) {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
            return Self::Named(names);
        };
        let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if least > 0.0 && largest / least >= FAR_APART {
            let margin = 0.06 * (largest / least).log10();
            return Self::Logarithmic(least.log10() - margin..largest.log10() + margin);
        }
        Self::Linear(Axis::spanning(numbers.into_iter(), TICKS))
    }

    fn range(&self) -> Range<f64> {
        match self {
            Self::Linear(axis) => axis.range.clone(),
            Self::Logarithmic(decades) => decades.clone(),
            Self::Named(names) => -0.5..names.len() as f64 - 0.5,
        }
    }

    /// The position of a value.
    fn place(&self, value: &Value) -> Option<f64> {
        match self {
            Self::Linear(axis) => value.as_f64().map(|value| axis.drawn(value)),
            Self::Logarithmic(_) => value.as_f64().map(f64::log10),
            Self::Named(names) => {
                let name = shown(value);
                names.iter().position(|known| *known == name).map(|place| place as f64)
            }
        }
    }

    fn tick(&self, at: f64) -> String {
        let whole = (at - at.round()).abs() < 1e-9;
        match self {
            Self::Linear(axis) => axis.tick(at),
            Self::Logarithmic(_) if whole => format!("1e{at:.0}"),
            Self::Named(names) if whole && at >= 0.0 => {
                names.get(at.round() as usize).map(|name| shapes::legible(name, LONGEST_TICK)).unwrap_or_default()
            }
            Self::Logarithmic(_) | Self::Named(_) => String::new(),
        }
    }

    fn named(&self, name: &str) -> String {
        match self {
            Self::Linear(axis) => axis.named(name),
            Self::Logarithmic(_) | Self::Named(_) => name.to_owned(),
        }
    }
}

/// Runs that only differ in the first parameter.
struct Line<'a> {
    /// Values of the other parameters.
    others: &'a [Value],
    rows: Vec<&'a Row>,
}

fn lines(found: &Found) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    for row in &found.rows {
        let others = row.values.get(1..).unwrap_or_default();
        match lines.iter_mut().find(|line| line.others == others) {
            Some(line) => line.rows.push(row),
            None => lines.push(Line { others, rows: vec![row] }),
        }
    }
    for line in &mut lines {
        let first = |row: &&Row| row.values.first().and_then(Value::as_f64);
        // Values between those of the request come after them where a sweep is refined. Words keep their order.
        if line.rows.iter().all(|row| first(row).is_some()) {
            line.rows.sort_by(|one, other| first(one).partial_cmp(&first(other)).unwrap_or(std::cmp::Ordering::Equal));
        }
    }
    lines
}

/// The picture as SVG text: the same for the same rows.
///
/// # Errors
/// No run has a number to draw.
pub fn svg(found: &Found) -> Result<String, PlotError> {
    let numbers = || found.rows.iter().filter_map(|row| up(found, row));
    let Some(first) = found.variation.parameters.first().filter(|_| numbers().next().is_some()) else {
        return Err(PlotError::NothingFound { sought: upwards(found) });
    };
    let (across, load) = (Across::of(&first.values), Axis::spanning(numbers(), TICKS));
    let lines = lines(found);
    let drawn = shapes::svg(CHART + LEGEND, HEIGHT, |sheet| {
        draw_chart(sheet, found, &lines, (&across, &load))?;
        legend(sheet, found, &lines)
    });
    drawn.map_err(|error| PlotError::Drawing(error.to_string()))
}

/// The name of what is drawn upwards.
fn upwards(found: &Found) -> String {
    let first = found.variation.responses.keys().next();
    first.map_or_else(|| "first limit load factor".to_owned(), |name| found.variation.headed(name))
}

/// What is drawn upwards of a run, if it has that.
fn up(found: &Found, row: &Row) -> Option<f64> {
    match found.variation.responses.keys().next() {
        Some(name) => row.responses.as_ref()?.get(name)?.as_f64(),
        None => row.first_limit.as_ref().map(|limit| limit.load_factor),
    }
}

fn draw_chart(sheet: &Sheet<'_>, found: &Found, lines: &[Line<'_>], (across, load): (&Across, &Axis)) -> Drawn {
    let (part, _) = sheet.split_horizontally(CHART * FINE);
    let first = found.variation.parameters.first().map(|parameter| place(&parameter.pointer)).unwrap_or_default();
    let sides = [
        Side { name: across.named(&first), range: across.range(), tick: &|at| across.tick(at), ticks: TICKS },
        Side { name: load.named(&upwards(found)), range: load.range.clone(), tick: &|at| load.tick(at), ticks: TICKS },
    ];
    let chart = chart::chart(&part, CHART, Some(found.name.as_deref().unwrap_or("sweep")), sides)?;
    for (number, line) in lines.iter().enumerate() {
        let color = color(number, lines.len());
        let places: Vec<Option<Place>> = line
            .rows
            .iter()
            .map(|row| {
                let number = up(found, row)?;
                let at = across.place(row.values.first()?)?;
                Some(chart.backend_coord(&(at, load.drawn(number))))
            })
            .collect();
        // A run without a number interrupts the line.
        if !matches!(across, Across::Named(_)) {
            for stretch in places.split(Option::is_none) {
                sheet.draw(&PathElement::new(
                    stretch.iter().flatten().copied().collect::<Vec<_>>(),
                    color.stroke_width(14),
                ))?;
            }
        }
        for place in places.into_iter().flatten() {
            sheet.draw(&Circle::new(place, DOT * FINE * 14 / 10, PAPER.filled()))?;
            sheet.draw(&Circle::new(place, DOT * FINE, color.filled()))?;
        }
    }
    Ok(())
}

fn legend(sheet: &Sheet<'_>, found: &Found, lines: &[Line<'_>]) -> Drawn {
    let left = CHART + MARGIN / 2;
    let mut top = CAPTION;
    let mut write = |words: &str, lettering: Lettering, indent: i32| {
        let at = ((left + indent) * FINE, (top + ROW / 2) * FINE);
        top += ROW;
        lettering.write(sheet, at, words, LONGEST_NAME).map(|()| at)
    };
    let others = found.variation.parameters.get(1..).unwrap_or_default();
    if !others.is_empty() {
        for parameter in others {
            write(&place(&parameter.pointer), FAINT, 0)?;
        }
        for (number, line) in lines.iter().enumerate().take(NAMED) {
            let values: Vec<String> = line.others.iter().map(shown).collect();
            let at = write(&values.join(", "), PLAIN, 30)?;
            let sample = vec![(at.0 - 28 * FINE, at.1), (at.0 - 6 * FINE, at.1)];
            sheet.draw(&PathElement::new(sample, color(number, lines.len()).stroke_width(14)))?;
        }
        if let Some(more @ 1..) = lines.len().checked_sub(NAMED) {
            write(&format!("and {more} more"), FAINT, 30)?;
        }
        write("", FAINT, 0)?;
    }
    let without = found.rows.iter().filter(|row| up(found, row).is_none()).count();
    if without > 0 {
        let lacking = if found.variation.responses.is_empty() { "a limit point" } else { "this response" };
        write(&format!("{without} of {} runs without {lacking}", found.rows.len()), FAINT, 0)?;
    }
    Ok(())
}

/// From the first line's colour to the last one's.
fn color(number: usize, of: usize) -> RGBColor {
    let part = number as f64 / (of.max(2) - 1) as f64;
    let mix = |from: u8, to: u8| (f64::from(from) + part * (f64::from(to) - f64::from(from))).round() as u8;
    RGBColor(mix(FIRST.0, LAST.0), mix(FIRST.1, LAST.1), mix(FIRST.2, LAST.2))
}

/// A pointer as a reader would write it, without the root.
fn place(pointer: &str) -> String {
    let place = InputError::new(pointer, "").place();
    place.strip_prefix("model.").map_or(place.clone(), str::to_owned)
}
