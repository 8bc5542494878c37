//! Writes a row of a table, cell by cell: as CSV (RFC 4180), or as the values of some of its columns.

use serde_json::Value;

/// The characters with which formulas begin. Spreadsheets may skip white space before them.
const FORMULAS: [char; 4] = ['=', '+', '-', '@'];

/// Receives the cells of a row in the order of its columns.
pub trait Cells {
    /// A text of a user.
    fn text(&mut self, cell: &str);

    /// A name of the interface, or nothing.
    fn word(&mut self, cell: &str);

    fn count(&mut self, value: u64);

    fn number(&mut self, value: f64);

    fn nothing(&mut self);

    fn flag(&mut self, is_set: bool) {
        self.word(if is_set { "true" } else { "false" });
    }

    /// A number, or nothing.
    fn optional(&mut self, value: Option<f64>) {
        match value {
            Some(value) => self.number(value),
            None => self.nothing(),
        }
    }

    /// The given number of cells, empty for missing numbers.
    fn numbers(&mut self, values: &[f64], cells: usize) {
        for place in 0..cells {
            self.optional(values.get(place).copied());
        }
    }
}

/// A row that is being written.
#[derive(Default)]
pub struct CsvRow(String);

impl CsvRow {
    /// A cell that needs no quotes.
    pub fn raw(&mut self, cell: &str) {
        self.0.push_str(cell);
        self.0.push(',');
    }

    /// The line with its line feed.
    pub fn end(mut self) -> String {
        self.0.pop();
        self.0.push('\n');
        self.0
    }
}

impl Cells for CsvRow {
    /// In quotes if necessary. A text that a spreadsheet would take for a formula is preceded by an apostrophe; numbers are
    /// written by [`number`](Self::number), without one.
    fn text(&mut self, cell: &str) {
        let apostrophe = if cell.trim_start().starts_with(FORMULAS) { "'" } else { "" };
        if cell.contains(['"', ',', '\n', '\r']) {
            self.raw(&format!("\"{apostrophe}{}\"", cell.replace('"', "\"\"")));
        } else {
            self.raw(&format!("{apostrophe}{cell}"));
        }
    }

    fn word(&mut self, cell: &str) {
        self.raw(cell);
    }

    fn count(&mut self, value: u64) {
        self.raw(&value.to_string());
    }

    /// The shortest text from which the same number is read, with an exponent if that is shorter.
    fn number(&mut self, value: f64) {
        self.raw(&format!("{value:?}"));
    }

    fn nothing(&mut self) {
        self.raw("");
    }
}

/// The values of some columns of a row.
pub struct ChosenCells<'a> {
    /// The columns, ascending.
    columns: &'a [usize],
    /// The column of the next cell.
    column: usize,
    values: Vec<Value>,
}

impl<'a> ChosenCells<'a> {
    pub fn of(columns: &'a [usize]) -> Self {
        Self { columns, column: 0, values: Vec::with_capacity(columns.len()) }
    }

    /// In the order of the columns, null where a cell is empty.
    pub fn values(self) -> Vec<Value> {
        self.values
    }

    fn cell(&mut self, value: impl FnOnce() -> Value) {
        if self.columns.get(self.values.len()) == Some(&self.column) {
            self.values.push(value());
        }
        self.column += 1;
    }
}

impl Cells for ChosenCells<'_> {
    fn text(&mut self, cell: &str) {
        self.cell(|| Value::from(cell));
    }

    fn word(&mut self, cell: &str) {
        self.cell(|| if cell.is_empty() { Value::Null } else { Value::from(cell) });
    }

    fn count(&mut self, value: u64) {
        self.cell(|| Value::from(value));
    }

    fn number(&mut self, value: f64) {
        self.cell(|| Value::from(value));
    }

    fn nothing(&mut self) {
        self.cell(|| Value::Null);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_no_formula_and_numbers_stay_numbers() {
        let mut row = CsvRow::default();
        ["=1+1", "+x", "-x", "@SUM(A1)", "=\"a\",b", "\t=1", "a=b", "x-", ""].iter().for_each(|cell| row.text(cell));
        row.number(-0.5);
        assert_eq!(row.end(), "'=1+1,'+x,'-x,'@SUM(A1),\"'=\"\"a\"\",b\",'\t=1,a=b,x-,,-0.5\n");
    }
}
