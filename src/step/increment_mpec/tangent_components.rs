//! The vectors of a contact as components along the obstacle's tangents, in which the program is written.

use crate::mechanics::contact::vector::{Vector, add, dot, scaled, unit};
use crate::mechanics::contact::{Frame, Mode, Reaction};

/// Components along the two tangents; the second is 0 where there is only one tangent.
pub type Components = [f64; 2];

/// The components of a vector along the tangents of a frame.
pub fn components(frame: &Frame, vector: &Vector) -> Components {
    frame.tangents.map(|tangent| dot(&tangent, vector))
}

/// The vector with given components along tangents.
pub fn vector(tangents: &[Vector; 2], components: Components) -> Vector {
    add(&scaled(&tangents[0], components[0]), components[1], &tangents[1])
}

/// The reaction with a normal part and components along the tangents.
pub fn reaction(tangents: &[Vector; 2], normal: f64, tangential: Components) -> Reaction {
    Reaction { normal, tangential: vector(tangents, tangential) }
}

/// The slip in the direction of components, whatever their size.
pub fn slip(tangents: &[Vector; 2], along: Components) -> Mode {
    Mode::Slip { direction: unit(&vector(tangents, along)) }
}
