//! Patch tests: a homogeneous deformation of a distorted mesh is in equilibrium, with the stress of the material.

use super::meshes::{Mesh, distorted, materials, neo_hookean, variants};
use super::structures::Solids;
use crate::mechanics::structure::elements::Resultants;
use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::materials::tensor::{IDENTITY, Tensor2, product, scaled, sum, transpose};
use crate::mechanics::structure::elements::solid::formulations::response::ConstitutiveLaw;
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, SolidKind};
use std::sync::Arc;

/// A homogeneous displacement gradient that the idealisation allows.
pub fn homogeneous(idealisation: Idealisation) -> Tensor2 {
    match idealisation {
        // Around an axis a homogeneous shear is not in equilibrium without body forces.
        Idealisation::Axisymmetric => [[0.2, 0.0, 0.0], [0.0, -0.15, 0.0], [0.0, 0.0, 0.2]],
        Idealisation::Space => [[0.2, -0.1, 0.15], [0.3, -0.15, 0.1], [-0.2, 0.05, 0.1]],
        _ => [[0.2, -0.1, 0.0], [0.3, -0.15, 0.0], [0.0, 0.0, 0.0]],
    }
}

/// The gradient with the thickness that plane stress has.
fn completed(material: &Arc<dyn ElasticMaterial>, idealisation: Idealisation, gradient: Tensor2) -> Tensor2 {
    let is_plane_stress = matches!(idealisation, Idealisation::PlaneStress { .. });
    if !is_plane_stress {
        return gradient;
    }
    let law = ConstitutiveLaw { material: material.clone(), is_plane_stress };
    let [[a, b, _], [c, d, _], _] = gradient;
    law.gradient::<2, 2>(&[[a, b], [c, d]]).unwrap()
}

fn moved(mesh: &Mesh, gradient: &Tensor2) -> Vec<f64> {
    let dimension = mesh.kind.dimension();
    let of = |position: &[f64; 3]| {
        let moved = gradient.map(|row| row.iter().zip(position).map(|(entry, value)| entry * value).sum::<f64>());
        (0..dimension).map(move |axis| moved[axis])
    };
    mesh.positions.iter().flat_map(of).collect()
}

#[test]
fn homogeneous_deformations_are_in_equilibrium_on_distorted_meshes() {
    let mut all = materials();
    all.push(neo_hookean(0.4999));
    for (kind, idealisation, mend) in variants() {
        let mesh = distorted(kind, 2);
        let inside: Vec<usize> = (0..mesh.positions.len()).filter(|node| !mesh.is_outside(*node)).collect();
        assert!(!inside.is_empty());
        for material in &all {
            let solids = Solids::new(&mesh, idealisation, material, Some(mend));
            let gradient = homogeneous(idealisation);
            let displacement = moved(&mesh, &gradient);
            let forces = solids.forces(&displacement);
            let most = forces.iter().fold(0.0_f64, |most, value| value.abs().max(most));
            for node in &inside {
                for axis in 0..kind.dimension() {
                    let force = forces[node * kind.dimension() + axis];
                    assert!(force.abs() <= 1e-12 * most, "{kind:?} {idealisation:?} {mend:?}: {force:e} {most:e}");
                }
            }
            let gradient = completed(material, idealisation, gradient);
            let deformation = sum(&gradient, 1.0, &IDENTITY);
            let stress = if material.is_linear() {
                material.stress(&gradient)
            } else {
                let volume = crate::mechanics::structure::elements::materials::tensor::determinant(&deformation);
                scaled(1.0 / volume, &product(&material.stress(&gradient), &transpose(&deformation)))
            };
            let exact = [stress[0][0], stress[1][1], stress[2][2], stress[0][1], stress[1][2], stress[0][2]];
            let scale = exact.iter().fold(0.0_f64, |most, value| value.abs().max(most));
            if matches!(idealisation, Idealisation::PlaneStress { .. }) {
                assert!(exact[2].abs() <= 1e-12 * scale, "{material:?} {}", exact[2]);
            }
            for element in &solids.elements {
                let own = solids.own(element.as_ref(), &displacement);
                let Some(Resultants::Stress { stress, von_mises }) = element.resultants(&own) else { panic!("stress") };
                for (value, exact) in stress.iter().zip(&exact) {
                    assert!((value - exact).abs() <= 1e-12 * scale.max(1.0), "{kind:?} {mend:?}: {value} {exact}");
                }
                let [xx, yy, zz, xy, yz, xz] = exact;
                let squares = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
                let exact = (0.5 * squares + 3.0 * (xy * xy + yz * yz + xz * xz)).sqrt();
                assert!((von_mises - exact).abs() <= 1e-12 * scale.max(1.0));
            }
        }
    }
}

#[test]
fn the_stretch_out_of_the_plane_of_incompressible_plane_stress() {
    // A sheet of incompressible neo-Hooke at the stretches 1.5 and 0.9: σ_1 = G (λ_1² - 1/(λ_1 λ_2)²).
    let mesh = distorted(SolidKind::Quadrilateral4, 1);
    let idealisation = Idealisation::PlaneStress { thickness: 0.3 };
    let error = |poisson: f64| {
        let material = neo_hookean(poisson);
        let shear = material.moduli().shear;
        let solids = Solids::new(&mesh, idealisation, &material, None);
        let displacement = moved(&mesh, &[[0.5, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0; 3]]);
        let own = solids.own(solids.elements[0].as_ref(), &displacement);
        let Some(Resultants::Stress { stress, .. }) = solids.elements[0].resultants(&own) else { panic!("stress") };
        let exact = shear * (2.25 - 1.0 / (1.5_f64 * 0.9).powi(2));
        (stress[0] / exact - 1.0).abs()
    };
    // The compressibility is of the order 1 - 2ν.
    assert!(error(0.49) < 0.05 && error(0.4999) < 5e-4 && error(0.499_999) < 5e-6);
}
