//! Rigid obstacles in space that triangles enclose.

use serde::{Deserialize, Serialize};

use crate::algebra::rounded_polyhedron::{PolyhedronMistake, RoundedPolyhedron};
use crate::model::request::structure::obstacle::Side;

/// A rigid obstacle in space: the polyhedron that triangles enclose, with rounded edges. The triangles make a closed surface,
/// each of their sides belongs to two of them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct TriangleMesh {
    /// The corners of the triangles (length, 3 coordinates each).
    pub points: Vec<Vec<f64>>,
    /// Three numbers of points each, counted from 0: all counter-clockwise or all clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The distance from an edge (length, positive) at which its rounding begins. The surface is where a ball of this radius
    /// is half filled by the polyhedron.
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub rounding: f64,
    /// Where nodes are free, `outside` when absent.
    #[serde(default)]
    pub side: Side,
}

impl TriangleMesh {
    /// The polyhedron that triangles enclose, free outside; its points and the distance from an edge at which its rounding
    /// begins are lengths.
    ///
    /// ```
    /// use arcslip::{Obstacle, TriangleMesh};
    ///
    /// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let tetrahedron = TriangleMesh::new(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], 0.1);
    /// assert_eq!(Obstacle::TriangleMesh(tetrahedron.clone()), Obstacle::TriangleMesh(tetrahedron));
    /// ```
    pub fn new(
        points: impl IntoIterator<Item = [f64; 3]>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
        rounding: f64,
    ) -> Self {
        let points = points.into_iter().map(|point| point.to_vec()).collect();
        Self { points, triangles: triangles.into_iter().collect(), rounding, side: Side::Outside }
    }

    /// Nodes stay on the given side.
    pub fn on_side(mut self, side: Side) -> Self {
        self.side = side;
        self
    }

    /// The first point, from which [`Self::surface`] measures: far from the origin no digits are lost.
    pub(crate) fn origin(&self) -> [f64; 3] {
        self.points.first().map_or([0.0; 3], |point| at(point))
    }

    /// The largest coordinate.
    pub(crate) fn reach(&self) -> f64 {
        self.points.iter().flatten().fold(0.0, |largest, value| value.abs().max(largest))
    }

    /// The surface relative to the first point, in the unit of the model. All triangles have points.
    pub(crate) fn surface(&self) -> Result<RoundedPolyhedron, PolyhedronMistake> {
        let origin = self.origin();
        let relative = |point: &Vec<f64>| {
            let point = at(point);
            std::array::from_fn(|k| point[k] - origin[k])
        };
        let points: Vec<[f64; 3]> = self.points.iter().map(relative).collect();
        let triangles: Vec<[usize; 3]> = self.triangles.iter().map(|one| one.map(|point| point as usize)).collect();
        RoundedPolyhedron::new(&points, &triangles, self.rounding)
    }
}

/// The first three coordinates; 0 where there are fewer.
fn at(point: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| point.get(k).copied().unwrap_or(0.0))
}
