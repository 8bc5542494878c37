//! The kinds of solid elements, the idealisations of the plane and the mends against locking.

use crate::mechanics::structure::elements::materials::ElasticModuli;
use serde::{Deserialize, Serialize};

/// Shape and number of nodes; the nodes are in the order of the VTK file format (`VTK_TRIANGLE`,
/// `VTK_QUADRATIC_TRIANGLE`, …, `VTK_QUADRATIC_HEXAHEDRON`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SolidKind {
    /// Linear triangle. It locks in bending and where nearly incompressible.
    Triangle3,
    /// Quadratic triangle.
    Triangle6,
    /// Bilinear quadrilateral.
    Quadrilateral4,
    /// Quadratic quadrilateral of the serendipity family.
    Quadrilateral8,
    /// Linear tetrahedron. It locks in bending and where nearly incompressible.
    Tetrahedron4,
    /// Quadratic tetrahedron.
    Tetrahedron10,
    /// Trilinear hexahedron.
    Hexahedron8,
    /// Quadratic hexahedron of the serendipity family.
    Hexahedron20,
}

/// What the displacement out of the plane is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Idealisation {
    /// None: the strain out of the plane is 0.
    PlaneStrain {
        /// Length out of the plane that energies and forces are for.
        thickness: f64,
    },
    /// Such that the stress out of the plane is 0.
    PlaneStress {
        /// Undeformed thickness.
        thickness: f64,
    },
    /// A body of revolution about the axis `y`, with the radius `x`; energies and forces are those of the whole
    /// revolution.
    Axisymmetric,
    /// No plane: a body in space.
    Space,
}

/// A mend against locking: which part of the deformation gradient the energy sees as a mean over the element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum LockingMend {
    /// None: the energy at each quadrature point. Against shear and volumetric locking of quadratic elements the number
    /// of their points suffices; linear elements lock.
    None,
    /// All of it, with an energy for the inhomogeneous part: see
    /// [`mean_gradient`](crate::mechanics::structure::elements::solid::formulations::mean_gradient). For quadrilaterals of 4 and
    /// hexahedra of 8 nodes.
    MeanGradient,
    /// The volume: see [`mean_dilatation`](crate::mechanics::structure::elements::solid::formulations::mean_dilatation). Not in plane
    /// stress, where the thickness follows.
    MeanDilatation,
}

/// Poisson's ratio above which a material counts as nearly incompressible: from about here on quadratic elements of
/// full integration lose accuracy to volumetric locking.
pub const NEARLY_INCOMPRESSIBLE: f64 = 0.45;

/// Rounding of a Poisson's ratio that follows from other moduli.
const ROUNDING_OF_RATIO: f64 = 1e-12;

/// The edges of a tetrahedron; the first three are those of a triangle.
pub(super) const EDGES_OF_SIMPLEX: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// The edges of a hexahedron; the first four are those of a quadrilateral.
const EDGES_OF_CUBE: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl SolidKind {
    /// All kinds, in the order of their declaration.
    pub const ALL: [Self; 8] = [
        Self::Triangle3,
        Self::Triangle6,
        Self::Quadrilateral4,
        Self::Quadrilateral8,
        Self::Tetrahedron4,
        Self::Tetrahedron10,
        Self::Hexahedron8,
        Self::Hexahedron20,
    ];

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            Self::Triangle3 => 3,
            Self::Quadrilateral4 | Self::Tetrahedron4 => 4,
            Self::Triangle6 => 6,
            Self::Quadrilateral8 | Self::Hexahedron8 => 8,
            Self::Tetrahedron10 => 10,
            Self::Hexahedron20 => 20,
        }
    }

    /// The ends of the edges with a node in their middle, in the order of these nodes, which follow the corners.
    pub fn edges_with_middle(self) -> &'static [[usize; 2]] {
        match self {
            Self::Triangle3 | Self::Quadrilateral4 | Self::Tetrahedron4 | Self::Hexahedron8 => &[],
            Self::Triangle6 => &EDGES_OF_SIMPLEX[..3],
            Self::Tetrahedron10 => &EDGES_OF_SIMPLEX,
            Self::Quadrilateral8 => &EDGES_OF_CUBE[..4],
            Self::Hexahedron20 => &EDGES_OF_CUBE,
        }
    }

    /// Number of dimensions of the space it fills.
    pub fn dimension(self) -> usize {
        match self {
            Self::Triangle3 | Self::Triangle6 | Self::Quadrilateral4 | Self::Quadrilateral8 => 2,
            Self::Tetrahedron4 | Self::Tetrahedron10 | Self::Hexahedron8 | Self::Hexahedron20 => 3,
        }
    }
}

impl Idealisation {
    /// Number of dimensions of the displacements.
    pub fn dimension(self) -> usize {
        match self {
            Self::PlaneStrain { .. } | Self::PlaneStress { .. } | Self::Axisymmetric => 2,
            Self::Space => 3,
        }
    }

    /// The length out of the plane; 1 in space and for a revolution, whose circumference is counted apart.
    pub fn thickness(self) -> f64 {
        match self {
            Self::PlaneStrain { thickness } | Self::PlaneStress { thickness } => thickness,
            Self::Axisymmetric | Self::Space => 1.0,
        }
    }
}

impl LockingMend {
    /// The mend that an element gets unless another is asked for.
    pub fn usual(kind: SolidKind, idealisation: Idealisation, moduli: &ElasticModuli) -> Self {
        match kind {
            SolidKind::Triangle3 | SolidKind::Tetrahedron4 => Self::None,
            SolidKind::Quadrilateral4 | SolidKind::Hexahedron8 => Self::MeanGradient,
            SolidKind::Triangle6 | SolidKind::Quadrilateral8 | SolidKind::Tetrahedron10 | SolidKind::Hexahedron20 => {
                let has_free_thickness = matches!(idealisation, Idealisation::PlaneStress { .. });
                // The ratio of rounded moduli: the bound itself is below it in any units.
                if moduli.poisson() > NEARLY_INCOMPRESSIBLE + ROUNDING_OF_RATIO && !has_free_thickness {
                    Self::MeanDilatation
                } else {
                    Self::None
                }
            }
        }
    }

    /// Whether there is such an element.
    pub fn suits(self, kind: SolidKind, idealisation: Idealisation) -> bool {
        match self {
            Self::None => true,
            Self::MeanGradient => matches!(kind, SolidKind::Quadrilateral4 | SolidKind::Hexahedron8),
            Self::MeanDilatation => !matches!(idealisation, Idealisation::PlaneStress { .. }),
        }
    }
}
