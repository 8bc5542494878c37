//! An increment as one line of JSON.

use crate::check::judged::JudgedIncrement;

/// Without the line's end. Numbers read back to the same bits.
pub fn json_line(increment: &JudgedIncrement) -> serde_json::Result<String> {
    serde_json::to_string(increment)
}
