//! Polyhedra with rounded edges: smooth closed surfaces in space, and the point of such a surface closest to a place.
//!
//! | module | content |
//! |---|---|
//! | `polyhedron` | flat faces and edges |
//! | `make` | flat faces and edges of a closed triangle mesh, and why triangles make none |
//! | `triangles` | the triangles in a tree: the nearest one, those within a distance |
//! | `filling` | the share of a ball that a polyhedron fills, with first and second derivatives, in closed form |
//! | `closest` | the closest point |
//!
//! The surface is where a ball of the radius `h` of the rounding is half filled:
//!
//! ```text
//! F(y) = ∫ w(|p - y|) dp / ∫ w(|p - y|) dp = 1/2,    w(r) = (1 - r²/h²)² for r < h, otherwise 0
//!        inside            everywhere
//! ```
//!
//! It coincides with the faces farther than `h` from their edges; convex edges and corners are cut, concave ones filled. Its
//! curvature is continuous. Where the polyhedron is convex the surface is, too, for `w` is logarithmically concave
//! (A. Prékopa, Acta Sci. Math. (Szeged) 34 (1973) 335). A gap measured from it has continuous second derivatives near
//! it, which Newton's method and the location of events require. All lengths have one unit.

mod closest;
mod filling;
pub(crate) mod make;
mod polyhedron;
#[cfg(test)]
mod tests;
mod triangles;

pub use closest::FootPoint;
pub use make::PolyhedronMistake;
use nalgebra::Vector3;
use polyhedron::Polyhedron;
use std::sync::Arc;

/// A closed surface with rounded edges.
#[derive(Debug, Clone, PartialEq)]
pub struct RoundedPolyhedron {
    /// The radius of the ball, which is the distance from an edge where its rounding begins (length).
    rounding: f64,
    polyhedron: Arc<Polyhedron>,
}

impl RoundedPolyhedron {
    /// The surface of triangles, each given by the numbers of its corners: all counter-clockwise or all clockwise as seen
    /// from outside.
    ///
    /// # Errors
    /// Triangles that enclose no volume. [`Self::check_rounding`] finds the other mistakes.
    pub fn new(points: &[[f64; 3]], triangles: &[[usize; 3]], rounding: f64) -> Result<Self, PolyhedronMistake> {
        let polyhedron = make::polyhedron(points, triangles, rounding)?;
        Ok(Self { rounding, polyhedron: Arc::new(polyhedron) })
    }

    /// # Errors
    /// Triangles that cross; a rounding that is too wide for the polyhedron or for its triangles.
    pub fn check_rounding(&self) -> Result<(), PolyhedronMistake> {
        make::check_crossings(&self.polyhedron.triangles)?;
        make::check_corners(&self.polyhedron)
    }

    /// The same surface in multiples of a unit of length.
    pub fn in_units_of(&self, unit: f64) -> Self {
        Self { rounding: self.rounding / unit, polyhedron: Arc::clone(&self.polyhedron) }
    }

    /// The surface at its point closest to a place: the one next to the nearest point of the polyhedron.
    pub fn closest(&self, place: [f64; 3]) -> FootPoint {
        closest::closest(&self.polyhedron, &(Vector3::from(place) / self.rounding)).times(self.rounding)
    }
}
