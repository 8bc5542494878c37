//! Bending by one layer of elements against the exact solution.

use super::meshes::{Mesh, linear};
use super::structures::{Solids, dead};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, SolidKind};

const LENGTH: f64 = 10.0;
const DEPTH: f64 = 0.5;
const THICKNESS: f64 = 0.3;
const YOUNG: f64 = 1000.0;

/// The deflection of the axis' end under an end moment, over the exact `M L²/(2 E I)`; `young`: the modulus of the exact
/// solution.
fn deflection(kind: SolidKind, idealisation: Idealisation, poisson: f64, young: f64, is_sheared: bool) -> f64 {
    // All cells are alike, parallelograms.
    let shear = |_: f64| if is_sheared { 0.2 } else { 0.0 };
    let mesh = Mesh::new(kind, [4, 1, 1], true, |[x, y, z]| {
        [LENGTH * x + shear(x) * (2.0 * y - 1.0), DEPTH * (y - 0.5), THICKNESS * (z - 0.5)]
    });
    let dimension = kind.dimension();
    let solids = Solids::new(&mesh, idealisation, &linear(YOUNG, poisson), None);
    // The exact tractions of the moment at the end: a couple of forces at the nodes of the face.
    let face = mesh.side(0, true);
    let couple = 1.0 / (DEPTH * (face.len() / 2) as f64);
    let mut forces = vec![0.0; solids.freedoms];
    for node in &face {
        forces[node * dimension] = -mesh.positions[*node][1].signum() * couple;
    }
    // The first cross-section stays plane; the middle of it is held.
    let mut held: Vec<(usize, f64)> = mesh.side(0, false).iter().map(|node| (node * dimension, 0.0)).collect();
    let below: Vec<usize> = mesh.side(0, false).into_iter().filter(|node| mesh.positions[*node][1] < 0.0).collect();
    held.extend(below.iter().map(|node| (node * dimension + 1, 0.0)));
    if dimension == 3 {
        held.push((below[0] * dimension + 2, 0.0));
    }
    let displacement = solids.solve(&held, &dead(forces), 1);
    let end = face.iter().find(|node| mesh.positions[**node][1] < 0.0).unwrap();
    let inertia = THICKNESS * DEPTH.powi(3) / 12.0;
    displacement[end * dimension + 1] / (LENGTH * LENGTH / (2.0 * young * inertia))
}

#[test]
fn bending_by_rectangles_is_exact() {
    let [strain, stress] =
        [Idealisation::PlaneStrain { thickness: THICKNESS }, Idealisation::PlaneStress { thickness: THICKNESS }];
    for poisson in [0.0, 0.3, 0.4999] {
        let in_plane = YOUNG / (1.0 - poisson * poisson);
        for (kind, idealisation, young) in [
            (SolidKind::Quadrilateral4, stress, YOUNG),
            (SolidKind::Quadrilateral4, strain, in_plane),
            (SolidKind::Hexahedron8, Idealisation::Space, YOUNG),
        ] {
            let ratio = deflection(kind, idealisation, poisson, young, false);
            assert!((ratio - 1.0).abs() <= 1e-8, "{kind:?} {idealisation:?} {poisson}: {ratio}");
        }
    }
}

#[test]
fn bending_by_parallelograms_does_not_lock() {
    let stress = Idealisation::PlaneStress { thickness: THICKNESS };
    let ratio = deflection(SolidKind::Quadrilateral4, stress, 0.3, YOUNG, true);
    assert!(ratio > 0.95 && ratio < 1.01, "{ratio}");
}
