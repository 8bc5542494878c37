//! Mistakes in the input, each with its place.

#![warn(missing_docs)]

use serde::Serialize;
use std::fmt;

/// One mistake: where it is, what was found, what would do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct InputError {
    /// JSON pointer (RFC 6901) to the offending value, for example `/model/elements/3/nodes/1`; empty for the document.
    pub pointer: String,
    /// What was found there and what would do.
    pub detail: String,
}

impl InputError {
    /// A mistake at a place.
    pub fn new(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), detail: detail.into() }
    }

    /// The place as a reader would write it: `model.elements[3].nodes[1]`.
    pub fn place(&self) -> String {
        let mut place = String::new();
        for part in self.pointer.split('/').skip(1) {
            let part = part.replace("~1", "/").replace("~0", "~");
            if !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit()) {
                place.push_str(&format!("[{part}]"));
            } else {
                if !place.is_empty() {
                    place.push('.');
                }
                place.push_str(&part);
            }
        }
        if place.is_empty() { "document".to_owned() } else { place }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.place(), self.detail)
    }
}

/// Everything that is wrong with one document; never empty where it is returned as an error.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Default, thiserror::Error)]
pub struct InputErrors(pub Vec<InputError>);

impl fmt::Display for InputErrors {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            if index > 0 {
                writeln!(formatter)?;
            }
            write!(formatter, "{error}")?;
        }
        Ok(())
    }
}
