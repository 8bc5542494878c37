//! Forces and tangent are the derivatives of the energy; rigid motions; bounds of rounding.

use super::meshes::{STRESS, element, linear, materials, neo_hookean, single, variants};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, LockingMend, SolidKind};
use crate::mechanics::structure::elements::{COLLAPSED, FiniteElement, Resultants};

/// Displacements of some size, node by node.
pub fn displacement(size: usize, factor: f64) -> Vec<f64> {
    (0..size).map(|place| factor * (1.7 * place as f64 + 0.4).sin()).collect()
}

pub fn forces(element: &dyn FiniteElement, at: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; at.len()];
    element.write_force(at, &mut forces);
    forces
}

pub fn stiffness(element: &dyn FiniteElement, at: &[f64]) -> Vec<f64> {
    let mut stiffness = vec![f64::NAN; at.len() * at.len()];
    element.write_stiffness(at, &mut stiffness);
    stiffness
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

#[test]
fn forces_and_tangent_are_the_derivatives_of_the_energy() {
    let mut all = materials();
    all.push(neo_hookean(0.4999));
    for (kind, idealisation, mend) in variants() {
        for material in &all {
            let (element, positions) = single(kind, idealisation, material, mend);
            let size = positions.len() * kind.dimension();
            for factor in [0.0, 0.06] {
                let at = displacement(size, factor);
                let (force, tangent) = (forces(element.as_ref(), &at), stiffness(element.as_ref(), &at));
                let scale = largest(&tangent);
                assert!(element.energy(&at).is_finite() && (factor > 0.0 || element.energy(&at) == 0.0));
                assert!(factor > 0.0 || largest(&force) == 0.0);
                let step = 2e-4;
                for column in 0..size {
                    let moved = |times: f64| {
                        let mut moved = at.clone();
                        moved[column] += times * step;
                        moved
                    };
                    // Central differences of fourth order.
                    let weights = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
                    let (mut slope, mut slopes) = (0.0, vec![0.0; size]);
                    for (times, weight) in weights {
                        let (at, weight) = (moved(times), weight / (12.0 * step));
                        slope += weight * element.energy(&at);
                        let force = forces(element.as_ref(), &at);
                        slopes.iter_mut().zip(force).for_each(|(slope, force)| *slope += weight * force);
                    }
                    assert!((slope - force[column]).abs() <= 1e-9 * scale, "{kind:?} {idealisation:?} {mend:?}");
                    for (row, slope) in slopes.into_iter().enumerate() {
                        let entry = tangent[row * size + column];
                        assert_eq!(entry, tangent[column * size + row]);
                        assert!(
                            (slope - entry).abs() <= 1e-8 * scale,
                            "{kind:?} {idealisation:?} {mend:?} {material:?} {row} {column}: {slope} {entry}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_rigid_motion_changes_nothing() {
    for (kind, idealisation, mend) in variants() {
        for material in materials().iter().filter(|material| !material.is_linear()) {
            let (element, positions) = single(kind, idealisation, material, mend);
            let dimension = kind.dimension();
            let at = displacement(positions.len() * dimension, 0.05);
            let (sin, cos) = if idealisation == Idealisation::Axisymmetric { (0.0, 1.0) } else { 2.2_f64.sin_cos() };
            let turned = |v: [f64; 3]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]];
            let away = if idealisation == Idealisation::Axisymmetric { [0.0, 4.0, 0.0] } else { [3.0, 4.0, -2.0] };
            let padded =
                |values: &[f64]| -> [f64; 3] { std::array::from_fn(|axis| values.get(axis).copied().unwrap_or(0.0)) };
            let motion = |of: &[f64]| -> Vec<f64> {
                let nodes = of.chunks(dimension).zip(&positions);
                nodes
                    .flat_map(|(own, position)| {
                        let own = padded(own);
                        let now = turned(std::array::from_fn(|axis| position[axis] + own[axis]));
                        (0..dimension).map(move |axis| now[axis] + away[axis] - position[axis])
                    })
                    .collect()
            };
            let rigid = motion(&vec![0.0; at.len()]);
            let scale = largest(&stiffness(element.as_ref(), &vec![0.0; at.len()]));
            assert!(largest(&forces(element.as_ref(), &rigid)) <= 1e-14 * scale * 10.0, "{kind:?} {mend:?}");
            assert!(element.energy(&rigid).abs() <= 1e-14 * scale);
            let (before, after) = (forces(element.as_ref(), &at), forces(element.as_ref(), &motion(&at)));
            for (before, after) in before.chunks(dimension).zip(after.chunks(dimension)) {
                let (before, after) = (turned(padded(before)), padded(after));
                (0..3)
                    .for_each(|axis| assert!((before[axis] - after[axis]).abs() <= 2e-13 * scale, "{kind:?} {mend:?}"));
            }
        }
    }
}

#[test]
fn rounding_stays_within_the_sizes_of_forces() {
    for (kind, idealisation, mend) in variants() {
        for material in [neo_hookean(0.3), neo_hookean(0.499), linear(1.0, 0.3)] {
            let (element, positions) = single(kind, idealisation, &material, mend);
            let size = positions.len() * kind.dimension();
            for factor in [1e-9, 0.05] {
                // A large translation, whose digits the strains lose.
                let exact = displacement(size, factor);
                let at: Vec<f64> = exact
                    .iter()
                    .enumerate()
                    .map(|(place, value)| if place % kind.dimension() == 1 { value + 1024.0 } else { *value })
                    .collect();
                let mut sizes = vec![0.0; size];
                element.write_force_sizes(&at, 0.0, &mut sizes);
                let (one, other) = (forces(element.as_ref(), &exact), forces(element.as_ref(), &at));
                for ((one, other), bound) in one.iter().zip(&other).zip(&sizes) {
                    let error = (one - other).abs();
                    assert!(error <= 4.0 * f64::EPSILON * bound, "{kind:?} {mend:?}: {error:e} {bound:e}");
                    assert!(bound.is_finite());
                }
            }
        }
    }
}

#[test]
fn an_element_that_is_inside_out_says_so_and_stays_finite() {
    for (kind, idealisation, mend) in variants() {
        for material in materials().iter().filter(|material| !material.is_linear()) {
            let (element, positions) = single(kind, idealisation, material, mend);
            // Mirrored in its middle line.
            let dimension = kind.dimension();
            let at: Vec<f64> = positions
                .iter()
                .flat_map(|position| (0..dimension).map(|axis| if axis == 1 { -2.0 * position[1] } else { 0.0 }))
                .collect();
            assert!(element.stretch(&at).unwrap() < COLLAPSED, "{kind:?} {idealisation:?}");
            assert_eq!(element.energy(&at), f64::INFINITY);
            assert!(forces(element.as_ref(), &at).iter().all(|value| value.is_finite()));
            assert!(stiffness(element.as_ref(), &at).iter().all(|value| value.is_finite()));
            let Some(Resultants::Stress { stress, von_mises }) = element.resultants(&at) else { panic!("no stress") };
            assert_eq!((stress, von_mises), ([0.0; 6], 0.0));
            assert!((element.stretch(&vec![0.0; at.len()]).unwrap() - 1.0).abs() < 1e-14);
        }
        let (element, positions) = single(kind, idealisation, &linear(1.0, 0.3), mend);
        assert!(element.is_linear() && element.stretch(&vec![0.0; positions.len() * kind.dimension()]).is_none());
    }
}

#[test]
fn nodes_that_make_no_element_are_refused() {
    let material = neo_hookean(0.3);
    let square = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let of = |nodes: [usize; 4], idealisation, mend| {
        element(SolidKind::Quadrilateral4, &nodes, &square, idealisation, &material, mend).err().map(|e| e.to_string())
    };
    assert!(of([0, 1, 2, 3], STRESS, None).is_none());
    assert!(of([3, 2, 1, 0], STRESS, None).unwrap().contains("wrong order"));
    assert!(of([0, 1, 2, 3], Idealisation::Space, None).unwrap().contains("dimensions"));
    assert!(of([0, 1, 2, 3], Idealisation::PlaneStrain { thickness: 0.0 }, None).unwrap().contains("thickness"));
    assert!(of([0, 1, 2, 3], STRESS, Some(LockingMend::MeanDilatation)).unwrap().contains("no mend"));
    let behind = square.map(|[x, y, z]| [x - 3.0, y, z]);
    let error = element(SolidKind::Quadrilateral4, &[0, 1, 2, 3], &behind, Idealisation::Axisymmetric, &material, None);
    assert!(error.err().unwrap().to_string().contains("axis of revolution"));
}
