//! A JSON value that keeps what `serde_json::Value` forgets: the order of members and duplicates.
