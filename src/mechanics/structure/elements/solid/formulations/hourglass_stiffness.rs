//! The stiffness against inhomogeneous strains, from the linear elastic element of enhanced strains on the undeformed
//! geometry.
//!
//! Let `ε_u = B u` be the compatible strain and `ε_α` strains of zero mean, each on its own in the element:
//!
//! ```text
//! ε_α = (j₀/j) J₀⁻ᵀ Ê_α J₀⁻¹,     ½ u·K u = min_α ½ ∫ (ε_u + ε_α) : C : (ε_u + ε_α) dV = ½ V ε̄_u : C : ε̄_u + ½ z·H z
//! ```
//!
//! (J. C. Simo, M. S. Rifai, Int. J. Numer. Methods Eng. 29 (1990) 1595, doi:10.1002/nme.1620290802.) The second equation
//! holds since `K` passes the patch test, and defines `H`; as `ε_α` has no mean, `H` is not negative. In the plane `Ê` are
//! the four strains of the incompatible modes `1 - ξ²`, `1 - η²`, with which bending is exact on rectangles (R. L. Taylor,
//! P. J. Beresford, E. L. Wilson, Int. J. Numer. Methods Eng. 10 (1976) 1211, doi:10.1002/nme.1620100602); around an axis
//! there is also `ξη`; in space there are nine, and three of volume, `ξη, ηζ, ζξ`, without which the mode `ξηζ` locks (J.
//! C. Simo, F. Armero, R. L. Taylor, Comput. Methods Appl. Mech. Eng. 110 (1993) 359, doi:10.1016/0045-7825(93)90215-J).

use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::ElasticModuli;
use crate::mechanics::structure::elements::materials::linear_elastic::LinearElastic;
use crate::mechanics::structure::elements::materials::tensor::{
    IDENTITY, Tensor2, contraction, product, scaled, sum, transpose,
};
use crate::mechanics::structure::elements::solid::formulations::mean_gradient::MeanGradient;
use crate::mechanics::structure::elements::solid::shapes::geometry::{PointGeometry, ReferenceGeometry};
use crate::mechanics::structure::elements::solid::shapes::kind::Idealisation;
use crate::mechanics::structure::elements::solid::shapes::shape_functions::{
    HEXAHEDRON, QUADRILATERAL, ShapePoint, of_cube,
};
use nalgebra::DMatrix;

/// An enhanced strain in natural coordinates: the product of these coordinates times the symmetric part of the dyad of
/// two axes, or times the identity.
struct EnhancedStrain {
    along: &'static [usize],
    dyad: Option<[usize; 2]>,
}

/// `along` times the dyad.
const fn strain(along: &'static [usize], one: usize, other: usize) -> EnhancedStrain {
    EnhancedStrain { along, dyad: Some([one, other]) }
}

const IN_PLANE: [EnhancedStrain; 4] = [strain(&[0], 0, 0), strain(&[1], 1, 1), strain(&[0], 0, 1), strain(&[1], 0, 1)];

const AROUND_AXIS: EnhancedStrain = strain(&[0, 1], 2, 2);

const IN_SPACE: [EnhancedStrain; 12] = [
    strain(&[0], 0, 0),
    strain(&[1], 1, 1),
    strain(&[2], 2, 2),
    strain(&[0], 0, 1),
    strain(&[1], 0, 1),
    strain(&[1], 1, 2),
    strain(&[2], 1, 2),
    strain(&[0], 0, 2),
    strain(&[2], 0, 2),
    EnhancedStrain { along: &[0, 1], dyad: None },
    EnhancedStrain { along: &[1, 2], dyad: None },
    EnhancedStrain { along: &[0, 2], dyad: None },
];

/// The matrix `H`, row by row; `None` where the element is so distorted that it is singular.
pub fn hourglass_stiffness<const N: usize, const D: usize, const S: usize>(
    geometry: &ReferenceGeometry<N, D>,
    shape: &[ShapePoint<N, D>],
    mean: &MeanGradient<N, D>,
    moduli: ElasticModuli,
) -> Option<Vec<f64>> {
    let material = linear_law(geometry.idealisation, moduli);
    let motions = unit_motions(mean)?;
    let enhanced: Vec<&EnhancedStrain> = match geometry.idealisation {
        Idealisation::Space => IN_SPACE.iter().collect(),
        Idealisation::Axisymmetric => IN_PLANE.iter().chain([&AROUND_AXIS]).collect(),
        Idealisation::PlaneStrain { .. } | Idealisation::PlaneStress { .. } => IN_PLANE.iter().collect(),
    };
    let centre = centre_of::<N, D>();
    let frame = geometry.inverse_jacobian(&centre);
    let density = |point: &ShapePoint<N, D>| geometry.jacobian_determinant(point) * geometry.thickness_at(point);
    let of_mean: Vec<Tensor2> = motions.iter().map(|motion| strain_of::<N, D, S>(motion, &mean.slots::<S>())).collect();
    let count = motions.len();
    let mut gram: DMatrix<f64> = DMatrix::zeros(count + enhanced.len(), count + enhanced.len());
    for point in shape {
        let at: PointGeometry<N, S> = geometry.at(point);
        let compatible = motions.iter().zip(&of_mean);
        let mut strains: Vec<Tensor2> =
            compatible.map(|(motion, mean)| sum(&strain_of::<N, D, S>(motion, &at.slots), -1.0, mean)).collect();
        let ratio = density(&centre) / density(point);
        strains.extend(enhanced.iter().map(|enhanced| scaled(ratio, &enhanced_strain(enhanced, &frame, &point.place))));
        let stresses: Vec<Tensor2> = strains.iter().map(|strain| material.stress(strain)).collect();
        for (row, strain) in strains.iter().enumerate() {
            for (column, stress) in stresses.iter().enumerate() {
                gram[(row, column)] += at.volume * contraction(strain, stress);
            }
        }
    }
    let split = |row: usize, column: usize, size: (usize, usize)| gram.view((row, column), size).into_owned();
    let coupling = split(count, 0, (enhanced.len(), count));
    let own = split(count, count, (enhanced.len(), enhanced.len())).cholesky()?;
    let condensed: DMatrix<f64> = split(0, 0, (count, count)) - coupling.transpose() * own.solve(&coupling);
    let symmetric = (&condensed + condensed.transpose()) * 0.5;
    symmetric.clone().cholesky()?;
    Some(symmetric.as_slice().to_vec())
}

/// The material of small strains; in plane stress with the modulus that leaves the strain out of the plane at 0.
fn linear_law(idealisation: Idealisation, moduli: ElasticModuli) -> LinearElastic {
    let ElasticModuli { shear, lame } = moduli;
    let lame = match idealisation {
        Idealisation::PlaneStress { .. } => 2.0 * lame * shear / (lame + 2.0 * shear),
        Idealisation::PlaneStrain { .. } | Idealisation::Axisymmetric | Idealisation::Space => lame,
    };
    LinearElastic { moduli: ElasticModuli { shear, lame } }
}

/// The shape functions at the centre.
fn centre_of<const N: usize, const D: usize>() -> ShapePoint<N, D> {
    let corner = |node: usize| -> [f64; D] {
        std::array::from_fn(|axis| if D == 2 { QUADRILATERAL[node][axis] } else { HEXAHEDRON[node][axis] })
    };
    let corners: [[f64; D]; N] = std::array::from_fn(corner);
    of_cube(&corners, ([0.0; D], 1.0))
}

/// Displacements of the nodes, each with one inhomogeneous strain of 1 and the others 0.
fn unit_motions<const N: usize, const D: usize>(mean: &MeanGradient<N, D>) -> Option<Vec<[[f64; D]; N]>> {
    let count = mean.strains();
    let mut slopes: DMatrix<f64> = DMatrix::zeros(count, N * D);
    for node in 0..N {
        for (row, slope) in mean.slopes_at_rest(node).iter().enumerate().take(count) {
            slope.iter().enumerate().for_each(|(axis, value)| slopes[(row, node * D + axis)] = *value);
        }
    }
    let gram = &slopes * slopes.transpose();
    let motions = slopes.transpose() * gram.cholesky()?.inverse();
    let motion =
        |column: usize| std::array::from_fn(|node| std::array::from_fn(|axis| motions[(node * D + axis, column)]));
    Some((0..count).map(motion).collect())
}

/// The strain of a motion of the nodes.
fn strain_of<const N: usize, const D: usize, const S: usize>(motion: &[[f64; D]; N], slots: &[[f64; S]; N]) -> Tensor2 {
    let mut gradient = [[0.0; 3]; 3];
    for (motion, slots) in motion.iter().zip(slots) {
        for (row, value) in gradient.iter_mut().zip(motion) {
            row.iter_mut().zip(slots).take(D).for_each(|(entry, slot)| *entry += value * slot);
        }
        if S > D {
            gradient[2][2] += motion[0] * slots[S - 1];
        }
    }
    scaled(0.5, &sum(&gradient, 1.0, &transpose(&gradient)))
}

/// An enhanced strain at a place, in the axes of the structure; `frame`: `J₀⁻¹`.
fn enhanced_strain<const D: usize>(strain: &EnhancedStrain, frame: &Tensor2, place: &[f64; D]) -> Tensor2 {
    let factor: f64 = strain.along.iter().map(|axis| place[*axis]).product();
    let Some([one, other]) = strain.dyad else { return scaled(factor, &IDENTITY) };
    let mut natural = [[0.0; 3]; 3];
    natural[one][other] += 0.5 * factor;
    natural[other][one] += 0.5 * factor;
    product(&transpose(frame), &product(&natural, frame))
}
