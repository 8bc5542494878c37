//! Rigid obstacles along polylines in the plane, and straight across it in space.

use serde::{Deserialize, Serialize};

use crate::algebra::plane_curve::make::doubled_area;
use crate::algebra::plane_curve::{CurveMistake, PlaneCurve, PlanePoint};
use crate::model::request::structure::obstacle::Side;

/// A rigid obstacle in the plane along a smooth curve through points, or in space the surface that continues the curve
/// straight across the plane of the points. The free side of an open polyline is to the left of its direction; its ends
/// continue straight to infinity.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Polyline {
    /// The points (length, 2 coordinates each) in order: 2 or more, 3 or more where the polyline is closed.
    pub points: Vec<Vec<f64>>,
    /// Whether the last point is joined to the first.
    #[serde(default)]
    pub closed: bool,
    /// Edges are straight, and each corner is rounded off from this distance (length, positive) before it to the same
    /// distance behind it. When absent the obstacle is the cubic spline through the points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub rounding: Option<f64>,
    /// Where nodes are free, for a closed polyline: `outside` when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// In space: the plane of the points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<Section>,
}

/// The plane in space in which the points of a polyline lie.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// The place (length, 3 coordinates) of the points' origin.
    pub origin: Vec<f64>,
    /// Along the first coordinate of the points (3 components), of any length but 0.
    pub x: Vec<f64>,
    /// Towards positive second coordinates (3 components), not along `x`: its part across `x` counts.
    pub y: Vec<f64>,
}

impl Section {
    /// The unit vectors of the points' coordinates.
    fn axes(&self) -> [[f64; 3]; 2] {
        let vector = |given: &[f64]| -> [f64; 3] { std::array::from_fn(|k| given.get(k).copied().unwrap_or(0.0)) };
        let unit = |given: [f64; 3]| {
            let size = given.iter().map(|value| value * value).sum::<f64>().sqrt();
            given.map(|value| value / size)
        };
        let x = unit(vector(&self.x));
        let y = unit(vector(&self.y));
        let along: f64 = x.iter().zip(&y).map(|(x, y)| x * y).sum();
        [x, unit(std::array::from_fn(|k| y[k] - along * x[k]))]
    }
}

impl Polyline {
    /// Puts the points into a plane in space: their origin, and the directions of their first and second coordinates.
    pub fn in_space(mut self, origin: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Self {
        self.section = Some(Section { origin: origin.to_vec(), x: x.to_vec(), y: y.to_vec() });
        self
    }

    /// The unit vectors of the points' coordinates, in space or in the plane.
    pub(crate) fn axes(&self) -> [[f64; 3]; 2] {
        self.section.as_ref().map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], Section::axes)
    }

    /// The coordinates, among those of the points, of a place in space or in the plane.
    pub(crate) fn coordinates(&self, place: &[f64]) -> PlanePoint {
        let Some(section) = &self.section else { return at(place) };
        let from: Vec<f64> = place.iter().zip(&section.origin).map(|(place, origin)| place - origin).collect();
        section.axes().map(|axis| axis.iter().zip(&from).map(|(axis, from)| axis * from).sum())
    }

    /// Closes the polyline; nodes stay on the given side.
    pub fn closed(mut self, side: Side) -> Self {
        (self.closed, self.side) = (true, Some(side));
        self
    }

    /// Straight edges with corners rounded off within this distance (length).
    pub fn rounded(mut self, rounding: f64) -> Self {
        self.rounding = Some(rounding);
        self
    }

    /// The first point, from which [`Self::curve`] measures: far from the origin no digits are lost.
    pub(crate) fn origin(&self) -> PlanePoint {
        self.points.first().map_or([0.0; 2], |point| at(point))
    }

    /// The largest coordinate.
    pub(crate) fn reach(&self) -> f64 {
        let origin = self.section.iter().flat_map(|section| &section.origin);
        self.points.iter().flatten().chain(origin).fold(0.0, |largest, value| value.abs().max(largest))
    }

    /// The curve relative to the first point, in the unit of the model.
    pub(crate) fn curve(&self) -> Result<PlaneCurve, CurveMistake> {
        let points: Vec<PlanePoint> = self.relative().collect();
        PlaneCurve::of_polyline(&points, self.closed, self.rounding)
    }

    /// 1 where the free side is to the left of the curve, -1 where it is to the right.
    pub(crate) fn free_side(&self) -> f64 {
        if !self.closed {
            return 1.0;
        }
        let points: Vec<PlanePoint> = self.relative().collect();
        let is_left_inside = doubled_area(&points) > 0.0;
        if is_left_inside == (self.side == Some(Side::Inside)) { 1.0 } else { -1.0 }
    }

    fn relative(&self) -> impl Iterator<Item = PlanePoint> {
        let origin = self.origin();
        self.points.iter().map(move |point| {
            let [x, y] = at(point);
            [x - origin[0], y - origin[1]]
        })
    }
}

/// The first two coordinates; 0 where there are fewer.
fn at(point: &[f64]) -> PlanePoint {
    [0, 1].map(|k| point.get(k).copied().unwrap_or(0.0))
}
