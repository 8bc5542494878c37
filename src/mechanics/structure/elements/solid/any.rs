//! Solid elements of a kind that is known at run time.

use crate::mechanics::structure::basis_transformation::BasisTransformation;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::FiniteElement;
use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::tensor::Tensor2;
use crate::mechanics::structure::elements::solid::loads::{body_force, dead_traction};
use crate::mechanics::structure::elements::solid::shapes::faces::FaceKind;
use crate::mechanics::structure::elements::solid::shapes::geometry::NodalPositions;
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, LockingMend, SolidKind};
use crate::mechanics::structure::elements::solid::transformed::push_transformed;
use crate::mechanics::structure::elements::solid::{SolidElement, SolidElementError};
use std::sync::Arc;

/// What makes a solid element, apart from its nodes' places.
#[derive(Debug, Clone)]
pub struct SolidData {
    /// Shape and number of nodes.
    pub kind: SolidKind,
    /// What holds in the third direction.
    pub idealisation: Idealisation,
    /// The material, in the unit of stress of the structure.
    pub material: Arc<dyn ElasticMaterial>,
    /// The mend against locking; `None`: the usual one.
    pub mend: Option<LockingMend>,
}

/// A solid element of any kind, on its way into a list of elements of one kind.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "an element is moved once, and kept among others of its kind")]
pub enum AnySolid {
    /// See [`SolidKind`], here and below.
    Triangle3(SolidElement<3, 2>),
    /// Quadratic triangle.
    Triangle6(SolidElement<6, 2>),
    /// Bilinear quadrilateral.
    Quadrilateral4(SolidElement<4, 2>),
    /// Quadratic quadrilateral.
    Quadrilateral8(SolidElement<8, 2>),
    /// Linear tetrahedron.
    Tetrahedron4(SolidElement<4, 3>),
    /// Quadratic tetrahedron.
    Tetrahedron10(SolidElement<10, 3>),
    /// Trilinear hexahedron.
    Hexahedron8(SolidElement<8, 3>),
    /// Quadratic hexahedron.
    Hexahedron20(SolidElement<20, 3>),
}

/// The first `N` nodes and their positions in `D` dimensions; what is missing is 0.
fn element<const N: usize, const D: usize>(
    data: &SolidData,
    nodes: &[usize],
    positions: &[[f64; 3]],
) -> Result<SolidElement<N, D>, SolidElementError>
where
    [[f64; D]; N]: NodalPositions<N, D>,
{
    let own_nodes: [usize; N] = std::array::from_fn(|place| nodes.get(place).copied().unwrap_or(0));
    let own_positions = leading::<N, D>(positions);
    let (idealisation, material) = (data.idealisation, Arc::clone(&data.material));
    match data.mend {
        Some(mend) => SolidElement::with_mend(own_nodes, &own_positions, idealisation, material, mend),
        None => SolidElement::new(own_nodes, &own_positions, idealisation, material),
    }
}

/// The first `N` positions in `D` dimensions.
pub(super) fn leading<const N: usize, const D: usize>(positions: &[[f64; 3]]) -> [[f64; D]; N] {
    std::array::from_fn(|node| std::array::from_fn(|axis| positions.get(node).map_or(0.0, |position| position[axis])))
}

/// Calls an expression with the element of a solid, whatever its kind.
macro_rules! of_any {
    ($solid:expr, $element:ident => $then:expr) => {
        match $solid {
            AnySolid::Triangle3($element) => $then,
            AnySolid::Triangle6($element) => $then,
            AnySolid::Quadrilateral4($element) => $then,
            AnySolid::Quadrilateral8($element) => $then,
            AnySolid::Tetrahedron4($element) => $then,
            AnySolid::Tetrahedron10($element) => $then,
            AnySolid::Hexahedron8($element) => $then,
            AnySolid::Hexahedron20($element) => $then,
        }
    };
}

impl AnySolid {
    /// The element of as many nodes as its kind has, with the positions of the undeformed nodes; in the plane the third
    /// component does not count.
    ///
    /// # Errors
    ///
    /// Where nodes and material make no element.
    pub fn new(data: &SolidData, nodes: &[usize], positions: &[[f64; 3]]) -> Result<Self, SolidElementError> {
        Ok(match data.kind {
            SolidKind::Triangle3 => Self::Triangle3(element(data, nodes, positions)?),
            SolidKind::Triangle6 => Self::Triangle6(element(data, nodes, positions)?),
            SolidKind::Quadrilateral4 => Self::Quadrilateral4(element(data, nodes, positions)?),
            SolidKind::Quadrilateral8 => Self::Quadrilateral8(element(data, nodes, positions)?),
            SolidKind::Tetrahedron4 => Self::Tetrahedron4(element(data, nodes, positions)?),
            SolidKind::Tetrahedron10 => Self::Tetrahedron10(element(data, nodes, positions)?),
            SolidKind::Hexahedron8 => Self::Hexahedron8(element(data, nodes, positions)?),
            SolidKind::Hexahedron20 => Self::Hexahedron20(element(data, nodes, positions)?),
        })
    }

    /// Adds the element at the end of a list, over the unknowns of a basis.
    pub fn add_to(self, list: &mut ElementList, basis: &BasisTransformation) {
        let dimension = of_any!(&self, element => element.kind().dimension());
        of_any!(self, element => {
            let edges = basis.edges_among(element.nodes());
            push_transformed(list, element, &edges, dimension);
        });
    }

    /// Undeformed volume: of the thickness, or the whole revolution.
    pub fn volume(&self) -> f64 {
        of_any!(self, element => element.volume())
    }

    /// The mean strain: see [`SolidElement::mean_strain`].
    pub fn mean_strain(&self, displacement: &[f64]) -> Tensor2 {
        of_any!(self, element => element.mean_strain(displacement))
    }

    /// Calls `each` with the place of each of the element's nodes and its part of a force per undeformed volume.
    pub fn each_body_force(&self, density: [f64; 3], each: &mut dyn FnMut(usize, [f64; 3])) {
        of_any!(self, element => give(&body_force(element, in_dimension(density)), each));
    }
}

/// The first `D` components.
fn in_dimension<const D: usize>(vector: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|axis| vector[axis])
}

/// Calls `each` with the place and the force of each node.
fn give<const N: usize, const D: usize>(forces: &[[f64; D]; N], each: &mut dyn FnMut(usize, [f64; 3])) {
    for (place, force) in forces.iter().enumerate() {
        each(place, std::array::from_fn(|axis| force.get(axis).copied().unwrap_or(0.0)));
    }
}

/// Calls `each` with the place of each node of a face and its part of a dead traction, a force per undeformed area; see
/// [`dead_traction`].
pub fn each_traction_force(
    kind: FaceKind,
    positions: &[[f64; 3]],
    idealisation: Idealisation,
    traction: [f64; 3],
    each: &mut dyn FnMut(usize, [f64; 3]),
) {
    match kind {
        FaceKind::Segment2 => {
            give(&dead_traction(&leading::<2, 2>(positions), idealisation, in_dimension(traction)), each);
        }
        FaceKind::Segment3 => {
            give(&dead_traction(&leading::<3, 2>(positions), idealisation, in_dimension(traction)), each);
        }
        FaceKind::Triangle3 => give(&dead_traction(&leading::<3, 3>(positions), idealisation, traction), each),
        FaceKind::Triangle6 => give(&dead_traction(&leading::<6, 3>(positions), idealisation, traction), each),
        FaceKind::Quadrilateral4 => give(&dead_traction(&leading::<4, 3>(positions), idealisation, traction), each),
        FaceKind::Quadrilateral8 => give(&dead_traction(&leading::<8, 3>(positions), idealisation, traction), each),
    }
}
