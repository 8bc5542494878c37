//! linear_algebra
