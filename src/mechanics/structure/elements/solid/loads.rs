//! Loads on solids: consistent nodal forces `f_a = ∫ N_a b dV`, `∫ N_a t dA`, and of a pressure that follows its surface,
//!
//! ```text
//! f_a = -p ∫ N_a n da,     n da = x_,ξ × x_,η dξ dη
//! ```
//!
//! on the deformed face `x = X + u`, whose derivative by `u` is not symmetric (J. Bonet, R. D. Wood, *Nonlinear Continuum
//! Mechanics for Finite Element Analysis*, Cambridge 2008, section 8.5). A positive pressure presses on the body; the
//! orientation of faces is that of [`faces`](crate::mechanics::structure::elements::solid::shapes::faces). Forces are for
//! the thickness or the whole revolution. In plane stress the thickness counts as undeformed.

use crate::mechanics::structure::elements::solid::SolidElement;
use crate::mechanics::structure::elements::solid::formulations::nodal_sums::Nodal;
use crate::mechanics::structure::elements::solid::shapes::faces::{
    FacePoint, FacePositions, cross, face_thickness, tangents,
};
use crate::mechanics::structure::elements::solid::shapes::kind::Idealisation;
use std::f64::consts::TAU;

/// The nodal forces of a force per undeformed volume.
pub fn body_force<const N: usize, const D: usize>(element: &SolidElement<N, D>, density: [f64; D]) -> Nodal<N, D> {
    let mut forces = [[0.0; D]; N];
    let geometry = &element.body.geometry;
    for shape in element.body.shape {
        let volume = shape.weight * geometry.jacobian_determinant(shape) * geometry.thickness_at(shape);
        for (force, value) in forces.iter_mut().zip(&shape.values) {
            force.iter_mut().zip(&density).for_each(|(force, density)| *force += volume * value * density);
        }
    }
    forces
}

/// The nodal forces of a dead traction, a force per undeformed area, on a face of undeformed positions.
pub fn dead_traction<const N: usize, const D: usize>(
    positions: &[[f64; D]; N],
    idealisation: Idealisation,
    traction: [f64; D],
) -> Nodal<N, D>
where
    [[f64; D]; N]: FacePositions<N, D>,
{
    let mut forces = [[0.0; D]; N];
    for point in <[[f64; D]; N]>::points() {
        let [first, second] = tangents(positions, point);
        let size = cross(&first, &second).iter().map(|value| value * value).sum::<f64>().sqrt();
        let area = size * point.weight * face_thickness(positions, idealisation, point);
        for (force, value) in forces.iter_mut().zip(&point.values) {
            force.iter_mut().zip(&traction).for_each(|(force, traction)| *force += area * value * traction);
        }
    }
    forces
}

/// The nodal forces of a pressure on a face of deformed positions.
pub fn pressure_force<const N: usize, const D: usize>(
    positions: &[[f64; D]; N],
    idealisation: Idealisation,
    pressure: f64,
) -> Nodal<N, D>
where
    [[f64; D]; N]: FacePositions<N, D>,
{
    let mut forces = [[0.0; D]; N];
    for point in <[[f64; D]; N]>::points() {
        let [first, second] = tangents(positions, point);
        let normal = cross(&first, &second);
        let factor = -pressure * point.weight * face_thickness(positions, idealisation, point);
        for (force, value) in forces.iter_mut().zip(&point.values) {
            force.iter_mut().zip(&normal).for_each(|(force, normal)| *force += factor * value * normal);
        }
    }
    forces
}

/// Writes the derivatives of [`pressure_force`] by the positions, row by row: the entry of the force component `i` at node
/// `a` and of the position component `k` of node `b` stands in row `D a + i`, column `D b + k`. Entries that do not fit are
/// left out.
pub fn write_pressure_stiffness<const N: usize, const D: usize>(
    positions: &[[f64; D]; N],
    idealisation: Idealisation,
    pressure: f64,
    stiffness: &mut [f64],
) where
    [[f64; D]; N]: FacePositions<N, D>,
{
    stiffness.fill(0.0);
    for point in <[[f64; D]; N]>::points() {
        let factor = -pressure * point.weight;
        let slopes = normal_slopes(positions, idealisation, point);
        for (rows, value) in stiffness.chunks_exact_mut(D * N * D).zip(&point.values) {
            for (row, entries) in rows.chunks_exact_mut(N * D).enumerate() {
                let columns = entries.iter_mut().zip(slopes.iter().flatten());
                columns.for_each(|(entry, slope)| *entry += factor * value * slope[row]);
            }
        }
    }
}

/// The derivatives of the normal times the thickness, by each component of the position of each node.
fn normal_slopes<const N: usize, const D: usize>(
    positions: &[[f64; D]; N],
    idealisation: Idealisation,
    point: &FacePoint<N>,
) -> [[[f64; 3]; D]; N] {
    let [first, second] = tangents(positions, point);
    let thickness = face_thickness(positions, idealisation, point);
    let normal = cross(&first, &second);
    std::array::from_fn(|node| {
        let [along_first, along_second] = point.gradients[node];
        std::array::from_fn(|axis| {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let (by_first, by_second) = (cross(&unit, &second), cross(&first, &unit));
            // The radius changes the circumference.
            let is_radius = axis == 0 && matches!(idealisation, Idealisation::Axisymmetric);
            let by_radius = if is_radius { TAU * point.values[node] } else { 0.0 };
            std::array::from_fn(|row| {
                thickness * (along_first * by_first[row] + along_second * by_second[row]) + by_radius * normal[row]
            })
        })
    })
}
