//! The findings of a sweep as text: CSV, and aligned columns.

use crate::model::InputError;
use crate::output::columns::{name_of, push_columns};
use crate::output::csv::{Cells, CsvRow};
use crate::studies::sweeps::{Found, Row};
use serde_json::Value;
use std::fmt::Write;

const COLUMNS: [&str; 9] = [
    "status",
    "stop_reason",
    "last_index",
    "limit_load",
    "limit_kind",
    "limit_stage",
    "limit_increment",
    "limit_arc_length",
    "error",
];

/// Whether the table has a column of this name beside the parameters and responses.
pub(super) fn is_column(name: &str) -> bool {
    ["run", "job"].contains(&name) || COLUMNS.contains(&name)
}

impl Found {
    /// One line per run: its number, its job at a service, its values under their pointers, its findings, and its responses under
    /// their names. A null value is an empty cell.
    ///
    /// # Errors
    /// None in practice: a name that cannot be written is a defect.
    pub fn csv(&self) -> serde_json::Result<String> {
        let mut header = CsvRow::default();
        ["run", "job"].iter().for_each(|name| header.raw(name));
        self.variation.parameters.iter().for_each(|parameter| header.text(&parameter.pointer));
        COLUMNS.iter().for_each(|name| header.raw(name));
        self.variation.responses.keys().for_each(|name| header.text(name));
        let mut text = header.end();
        for row in &self.rows {
            text.push_str(&csv_row(row, self.variation.responses.keys())?);
        }
        Ok(text)
    }

    /// Aligned columns.
    ///
    /// # Errors
    /// As for [`csv`](Self::csv).
    pub fn text(&self) -> serde_json::Result<String> {
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = writeln!(text, "{}\n", self.name.as_deref().unwrap_or("sweep"));
        let mut header = vec!["run".to_owned()];
        header.extend(self.variation.parameters.iter().map(|one| InputError::new(one.pointer.as_str(), "").place()));
        header.extend(["limit load", "kind", "at increment"].map(str::to_owned));
        header.extend(self.variation.responses.keys().map(|name| self.variation.headed(name)));
        header.push("end".to_owned());
        let mut cells = vec![header];
        for row in &self.rows {
            cells.push(text_row(row, self.variation.responses.keys())?);
        }
        push_columns(&mut text, &cells);
        Ok(text)
    }
}

/// The responses of a row in the order of their names, null where there is none.
fn responses<'a>(row: &'a Row, names: impl Iterator<Item = &'a String>) -> impl Iterator<Item = &'a Value> {
    names.map(|name| row.responses.as_ref().and_then(|found| found.get(name)).unwrap_or(&Value::Null))
}

fn csv_row<'a>(row: &'a Row, names: impl Iterator<Item = &'a String>) -> serde_json::Result<String> {
    let mut line = CsvRow::default();
    line.raw(&row.run.to_string());
    line.raw(row.job.as_deref().unwrap_or_default());
    for value in &row.values {
        match value {
            Value::Number(number) => line.raw(&number.to_string()),
            other => line.text(&shown(other)),
        }
    }
    line.raw(&row.status);
    line.raw(row.stop_reason.as_deref().unwrap_or_default());
    line.raw(&row.last_index.map(|index| index.to_string()).unwrap_or_default());
    match &row.first_limit {
        Some(limit) => {
            line.number(limit.load_factor);
            line.raw(&name_of(&limit.kind)?);
            line.text(&limit.stage);
            line.raw(&limit.increment.to_string());
            line.number(limit.arc_length);
        }
        None => (0..5).for_each(|_| line.raw("")),
    }
    line.text(row.error.as_deref().unwrap_or_default());
    for value in responses(row, names) {
        match value {
            Value::Null => line.nothing(),
            Value::Number(number) => line.raw(&number.to_string()),
            other => line.text(&shown(other)),
        }
    }
    Ok(line.end())
}

fn text_row<'a>(row: &'a Row, names: impl Iterator<Item = &'a String>) -> serde_json::Result<Vec<String>> {
    let mut cells = vec![row.run.to_string()];
    cells.extend(row.values.iter().map(shown));
    match &row.first_limit {
        Some(limit) => {
            cells.extend([format!("{:.9e}", limit.load_factor), name_of(&limit.kind)?, limit.increment.to_string()])
        }
        None => cells.extend(["-", "-", "-"].map(str::to_owned)),
    }
    cells.extend(responses(row, names).map(|value| match value {
        Value::Null => "-".to_owned(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), |number| format!("{number:.9e}")),
        other => shown(other),
    }));
    cells.push(row.stop_reason.clone().unwrap_or_else(|| row.status.clone()));
    Ok(cells)
}

/// A text without quotes; any other value as JSON.
pub fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
