//! Shared by the test files.

pub mod bad_documents;
