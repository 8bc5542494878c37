//! The undeformed geometry of an element: from natural coordinates to lengths.
//!
//! What the displacement `u_a` of node `a` adds to the displacement gradient is written with *slots*, `h_is = Σ_a u_ai g_as`:
//! the slots `g_as` of a node are the derivatives of its shape function by the undeformed coordinates and, in a body of
//! revolution, `N_a/R` in a third slot, so that `h_02` is the strain around the axis.

use crate::mechanics::structure::elements::materials::tensor::{IDENTITY, cofactor, determinant};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, SolidKind};
use crate::mechanics::structure::elements::solid::shapes::quadrature::{
    centroid, gauss, interior, triangle_of_degree_4,
};
use crate::mechanics::structure::elements::solid::shapes::shape_functions::{
    HEXAHEDRON, QUADRILATERAL, ShapePoint, of_cube, of_simplex,
};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Undeformed positions of `N` nodes in `D` dimensions.
#[derive(Debug, Clone)]
pub struct ReferenceGeometry<const N: usize, const D: usize> {
    /// Relative to the first node, so that small elements far from the origin keep their digits.
    pub positions: [[f64; D]; N],
    /// Distance of the first node from the axis, for bodies of revolution.
    pub radius: f64,
    /// The idealisation of the plane.
    pub idealisation: Idealisation,
}

/// A quadrature point: its undeformed volume and the slots of the nodes, per length.
#[derive(Debug, Clone, Copy)]
pub struct PointGeometry<const N: usize, const S: usize> {
    /// Volume that the point stands for.
    pub volume: f64,
    /// Slots of the nodes.
    pub slots: [[f64; S]; N],
}

impl<const N: usize, const D: usize> ReferenceGeometry<N, D> {
    /// From the positions of the nodes; only differences are kept.
    pub fn new(positions: &[[f64; D]; N], idealisation: Idealisation) -> Self {
        let origin = positions[0];
        let relative = |position: &[f64; D]| std::array::from_fn(|axis| position[axis] - origin[axis]);
        Self { positions: std::array::from_fn(|node| relative(&positions[node])), radius: origin[0], idealisation }
    }

    /// The derivatives `∂X_i/∂ξ_j` of the position by the natural coordinates, extended by a 1 in the plane.
    #[inline(always)]
    fn jacobian(&self, shape: &ShapePoint<N, D>) -> [[f64; 3]; 3] {
        let mut jacobian = IDENTITY;
        for (axis, row) in jacobian.iter_mut().enumerate().take(D) {
            for (natural, value) in row.iter_mut().enumerate().take(D) {
                let parts = self.positions.iter().zip(&shape.gradients);
                *value = parts.map(|(position, gradient)| position[axis] * gradient[natural]).sum();
            }
        }
        jacobian
    }

    /// Volume per natural volume, without the thickness or circumference; not positive where the element is inverted.
    pub fn jacobian_determinant(&self, shape: &ShapePoint<N, D>) -> f64 {
        determinant(&self.jacobian(shape))
    }

    /// The derivatives `∂ξ_j/∂X_i` in row `j`, extended by a 1 in the plane.
    pub fn inverse_jacobian(&self, shape: &ShapePoint<N, D>) -> [[f64; 3]; 3] {
        let jacobian = self.jacobian(shape);
        let (cofactor, determinant) = (cofactor(&jacobian), determinant(&jacobian));
        std::array::from_fn(|row| std::array::from_fn(|column| cofactor[column][row] / determinant))
    }

    /// Distance from the axis of revolution.
    #[inline(always)]
    pub fn radius_at(&self, shape: &ShapePoint<N, D>) -> f64 {
        self.radius + self.positions.iter().zip(&shape.values).map(|(position, value)| position[0] * value).sum::<f64>()
    }

    /// Undeformed position relative to the first node.
    pub fn position_at(&self, shape: &ShapePoint<N, D>) -> [f64; D] {
        std::array::from_fn(|axis| {
            self.positions.iter().zip(&shape.values).map(|(position, value)| position[axis] * value).sum()
        })
    }

    /// The thickness, or the circumference at a point of a body of revolution.
    #[inline(always)]
    pub fn thickness_at(&self, shape: &ShapePoint<N, D>) -> f64 {
        match self.idealisation {
            Idealisation::Axisymmetric => TAU * self.radius_at(shape),
            Idealisation::PlaneStrain { thickness } | Idealisation::PlaneStress { thickness } => thickness,
            Idealisation::Space => 1.0,
        }
    }

    /// A quadrature point with `S` slots: `D`, or 3 in a body of revolution.
    #[inline(always)]
    pub fn at<const S: usize>(&self, shape: &ShapePoint<N, D>) -> PointGeometry<N, S> {
        let jacobian = self.jacobian(shape);
        let cofactor = cofactor(&jacobian);
        let determinant = determinant(&jacobian);
        let scale = 1.0 / determinant;
        let mut slots = [[0.0; S]; N];
        for (slots, gradient) in slots.iter_mut().zip(&shape.gradients) {
            for (slot, row) in slots.iter_mut().zip(&cofactor).take(D) {
                *slot = scale * row.iter().zip(gradient).map(|(value, gradient)| value * gradient).sum::<f64>();
            }
        }
        if S > D {
            let per_radius = 1.0 / self.radius_at(shape);
            for (slots, value) in slots.iter_mut().zip(&shape.values) {
                slots[S - 1] = value * per_radius;
            }
        }
        PointGeometry { volume: shape.weight * determinant * self.thickness_at(shape), slots }
    }
}

/// Undeformed positions that make one of the kinds of elements.
pub trait NodalPositions<const N: usize, const D: usize> {
    /// The kind with as many nodes.
    const KIND: SolidKind;

    /// The shape functions at the quadrature points.
    fn shape(idealisation: Idealisation) -> &'static [ShapePoint<N, D>];
}

/// Shape functions at the points of a rule, and of another around an axis, computed once.
macro_rules! kind {
    ($nodes:literal, $dimension:literal, $kind:ident, $rule:expr, $around_axis:expr, $functions:expr) => {
        impl NodalPositions<$nodes, $dimension> for [[f64; $dimension]; $nodes] {
            const KIND: SolidKind = SolidKind::$kind;

            fn shape(idealisation: Idealisation) -> &'static [ShapePoint<$nodes, $dimension>] {
                static SHAPE: LazyLock<Vec<ShapePoint<$nodes, $dimension>>> =
                    LazyLock::new(|| $rule.into_iter().map($functions).collect());
                static AROUND_AXIS: LazyLock<Vec<ShapePoint<$nodes, $dimension>>> =
                    LazyLock::new(|| $around_axis.into_iter().map($functions).collect());
                if idealisation == Idealisation::Axisymmetric { &AROUND_AXIS } else { &SHAPE }
            }
        }
    };
    ($nodes:literal, $dimension:literal, $kind:ident, $rule:expr, $functions:expr) => {
        kind!($nodes, $dimension, $kind, $rule, $rule, $functions);
    };
}

// Around an axis the strain varies more: with the fewest points a cross-section could turn without resistance.
kind!(3, 2, Triangle3, centroid::<2>(), interior::<2>(), of_simplex);
kind!(6, 2, Triangle6, interior::<2>(), triangle_of_degree_4(), of_simplex);
kind!(4, 2, Quadrilateral4, gauss::<2>(2), |point| of_cube(&QUADRILATERAL, point));
kind!(8, 2, Quadrilateral8, gauss::<2>(3), |point| of_cube(&QUADRILATERAL, point));
kind!(4, 3, Tetrahedron4, centroid::<3>(), of_simplex);
kind!(10, 3, Tetrahedron10, interior::<3>(), of_simplex);
kind!(8, 3, Hexahedron8, gauss::<3>(2), |point| of_cube(&HEXAHEDRON, point));
kind!(20, 3, Hexahedron20, gauss::<3>(3), |point| of_cube(&HEXAHEDRON, point));
