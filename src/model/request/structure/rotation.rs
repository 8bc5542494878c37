//! Rotations of obstacles.

use crate::mechanics::contact::vector::{Vector, unit_of};
use crate::model::request::structure::obstacle::Obstacle;
use serde::{Deserialize, Serialize};

/// How an obstacle turns: about a point in the plane, about an axis in space. In all stages that turn it the point and the
/// axis are the same; `obstacle_motion` moves both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ObstacleRotation {
    /// Radians; counter-clockwise in the plane, right-handed about the axis in space. Multiplied by the load factor.
    pub angle: f64,
    /// The point about which the obstacle turns, or a point on the axis (length, `dimension` coordinates). Absent: the
    /// `point` of a plane or a cylinder, the `center` of a ball or a box; of others it is required.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<Vec<f64>>,
    /// In space: along the axis (3 components), of any length but 0. Absent: the axis of a cylinder; of others it is required.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<Vec<f64>>,
}

impl ObstacleRotation {
    /// A rotation about the obstacle's own point (radians).
    ///
    /// ```
    /// use arcslip::{ObstacleRotation, Stage};
    ///
    /// let tilt = ObstacleRotation::by(0.5).about([0.0, 0.0]);
    /// let stage = Stage::new("tilt").obstacle_rotation("plane", tilt);
    /// assert_eq!(stage.obstacle_rotation["plane"].angle, 0.5);
    /// ```
    pub fn by(angle: f64) -> Self {
        Self { angle, about: None, axis: None }
    }

    /// About this point (length, `dimension` coordinates).
    #[must_use]
    pub fn about(mut self, point: impl Into<Vec<f64>>) -> Self {
        self.about = Some(point.into());
        self
    }

    /// About an axis in this direction (3 components), in space.
    #[must_use]
    pub fn axis(mut self, axis: impl Into<Vec<f64>>) -> Self {
        self.axis = Some(axis.into());
        self
    }

    /// Where an obstacle turns; `None` where the rotation does not say so.
    pub(crate) fn pivot(&self, obstacle: &Obstacle, dimension: usize) -> Option<ObstaclePivot> {
        let own = match obstacle {
            Obstacle::Plane { point, .. } | Obstacle::Cylinder { point, .. } => Some(point),
            Obstacle::Ball { center, .. } => Some(center),
            Obstacle::Box(own) => Some(&own.center),
            Obstacle::Polyline(_) | Obstacle::TriangleMesh(_) => None,
        };
        let own_axis = match obstacle {
            Obstacle::Cylinder { axis, .. } => Some(axis),
            Obstacle::Plane { .. }
            | Obstacle::Ball { .. }
            | Obstacle::Polyline(_)
            | Obstacle::Box(_)
            | Obstacle::TriangleMesh(_) => None,
        };
        let axis = match dimension {
            2 => [0.0, 0.0, 1.0],
            _ => self
                .axis
                .as_ref()
                .or(own_axis)
                .filter(|axis| axis.iter().any(|part| *part != 0.0))
                .map(|axis| unit_of(axis))?,
        };
        Some(ObstaclePivot { place: padded(self.about.as_ref().or(own)?), axis })
    }
}

/// The point and the axis about which an obstacle turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ObstaclePivot {
    /// A point on the axis, in the unit of the model.
    pub place: Vector,
    /// A unit vector; the third axis in the plane.
    pub axis: Vector,
}

fn padded(values: &[f64]) -> Vector {
    let mut vector = [0.0; 3];
    vector.iter_mut().zip(values).for_each(|(component, value)| *component = *value);
    vector
}
