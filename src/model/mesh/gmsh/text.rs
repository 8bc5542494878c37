//! Numbers and words of text.

use crate::model::mesh::data::error::{MeshError, MeshPlace, quoted};

/// A text that is read word by word, with the number of its line.
#[derive(Debug, Clone)]
pub struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

impl<'a> Words<'a> {
    /// A text from its first line on.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 1 }
    }

    /// Bytes before the next one to be read.
    pub fn at(&self) -> usize {
        self.at
    }

    /// The line of the next byte to be read.
    pub fn line(&self) -> MeshPlace {
        MeshPlace::Line(self.line)
    }

    /// What is not read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// Passes over bytes of text.
    pub fn skip(&mut self, bytes: usize) {
        let passed = self.rest().get(..bytes).unwrap_or(self.rest());
        self.line += passed.iter().filter(|byte| **byte == b'\n').count() as u64;
        self.at += passed.len();
    }

    /// Passes over bytes that are no text.
    pub fn skip_binary(&mut self, bytes: usize) {
        self.at = self.at.saturating_add(bytes).min(self.bytes.len());
    }

    fn skip_blanks(&mut self) {
        let blanks = self.rest().iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        self.skip(blanks);
    }

    /// The next word, empty at the end of the text.
    pub fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let rest = self.rest();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += end;
        rest.get(..end).unwrap_or_default()
    }

    /// The rest of the line, whose end is passed.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let end = rest.iter().position(|byte| *byte == b'\n');
        let line = rest.get(..end.unwrap_or(rest.len())).unwrap_or_default();
        self.skip(line.len() + usize::from(end.is_some()));
        line
    }

    /// A whole number of at least zero.
    pub fn natural(&mut self, what: &str) -> Result<u64, MeshError> {
        let word = self.word();
        natural(word).ok_or_else(|| MeshError::expected(self.line(), what, quoted(word)))
    }

    /// A whole number.
    pub fn integer(&mut self, what: &str) -> Result<i64, MeshError> {
        let word = self.word();
        let (sign, digits) = match word.strip_prefix(b"-") {
            Some(digits) => (-1, digits),
            None => (1, word.strip_prefix(b"+").unwrap_or(word)),
        };
        let number = natural(digits).and_then(|number| i64::try_from(number).ok());
        number.map(|number| sign * number).ok_or_else(|| MeshError::expected(self.line(), what, quoted(word)))
    }

    /// A finite number.
    pub fn real(&mut self, what: &str) -> Result<f64, MeshError> {
        let word = self.word();
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f64>().ok());
        let finite = number.filter(|number| number.is_finite());
        finite.ok_or_else(|| MeshError::expected(self.line(), format_args!("{what}, a finite number"), quoted(word)))
    }
}

/// A whole number of at least zero, in digits.
fn natural(word: &[u8]) -> Option<u64> {
    if word.is_empty() {
        return None;
    }
    word.iter().try_fold(0_u64, |number, byte| {
        let digit = byte.is_ascii_digit().then(|| u64::from(byte - b'0'))?;
        number.checked_mul(10)?.checked_add(digit)
    })
}
