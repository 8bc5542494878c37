//! Work and memory of paths, counted by an allocator of their own.

#[path = "../common/mod.rs"]
mod common;

mod counts;
mod memory;
