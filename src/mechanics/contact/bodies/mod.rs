//! Contact of a node of one body with a surface of another; in space see [`space`].
//!
//! ```text
//! g = N·(x - Σ_l w_l x_l),      ẋ_t = λ d/dt Σ_l w_l S_l,      Σ_l w_l = 1
//! ```
//!
//! The weights `w(u)` say which point of the opposite surface the node is in front of; `S` are the coordinates of the
//! surface's nodes along the undeformed surface and `λ` is its stretch, so that `ẋ_t` is the velocity of slip. A common
//! rigid motion of both bodies changes neither gap nor weights: the forces `Bᵀ r` on the two bodies are in equilibrium
//! with each other, and so are their moments, at every gap.
//!
//! | module | the weights are those of |
//! |---|---|
//! | [`mortar`] | an average over the faces at the node, which passes the patch test on meshes that do not match |
//! | [`node_to_surface`] | the closest point of a smoothed surface |
//!
//! The axes of such a contact are tangent and normal of the opposite surface: its obstacle is a plane.

mod covered_face;
mod face_moments;
pub mod mortar;
pub mod node_to_surface;
pub mod opposite_surface;
mod second_derivatives;
pub mod self_contact;
pub mod space;
#[cfg(test)]
mod tests;
mod tolerances;

/// A point or vector in the plane.
pub type PlaneVector = [f64; 2];

/// A node, its displacement apart from its undeformed place: what is small is computed from what is small.
#[derive(Debug, Clone, Copy)]
struct MovedNode {
    place: PlaneVector,
    moved: PlaneVector,
}

impl MovedNode {
    fn position(&self) -> PlaneVector {
        [self.place[0] + self.moved[0], self.place[1] + self.moved[1]]
    }

    /// The height of the node over the face from one node to another, of this length:
    ///
    /// ```text
    /// h L = E × Q = E₀ × Q₀ + e × Q₀ + E × q
    /// ```
    ///
    /// with undeformed edge `E₀` and way `Q₀` from its first node, and their changes `e` and `q`. The first term is the same in
    /// every state; the others have the rounding of displacements, where `E × Q` has that of coordinates.
    fn height_over(&self, [first, last]: [&Self; 2], length: f64) -> f64 {
        let across = |a: PlaneVector, b: PlaneVector| a[0] * b[1] - a[1] * b[0];
        let [edge_at_rest, way_at_rest] = [last, self].map(|node| difference(node.place, first.place));
        let [edge_moved, way_moved] = [last, self].map(|node| difference(node.moved, first.moved));
        let edge = difference(last.position(), first.position());
        (across(edge_at_rest, way_at_rest) + (across(edge_moved, way_at_rest) + across(edge, way_moved))) / length
    }

    /// The coordinate of the node along the undeformed face, `L₀ E·Q/|E|²` from the face's first node, in two parts: that at
    /// rest, and the change, which has the rounding of displacements.
    fn along_undeformed(&self, [first, last]: [&Self; 2]) -> [f64; 2] {
        let [edge_at_rest, way_at_rest] = [last, self].map(|node| difference(node.place, first.place));
        let [edge_moved, way_moved] = [last, self].map(|node| difference(node.moved, first.moved));
        let edge = difference(last.position(), first.position());
        let square = product(edge_at_rest, edge_at_rest);
        let share = product(edge_at_rest, way_at_rest) / square;
        let lengthened = 2.0 * product(edge_at_rest, edge_moved) + product(edge_moved, edge_moved);
        let moved = product(edge_moved, way_at_rest) + product(edge, way_moved) - share * lengthened;
        [share, moved / product(edge, edge)].map(|part| square.sqrt() * part)
    }
}

pub(super) fn difference(a: PlaneVector, b: PlaneVector) -> PlaneVector {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn product(a: PlaneVector, b: PlaneVector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The vector turned by a right angle, counter-clockwise.
pub(super) fn turned_left(a: PlaneVector) -> PlaneVector {
    [-a[1], a[0]]
}
