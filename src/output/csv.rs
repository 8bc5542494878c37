//! One row of CSV (RFC 4180), cell by cell.

/// A row being written.
#[derive(Default)]
pub struct CsvRow(String);

impl CsvRow {
    /// A cell that needs no quotes.
    pub fn raw(&mut self, cell: &str) {
        self.0.push_str(cell);
        self.0.push(',');
    }

    /// A cell in quotes where it needs them.
    pub fn text(&mut self, cell: &str) {
        if cell.contains(['"', ',', '\n', '\r']) {
            self.raw(&format!("\"{}\"", cell.replace('"', "\"\"")));
        } else {
            self.raw(cell);
        }
    }

    /// The shortest text that reads back to the same bits, with an exponent where that is shorter.
    pub fn number(&mut self, value: f64) {
        self.raw(&format!("{value:?}"));
    }

    /// A number, or an empty cell.
    pub fn optional(&mut self, value: Option<f64>) {
        match value {
            Some(value) => self.number(value),
            None => self.raw(""),
        }
    }

    /// So many cells, empty where there is no number.
    pub fn numbers(&mut self, values: &[f64], cells: usize) {
        for place in 0..cells {
            self.optional(values.get(place).copied());
        }
    }

    /// The line, its line feed included.
    pub fn end(mut self) -> String {
        self.0.pop();
        self.0.push('\n');
        self.0
    }
}
