//! Faces of solid elements: segments in the plane, triangles and quadrilaterals in space, in VTK's order of nodes.
//!
//! The nodes of a face run such that its normal points out of the element: counter-clockwise around an element of the
//! plane (the normal is the direction turned clockwise by a quarter), counter-clockwise as seen from outside in space.

use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, SolidKind};
use crate::mechanics::structure::elements::solid::shapes::quadrature::{gauss, triangle_of_degree_4};
use crate::mechanics::structure::elements::solid::shapes::shape_functions::{
    QUADRILATERAL, SEGMENT, ShapePoint, of_cube, of_simplex,
};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Shape and number of nodes of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FaceKind {
    /// Linear segment.
    Segment2,
    /// Quadratic segment, the middle node last.
    Segment3,
    /// Linear triangle.
    Triangle3,
    /// Quadratic triangle.
    Triangle6,
    /// Bilinear quadrilateral.
    Quadrilateral4,
    /// Quadratic quadrilateral of the serendipity family.
    Quadrilateral8,
}

impl FaceKind {
    /// Number of corners, which are the first nodes; middles of edges follow.
    pub fn corners(self) -> usize {
        match self {
            Self::Segment2 | Self::Segment3 => 2,
            Self::Triangle3 | Self::Triangle6 => 3,
            Self::Quadrilateral4 | Self::Quadrilateral8 => 4,
        }
    }

    /// The ends of the edge of each middle, in the order of these nodes.
    pub fn edges_with_middle(self) -> &'static [[usize; 2]] {
        match self {
            Self::Segment2 | Self::Triangle3 | Self::Quadrilateral4 => &[],
            Self::Segment3 => &[[0, 1]],
            Self::Triangle6 => SolidKind::Triangle6.edges_with_middle(),
            Self::Quadrilateral8 => SolidKind::Quadrilateral8.edges_with_middle(),
        }
    }

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            Self::Segment2 => 2,
            Self::Segment3 | Self::Triangle3 => 3,
            Self::Quadrilateral4 => 4,
            Self::Triangle6 => 6,
            Self::Quadrilateral8 => 8,
        }
    }
}

/// The faces of an element: places of their nodes among the element's.
pub fn faces_of(kind: SolidKind) -> (FaceKind, &'static [&'static [usize]]) {
    match kind {
        SolidKind::Triangle3 => (FaceKind::Segment2, &[&[0, 1], &[1, 2], &[2, 0]]),
        SolidKind::Triangle6 => (FaceKind::Segment3, &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]]),
        SolidKind::Quadrilateral4 => (FaceKind::Segment2, &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]]),
        SolidKind::Quadrilateral8 => (FaceKind::Segment3, &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]]),
        SolidKind::Tetrahedron4 => (FaceKind::Triangle3, &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]]),
        SolidKind::Tetrahedron10 => {
            (FaceKind::Triangle6, &[&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[0, 3, 2, 7, 9, 6]])
        }
        SolidKind::Hexahedron8 => (
            FaceKind::Quadrilateral4,
            &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
        ),
        SolidKind::Hexahedron20 => (
            FaceKind::Quadrilateral8,
            &[
                &[0, 3, 2, 1, 11, 10, 9, 8],
                &[4, 5, 6, 7, 12, 13, 14, 15],
                &[0, 1, 5, 4, 8, 17, 12, 16],
                &[1, 2, 6, 5, 9, 18, 13, 17],
                &[2, 3, 7, 6, 10, 19, 14, 18],
                &[3, 0, 4, 7, 11, 16, 15, 19],
            ],
        ),
    }
}

/// The shape functions at a quadrature point of a face with `N` nodes.
#[derive(Debug, Clone, Copy)]
pub struct FacePoint<const N: usize> {
    /// Weight in natural coordinates.
    pub weight: f64,
    /// Values.
    pub values: [f64; N],
    /// Derivatives by the two natural coordinates; the second is 0 on a segment.
    pub gradients: [[f64; 2]; N],
}

impl<const N: usize> FacePoint<N> {
    fn of<const E: usize>(shape: ShapePoint<N, E>) -> Self {
        let gradients = shape.gradients.map(|own| std::array::from_fn(|axis| own.get(axis).copied().unwrap_or(0.0)));
        Self { weight: shape.weight, values: shape.values, gradients }
    }
}

/// Positions of `N` nodes in `D` dimensions that make a face.
pub trait FacePositions<const N: usize, const D: usize> {
    /// The kind of the face.
    const KIND: FaceKind;

    /// The shape functions at the quadrature points.
    fn points() -> &'static [FacePoint<N>];
}

/// Shape functions at the points of a rule, computed once.
macro_rules! face {
    ($nodes:literal, $dimension:literal, $kind:ident, $rule:expr, $functions:expr) => {
        impl FacePositions<$nodes, $dimension> for [[f64; $dimension]; $nodes] {
            const KIND: FaceKind = FaceKind::$kind;

            fn points() -> &'static [FacePoint<$nodes>] {
                static POINTS: LazyLock<Vec<FacePoint<$nodes>>> =
                    LazyLock::new(|| $rule.into_iter().map(|point| FacePoint::of($functions(point))).collect());
                &POINTS
            }
        }
    };
}

face!(2, 2, Segment2, gauss::<1>(2), |point| of_cube(&SEGMENT, point));
face!(3, 2, Segment3, gauss::<1>(3), |point| of_cube(&SEGMENT, point));
face!(3, 3, Triangle3, triangle_of_degree_4(), of_simplex);
face!(6, 3, Triangle6, triangle_of_degree_4(), of_simplex);
face!(4, 3, Quadrilateral4, gauss::<2>(2), |point| of_cube(&QUADRILATERAL, point));
face!(8, 3, Quadrilateral8, gauss::<2>(3), |point| of_cube(&QUADRILATERAL, point));

/// The two tangents of a face at a point; the second is the unit vector out of the plane on a segment.
#[inline(always)]
pub fn tangents<const N: usize, const D: usize>(positions: &[[f64; D]; N], point: &FacePoint<N>) -> [[f64; 3]; 2] {
    let mut tangents = [[0.0; 3]; 2];
    for (position, gradient) in positions.iter().zip(&point.gradients) {
        for (tangent, factor) in tangents.iter_mut().zip(gradient) {
            tangent.iter_mut().zip(position).for_each(|(value, position)| *value += factor * position);
        }
    }
    if D == 2 {
        tangents[1] = [0.0, 0.0, 1.0];
    }
    tangents
}

/// The vector product.
#[inline(always)]
pub fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The thickness, or the circumference around the axis.
#[inline(always)]
pub fn face_thickness<const N: usize, const D: usize>(
    positions: &[[f64; D]; N],
    idealisation: Idealisation,
    point: &FacePoint<N>,
) -> f64 {
    match idealisation {
        Idealisation::Axisymmetric => {
            TAU * positions.iter().zip(&point.values).map(|(position, value)| position[0] * value).sum::<f64>()
        }
        Idealisation::PlaneStrain { thickness } | Idealisation::PlaneStress { thickness } => thickness,
        Idealisation::Space => 1.0,
    }
}
