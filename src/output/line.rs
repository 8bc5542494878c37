//! An increment as one line of JSON.

use crate::check::judged::JudgedIncrement;

/// The JSON without a line feed. Numbers are read back exactly.
pub fn json_line(increment: &JudgedIncrement) -> serde_json::Result<String> {
    serde_json::to_string(increment)
}
