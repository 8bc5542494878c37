//! Families of stiff and extreme cases, which vary a parameter over decades.
//!
//! | file | families |
//! |---|---|
//! | `stiffness` | stiffness ratios, contacts on soft structures, nearly coincident nodes, slender triangles |
//! | `friction` | friction from 0 to 1e6, the critical friction, contacts with zero reaction at the start |
//! | `units` | units of length and force, magnitudes of gaps and loads |
//! | `touch` | grazing contact, a node in a wedge, redundant contacts |
//! | `together` | limit point and contact change at one point, several simultaneous or nearly simultaneous events |
//! | `history` | snap-back, loading cycles, stages without load, mechanisms |

pub(crate) mod friction;
pub(crate) mod history;
pub(crate) mod stiffness;
pub(crate) mod together;
pub(crate) mod touch;
pub(crate) mod units;

use crate::check::verify::case::Case;

/// Every case of every family.
pub fn cases() -> Vec<Case> {
    [stiffness::cases(), friction::cases(), units::cases(), touch::cases(), together::cases(), history::cases()]
        .into_iter()
        .flatten()
        .collect()
}
