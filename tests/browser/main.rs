//! The dashboard in a real browser. Without chromedriver these tests say that they are skipped.

#[path = "../common/mod.rs"]
mod common;

mod jobs;
mod large;
mod lists;
mod manual;
mod paths;
mod pictures;
mod states;
mod views;
