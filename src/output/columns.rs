//! Text in aligned columns, and the names of values in the JSON interface.

use std::fmt::Write;

/// Aligns cells in columns, the first and the last to the left, the others to the right. All rows have the length of the first.
pub fn push_columns(text: &mut String, rows: &[Vec<String>]) {
    let columns = rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> = (0..columns)
        .map(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default())
        .collect();
    for row in rows {
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            if column > 0 {
                text.push_str("  ");
            }
            // Writing to a string does not fail.
            let _ = match column {
                0 => write!(text, "{cell:<width$}"),
                _ if column + 1 == columns => write!(text, "{cell}"),
                _ => write!(text, "{cell:>width$}"),
            };
        }
        text.push('\n');
    }
}

/// The name of a value without fields, as written in JSON.
///
/// # Errors
/// The value has another form.
pub fn name_of(value: &impl serde::Serialize) -> serde_json::Result<String> {
    serde_json::from_value(serde_json::to_value(value)?)
}
