//! The formulas of the measure against the solver's elements, which share no code with them.

use crate::check::measure::solids::{MeasuredSolid, padded};
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::basis_transformation::BasisTransformation;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::solid::any::{AnySolid, SolidData};
use crate::model::request::{Element, LockingMend, Material, Model, PlaneCondition, Solid, SolidKind};
use crate::model::solids::data;
use nalgebra::Vector3;

/// Pseudo-random numbers between -1 and 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }
}

/// A distorted element away from the axis of revolution.
fn model(kind: SolidKind, plane: PlaneCondition, mend: LockingMend, material: Material) -> (Model, Element) {
    let dimension = kind.dimension();
    let mut numbers = Numbers(7 + kind.nodes() as u64);
    let mut model = Model::new(dimension).material("matter", material);
    let mut names = Vec::new();
    for (place, natural) in super::shapes::nodes(kind).into_iter().enumerate() {
        let moved: Vec<f64> = natural.iter().take(dimension).map(|value| 3.0 + value + 0.05 * numbers.next()).collect();
        model = model.node(format!("n{place}"), moved);
        names.push(format!("n{place}"));
    }
    let mut solid = Solid { plane: (dimension == 2).then_some(plane), ..Solid::new::<0>([] as [String; 0], "matter") };
    solid.nodes = names;
    solid.locking = Some(mend);
    if dimension == 2 && plane != PlaneCondition::Axisymmetric {
        solid.thickness = Some(0.3);
    }
    (model, Element::of_solid(kind, solid))
}

fn materials() -> [Material; 5] {
    [
        Material::linear_elastic(2.0, 0.3),
        Material::saint_venant_kirchhoff(2.0, 0.3),
        Material::neo_hookean(2.0, 0.48),
        Material::neo_hookean(2.0, 0.3),
        Material::mooney_rivlin(0.3, 0.2, 40.0),
    ]
}

/// The structure of the one element, by the solver.
fn solver(model: &Model, element: &Element) -> Option<Structure> {
    let (kind, solid) = element.solid()?;
    let idealisation = data::idealisation(solid, model.dimension, 1.0);
    let material = data::material(&model.materials["matter"], 1.0).ok()?;
    let data = SolidData { kind, idealisation, material, mend: solid.locking };
    let nodes: Vec<usize> = (0..kind.nodes()).collect();
    let places: Vec<&[f64]> = model.nodes.values().map(Vec::as_slice).collect();
    let mut list = ElementList::default();
    AnySolid::new(&data, &nodes, &data::positions(&places, idealisation, 1.0))
        .ok()?
        .add_to(&mut list, &BasisTransformation::default());
    Some(Structure::new(model.dimension, nodes.len(), &[], list))
}

/// The largest difference of forces and energy, relative to the largest force, energy and stress.
fn difference(kind: SolidKind, plane: PlaneCondition, mend: LockingMend, material: Material, size: f64) -> Option<f64> {
    let (model, element) = model(kind, plane, mend, material);
    let structure = solver(&model, &element)?;
    let (kind, solid) = element.solid()?;
    let measured = MeasuredSolid::new(&model, kind, solid)?;
    let mut numbers = Numbers(3);
    let displacement: Vec<f64> = (0..structure.freedoms()).map(|_| size * numbers.next()).collect();
    let u: Vec<Vector3<f64>> = displacement.chunks(model.dimension).map(padded).collect();
    let response = measured.response(&u);
    let mut forces = vec![0.0; structure.freedoms()];
    structure.internal_force(&displacement, &mut forces);
    let own: Vec<Vector3<f64>> = forces.chunks(model.dimension).map(padded).collect();
    let most = own.iter().map(Vector3::amax).fold(0.0, f64::max);
    let off = own.iter().zip(&response.forces).map(|(a, b)| (a - b).amax() / most).fold(0.0, f64::max);
    let energy = structure.strain_energy(&displacement);
    let Some(crate::mechanics::structure::elements::Resultants::Stress { stress, .. }) =
        structure.resultants(0, &displacement)
    else {
        return None;
    };
    let reported = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|place| response.stress[place]);
    let largest_stress = stress.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let off_stress = stress.iter().zip(reported).map(|(a, b)| (a - b).abs() / largest_stress).fold(0.0, f64::max);
    Some(off.max((response.energy / energy - 1.0).abs()).max(off_stress))
}

#[test]
fn the_measure_agrees_with_the_elements() {
    let (mut worst, mut cases) = (0.0_f64, 0);
    for kind in SolidKind::ALL {
        let planes = [PlaneCondition::Strain, PlaneCondition::Stress, PlaneCondition::Axisymmetric];
        for plane in &planes[..if kind.dimension() == 2 { 3 } else { 1 }] {
            for mend in [LockingMend::None, LockingMend::MeanDilatation, LockingMend::MeanGradient] {
                for (place, material) in materials().into_iter().enumerate() {
                    for size in [1e-8, 0.08] {
                        let Some(off) = difference(kind, *plane, mend, material, size) else { continue };
                        assert!(off < 1e-10, "{kind:?} {plane:?} {mend:?} material {place} {size}: {off:e}");
                        worst = worst.max(off);
                        cases += 1;
                    }
                }
            }
        }
    }
    println!("{cases} elements and states: largest difference {worst:.1e}");
    assert_eq!(cases, 320);
}
