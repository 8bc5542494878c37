//! Between a contact's vectors and their components along the obstacle's tangents, in which the program is written.

use crate::contact::{Contact, Mode, Reaction};
use crate::path::state::along;

/// Components along the two tangents; the second is 0 in 2D.
pub type Components = [f64; 2];

/// `r_t` along the tangents.
pub fn traction(reaction: &Reaction) -> Components {
    reaction.tangential
}

/// The reaction of a normal part and components along the tangents.
pub fn reaction(normal: f64, tangential: Components) -> Reaction {
    Reaction { normal, tangential }
}

/// The node's part of a motion of all degrees of freedom, along the tangents.
pub fn motion(contact: &Contact, dimension: usize, displacement: &[f64]) -> Components {
    let first = contact.node * dimension;
    let node = &displacement[first..first + dimension];
    let tangents = contact.obstacle.tangents(dimension);
    [along(node, &tangents[0]), along(node, &tangents[1])]
}

/// Slip along components, whatever their size.
pub fn slip(along: Components) -> Mode {
    let size = along[0].hypot(along[1]);
    let unit = if size > 0.0 { along.map(|value| value / size) } else { [0.0; 2] };
    Mode::Slip { direction: unit }
}

/// Whether two modes say the same: the same status, and slip within 60° of each other, since within an increment its
/// direction turns.
pub fn agree(one: Mode, other: Mode) -> bool {
    const LEAST_COSINE: f64 = 0.5;
    match (one, other) {
        (Mode::Slip { direction: a }, Mode::Slip { direction: b }) => {
            a == b || a[0] * b[0] + a[1] * b[1] > LEAST_COSINE
        }
        _ => one == other,
    }
}
