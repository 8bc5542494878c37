//! The frame of a contact: gap, normal and tangents, and their change with the position.

use crate::mechanics::contact::tolerances::EQUALLY_ALIGNED;
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};

/// The directions in which a closed contact can slide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sliding {
    /// None: the supports of the node leave no tangential motion.
    None,
    /// Along the line perpendicular to the normal and to the unit vector `across`: in 2D, where `across` is the third
    /// axis, and in 3D for a node with one supported component.
    Line { across: Vector },
    /// Along any tangent.
    Plane,
}

impl Sliding {
    /// Number of independent directions.
    pub fn directions(self) -> usize {
        match self {
            Self::None => 0,
            Self::Line { .. } => 1,
            Self::Plane => 2,
        }
    }
}

/// The gap, the unit normal into the free side and the tangents of a contact.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub gap: f64,
    pub normal: Vector,
    /// Orthonormal tangents, as many as there are directions of sliding; the others are zero.
    pub tangents: [Vector; 2],
    pub curvature: Curvature,
    sliding: Sliding,
}

/// How the normal turns with the position on an obstacle: `dn = W dx` with the shape operator
/// `W = κ₁ (I - n nᵀ) - (κ₁ - κ₂) a aᵀ`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Curvature {
    /// `κ₁`, the one principal curvature; 0 for planes. One over a length, dimensionless.
    pub value: f64,
    /// `κ₁ - κ₂`, by how much the other one is less; 0 for balls, `κ₁` for cylinders.
    pub less: f64,
    /// `a`, the unit tangent along the other one; zero where both are equal.
    pub along: Vector,
}

impl Curvature {
    /// The same in all tangential directions, or in the only one.
    pub fn uniform(value: f64) -> Self {
        Self { value, less: 0.0, along: [0.0; 3] }
    }

    /// That of a surface which is straight along a unit vector.
    pub fn around(value: f64, straight: Vector) -> Self {
        Self { value, less: value, along: straight }
    }

    pub fn is_zero(&self) -> bool {
        self.value == 0.0 && self.less == 0.0
    }
}

impl Frame {
    #[inline(always)]
    pub(super) fn new(gap: f64, normal: Vector, curvature: Curvature, sliding: Sliding) -> Self {
        let tangents = match sliding {
            Sliding::None => [[0.0; 3]; 2],
            // In 2D the tangent is the normal turned clockwise by a right angle, without rounding.
            Sliding::Line { across } if across == [0.0, 0.0, 1.0] && normal[2] == 0.0 => {
                [[normal[1], -normal[0], 0.0], [0.0; 3]]
            }
            Sliding::Line { across } => [unit(&cross(&normal, &across)), [0.0; 3]],
            Sliding::Plane => tangents_in_space(&normal),
        };
        Self { gap, normal, tangents, curvature, sliding }
    }

    /// The change `W dx` of the normal with a motion.
    pub fn normal_change(&self, motion: &Vector) -> Vector {
        let Curvature { value, less, along } = &self.curvature;
        let tangential = add(motion, -dot(motion, &self.normal), &self.normal);
        add(&scaled(&tangential, *value), -less * dot(motion, along), along)
    }

    /// The matrix `W`.
    pub fn shape_operator(&self) -> [Vector; 3] {
        let axes: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        axes.map(|axis| self.normal_change(&axis))
    }

    /// The entry `t·W s` of the shape operator for two perpendicular tangents.
    pub fn curvature_across(&self, first: &Vector, second: &Vector) -> f64 {
        let Curvature { less, along, .. } = &self.curvature;
        -less * dot(first, along) * dot(second, along)
    }

    /// The normal curvature `t·W t` along a unit tangent.
    pub fn curvature_along(&self, tangent: &Vector) -> f64 {
        let along = dot(tangent, &self.curvature.along);
        self.curvature.value - self.curvature.less * along * along
    }

    /// The change of the first tangent with a motion, where sliding is along a line.
    pub fn tangent_change(&self, motion: &Vector) -> Vector {
        let Sliding::Line { across } = self.sliding else { return [0.0; 3] };
        if self.curvature.is_zero() {
            return [0.0; 3];
        }
        let turn = cross(&self.normal_change(motion), &across);
        let tangent = &self.tangents[0];
        scaled(&add(&turn, -dot(&turn, tangent), tangent), 1.0 / size(&cross(&self.normal, &across)))
    }
}

/// Orthonormal tangents to a normal in space: the coordinate axis least aligned with the normal, made perpendicular to
/// the normal, and the cross product of `n` with this tangent. Of axes that are equally aligned but for round-off it is
/// the first: at the top of a ball two are, and without a tolerance the tangents would change places at random.
pub fn tangents_in_space(normal: &Vector) -> [Vector; 2] {
    let sizes = normal.map(f64::abs);
    let least = sizes[0].min(sizes[1]).min(sizes[2]) + EQUALLY_ALIGNED;
    let axis = sizes.iter().position(|size| *size <= least).unwrap_or(0);
    let mut along = [0.0; 3];
    along[axis] = 1.0;
    let first = unit(&add(&along, -normal[axis], normal));
    [first, cross(normal, &first)]
}
