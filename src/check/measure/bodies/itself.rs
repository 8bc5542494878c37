//! A surface in the plane that touches itself: the faces at a node, and which of the surface each may touch.

use crate::check::measure::bodies::surface::OppositeFace;
use crate::check::measure::numbers::MeasuredVector;

/// How far beside a face, in its length and the thickness of the wall, the other side of a wall is left out.
const BESIDE: f64 = 3.0;
/// The thickness of a wall over the length of a face below which its sides are those of a closed slit.
const THINNEST: f64 = 0.05;

/// A face at a node.
#[derive(Debug, Clone)]
pub(super) struct MeasuredOwnFace {
    pub nodes: [usize; 2],
    /// Whether the mean over the face belongs to the node alone.
    pub is_alone: bool,
    /// Which of the opposite faces it may touch.
    pub touchable: Touchable,
}

/// Which of the faces of the opposite surface a face may touch.
#[derive(Debug, Clone)]
pub(super) enum Touchable {
    All,
    /// By the index of the face.
    Some(Vec<bool>),
}

impl Touchable {
    pub fn has(&self, face: usize) -> bool {
        match self {
            Self::All => true,
            Self::Some(touchable) => touchable[face],
        }
    }
}

/// The faces at a node. At the node where a closed surface begins its last face belongs to the node before it.
pub(super) fn faces_in_itself(
    node: usize,
    surface: &[OppositeFace],
    places: &[MeasuredVector],
) -> Vec<MeasuredOwnFace> {
    let closes = |face: &OppositeFace| face.period == Some(face.along[1]);
    let at_node = surface.iter().filter(|face| face.nodes[0] == node || (face.nodes[1] == node && !closes(face)));
    let faces = at_node.map(|face| MeasuredOwnFace {
        nodes: face.nodes,
        is_alone: closes(face),
        touchable: Touchable::Some(surface.iter().map(|other| may_touch(face, other, places)).collect()),
    });
    faces.collect()
}

/// Whether a face may touch an earlier one: it has no node in common with it, and the two are not the sides of a wall.
fn may_touch(face: &OppositeFace, other: &OppositeFace, places: &[MeasuredVector]) -> bool {
    if other.rank >= face.rank || other.nodes.iter().any(|node| face.nodes.contains(node)) {
        return false;
    }
    let start = places[face.nodes[0]];
    let edge = places[face.nodes[1]] - start;
    let (length, along) = (edge.norm(), edge.normalize());
    let left = MeasuredVector::new(-along.y, along.x, 0.0);
    let [from, to] = other.nodes.map(|node| (places[node] - start).dot(&along));
    let heights = other.nodes.map(|node| (places[node] - start).dot(&left));
    let beside = BESIDE * (length - heights[0].min(heights[1]));
    let is_behind = heights.iter().all(|height| *height < -THINNEST * length);
    let is_side = is_behind && to < from && from > -beside && to < length + beside;
    !is_side
}
