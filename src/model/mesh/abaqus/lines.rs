//! Lines of a deck: keywords with parameters, and data.

use crate::model::input::limits::MAX_NAME_BYTES;
use crate::model::mesh::data::error::{MeshError, MeshPlace, quoted};

/// The name and the parameters of a keyword at most.
const MOST_PARAMETERS: usize = 101;

/// The lines of a deck that are no comments and not blank.
#[derive(Debug, Clone)]
pub struct DeckLines<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

/// A keyword line, with the lines that continue it.
#[derive(Debug, Clone)]
pub struct Keyword {
    /// Its name in upper case with single blanks, without the star.
    pub name: String,
    /// Parameters: names in upper case, values as they are.
    parameters: Vec<(String, Option<String>)>,
    /// Its line.
    pub place: MeshPlace,
}

/// A data line.
#[derive(Debug, Clone, Copy)]
pub struct DataLine<'a> {
    text: &'a [u8],
    /// Its line.
    pub place: MeshPlace,
}

impl<'a> DeckLines<'a> {
    /// A deck from its first line on.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 0 }
    }

    /// The line that comes next, without moving on: where it ends, its number, its text.
    fn peek(&self) -> Option<(usize, u64, &'a [u8])> {
        let (mut at, mut line) = (self.at, self.line);
        loop {
            let rest = self.bytes.get(at..).filter(|rest| !rest.is_empty())?;
            let length = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
            let text = rest.get(..length).unwrap_or_default().trim_ascii();
            at += length;
            line += 1;
            if !text.is_empty() && !text.starts_with(b"**") {
                return Some((at, line, text));
            }
        }
    }

    /// The next line, if it is data.
    pub fn next_data(&mut self) -> Option<DataLine<'a>> {
        let (at, line, text) = self.peek()?;
        if text.starts_with(b"*") {
            return None;
        }
        (self.at, self.line) = (at, line);
        Some(DataLine { text, place: MeshPlace::Line(line) })
    }

    /// The next keyword; data lines before it are passed over.
    ///
    /// # Errors
    /// Its line is no UTF-8, or has no name.
    pub fn next_keyword(&mut self) -> Result<Option<Keyword>, MeshError> {
        while self.next_data().is_some() {}
        let Some((at, line, text)) = self.peek() else { return Ok(None) };
        (self.at, self.line) = (at, line);
        let mut whole = text.to_vec();
        // A comma at its end continues a keyword line.
        while whole.ends_with(b",") {
            let Some(more) = self.next_data() else { break };
            whole.extend_from_slice(more.text);
        }
        Keyword::parse(&whole, MeshPlace::Line(line)).map(Some)
    }
}

impl Keyword {
    fn parse(text: &[u8], place: MeshPlace) -> Result<Self, MeshError> {
        let utf8 = std::str::from_utf8(text);
        let text = utf8.map_err(|_| MeshError::expected(place, "a keyword line in UTF-8", quoted(text)))?;
        let parts = unquoted_commas(text.trim_start_matches('*'));
        if parts.len() > MOST_PARAMETERS {
            let expected = format!("at most {} parameters", MOST_PARAMETERS - 1);
            return Err(MeshError::expected(place, expected, "more"));
        }
        let mut parts = parts.into_iter();
        let name = parts.next().unwrap_or_default();
        let name = name.split_ascii_whitespace().collect::<Vec<&str>>().join(" ").to_ascii_uppercase();
        if name.is_empty() {
            return Err(MeshError::expected(place, "a keyword such as *NODE", quoted(text.as_bytes())));
        }
        let parameters = parts.filter(|part| !part.trim().is_empty()).map(|part| {
            let (name, value) = part.split_once('=').map_or((part, None), |(name, value)| (name, Some(value)));
            let value = value.map(|value| value.trim().trim_matches('"').trim().to_owned());
            (name.trim().to_ascii_uppercase(), value)
        });
        Ok(Self { name, parameters: parameters.collect(), place })
    }

    /// Whether a parameter is there, with or without a value.
    pub fn has(&self, parameter: &str) -> bool {
        self.parameters.iter().any(|(name, _)| name == parameter)
    }

    /// The value of a parameter that is there.
    pub fn value(&self, parameter: &str) -> Option<&str> {
        self.parameters.iter().find(|(name, _)| name == parameter).and_then(|(_, value)| value.as_deref())
    }

    /// The value of a parameter that has to be there.
    ///
    /// # Errors
    /// It is not there, or empty, or too long for a name.
    pub fn required(&self, parameter: &str) -> Result<&str, MeshError> {
        match self.value(parameter) {
            Some(value) if !value.is_empty() && value.len() <= MAX_NAME_BYTES => Ok(value),
            Some(value) if value.len() > MAX_NAME_BYTES => {
                let found = format!("{} bytes", value.len());
                Err(MeshError::expected(self.place, format_args!("at most 200 bytes for {parameter}"), found))
            }
            _ => {
                let expected = format!("{parameter}=... of *{}", self.name);
                Err(MeshError::expected(self.place, expected, "nothing"))
            }
        }
    }
}

/// The parts of a text between commas that are not in quotes, one more than may be at most.
fn unquoted_commas(text: &str) -> Vec<&str> {
    let mut is_quoted = false;
    let split = |letter: char| {
        is_quoted ^= letter == '"';
        letter == ',' && !is_quoted
    };
    text.split(split).take(MOST_PARAMETERS + 1).collect()
}

impl<'a> DataLine<'a> {
    /// The fields between commas, without blanks about them. A comma at the end adds none.
    pub fn fields(self) -> impl Iterator<Item = &'a [u8]> {
        let text = self.text.strip_suffix(b",").unwrap_or(self.text);
        text.split(|byte| *byte == b',').map(<[u8]>::trim_ascii)
    }

    /// Whether a comma at its end says that the next line continues it.
    pub fn is_continued(self) -> bool {
        self.text.ends_with(b",")
    }

    /// A label, a whole number of at least zero.
    ///
    /// # Errors
    /// The field is something else.
    pub fn label(self, field: &[u8], what: &str) -> Result<u64, MeshError> {
        label(field).ok_or_else(|| MeshError::expected(self.place, what, quoted(field)))
    }

    /// A finite number; zero for an empty field, as in Abaqus.
    ///
    /// # Errors
    /// The field is something else.
    pub fn real(self, field: &[u8], what: &str) -> Result<f64, MeshError> {
        if field.is_empty() {
            return Ok(0.0);
        }
        let number = std::str::from_utf8(field).ok().and_then(|text| {
            // Fortran writes exponents with a D.
            text.parse::<f64>().ok().or_else(|| text.replace(['d', 'D'], "e").parse().ok())
        });
        let finite = number.filter(|number| number.is_finite());
        finite.ok_or_else(|| MeshError::expected(self.place, format_args!("{what}, a finite number"), quoted(field)))
    }

    /// A name in UTF-8.
    ///
    /// # Errors
    /// The field is something else.
    pub fn name(self, field: &'a [u8]) -> Result<&'a str, MeshError> {
        let name = std::str::from_utf8(field).ok().map(|name| name.trim_matches('"').trim());
        let name = name.filter(|name| !name.is_empty() && name.len() <= MAX_NAME_BYTES);
        name.ok_or_else(|| MeshError::expected(self.place, "a name of at most 200 bytes", quoted(field)))
    }
}

/// A whole number of at least zero, in digits.
pub fn label(field: &[u8]) -> Option<u64> {
    if field.is_empty() {
        return None;
    }
    field.iter().try_fold(0_u64, |number, byte| {
        let digit = byte.is_ascii_digit().then(|| u64::from(byte - b'0'))?;
        number.checked_mul(10)?.checked_add(digit)
    })
}
