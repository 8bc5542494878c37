//! The dashboard in a real browser. Without chromedriver these tests say that they are skipped.

#[path = "../common/mod.rs"]
mod common;

mod jobs;
mod large;
mod manual;
mod pictures;
mod states;
mod structure;
mod values;
mod views;
