//! Mistakes in a mesh file, each with its place.

use std::fmt;

/// Bytes of a file that an error message repeats at most.
const MOST_QUOTED: usize = 40;

/// A place in a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MeshPlace {
    /// A line of a text file, from 1 on.
    Line(u64),
    /// Bytes before it in a binary file.
    Byte(u64),
    /// The file as a whole.
    File,
}

impl fmt::Display for MeshPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(formatter, "line {line}"),
            Self::Byte(byte) => write!(formatter, "byte {byte}"),
            Self::File => write!(formatter, "the file"),
        }
    }
}

/// The first mistake in a mesh file: where it is, what was expected, what was found.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {detail}")]
pub struct MeshError {
    /// Where the mistake is.
    pub place: MeshPlace,
    /// What was expected there, and what was found.
    pub detail: String,
}

impl MeshError {
    /// A mistake at a place.
    pub fn new(place: MeshPlace, detail: impl Into<String>) -> Self {
        Self { place, detail: detail.into() }
    }

    /// Something else was found than expected.
    pub fn expected(place: MeshPlace, expected: impl fmt::Display, found: impl fmt::Display) -> Self {
        Self::new(place, format!("expected {expected}, found {found}"))
    }
}

/// Bytes of the file as they appear in a message: between backquotes, printable, and cut where they are long.
pub fn quoted(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "nothing".to_owned();
    }
    let cut = bytes.get(..MOST_QUOTED);
    let shown = cut.unwrap_or(bytes).escape_ascii();
    if cut.is_some_and(|cut| cut.len() < bytes.len()) { format!("`{shown}...`") } else { format!("`{shown}`") }
}
