//! The picture of a study: error against time on logarithmic scales, one line per method. As long as there are rows without a
//! time, the varied setting replaces the time.

use crate::model::request::Method;
use crate::model::request::study::Parameter;
use crate::studies::error_against_time::{StudyReport, StudyRow};
use crate::studies::picture::PlotError;
use crate::studies::picture::labels::Map;
use crate::studies::picture::shapes::{self, Drawn, FAINT_INK, FINE, INK, Lettering, PAPER, Place, Sheet};
use plotters::element::DashedPathElement;
use plotters::prelude::{Circle, PathElement, Polygon, RGBColor, Rectangle};
use plotters::style::Color;

/// Widths and heights, in pixels.
const WIDTH: i32 = 820;
const HEIGHT: i32 = 520;
const CAPTION: i32 = 72;
const LEFT: i32 = 84;
const BELOW: i32 = 58;
const LEGEND: i32 = 190;
const MARGIN: i32 = 16;
const MARKER: i32 = 5;
const ROW: i32 = 22;

/// Smaller errors, including zero, are drawn at this value.
const LEAST: f64 = 1e-17;
/// The most texts of an axis; decades are skipped or subdivided accordingly.
const MOST_TICKS: i32 = 12;
/// The most characters of a title.
const LONGEST: usize = 90;

const GRID: RGBColor = RGBColor(228, 228, 228);
const UNRESOLVED: RGBColor = RGBColor(244, 244, 238);
const TITLE: Lettering = Lettering { size: 15, color: &INK, bold: true, centred: true };
const NAME: Lettering = Lettering { size: 13, color: &INK, bold: false, centred: true };
const TICK: Lettering = Lettering { size: 12, ..NAME };
const FAINT: Lettering = Lettering { size: 11, color: &FAINT_INK, bold: false, centred: true };
const PLAIN: Lettering = Lettering { size: 12, color: &INK, bold: false, centred: false };

/// The abscissa of the errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Against {
    Time,
    Setting(Parameter),
}

impl Against {
    /// Time, if all rows with an error have one.
    fn of(report: &StudyReport) -> Self {
        let timed = report.rows.iter().filter(|row| row.path_error.is_some()).all(|row| row.time.is_some());
        if timed { Self::Time } else { Self::Setting(report.parameter) }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Time => "solver time of the whole path (s)",
            Self::Setting(Parameter::ArcLength) => "mean arc length of the increments (not all paths are timed)",
            Self::Setting(Parameter::Tolerance) => "tolerance (not all paths are timed)",
            Self::Setting(Parameter::Penalty) => "penalty (not all paths are timed)",
        }
    }
}

/// A path with an error and an abscissa.
struct Dot {
    error: f64,
    /// Of times, the median.
    across: f64,
    /// Least and largest time.
    spread: Option<(f64, f64)>,
    label: String,
}

impl Dot {
    fn of(row: &StudyRow, against: Against) -> Option<Self> {
        let (across, spread) = match against {
            Against::Time => row.time.map(|time| (time.median_s, Some((time.least_s, time.largest_s))))?,
            Against::Setting(parameter) => (row.setting(parameter == Parameter::ArcLength), None),
        };
        // A time of zero has no logarithm, nor has the step of a path without increments.
        let drawn = spread.map_or(across, |(least, _)| least) > 0.0;
        let error = row.path_error?.max(LEAST);
        drawn.then(|| Self { error, across, spread, label: format!("{}", row.value) })
    }

    /// All values on the axis.
    fn extent(&self) -> [f64; 2] {
        self.spread.map_or([self.across; 2], |(least, largest)| [least, largest])
    }
}

/// The picture as SVG text; times differ from run to run, and so does the picture.
pub fn svg(report: &StudyReport) -> Result<String, PlotError> {
    let against = Against::of(report);
    let lines: Vec<(Method, Vec<Dot>)> = report
        .by_method()
        .map(|(order, rows)| (order.method, rows.into_iter().filter_map(|row| Dot::of(row, against)).collect()))
        .filter(|(_, dots): &(Method, Vec<Dot>)| !dots.is_empty())
        .collect();
    let dots = || lines.iter().flat_map(|(_, dots)| dots);
    if dots().next().is_none() {
        return Err(PlotError::NoErrors);
    }
    let right = WIDTH - LEGEND - MARGIN;
    let across = Scale::showing(dots().flat_map(Dot::extent), (LEFT, right));
    let errors = Scale::showing(dots().map(|dot| dot.error).chain([report.reference.floor]), (HEIGHT - BELOW, CAPTION));
    let drawn = shapes::svg(WIDTH, HEIGHT, |sheet| {
        frame(sheet, report, against, (&across, &errors))?;
        let mut map = Map::new((LEFT * FINE, CAPTION * FINE), (right * FINE, (HEIGHT - BELOW) * FINE));
        for (method, dots) in &lines {
            curve(sheet, *method, dots, (&across, &errors), &mut map)?;
        }
        for dot in dots() {
            map.add_marker((across.place(dot.across), errors.place(dot.error)), MARKER * FINE);
        }
        for dot in dots() {
            let half = (35 * i32::try_from(dot.label.len()).unwrap_or(1), 60);
            let middle = map.take_room((across.place(dot.across), errors.place(dot.error)), half);
            FAINT.write(sheet, middle, &dot.label, LONGEST)?;
        }
        legend(sheet, report, against, right + MARGIN)
    });
    drawn.map_err(|error| PlotError::Drawing(error.to_string()))
}

/// A logarithmic axis.
struct Scale {
    /// Powers of ten at both ends.
    decades: (f64, f64),
    /// Pixels at both ends.
    pixels: (i32, i32),
}

impl Scale {
    fn showing(values: impl Iterator<Item = f64>, pixels: (i32, i32)) -> Self {
        let logarithms = values.map(|value| value.max(f64::MIN_POSITIVE).log10());
        let (low, high) =
            logarithms.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        // Margins for marks at the ends, and a length for an axis with a single value.
        let margin = (0.06 * (high - low)).max(0.15);
        Self { decades: (low - margin, high + margin), pixels }
    }

    fn place(&self, value: f64) -> i32 {
        let part = (value.log10() - self.decades.0) / (self.decades.1 - self.decades.0);
        let (from, to) = (f64::from(self.pixels.0 * FINE), f64::from(self.pixels.1 * FINE));
        (from + part * (to - from)).round() as i32
    }

    /// Values with a text of their own.
    fn ticks(&self) -> Vec<f64> {
        let (low, high) = (self.decades.0.ceil() as i32 - 1, self.decades.1.floor() as i32);
        let parts: &[f64] = match high - low {
            0..=2 => &[1.0, 2.0, 5.0],
            3..=4 => &[1.0, 3.0],
            _ => &[1.0],
        };
        let every = (high - low) / MOST_TICKS + 1;
        let powers = (low..=high).filter(|power| power % every == 0);
        let all = powers.flat_map(|power| parts.iter().map(move |part| part * 10_f64.powi(power)));
        all.filter(|value| (self.decades.0..=self.decades.1).contains(&value.log10())).collect()
    }
}

/// Title, axes and the range of unresolved errors.
fn frame(sheet: &Sheet<'_>, report: &StudyReport, against: Against, (across, errors): (&Scale, &Scale)) -> Drawn {
    let (left, right) = (across.pixels.0 * FINE, across.pixels.1 * FINE);
    let (bottom, top) = (errors.pixels.0 * FINE, errors.pixels.1 * FINE);
    let middle = (left + right) / 2;
    TITLE.write(sheet, (middle, 18 * FINE), report.name.as_deref().unwrap_or("study"), LONGEST)?;
    FAINT.write(sheet, (middle, 38 * FINE), &format!("against: {}", report.reference.what), LONGEST + 20)?;
    let floor = errors.place(report.reference.floor);
    sheet.draw(&Rectangle::new([(left, floor), (right, bottom)], UNRESOLVED.filled()))?;
    for value in across.ticks() {
        let x = across.place(value);
        sheet.draw(&PathElement::new(vec![(x, top), (x, bottom)], GRID.stroke_width(8)))?;
        TICK.write(sheet, (x, bottom + 14 * FINE), &format!("{value:.0e}"), LONGEST)?;
    }
    for value in errors.ticks() {
        let y = errors.place(value);
        sheet.draw(&PathElement::new(vec![(left, y), (right, y)], GRID.stroke_width(8)))?;
        TICK.write(sheet, (left - 26 * FINE, y), &format!("{value:.0e}"), LONGEST)?;
    }
    let dash = FAINT_INK.stroke_width(8);
    sheet.draw(&DashedPathElement::new(vec![(left, floor), (right, floor)], 6 * FINE, 5 * FINE, dash))?;
    sheet.draw(&PathElement::new(vec![(left, top), (left, bottom), (right, bottom)], INK.stroke_width(10)))?;
    NAME.write(sheet, (middle, bottom + 38 * FINE), against.name(), LONGEST)?;
    NAME.write(sheet, (left, top - 9 * FINE), "path error", LONGEST)
}

fn look(method: Method) -> RGBColor {
    match method {
        Method::Auto => RGBColor(25, 85, 150),
        Method::Mpec => RGBColor(190, 20, 40),
        Method::Regularised => RGBColor(60, 140, 40),
    }
}

/// Every method has its own shape.
fn mark(sheet: &Sheet<'_>, method: Method, (x, y): Place) -> Drawn {
    let (size, color) = (MARKER * FINE, look(method).filled());
    match method {
        Method::Auto => sheet.draw(&Circle::new((x, y), size, color)),
        Method::Mpec => {
            let reach = size * 13 / 10;
            let corners = vec![(x - reach, y), (x, y - reach), (x + reach, y), (x, y + reach)];
            sheet.draw(&Polygon::new(corners, color))
        }
        Method::Regularised => {
            let reach = size * 9 / 10;
            sheet.draw(&Rectangle::new([(x - reach, y - reach), (x + reach, y + reach)], color))
        }
    }
}

fn curve(sheet: &Sheet<'_>, method: Method, dots: &[Dot], scales: (&Scale, &Scale), map: &mut Map) -> Drawn {
    let (across, errors) = scales;
    let places: Vec<Place> = dots.iter().map(|dot| (across.place(dot.across), errors.place(dot.error))).collect();
    places.windows(2).for_each(|ends| map.add_line(ends[0], ends[1]));
    sheet.draw(&PathElement::new(places.clone(), look(method).stroke_width(16)))?;
    for (dot, place) in dots.iter().zip(places) {
        if let Some((least, largest)) = dot.spread {
            let (least, largest) = (across.place(least), across.place(largest));
            map.add_line((least, place.1), (largest, place.1));
            sheet.draw(&PathElement::new(vec![(least, place.1), (largest, place.1)], look(method).stroke_width(8)))?;
            for end in [least, largest] {
                let tip = 3 * FINE;
                sheet.draw(&PathElement::new(
                    vec![(end, place.1 - tip), (end, place.1 + tip)],
                    look(method).stroke_width(8),
                ))?;
            }
        }
        // A rim, so that overlapping marks can be distinguished.
        sheet.draw(&Circle::new(place, MARKER * FINE * 14 / 10, PAPER.filled()))?;
        mark(sheet, method, place)?;
    }
    Ok(())
}

fn legend(sheet: &Sheet<'_>, report: &StudyReport, against: Against, left: i32) -> Drawn {
    let mut top = CAPTION;
    let mut write = |words: &str, lettering: Lettering, indent: i32| {
        let place = ((left + indent) * FINE, (top + ROW / 2) * FINE);
        top += ROW;
        lettering.write(sheet, place, words, LONGEST).map(|()| place)
    };
    for order in &report.orders {
        let place = write(order.method.name(), PLAIN, 30)?;
        let sample = vec![(place.0 - 28 * FINE, place.1), (place.0 - 6 * FINE, place.1)];
        sheet.draw(&PathElement::new(sample, look(order.method).stroke_width(16)))?;
        mark(sheet, order.method, (place.0 - 17 * FINE, place.1))?;
        let words = match order.order {
            // A value that rounds to zero has no sign.
            Some(slope) => format!("order {:.1}", (10.0 * slope).round() / 10.0 + 0.0),
            None => "no order to be read".to_owned(),
        };
        write(&words, Lettering { centred: false, ..FAINT }, 30)?;
    }
    let faint = Lettering { centred: false, ..FAINT };
    write("", faint, 0)?;
    write(&format!("numbers: {}", report.parameter.name()), faint, 0)?;
    if against == Against::Time {
        write("bars: least and largest time", faint, 0)?;
    }
    write(&format!("shaded: up to {:.1e},", report.reference.floor), faint, 0)?;
    write("not resolved", faint, 0)?;
    Ok(())
}
