//! Mortar contact of bodies in space.
//!
//! ```text
//! g_j = ∫ χ_j h dA / ∫ χ_j dA,      ẋ_t = ∫ χ_j Σ_l (t·y_l) dβ_l/dt dA / ∫ χ_j dA
//! ```
//!
//! The integrals run over the part of the faces at the node `j` that the opposite surface covers, by undeformed area. `h`
//! is the distance of the opposite surface along the normal of the face, `β_l` are the shape functions of its nodes `y_l`
//! at the point that is in front. The function `χ_j` is dual to the shape functions on faces that are covered as a whole (B. I.
//! Wohlmuth, A mortar finite element method using dual spaces for the Lagrange multiplier, SIAM J. Numer. Anal. 38, 2000; A.
//! Popp, M. Gitterle, M. W. Gee and W. A. Wall, A dual mortar approach for 3D finite deformation contact, Int. J. Numer.
//! Meth. Engng 83, 2010), and turns into the shape function of the node as less and less of a face is. The integration over
//! polygons on the faces is that of M. A. Puso and T. A. Laursen (A mortar segment-to-segment contact method for large
//! deformation solid mechanics, Comput. Meth. Appl. Mech. Engng 193, 2004). Slip is the mean of the rates of the shares `β_l`
//! at fixed points of the face, which a common rigid motion does not change. On faces with supported nodes `χ_j` is the shape
//! function in the mean of slips.
//!
//! All faces are made of plane triangles, a quadrilateral of four around its centre. The overlap of two triangles is
//! a polygon, over which all integrals have closed forms.
//!
//! | module | content |
//! |---|---|
//! | [`surface`] | the faces of a surface and their triangles |
//! | `own_face` | the shape function of a node and its dual function on a face |
//! | `tangents` | the tangents at a node |
//! | `projection` | a point in the frame of a triangle, with derivatives |
//! | `overlap` | integrals over the part of a triangle that another one covers, with derivatives |
//! | `covered_part` | what is covered of the faces at a node, and the means over it |
//! | `second_derivatives` | the derivatives of the forces at constant reactions |
//! | [`mortar`] | a node with its faces in front of an opposite surface |

mod covered_part;
pub mod mortar;
mod overlap;
mod own_face;
mod projection;
mod second_derivatives;
pub mod surface;
mod tangents;
#[cfg(test)]
mod tests;
