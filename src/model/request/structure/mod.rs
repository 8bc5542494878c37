//! A structure, its obstacles, and the stages of its load.
//!
//! Fields are public and are what the JSON contract names; constructors and methods that return the value let a model be
//! written in code. Neither checks anything: [`check`](crate::model::check) does, for models from JSON and from code alike.

#![warn(missing_docs)]

mod component;
mod element;
mod material;
mod mesh;
mod model;
mod obstacle;
mod polyline;
mod rotation;
mod rounded_box;
mod solid;
mod stage;
mod surface;
mod triangle_mesh;

pub use crate::model::mesh::MeshFormat;
pub use component::Component;
pub use element::{BendingStiffness, Element};
pub use material::{ElasticConstants, Material};
pub use mesh::{ContentEncoding, MeshFile, MeshGroup};
pub use model::{Model, Units};
pub(crate) use obstacle::PostedShape;
pub use obstacle::{Contact, ContactDiscretisation, Obstacle, Side};
pub use polyline::{Polyline, Section};
pub(crate) use rotation::ObstaclePivot;
pub use rotation::ObstacleRotation;
pub use rounded_box::RoundedBox;
pub use solid::{PlaneCondition, Solid};
pub use stage::{DisplacementBound, Stage, StageControl, Until};
pub use surface::{NamedSet, Surface};
pub use triangle_mesh::TriangleMesh;
