//! The path as an iterator of increments.
use super::{Increment, Report, Scene};
use crate::cancel::CancelFlag;

pub struct Path {}

impl Path {
    pub fn new(_scene: &Scene, _cancel: CancelFlag) -> Self {
        Self {}
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        None
    }
}

impl Iterator for Path {
    type Item = Increment;
    fn next(&mut self) -> Option<Increment> {
        None
    }
}
