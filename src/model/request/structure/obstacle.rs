//! Rigid obstacles, and contacts of nodes with them.

use crate::model::request::structure::polyline::Polyline;
use crate::model::request::structure::rounded_box::RoundedBox;
use crate::model::request::structure::triangle_mesh::TriangleMesh;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

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
    /// A circular cylinder without ends, in 3D.
    Cylinder {
        /// A point on the axis (length, 3 coordinates).
        point: Vec<f64>,
        /// Along the axis (3 components), of any length but 0 and of either sense.
        axis: Vec<f64>,
        /// Length, positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        radius: f64,
        /// Where nodes are free, `outside` when absent.
        #[serde(default)]
        side: Side,
    },
    /// A smooth curve through points, or a polygon with rounded corners, in the plane; in space straight across it.
    Polyline(Polyline),
    /// A rectangle in the plane or a cuboid in space, with rounded edges.
    Box(RoundedBox),
    /// The polyhedron that triangles enclose, with rounded edges, in space.
    TriangleMesh(TriangleMesh),
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

    /// A circular cylinder in 3D about the line through a point (length) along an axis, of positive radius (length); nodes
    /// stay on the given side of it.
    ///
    /// ```
    /// use arcslip::{Obstacle, Side};
    ///
    /// let drum = Obstacle::cylinder([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5, Side::Outside);
    /// let pipe = Obstacle::cylinder([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5, Side::Inside);
    /// assert_ne!(drum, pipe);
    /// ```
    pub fn cylinder(point: impl Into<Vec<f64>>, axis: impl Into<Vec<f64>>, radius: f64, side: Side) -> Self {
        Self::Cylinder { point: point.into(), axis: axis.into(), radius, side }
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

/// An obstacle as what solver and measure know: a box is the polyline or the polyhedron of its sides.
#[derive(Debug, Clone)]
pub(crate) enum PostedShape<'a> {
    Plane { point: &'a [f64], normal: &'a [f64] },
    Ball { center: &'a [f64], radius: f64, side: Side },
    Cylinder { point: &'a [f64], axis: &'a [f64], radius: f64, side: Side },
    Curve(Cow<'a, Polyline>),
    Polyhedron(Cow<'a, TriangleMesh>),
}

impl Obstacle {
    /// The shape of a well-formed obstacle in a space of so many dimensions.
    pub(crate) fn shape(&self, dimension: usize) -> PostedShape<'_> {
        match self {
            Self::Plane { point, normal } => PostedShape::Plane { point, normal },
            Self::Ball { center, radius, side } => PostedShape::Ball { center, radius: *radius, side: *side },
            Self::Cylinder { point, axis, radius, side } => {
                PostedShape::Cylinder { point, axis, radius: *radius, side: *side }
            }
            Self::Polyline(polyline) => PostedShape::Curve(Cow::Borrowed(polyline)),
            Self::Box(own) if dimension == 2 => PostedShape::Curve(Cow::Owned(own.polyline())),
            Self::Box(own) => PostedShape::Polyhedron(Cow::Owned(own.triangles())),
            Self::TriangleMesh(mesh) => PostedShape::Polyhedron(Cow::Borrowed(mesh)),
        }
    }
}

/// On which side of a closed obstacle the nodes are free.
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

impl Side {
    /// 1 outside, -1 inside: the sense of the outward normal that points into the free side.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Outside => 1.0,
            Self::Inside => -1.0,
        }
    }
}

/// A node, or the nodes of a surface, against an obstacle, the surface of another body, or the same surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name of the node; `@` and a name: the nodes of a set or surface. Absent where a whole `surface` touches.
    #[serde(default)]
    pub node: String,
    /// Name of a surface, whose nodes touch, in place of `node`. With `against` both may be given: a node of the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
    /// Name of the obstacle. Absent where `against` is given.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub obstacle: String,
    /// Name of the surface of another body, in place of `obstacle`; in the plane also that of `surface`, which may then
    /// touch itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against: Option<String>,
    /// How a contact of bodies is discretised; `mortar` when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discretisation: Option<ContactDiscretisation>,
    /// Coulomb's coefficient, 0 or more; 0 is frictionless.
    #[serde(default)]
    #[cfg_attr(feature = "server", schema(minimum = 0.0))]
    pub friction: f64,
}

/// How contacts of bodies are discretised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ContactDiscretisation {
    /// Mean gaps and slips over the faces at each node of the surface: passes the patch test.
    #[default]
    Mortar,
    /// Each node against the nearest point of the other surface, which is smoothed.
    NodeToSurface,
}

impl Contact {
    /// A node against an obstacle with Coulomb's coefficient of friction (dimensionless, 0 or more).
    pub fn new(node: impl Into<String>, obstacle: impl Into<String>, friction: f64) -> Self {
        Self {
            node: node.into(),
            surface: None,
            obstacle: obstacle.into(),
            against: None,
            discretisation: None,
            friction,
        }
    }

    /// The nodes of a surface against another surface with Coulomb's coefficient of friction (dimensionless, 0 or more).
    /// The names stand for nodes once the request is [`expanded`](crate::expanded).
    pub fn between(surface: impl Into<String>, against: impl Into<String>, friction: f64) -> Self {
        let (surface, against) = (Some(surface.into()), Some(against.into()));
        Self { surface, against, ..Self::new(String::new(), String::new(), friction) }
    }

    /// Whether the contact stands for those of all nodes of its surface.
    pub fn names_whole_surface(&self) -> bool {
        self.surface.is_some() && self.node.is_empty()
    }

    /// Whether the surface of the contact touches itself.
    pub fn touches_itself(&self) -> bool {
        self.surface.is_some() && self.surface == self.against
    }

    /// The name of what is touched: the obstacle or the other surface.
    pub fn counterpart(&self) -> &str {
        self.against.as_deref().unwrap_or(&self.obstacle)
    }
}
