//! Rigid obstacles, and contacts of nodes with them.

use crate::model::request::structure::polyline::Polyline;
use serde::{Deserialize, Serialize};

/// A rigid obstacle that nodes may touch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Obstacle {
    /// A half-space; `normal` points into the free side and need not have unit length.
    Plane {
        /// A point on the plane (length, `dimension` coordinates).
        point: Vec<f64>,
        /// Towards the free side (`dimension` components), of any length but 0.
        normal: Vec<f64>,
    },
    /// A circle in 2D, a sphere in 3D.
    Ball {
        /// Centre (length, `dimension` coordinates).
        center: Vec<f64>,
        /// Length, positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        radius: f64,
        /// Where nodes are free, `outside` when absent.
        #[serde(default)]
        side: Side,
    },
    /// A smooth curve through points, or a polygon with rounded corners, in the plane.
    Polyline(Polyline),
}

impl Obstacle {
    /// A plane through a point; `normal` points into the free side and need not have unit length.
    ///
    /// ```
    /// use arcslip::{Obstacle, Side};
    ///
    /// let floor = Obstacle::plane([0.0, 0.0], [0.0, 1.0]);
    /// let bowl = Obstacle::ball([0.0, 2.0], 2.0, Side::Inside);
    /// assert_ne!(floor, bowl);
    /// ```
    pub fn plane(point: impl Into<Vec<f64>>, normal: impl Into<Vec<f64>>) -> Self {
        Self::Plane { point: point.into(), normal: normal.into() }
    }

    /// A circle in 2D, a sphere in 3D, of positive radius (length); nodes stay on the given side of it.
    pub fn ball(center: impl Into<Vec<f64>>, radius: f64, side: Side) -> Self {
        Self::Ball { center: center.into(), radius, side }
    }

    /// The smooth curve through points (length) in the plane, open, free to the left of its direction.
    ///
    /// ```
    /// use arcslip::{Obstacle, Polyline, Side};
    ///
    /// let ramp = Obstacle::polyline([[0.0, 0.0], [1.0, 0.1], [2.0, 0.4]]);
    /// let corners = vec![vec![0.0, 0.0], vec![2.0, 0.0], vec![2.0, 1.0], vec![0.0, 1.0]];
    /// let block = Polyline { points: corners, ..Polyline::default() }.closed(Side::Outside).rounded(0.1);
    /// assert_ne!(ramp, Obstacle::Polyline(block));
    /// ```
    pub fn polyline(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let points = points.into_iter().map(|point| point.to_vec()).collect();
        Self::Polyline(Polyline { points, ..Polyline::default() })
    }
}

/// On which side of a ball or a closed polyline the nodes are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Nodes stay out of it.
    #[default]
    Outside,
    /// Nodes stay in it.
    Inside,
}

/// A node, or the nodes of a surface, against an obstacle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name of the node; `@` and a name: the nodes of a set or surface. Absent where `surface` is given.
    #[serde(default)]
    pub node: String,
    /// Name of a surface, whose nodes touch, in place of `node`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
    /// Name of the obstacle.
    pub obstacle: String,
    /// Coulomb's coefficient, 0 or more; 0 is frictionless.
    #[serde(default)]
    #[cfg_attr(feature = "server", schema(minimum = 0.0))]
    pub friction: f64,
}

impl Contact {
    /// A node against an obstacle with Coulomb's coefficient of friction (dimensionless, 0 or more).
    pub fn new(node: impl Into<String>, obstacle: impl Into<String>, friction: f64) -> Self {
        Self { node: node.into(), surface: None, obstacle: obstacle.into(), friction }
    }
}
