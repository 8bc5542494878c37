//! The findings of a study as text: CSV, and aligned columns.

use crate::output::columns::{name_of, push_columns};
use crate::output::csv::{Cells, CsvRow};
use crate::studies::error_against_time::report::StudyReport;
use crate::studies::error_against_time::row::StudyRow;
use std::fmt::Write;

const COLUMNS: [&str; 26] = [
    "row",
    "method",
    "parameter",
    "value",
    "mean_step",
    "path_error",
    "resolved",
    "points_outside",
    "events_expected",
    "events_found",
    "events_others",
    "event_error",
    "largest_estimate",
    "increments",
    "factorisations",
    "newton_iterations",
    "qp_solves",
    "mpec_solves",
    "stop_reason",
    "time_median_s",
    "time_least_s",
    "time_largest_s",
    "repeats",
    "order",
    "reference",
    "reference_floor",
];

/// One line a row, names first. What is null in JSON is an empty cell.
///
/// # Errors
/// None in practice: names of the contract that cannot be written are a defect.
pub fn csv(report: &StudyReport) -> serde_json::Result<String> {
    let mut header = CsvRow::default();
    COLUMNS.iter().for_each(|name| header.raw(name));
    let mut text = header.end();
    for row in &report.rows {
        text.push_str(&csv_row(report, row)?);
    }
    Ok(text)
}

fn csv_row(report: &StudyReport, row: &StudyRow) -> serde_json::Result<String> {
    let mut line = CsvRow::default();
    let count = |line: &mut CsvRow, count: u64| line.raw(&count.to_string());
    count(&mut line, row.row);
    line.raw(row.method.name());
    line.raw(report.parameter.name());
    line.number(row.value);
    line.number(row.mean_step);
    line.optional(row.path_error);
    line.raw(if row.resolved { "true" } else { "false" });
    let events = &row.events;
    for number in [row.points_outside, events.expected, events.found, events.others] {
        count(&mut line, number);
    }
    line.optional(events.largest_error);
    line.number(row.largest_estimate);
    for number in [row.increments, row.factorisations, row.newton_iterations, row.qp_solves, row.mpec_solves] {
        count(&mut line, number);
    }
    line.raw(&name_of(&row.stop_reason)?);
    line.optional(row.time.map(|time| time.median_s));
    line.optional(row.time.map(|time| time.least_s));
    line.optional(row.time.map(|time| time.largest_s));
    count(&mut line, row.time.map_or(0, |time| time.repeats));
    line.optional(row.order);
    line.raw(&name_of(&report.reference.kind)?);
    line.number(report.reference.floor);
    Ok(line.end())
}

/// Columns for a reader, the reference above and the orders below.
///
/// # Errors
/// As for [`csv`].
pub fn text(report: &StudyReport) -> serde_json::Result<String> {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(text, "{}", report.name.as_deref().unwrap_or("study"));
    let _ = writeln!(text, "errors against: {}", report.reference.what);
    if let Some(own) = report.reference.uncertainty {
        let _ = writeln!(text, "the reference's own uncertainty is {own:.1e}");
    }
    let _ = writeln!(text, "errors up to {:.1e} are not resolved and stand in brackets\n", report.reference.floor);
    let mut cells = vec![
        ["method", report.parameter.name(), "mean step", "error", "order", "events", "event error", "increments"]
            .map(str::to_owned)
            .to_vec(),
    ];
    cells[0].extend(["LU", "QP", "time ms", "least", "largest", "end"].map(str::to_owned));
    for row in &report.rows {
        cells.push(text_row(row)?);
    }
    push_columns(&mut text, &cells);
    text.push('\n');
    for order in &report.orders {
        let slope = order.order.map_or_else(|| "not resolved".to_owned(), |order| format!("{order:.2}"));
        let _ = writeln!(text, "order of {}: {slope}", order.method.name());
    }
    if !report.complete {
        text.push_str("not complete: some paths have not been traced as often as was asked for\n");
    }
    Ok(text)
}

fn text_row(row: &StudyRow) -> serde_json::Result<Vec<String>> {
    let events = &row.events;
    let others = if events.others > 0 { format!(" +{}", events.others) } else { String::new() };
    let scientific = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.1e}"));
    let error = scientific(row.path_error);
    let time = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{:.3}", 1e3 * value));
    Ok(vec![
        row.method.name().to_owned(),
        format!("{}", row.value),
        format!("{:.2e}", row.mean_step),
        if row.resolved || row.path_error.is_none() { error } else { format!("({error})") },
        row.order.map_or_else(|| "-".to_owned(), |order| format!("{order:.2}")),
        format!("{} of {}{others}", events.found, events.expected),
        scientific(events.largest_error),
        row.increments.to_string(),
        row.factorisations.to_string(),
        row.qp_solves.to_string(),
        time(row.time.map(|time| time.median_s)),
        time(row.time.map(|time| time.least_s)),
        time(row.time.map(|time| time.largest_s)),
        name_of(&row.stop_reason)?,
    ])
}
