//! Mortar contact of bodies in space.
//!
//! ```text
//! g_j = ∫ φ_j h dA / ∫ φ_j dA,      ẋ_t = ∫ φ_j Σ_l (t·y_l) dβ_l/dt dA / ∫ φ_j dA
//! ```
//!
//! The integrals run over the part of the faces at the node `j` that the opposite surface covers, by undeformed area. `h`
//! is the distance of the opposite surface along the normal of the face, `β_l` are the shape functions of its nodes `y_l`
//! at the point that is in front. The multipliers are in the space of the shape functions `φ_j`, as M. A. Puso and T. A.
//! Laursen have them (A mortar segment-to-segment contact method for large deformation solid mechanics, Comput. Meth. Appl.
//! Mech. Engng 193, 2004); their means have positive weights, also where a face is covered in part. Slip is the mean of the
//! rates of the shares `β_l` at fixed points of the face, which a common rigid motion does not change.
//!
//! All faces are made of plane triangles, a quadrilateral of four around its centre. The overlap of two triangles is
//! a polygon, over which all integrals have closed forms.
//!
//! | module | content |
//! |---|---|
//! | [`surface`] | the faces of a surface and their triangles |
//! | `projection` | a point in the frame of a triangle, with derivatives |
//! | `overlap` | integrals over the part of a triangle that another one covers, with derivatives |
//! | [`mortar`] | a node with its faces in front of an opposite surface |

pub mod mortar;
mod overlap;
mod projection;
mod second_derivatives;
pub mod surface;
#[cfg(test)]
mod tests;
