//! Body forces and tractions as nodal forces per unit load factor: `∫ N_a b dV` and `∫ N_a t dA`.

use crate::check::measure::solids::{PlacedSolid, PlaneOf, jacobian, padded, shapes};
use crate::model::request::{Element, Model, SolidKind, Stage};
use crate::model::solids::faces::{FaceMatch, SolidFace, surface_faces};
use nalgebra::Vector3;

/// Gauss's rule of four points on `[-1, 1]`.
const LINE: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The nodal forces of a stage's loads on solids.
pub fn solid_loads(model: &Model, stage: &Stage) -> Vec<(usize, Vector3<f64>)> {
    let mut forces = Vec::new();
    for (kind, solid) in model.elements.iter().filter_map(Element::solid) {
        let Some(density) = stage.body_forces.get(&solid.material) else { continue };
        let Some(placed) = PlacedSolid::new(model, solid) else { continue };
        let (dimension, _) = shapes::form(kind);
        let shape = shapes::Shape::of(kind);
        for (place, weight) in shapes::rule(kind, placed.plane == PlaneOf::Revolution) {
            let here = shape.at(place);
            let volume = weight * jacobian(&here.slopes, &placed.places, dimension).determinant();
            let around = placed.around(&here.values);
            let of_nodes = placed.nodes.iter().zip(&here.values);
            forces.extend(of_nodes.map(|(node, value)| (*node, padded(density) * (value * volume * around))));
        }
    }
    if stage.tractions.is_empty() {
        return forces;
    }
    for (name, faces) in model.surfaces.keys().zip(surface_faces(model)) {
        let Some(traction) = stage.tractions.get(name) else { continue };
        for face in faces {
            if let FaceMatch::Face(face) = face {
                forces.extend(face_forces(model, &face, &padded(traction)));
            }
        }
    }
    forces
}

/// Faces in space are plane solids of their own; on a triangle the rule of the square is collapsed onto it (a rule of high
/// degree), so that no rule is shared with the element's.
fn face_forces(model: &Model, face: &SolidFace, traction: &Vector3<f64>) -> Vec<(usize, Vector3<f64>)> {
    let Some((_, solid)) = model.elements.get(face.element).and_then(Element::solid) else { return Vec::new() };
    let Some(solid) = PlacedSolid::new(model, solid) else { return Vec::new() };
    let places: Vec<Vector3<f64>> = face.nodes.iter().map(|node| padded(&model.nodes[*node])).collect();
    let on_face = PlacedSolid { nodes: face.nodes.clone(), places: places.clone(), ..solid };
    let mut forces = vec![Vector3::zeros(); face.nodes.len()];
    let mut add = |values: &[f64], area: f64| {
        let size = area * on_face.around(values);
        forces.iter_mut().zip(values).for_each(|(force, value)| *force += traction * (size * value));
    };
    let kind = match (model.dimension, face.nodes.len()) {
        (2, _) => None,
        (_, 3) => Some(SolidKind::Triangle3),
        (_, 6) => Some(SolidKind::Triangle6),
        (_, 4) => Some(SolidKind::Quadrilateral4),
        _ => Some(SolidKind::Quadrilateral8),
    };
    match kind {
        None => {
            for (at, weight) in LINE {
                let (values, slopes) = line_functions(face.nodes.len(), at);
                let tangent: Vector3<f64> = slopes.iter().zip(&places).map(|(slope, place)| place * *slope).sum();
                add(&values, weight * tangent.norm());
            }
        }
        Some(kind) => {
            let shape = shapes::Shape::of(kind);
            let (_, is_simplex) = shapes::form(kind);
            for (x, by_x) in LINE {
                for (y, by_y) in LINE {
                    // The square onto the triangle: one side shrinks to a corner.
                    let (at, weight) = if is_simplex {
                        let (u, v) = (0.5 * (1.0 + x), 0.5 * (1.0 + y));
                        ([u, v * (1.0 - u), 0.0], 0.25 * by_x * by_y * (1.0 - u))
                    } else {
                        ([x, y, 0.0], by_x * by_y)
                    };
                    let here = shape.at(at);
                    let along = |axis: usize| -> Vector3<f64> {
                        here.slopes.iter().zip(&places).map(|(slope, place)| place * slope[axis]).sum()
                    };
                    add(&here.values, weight * along(0).cross(&along(1)).norm());
                }
            }
        }
    }
    face.nodes.iter().copied().zip(forces).collect()
}

/// The functions of a segment of two nodes, or of three with the middle one last, and their slopes.
fn line_functions(nodes: usize, at: f64) -> (Vec<f64>, Vec<f64>) {
    if nodes == 2 {
        (vec![0.5 * (1.0 - at), 0.5 * (1.0 + at)], vec![-0.5, 0.5])
    } else {
        (vec![0.5 * at * (at - 1.0), 0.5 * at * (at + 1.0), 1.0 - at * at], vec![at - 0.5, at + 0.5, -2.0 * at])
    }
}
