//! A JSON value that keeps the order of members and duplicates, unlike `serde_json::Value`.
//!
//! The text is read by serde_json, which bounds the nesting (127 levels) and refuses numbers out of range and text
//! after the document; the number of values is bounded here.

use std::cell::Cell;
use std::fmt;

use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};

use crate::model::InputError;
use crate::model::input::limits::{MAX_TEXT_BYTES, max_values};
use crate::model::input::names::quoted;

/// A JSON value; members in the order of the text, duplicates included.
#[derive(Debug, Clone, PartialEq)]
pub enum Json {
    Null,
    Bool(bool),
    Number(Number),
    Text(String),
    Array(Vec<Json>),
    Object(Vec<(String, Json)>),
}

/// A number as it was written: whole numbers keep all their digits up to 64 bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    Unsigned(u64),
    Negative(i64),
    Real(f64),
}

impl Json {
    /// Parses a document; `what` names the expected content in the message about an empty one.
    ///
    /// # Errors
    /// Text that is too long, not UTF-8, not JSON, nested too deeply, with a number out of range, with more than
    /// [`max_values`] values or with anything after the document; line and column are in the detail.
    pub fn parse(text: &[u8], what: &str) -> Result<Self, InputError> {
        let whole = |detail: String| Err(InputError::new("", detail));
        if text.len() > MAX_TEXT_BYTES {
            return whole(format!("the document has {} bytes; at most {MAX_TEXT_BYTES} are taken", text.len()));
        }
        if let Err(error) = std::str::from_utf8(text) {
            let (line, column) = position(text, error.valid_up_to());
            return whole(format!("not UTF-8 at line {line} column {column}; JSON text in UTF-8 is expected"));
        }
        if text.iter().all(u8::is_ascii_whitespace) {
            return whole(format!("the document is empty; {what}, a JSON object, is expected"));
        }
        if text.starts_with("\u{feff}".as_bytes()) {
            return whole("the document starts with a byte order mark; plain UTF-8 without one is expected".to_owned());
        }
        let most = max_values(text.len());
        let left = Cell::new(most);
        let mut source = serde_json::Deserializer::from_slice(text);
        let parsed =
            Value { left: &left, most }.deserialize(&mut source).and_then(|value| source.end().map(|()| value));
        parsed.or_else(|error| whole(format!("not a JSON document that can be read: {}", told(text, &error))))
    }

    /// A description for messages: the type and, if short, the value.
    pub fn describe(&self) -> String {
        match self {
            Self::Null => "null".to_owned(),
            Self::Bool(value) => format!("the boolean `{value}`"),
            Self::Number(number) => format!("the number `{number}`"),
            Self::Text(text) => format!("the string {}", quoted(text)),
            Self::Array(items) => format!("an array of {}", items.len()),
            Self::Object(_) => "an object".to_owned(),
        }
    }
}

impl Number {
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Unsigned(value) => value as f64,
            Self::Negative(value) => value as f64,
            Self::Real(value) => value,
        }
    }

    /// The number if it is whole and not negative; `1e3` and `5.0` are, as JSON Schema has it.
    pub fn as_u64(self) -> Option<u64> {
        /// Up to this bound every whole number is an `f64`.
        const LAST_EXACT: f64 = 9_007_199_254_740_992.0;
        match self {
            Self::Unsigned(value) => Some(value),
            Self::Negative(_) => None,
            Self::Real(value) if value.fract() == 0.0 && (0.0..=LAST_EXACT).contains(&value) => Some(value as u64),
            Self::Real(_) => None,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsigned(value) => write!(formatter, "{value}"),
            Self::Negative(value) => write!(formatter, "{value}"),
            Self::Real(value) => write!(formatter, "{value:?}"),
        }
    }
}

/// What is wrong and where, as `serde_json` says it, but with the column in characters: it counts bytes.
fn told(text: &[u8], error: &serde_json::Error) -> String {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let Some(what) = message.strip_suffix(&format!(" at line {line} column {column}")) else { return message };
    let row = text.split(|&byte| byte == b'\n').nth(line.saturating_sub(1)).unwrap_or_default();
    let before = row.get(..column).unwrap_or(row);
    format!("{what} at line {line} column {}", String::from_utf8_lossy(before).chars().count())
}

/// Line and column (in characters), both from 1, of a byte.
fn position(text: &[u8], byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    let lines = before.iter().filter(|&&byte| byte == b'\n').count();
    let column = String::from_utf8_lossy(before.get(line_start..).unwrap_or_default()).chars().count();
    (lines + 1, column + 1)
}

/// Reads one value and counts it.
#[derive(Clone, Copy)]
struct Value<'a> {
    left: &'a Cell<usize>,
    most: usize,
}

impl<'de> DeserializeSeed<'de> for Value<'_> {
    type Value = Json;

    fn deserialize<D: de::Deserializer<'de>>(self, source: D) -> Result<Json, D::Error> {
        match self.left.get().checked_sub(1) {
            Some(left) => self.left.set(left),
            None => {
                let most = self.most;
                return Err(de::Error::custom(format!("more than {most} values, the largest number accepted")));
            }
        }
        source.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Value<'_> {
    type Value = Json;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
        Ok(Json::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Json, E> {
        Ok(Json::Number(Number::Unsigned(value)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Json, E> {
        Ok(Json::Number(u64::try_from(value).map_or(Number::Negative(value), Number::Unsigned)))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Json, E> {
        Ok(Json::Number(Number::Real(value)))
    }

    fn visit_str<E>(self, value: &str) -> Result<Json, E> {
        Ok(Json::Text(value.to_owned()))
    }

    fn visit_string<E>(self, value: String) -> Result<Json, E> {
        Ok(Json::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut source: A) -> Result<Json, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = source.next_element_seed(self)? {
            items.push(item);
        }
        Ok(Json::Array(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut source: A) -> Result<Json, A::Error> {
        let mut members = Vec::new();
        while let Some(name) = source.next_key::<String>()? {
            members.push((name, source.next_value_seed(self)?));
        }
        Ok(Json::Object(members))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &[u8]) -> String {
        Json::parse(text, "a text").unwrap_err().detail
    }

    #[test]
    fn members_keep_their_order_and_duplicates() {
        let Json::Object(members) = Json::parse(br#"{"b": 1, "a": -2, "b": 1.5}"#, "a text").unwrap() else { panic!() };
        let names: Vec<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["b", "a", "b"]);
        assert_eq!(members[1].1, Json::Number(Number::Negative(-2)));
        assert_eq!(members[2].1, Json::Number(Number::Real(1.5)));
    }

    #[test]
    fn text_that_is_not_one_json_document_is_refused_with_its_position() {
        assert!(refusal(b"{\n  \"a\" 1}").contains("line 2 column 7"));
        assert!(refusal(b"[1e999]").contains("number out of range at line 1"));
        assert!(refusal(b"[NaN]").contains("line 1 column 2"));
        assert!(refusal("{\"\u{e4}\u{1f600}\" 1}".as_bytes()).contains("line 1 column 7"));
        assert!(refusal(b"{} {}").contains("trailing characters at line 1 column 4"));
        assert!(refusal(b"[\n\"\xc3\xa4\xff\"]").contains("not UTF-8 at line 2 column 3"));
        assert!(refusal(b" \n").contains("empty"));
        assert!(refusal("\u{feff}{}".as_bytes()).contains("byte order mark"));
    }

    #[test]
    fn nesting_and_size_are_bounded() {
        let deep = [vec![b'['; 1_000_000], vec![b']'; 1_000_000]].concat();
        assert!(refusal(&deep).contains("recursion limit exceeded"));
        assert!(refusal(&vec![b' '; MAX_TEXT_BYTES + 1]).contains("at most 268435456"));
        let many = format!("[{}0]", "0,".repeat(max_values(0)));
        assert!(refusal(many.as_bytes()).contains("more than 4000000 values"));
    }

    #[test]
    fn whole_numbers_may_be_written_as_reals() {
        assert_eq!(Number::Real(1e3).as_u64(), Some(1000));
        assert_eq!(Number::Real(0.5).as_u64(), None);
        assert_eq!(Number::Real(1e300).as_u64(), None);
        assert_eq!(Number::Negative(-1).as_u64(), None);
        assert_eq!(Number::Unsigned(u64::MAX).as_u64(), Some(u64::MAX));
    }
}
