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
