//! Triangles in an R*-tree (N. Beckmann, H.-P. Kriegel, R. Schneider and B. Seeger, SIGMOD 1990, 322,
//! doi:10.1145/93597.98741).

use nalgebra::Vector3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

#[derive(Debug)]
pub(super) struct TriangleTree(RTree<PlacedTriangle>);

/// A triangle of a polyhedron.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedTriangle {
    pub corners: [Vector3<f64>; 3],
    /// The numbers of its corners among the points.
    pub points: [usize; 3],
    /// Its number among the triangles.
    pub number: usize,
    /// The number of the flat face to which it belongs.
    pub face: usize,
}

impl TriangleTree {
    pub fn new(triangles: Vec<PlacedTriangle>) -> Self {
        Self(RTree::bulk_load(triangles))
    }

    /// The flat face nearest to a place, and its nearest point; `None` where there is no triangle.
    pub fn nearest(&self, place: &Vector3<f64>) -> Option<(usize, Vector3<f64>)> {
        let triangle = self.0.nearest_neighbor((*place).into())?;
        Some((triangle.face, triangle.nearest_point(place)))
    }

    /// The numbers of the flat faces within a distance, in order.
    pub fn faces_within(&self, distance: f64, place: &Vector3<f64>) -> Vec<usize> {
        let near = self.0.locate_within_distance((*place).into(), distance * distance);
        let mut faces: Vec<usize> = near.map(|triangle| triangle.face).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// The triangles whose boxes overlap that of a triangle.
    pub fn beside(&self, triangle: &PlacedTriangle) -> impl Iterator<Item = &PlacedTriangle> {
        self.0.locate_in_envelope_intersecting(triangle.envelope())
    }

    pub fn iter(&self) -> impl Iterator<Item = &PlacedTriangle> {
        self.0.iter()
    }
}

impl PlacedTriangle {
    /// The point of the triangle nearest to a place (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
    fn nearest_point(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let [a, b, c] = &self.corners;
        let sides = [b - a, c - a];
        let along = |corner: &Vector3<f64>| sides.map(|side| side.dot(&(place - corner)));
        let [[a_b, a_c], [b_b, b_c], [c_b, c_c]] = [a, b, c].map(along);
        if a_b <= 0.0 && a_c <= 0.0 {
            return *a;
        }
        if b_b >= 0.0 && b_c <= b_b {
            return *b;
        }
        if c_c >= 0.0 && c_b <= c_c {
            return *c;
        }
        // Areas opposite to the corners, up to a common factor.
        let [of_c, of_b, of_a] = [a_b * b_c - b_b * a_c, c_b * a_c - a_b * c_c, b_b * c_c - c_b * b_c];
        if of_c <= 0.0 && a_b >= 0.0 && b_b <= 0.0 {
            return a + sides[0] * (a_b / (a_b - b_b));
        }
        if of_b <= 0.0 && a_c >= 0.0 && c_c <= 0.0 {
            return a + sides[1] * (a_c / (a_c - c_c));
        }
        let (onwards, back) = (b_c - b_b, c_b - c_c);
        if of_a <= 0.0 && onwards >= 0.0 && back >= 0.0 {
            return b + (c - b) * (onwards / (onwards + back));
        }
        let whole = of_a + of_b + of_c;
        a + sides[0] * (of_b / whole) + sides[1] * (of_c / whole)
    }
}

impl RTreeObject for PlacedTriangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = &self.corners;
        AABB::from_corners(a.inf(b).inf(c).into(), a.sup(b).sup(c).into())
    }
}

impl PointDistance for PlacedTriangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let place = Vector3::from(*point);
        (place - self.nearest_point(&place)).norm_squared()
    }
}
