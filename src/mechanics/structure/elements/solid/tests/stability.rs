//! The eigenvalues of single elements: rigid motions and no others at rest, no hourglass instabilities under stress.

use super::consistency::{displacement, stiffness};
use super::meshes::{linear, materials, neo_hookean, single, variants};
use crate::mechanics::structure::elements::materials::Material;
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
fn unstable_directions(material: &Arc<dyn Material>, idealisation: Idealisation, stretches: [f64; 3]) -> usize {
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

#[test]
fn homogeneous_states_are_as_stable_as_the_material() {
    let states = [[2.0; 3], [0.5; 3], [0.5, 1.4, 1.4], [2.0, 0.75, 0.75], [0.5, 1.0, 1.0], [1.4, 0.5, 1.4], [0.7, 0.7, 2.0]];
    let mut unlike = Vec::new();
    for (kind, idealisation, mend) in variants() {
        for material in [neo_hookean(0.3), neo_hookean(0.4999)] {
            for state in states {
                let stretches = if idealisation == Idealisation::Axisymmetric { [state[0], state[1], state[0]] } else { state };
                let dimension = kind.dimension();
                let (element, positions) = single(kind, idealisation, &material, mend);
                let at: Vec<f64> = positions
                    .iter()
                    .flat_map(|position| (0..dimension).map(|axis| (stretches[axis] - 1.0) * position[axis]))
                    .collect();
                let tangent = stiffness(element.as_ref(), &at);
                let found = inertia(at.len(), &tangent, 1e-12)[0];
                let of_material = unstable_directions(&material, idealisation, stretches);
                if found > of_material {
                    unlike.push((kind, idealisation, mend, material.moduli().poisson(), state, found, of_material));
                }
                if mend == LockingMend::MeanGradient && idealisation != Idealisation::Axisymmetric {
                    assert_eq!(found, of_material, "{kind:?} {idealisation:?} {state:?}");
                }
            }
        }
    }
    unlike.iter().for_each(|case| println!("{case:?}"));
    assert!(unlike.is_empty());
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
