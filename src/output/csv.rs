//! One row of CSV (RFC 4180), cell by cell.

/// What formulas begin with. Spreadsheets may skip white space before one.
const FORMULAS: [char; 4] = ['=', '+', '-', '@'];

/// A row being written.
#[derive(Default)]
pub struct CsvRow(String);

impl CsvRow {
    /// A cell that needs no quotes.
    pub fn raw(&mut self, cell: &str) {
        self.0.push_str(cell);
        self.0.push(',');
    }

    /// Text, in quotes where it needs them. What a spreadsheet would take for a formula has an apostrophe before it, by which
    /// it is text there too; numbers are written by [`number`](Self::number) and have none.
    pub fn text(&mut self, cell: &str) {
        let apostrophe = if cell.trim_start().starts_with(FORMULAS) { "'" } else { "" };
        if cell.contains(['"', ',', '\n', '\r']) {
            self.raw(&format!("\"{apostrophe}{}\"", cell.replace('"', "\"\"")));
        } else {
            self.raw(&format!("{apostrophe}{cell}"));
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
