//! The findings of a curve as text: CSV, and aligned columns.

use crate::model::InputError;
use crate::output::columns::{name_of, push_columns};
use crate::output::csv::{Cells, CsvRow};
use crate::studies::critical_curves::row::{CurveFound, CurveRow};
use std::fmt::Write;

const COLUMNS: [&str; 8] =
    ["load_factor", "kind", "stage", "codimension_two", "from_path", "off_path", "largest_error", "event"];

/// One line a point, in order along the curve: its number, the value under its pointer, the load factor, and the displacements under
/// the names of their nodes.
///
/// # Errors
/// None in practice: a name that cannot be written is a defect.
pub fn csv(found: &CurveFound) -> serde_json::Result<String> {
    let mut header = CsvRow::default();
    header.raw("index");
    header.text(&found.curve.parameter);
    COLUMNS.iter().for_each(|name| header.raw(name));
    let names = found.rows.first().map(|row| displacement_names(row, found.dimension)).unwrap_or_default();
    names.iter().for_each(|name| header.text(name));
    let mut text = header.end();
    for row in &found.rows {
        let mut line = CsvRow::default();
        line.raw(&row.index.to_string());
        line.number(row.value);
        line.number(row.load_factor);
        line.raw(&name_of(&row.kind)?);
        line.text(&row.stage);
        line.raw(&row.codimension_two.to_string());
        line.raw(&row.from_path.to_string());
        line.raw(&is_off_path(found, row).to_string());
        line.number(row.measure.largest_of_state());
        line.text(row.event.as_deref().unwrap_or_default());
        row.displacements.values().flatten().for_each(|value| line.number(*value));
        text.push_str(&line.end());
    }
    Ok(text)
}

/// Aligned columns.
///
/// # Errors
/// As for [`csv`].
pub fn text(found: &CurveFound) -> serde_json::Result<String> {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(text, "{}\n", found.name.as_deref().unwrap_or("curve of limit points"));
    let parameter = InputError::new(found.curve.parameter.as_str(), "").place();
    let mut cells = vec![["", &parameter, "load factor", "kind", "event"].map(str::to_owned).to_vec()];
    for row in &found.rows {
        let mark = if is_off_path(found, row) {
            "?"
        } else if row.codimension_two {
            "x"
        } else if row.from_path {
            "o"
        } else {
            ""
        };
        cells.push(vec![
            mark.to_owned(),
            format!("{:.9}", row.value),
            format!("{:.9e}", row.load_factor),
            name_of(&row.kind)?,
            row.event.clone().unwrap_or_default(),
        ]);
    }
    let mut columns = String::new();
    push_columns(&mut columns, &cells);
    // Most rows have no event in the last column.
    columns.lines().for_each(|line| text.extend([line.trim_end(), "\n"]));
    let Some(summary) = &found.summary else { return Ok(text) };
    let ends = [("smaller", &summary.ends_below), ("larger", &summary.ends_above)];
    let off = found.rows.iter().any(|row| summary.is_off_path(row));
    let off = if off { "; ?: on no path, as far as is known" } else { "" };
    let _ = writeln!(
        text,
        "\nx: a change of kind, or of the path; o: found on a path traced for it{off}; paths traced in all: {}",
        summary.paths
    );
    for (side, end) in ends {
        let _ = writeln!(text, "from the start towards {side} values: {}", end.as_deref().unwrap_or("cancelled"));
    }
    Ok(text)
}

/// Whether the end of the curve tells that a point of it is not known to be on a path.
fn is_off_path(found: &CurveFound, row: &CurveRow) -> bool {
    found.summary.as_ref().is_some_and(|summary| summary.is_off_path(row))
}

/// `node.x`, `node.y`, ..., of rotations `node.rz` or `node.rx`, ...
fn displacement_names(row: &CurveRow, dimension: usize) -> Vec<String> {
    let axes: &[&str] = if dimension == 2 { &["x", "y", "rz"] } else { &["x", "y", "z", "rx", "ry", "rz"] };
    let named = row.displacements.iter();
    named.flat_map(|(name, values)| axes.iter().take(values.len()).map(move |axis| format!("{name}.{axis}"))).collect()
}
