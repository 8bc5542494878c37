//! Between a contact's vectors and their components along the obstacle's tangents, in which the program is written.

use crate::mechanics::contact::vector::{Vector, add, dot, scaled, unit};
use crate::mechanics::contact::{Frame, Mode, Reaction};

/// Components along the two tangents; the second is 0 where there is one.
pub type Components = [f64; 2];

/// A vector along the tangents of a frame.
pub fn components(frame: &Frame, vector: &Vector) -> Components {
    frame.tangents.map(|tangent| dot(&tangent, vector))
}

/// The vector of components along tangents.
pub fn vector(tangents: &[Vector; 2], components: Components) -> Vector {
    add(&scaled(&tangents[0], components[0]), components[1], &tangents[1])
}

/// The reaction of a normal part and components along the tangents.
pub fn reaction(tangents: &[Vector; 2], normal: f64, tangential: Components) -> Reaction {
    Reaction { normal, tangential: vector(tangents, tangential) }
}

/// Slip along components, whatever their size.
pub fn slip(tangents: &[Vector; 2], along: Components) -> Mode {
    Mode::Slip { direction: unit(&vector(tangents, along)) }
}
