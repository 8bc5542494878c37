//! The dashboard in a real browser. Without chromedriver these tests say that they are skipped.

#[path = "../common/mod.rs"]
mod common;

mod contacts;
mod jobs;
mod large;
mod lists;
mod manual;
mod paths;
mod pictures;
mod playback;
mod preview;
mod states;
mod structure;
mod values;
mod views;
