//! The JSON answers of version 1, and how they are made from the stored records.

pub mod change;
pub mod curve;
pub mod job;
pub mod probe;
pub mod scene;
pub mod stream;
pub mod study;
pub mod submitted;
pub mod sweep;
