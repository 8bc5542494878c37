//! The eigenvalues of single elements: rigid motions and no others at rest, no hourglass instabilities under stress.

use super::consistency::{displacement, stiffness};
use super::meshes::{distorted, linear, materials, neo_hookean, single, variants};
use super::structures::Solids;
use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::solid::formulations::response::{ConstitutiveLaw, Slots4};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, LockingMend};
use nalgebra::DMatrix;
use std::sync::Arc;

/// Number of eigenvalues below, within and above `±bound` times the largest.
fn inertia(size: usize, values: &[f64], bound: f64) -> [usize; 3] {
    let eigenvalues = DMatrix::from_row_slice(size, size, values).symmetric_eigenvalues();
    let largest = eigenvalues.amax();
    let count = |is: &dyn Fn(f64) -> bool| eigenvalues.iter().filter(|value| is(**value / largest)).count();
    [count(&|v| v < -bound), count(&|v| v.abs() <= bound), count(&|v| v > bound)]
}

fn rigid_motions(idealisation: Idealisation) -> usize {
    match idealisation {
        Idealisation::Axisymmetric => 1,
        Idealisation::Space => 6,
        _ => 3,
    }
}

#[test]
fn at_rest_only_rigid_motions_have_no_stiffness() {
    let mut all = materials();
    all.push(neo_hookean(0.4999));
    all.push(linear(1.0, 0.0));
    for (kind, idealisation, mend) in variants() {
        for material in &all {
            let (element, positions) = single(kind, idealisation, material, mend);
            let size = positions.len() * kind.dimension();
            let tangent = stiffness(element.as_ref(), &vec![0.0; size]);
            let rigid = rigid_motions(idealisation);
            let found = inertia(size, &tangent, 1e-11);
            assert_eq!(found, [0, rigid, size - rigid], "{kind:?} {idealisation:?} {mend:?} {material:?}");
            // Nothing in between: the softest motion is far from a rigid one.
            assert_eq!(inertia(size, &tangent, 1e-7)[1], rigid, "{kind:?} {idealisation:?} {mend:?} {material:?}");
        }
    }
}

/// The tangent of the material as a matrix over the components in slots.
fn as_matrix<const D: usize, const S: usize>(tangent: &Slots4<D, S>) -> Vec<f64> {
    tangent.iter().flatten().flat_map(|own| own.iter().flatten().copied()).collect()
}

/// Negative eigenvalues of the material's tangent at the stretches along the axes.
fn unstable_directions(material: &Arc<dyn ElasticMaterial>, idealisation: Idealisation, stretches: [f64; 3]) -> usize {
    let is_plane_stress = matches!(idealisation, Idealisation::PlaneStress { .. });
    let law = ConstitutiveLaw { material: material.clone(), is_plane_stress };
    let [x, y, z] = stretches.map(|stretch| stretch - 1.0);
    match idealisation {
        Idealisation::Space => {
            let gradient = law.gradient(&[[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]).unwrap();
            inertia(9, &as_matrix(&law.tangent::<3, 3>(&gradient)), 1e-12)[0]
        }
        Idealisation::Axisymmetric => {
            let gradient = law.gradient(&[[x, 0.0, x], [0.0, y, 0.0]]).unwrap();
            inertia(6, &as_matrix(&law.tangent::<2, 3>(&gradient)), 1e-12)[0]
        }
        _ => {
            let gradient = law.gradient(&[[x, 0.0], [0.0, y]]).unwrap();
            inertia(4, &as_matrix(&law.tangent::<2, 2>(&gradient)), 1e-12)[0]
        }
    }
}

/// A displacement of stretches along the axes.
fn stretched(positions: &[[f64; 3]], dimension: usize, stretches: [f64; 3]) -> Vec<f64> {
    let of = |position: &[f64; 3]| -> Vec<f64> {
        (0..dimension).map(|axis| (stretches[axis] - 1.0) * position[axis]).collect()
    };
    positions.iter().flat_map(of).collect()
}

/// Stretches of all kinds; around an axis the radius and the circumference are stretched alike.
fn states(idealisation: Idealisation) -> Vec<[f64; 3]> {
    let all = [
        [2.0; 3],
        [0.5; 3],
        [0.5, 1.4, 1.4],
        [2.0, 0.75, 0.75],
        [0.5, 1.0, 1.0],
        [1.4, 0.5, 1.4],
        [0.7, 0.7, 2.0],
        [0.5, 2.05, 1.0],
        [1.4, 0.52, 1.4],
    ];
    let own = |[x, y, z]: [f64; 3]| [x, y, if idealisation == Idealisation::Axisymmetric { x } else { z }];
    all.into_iter().map(own).collect()
}

#[test]
fn mean_gradients_are_as_stable_as_the_material() {
    for (kind, idealisation, mend) in variants() {
        if mend != LockingMend::MeanGradient {
            continue;
        }
        for material in [neo_hookean(0.3), neo_hookean(0.4999)] {
            let (element, positions) = single(kind, idealisation, &material, mend);
            for state in states(idealisation) {
                let at = stretched(&positions, kind.dimension(), state);
                let found = inertia(at.len(), &stiffness(element.as_ref(), &at), 1e-12)[0];
                let of_material = unstable_directions(&material, idealisation, state);
                // Around an axis the gradient of the stretch resists some of them.
                let is_alike = if idealisation == Idealisation::Axisymmetric {
                    found <= of_material
                } else {
                    found == of_material
                };
                assert!(is_alike, "{kind:?} {idealisation:?} {state:?}: {found} {of_material}");
            }
        }
    }
}

#[test]
fn held_at_the_boundary_every_homogeneous_state_is_stable() {
    // The neo-Hookean energy is polyconvex: the body is stable, and an instability would be the element's own.
    let mut unstable = Vec::new();
    for (kind, idealisation, mend) in variants() {
        let mesh = distorted(kind, 3);
        for material in [neo_hookean(0.3), neo_hookean(0.4999)] {
            let solids = Solids::new(&mesh, idealisation, &material, Some(mend));
            let dimension = kind.dimension();
            let free: Vec<usize> =
                (0..solids.freedoms).filter(|freedom| !mesh.is_outside(freedom / dimension)).collect();
            // Nearly incompressible, only where the pressure is not thousands of shear moduli.
            let is_near = |state: &[f64; 3]| {
                let volume = if dimension == 2 && idealisation != Idealisation::Axisymmetric {
                    state[0] * state[1]
                } else {
                    state.iter().product()
                };
                material.moduli().poisson() < 0.49
                    || (volume - 1.0_f64).abs() < 0.1
                    || matches!(idealisation, Idealisation::PlaneStress { .. })
            };
            for state in states(idealisation).into_iter().filter(is_near) {
                let tangent = solids.dense_stiffness(&stretched(&mesh.positions, dimension, state), &free);
                let found = inertia(free.len(), &tangent, 1e-12);
                if found != [0, 0, free.len()] {
                    unstable.push((kind, idealisation, mend, material.moduli().poisson(), state, found));
                }
            }
        }
    }
    unstable.iter().for_each(|case| println!("{case:?}"));
    assert!(unstable.is_empty());
}

#[test]
fn mean_gradients_have_no_instability_of_their_own_in_bent_states() {
    for (kind, idealisation, mend) in variants() {
        if mend != LockingMend::MeanGradient {
            continue;
        }
        let material = neo_hookean(0.4);
        let (element, positions) = single(kind, idealisation, &material, mend);
        let size = positions.len() * kind.dimension();
        let at = displacement(size, 0.02);
        // In a state of little stress rotations may turn unstable, other motions not.
        let found = inertia(size, &stiffness(element.as_ref(), &at), 1e-12)[0];
        assert!(found <= rigid_motions(idealisation), "{kind:?} {idealisation:?}: {found}");
    }
}
