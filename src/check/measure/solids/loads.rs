//! Body forces and tractions as nodal forces per unit load factor: `b ∫ N_a dV` and `t ∫ N_a dA`.

use crate::check::measure::solids::shapes::Shape;
use crate::check::measure::solids::{PlacedSolid, PlaneOf, jacobian, padded, shapes};
use crate::model::request::{Element, Model, SolidKind, Stage};
use crate::model::solids::faces::{FaceMatch, SolidFace, surface_faces};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap};

/// Gauss's rule of four points on `[-1, 1]`.
const LINE: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The volumes `∫ N_a dV` of nodes by material and their areas `∫ N_a dA` by surface, as far as some stage loads them.
pub struct SolidShares<'a> {
    volumes: HashMap<&'a str, BTreeMap<usize, f64>>,
    areas: HashMap<&'a str, BTreeMap<usize, f64>>,
}

impl<'a> SolidShares<'a> {
    pub fn new(model: &'a Model) -> Self {
        let mut shares = Self { volumes: HashMap::new(), areas: HashMap::new() };
        for stage in &model.stages {
            shares.volumes.extend(stage.body_forces.keys().map(|name| (name.as_str(), BTreeMap::new())));
            shares.areas.extend(stage.tractions.keys().map(|name| (name.as_str(), BTreeMap::new())));
        }
        for (kind, solid) in model.elements.iter().filter_map(Element::solid) {
            let Some(volumes) = shares.volumes.get_mut(solid.material.as_str()) else { continue };
            let Some(placed) = PlacedSolid::new(model, solid) else { continue };
            let (dimension, _) = shapes::form(kind);
            let shape = Shape::of(kind);
            for (place, weight) in shapes::rule(kind, placed.plane == PlaneOf::Revolution) {
                let here = shape.at(place);
                let volume = weight * jacobian(&here.slopes, &placed.places, dimension).determinant();
                let around = placed.around(&here.values);
                for (node, value) in placed.nodes.iter().zip(&here.values) {
                    *volumes.entry(*node).or_default() += value * volume * around;
                }
            }
        }
        if !shares.areas.is_empty() {
            for (name, faces) in model.surfaces.keys().zip(surface_faces(model)) {
                let Some(areas) = shares.areas.get_mut(name.as_str()) else { continue };
                for face in faces {
                    if let FaceMatch::Face(face) = face {
                        for (node, area) in face_areas(model, &face) {
                            *areas.entry(node).or_default() += area;
                        }
                    }
                }
            }
        }
        shares
    }

    /// The nodal forces of a stage's loads on solids.
    pub fn loads(&self, stage: &Stage) -> Vec<(usize, Vector3<f64>)> {
        let bodies = stage.body_forces.iter().map(|(name, force)| (self.volumes.get(name.as_str()), force));
        let tractions = stage.tractions.iter().map(|(name, force)| (self.areas.get(name.as_str()), force));
        let of_load = |(shares, force): (Option<&BTreeMap<usize, f64>>, &Vec<f64>)| {
            let force = padded(force);
            shares.into_iter().flatten().map(move |(node, share)| (*node, force * *share)).collect::<Vec<_>>()
        };
        bodies.chain(tractions).flat_map(of_load).collect()
    }
}

/// Faces in space are plane solids of their own; on a triangle the rule of the square is collapsed onto it (a rule of high
/// degree), so that no rule is shared with the element's.
fn face_areas(model: &Model, face: &SolidFace) -> Vec<(usize, f64)> {
    let Some((_, solid)) = model.elements.get(face.element).and_then(Element::solid) else { return Vec::new() };
    let Some(solid) = PlacedSolid::new(model, solid) else { return Vec::new() };
    let places: Vec<Vector3<f64>> = face.nodes.iter().map(|node| padded(&model.nodes[*node])).collect();
    let on_face = PlacedSolid { nodes: face.nodes.clone(), places: places.clone(), ..solid };
    let mut areas = vec![0.0; face.nodes.len()];
    let mut add = |values: &[f64], area: f64| {
        let size = area * on_face.around(values);
        areas.iter_mut().zip(values).for_each(|(own, value)| *own += size * value);
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
            let shape = Shape::of(kind);
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
    face.nodes.iter().copied().zip(areas).collect()
}

/// The functions of a segment of two nodes, or of three with the middle one last, and their slopes.
fn line_functions(nodes: usize, at: f64) -> (Vec<f64>, Vec<f64>) {
    if nodes == 2 {
        (vec![0.5 * (1.0 - at), 0.5 * (1.0 + at)], vec![-0.5, 0.5])
    } else {
        (vec![0.5 * at * (at - 1.0), 0.5 * at * (at + 1.0), 1.0 - at * at], vec![at - 0.5, at + 0.5, -2.0 * at])
    }
}
