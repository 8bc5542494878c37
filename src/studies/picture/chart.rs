//! A chart with linear axes: title, mesh, ticks and names. [`crate::studies::picture::path`] and [`crate::studies::picture::sweep`] draw into it.

use crate::studies::picture::shapes::{self, DrawingError, FINE, INK, Lettering, Sheet};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{Cartesian2d, ChartBuilder, ChartContext, RGBColor, SVGBackend};
use plotters::style::Color;
use std::ops::Range;

/// Widths, in pixels.
pub const MARGIN: i32 = 16;
pub const CAPTION: i32 = 42;
/// Room for the texts of ticks and the names of axes.
const BELOW: i32 = 48;
const BESIDE: i32 = 70;
/// The most characters of the title and of the name of an axis.
pub const LONGEST: usize = 80;

const GRID: RGBColor = RGBColor(228, 228, 228);
pub const TITLE: Lettering = Lettering { size: 15, color: &INK, bold: true, centred: true };
const NAME: Lettering = Lettering { size: 13, color: &INK, bold: false, centred: true };
const TICK: Lettering = Lettering { size: 12, ..NAME };

pub type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// One of the two axes.
pub struct Side<'s> {
    pub name: String,
    /// The range of the values.
    pub range: Range<f64>,
    /// The text of a tick.
    pub tick: &'s dyn Fn(f64) -> String,
    /// The most texts.
    pub ticks: usize,
}

/// An empty chart in the left part of a sheet, with the given width in pixels.
pub fn chart<'a>(
    part: &Sheet<'a>,
    width: i32,
    title: Option<&str>,
    [across, along]: [Side<'_>; 2],
) -> Result<Chart<'a>, DrawingError> {
    if let Some(title) = title {
        TITLE.write(part, ((width + BESIDE) / 2 * FINE, CAPTION / 2 * FINE), title, LONGEST)?;
    }
    let mut chart = ChartBuilder::on(part)
        .margin(MARGIN * FINE)
        .margin_top(CAPTION * FINE)
        .x_label_area_size(BELOW * FINE)
        .y_label_area_size(BESIDE * FINE)
        .build_cartesian_2d(across.range, along.range)?;
    chart
        .configure_mesh()
        .x_labels(across.ticks)
        .y_labels(along.ticks)
        .max_light_lines(0)
        .bold_line_style(GRID.stroke_width(8))
        .axis_style(INK.stroke_width(10))
        .set_all_tick_mark_size(5 * FINE)
        .label_style(TICK.style())
        .axis_desc_style(NAME.style())
        .x_label_formatter(&|value| (across.tick)(*value))
        .y_label_formatter(&|value| (along.tick)(*value))
        .x_desc(shapes::legible(&across.name, LONGEST))
        .y_desc(shapes::legible(&along.name, LONGEST))
        .draw()?;
    Ok(chart)
}
