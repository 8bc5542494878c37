//! Rigid boxes: rectangles in the plane, cuboids in space.

use serde::{Deserialize, Serialize};

use crate::mechanics::contact::vector::{Vector, add, cross, dot, unit, unit_of};
use crate::model::request::structure::obstacle::Side;
use crate::model::request::structure::polyline::Polyline;
use crate::model::request::structure::triangle_mesh::TriangleMesh;

/// The rounding of a box whose rounding is absent, as a part of its shortest side.
const USUAL_ROUNDING: f64 = 0.05;

/// A rigid rectangle in the plane or a rigid cuboid in space, with rounded edges.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct RoundedBox {
    /// Length, `dimension` coordinates.
    pub center: Vec<f64>,
    /// The lengths of its sides (length, positive, `dimension` of them), from face to face.
    pub size: Vec<f64>,
    /// The distance from an edge (length, positive) at which its rounding begins, at most half of the shortest side; a
    /// twentieth of that side when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub rounding: Option<f64>,
    /// Where nodes are free, `outside` when absent.
    #[serde(default)]
    pub side: Side,
    /// Along its first side (`dimension` components), of any length but 0; along the first axis when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<Vec<f64>>,
    /// In space, towards its second side (3 components), not along `x`: its part across `x` counts. Absent: along the second
    /// axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y: Option<Vec<f64>>,
}

impl RoundedBox {
    /// A box along the axes with its centre and the lengths of its sides, free outside.
    ///
    /// ```
    /// use arcslip::{Obstacle, RoundedBox};
    ///
    /// let step = RoundedBox::new([0.0, -0.5], [4.0, 1.0]).rounded(0.1);
    /// let crate_in_space = RoundedBox::new([0.0, 0.0, 1.0], [2.0, 2.0, 2.0]).turned([1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]);
    /// assert_ne!(Obstacle::Box(step), Obstacle::Box(crate_in_space));
    /// ```
    pub fn new(center: impl Into<Vec<f64>>, size: impl Into<Vec<f64>>) -> Self {
        Self { center: center.into(), size: size.into(), ..Self::default() }
    }

    /// With edges rounded from this distance (length) on.
    pub fn rounded(mut self, rounding: f64) -> Self {
        self.rounding = Some(rounding);
        self
    }

    /// Nodes stay on the given side.
    pub fn on_side(mut self, side: Side) -> Self {
        self.side = side;
        self
    }

    /// With the directions of its first and second sides in space.
    pub fn turned(mut self, x: [f64; 3], y: [f64; 3]) -> Self {
        (self.x, self.y) = (Some(x.to_vec()), Some(y.to_vec()));
        self
    }

    /// The unit vectors along its sides.
    fn axes(&self) -> [Vector; 3] {
        let is_flat = self.center.len() == 2;
        let x = self.x.as_deref().map_or([1.0, 0.0, 0.0], unit_of);
        if is_flat {
            return [x, [-x[1], x[0], 0.0], [0.0, 0.0, 1.0]];
        }
        let y = self.y.as_deref().map_or([0.0, 1.0, 0.0], unit_of);
        let y = unit(&add(&y, -dot(&x, &y), &x));
        [x, y, cross(&x, &y)]
    }

    /// The corners: the sign along the first side changes first.
    fn corners(&self) -> impl Iterator<Item = Vec<f64>> {
        let (axes, sides) = (self.axes(), self.center.len());
        (0..1_usize << sides).map(move |corner| {
            let part = |axis: usize| self.size[axis] * if corner >> axis & 1 == 1 { 0.5 } else { -0.5 };
            let component = |k: usize| self.center[k] + (0..sides).map(|axis| part(axis) * axes[axis][k]).sum::<f64>();
            (0..sides).map(component).collect()
        })
    }

    fn rounding(&self) -> f64 {
        let shortest = self.size.iter().copied().fold(f64::INFINITY, f64::min);
        self.rounding.unwrap_or(USUAL_ROUNDING * shortest)
    }

    /// The closed polyline around a box in the plane.
    pub(crate) fn polyline(&self) -> Polyline {
        let mut points: Vec<Vec<f64>> = self.corners().collect();
        points.swap(2, 3);
        Polyline { points, ..Polyline::default() }.closed(self.side).rounded(self.rounding())
    }

    /// The triangles around a box in space.
    pub(crate) fn triangles(&self) -> TriangleMesh {
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        TriangleMesh {
            points: self.corners().collect(),
            triangles: faces.into_iter().flat_map(halves).collect(),
            rounding: self.rounding(),
            side: self.side,
        }
    }
}
