//! Writes a row of CSV (RFC 4180), cell by cell.

/// The characters with which formulas begin. Spreadsheets may skip white space before them.
const FORMULAS: [char; 4] = ['=', '+', '-', '@'];

/// A row that is being written.
#[derive(Default)]
pub struct CsvRow(String);

impl CsvRow {
    /// A cell that needs no quotes.
    pub fn raw(&mut self, cell: &str) {
        self.0.push_str(cell);
        self.0.push(',');
    }

    /// A text, in quotes if necessary. A text that a spreadsheet would take for a formula is preceded by an apostrophe; numbers are
    /// written by [`number`](Self::number), without one.
    pub fn text(&mut self, cell: &str) {
        let apostrophe = if cell.trim_start().starts_with(FORMULAS) { "'" } else { "" };
        if cell.contains(['"', ',', '\n', '\r']) {
            self.raw(&format!("\"{apostrophe}{}\"", cell.replace('"', "\"\"")));
        } else {
            self.raw(&format!("{apostrophe}{cell}"));
        }
    }

    /// The shortest text from which the same number is read, with an exponent if that is shorter.
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

    /// The given number of cells, empty for missing numbers.
    pub fn numbers(&mut self, values: &[f64], cells: usize) {
        for place in 0..cells {
            self.optional(values.get(place).copied());
        }
    }

    /// The line with its line feed.
    pub fn end(mut self) -> String {
        self.0.pop();
        self.0.push('\n');
        self.0
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
