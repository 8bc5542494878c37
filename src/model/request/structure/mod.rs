//! A structure, its obstacles, and the stages of its load.
//!
//! Fields are public and are what the JSON contract names; constructors and methods that return the value let a model be
//! written in code. Neither checks anything: [`check`](crate::model::check) does, for models from JSON and from code alike.

#![warn(missing_docs)]

mod component;
mod element;
mod model;
mod obstacle;
mod stage;

pub use component::Component;
pub use element::{BendingStiffness, Element};
pub use model::{Model, Units};
pub use obstacle::{Contact, Obstacle, Side};
pub use stage::{DisplacementBound, Stage, Until};
