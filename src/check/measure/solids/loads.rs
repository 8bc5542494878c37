//! Body forces and tractions as nodal forces per unit load factor, `b ∫ N_a dV` and `t ∫ N_a dA`, and the nodal forces
//! `-p ∫ N_a n da` of a pressure on deformed faces.

use crate::check::measure::solids::shapes::Shape;
use crate::check::measure::solids::{PlacedSolid, PlaneOf, jacobian, padded, shapes};
use crate::model::request::{Element, Model, SolidKind, Stage};
use crate::model::solids::faces::{FaceMatch, SolidFace, surface_faces};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap, HashSet};

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
                    for (node, area) in MeasuredFace::new(model, &face).iter().flat_map(MeasuredFace::areas) {
                        *areas.entry(node).or_default() += area;
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

/// A face of a solid, or a side of a bar or a beam, its nodes numbered.
#[derive(Debug, Clone)]
pub struct MeasuredFace {
    placed: PlacedSolid,
    /// The plane solid of the face's nodes; `None` for a segment.
    kind: Option<SolidKind>,
}

impl MeasuredFace {
    fn new(model: &Model, face: &FaceMatch) -> Option<Self> {
        match face {
            FaceMatch::Face(face) => Self::of_solid(model, face),
            FaceMatch::Side(nodes) => Some(Self::side(model, *nodes)),
            FaceMatch::None | FaceMatch::Inside => None,
        }
    }

    /// The side to the left of the order of the nodes, of unit thickness: the body is to the right.
    fn side(model: &Model, [first, last]: [usize; 2]) -> Self {
        let origin = padded(&model.nodes[last]);
        let nodes = vec![last, first];
        let places = nodes.iter().map(|node| padded(&model.nodes[*node]) - origin).collect();
        Self { placed: PlacedSolid { origin, nodes, places, plane: PlaneOf::Strain, thickness: 1.0 }, kind: None }
    }

    fn of_solid(model: &Model, face: &SolidFace) -> Option<Self> {
        let (_, solid) = model.elements.get(face.element).and_then(Element::solid)?;
        let solid = PlacedSolid::new(model, solid)?;
        let places = face.nodes.iter().map(|node| padded(&model.nodes[*node]) - solid.origin).collect();
        let kind = match (model.dimension, face.nodes.len()) {
            (2, _) => None,
            (_, 3) => Some(SolidKind::Triangle3),
            (_, 6) => Some(SolidKind::Triangle6),
            (_, 4) => Some(SolidKind::Quadrilateral4),
            _ => Some(SolidKind::Quadrilateral8),
        };
        Some(Self { placed: PlacedSolid { nodes: face.nodes.clone(), places, ..solid }, kind })
    }

    /// The area of each node.
    fn areas(&self) -> Vec<(usize, f64)> {
        let mut areas = vec![0.0; self.placed.nodes.len()];
        each_point(&self.placed, self.kind, |values, normal| {
            let size = normal.norm();
            areas.iter_mut().zip(values).for_each(|(own, value)| *own += size * value);
        });
        self.placed.nodes.iter().copied().zip(areas).collect()
    }

    /// The force of a pressure on each node, where the nodes have these displacements.
    pub fn pressed(&self, displacements: &[Vector3<f64>], pressure: f64) -> Vec<(usize, Vector3<f64>)> {
        let mut moved = self.placed.clone();
        moved.places.iter_mut().zip(&self.placed.nodes).for_each(|(place, node)| *place += displacements[*node]);
        let mut forces = vec![Vector3::zeros(); moved.nodes.len()];
        each_point(&moved, self.kind, |values, normal| {
            forces.iter_mut().zip(values).for_each(|(own, value)| *own -= normal * (pressure * value));
        });
        self.placed.nodes.iter().copied().zip(forces).collect()
    }
}

/// For each surface that some stage presses, its name and its faces, in the order of the surfaces.
pub fn pressed_surfaces(model: &Model) -> Vec<(&str, Vec<MeasuredFace>)> {
    let named: HashSet<&str> =
        model.stages.iter().flat_map(|stage| stage.pressures.keys()).map(String::as_str).collect();
    if named.is_empty() {
        return Vec::new();
    }
    let faces = |faces: Vec<FaceMatch>| faces.iter().filter_map(|face| MeasuredFace::new(model, face)).collect();
    let all = model.surfaces.keys().zip(surface_faces(model)).filter(|(name, _)| named.contains(name.as_str()));
    all.map(|(name, own)| (name.as_str(), faces(own))).collect()
}

/// Calls `each` with the shape functions at the points of a rule and the outward normal times the area of the point.
///
/// Faces in space are plane solids of their own; on a triangle the rule of the square is collapsed onto it (a rule of high
/// degree), so that no rule is shared with the element's.
fn each_point(face: &PlacedSolid, kind: Option<SolidKind>, mut each: impl FnMut(&[f64], Vector3<f64>)) {
    let Some(kind) = kind else {
        for (at, weight) in LINE {
            let (values, slopes) = line_functions(face.nodes.len(), at);
            let tangent: Vector3<f64> = slopes.iter().zip(&face.places).map(|(slope, place)| place * *slope).sum();
            // The body lies to the left of its outline.
            each(&values, Vector3::new(tangent.y, -tangent.x, 0.0) * (weight * face.around(&values)));
        }
        return;
    };
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
                here.slopes.iter().zip(&face.places).map(|(slope, place)| place * slope[axis]).sum()
            };
            each(&here.values, along(0).cross(&along(1)) * weight);
        }
    }
}

/// The functions of a segment of two nodes, or of three with the middle one last, and their slopes.
fn line_functions(nodes: usize, at: f64) -> (Vec<f64>, Vec<f64>) {
    if nodes == 2 {
        (vec![0.5 * (1.0 - at), 0.5 * (1.0 + at)], vec![-0.5, 0.5])
    } else {
        (vec![0.5 * at * (at - 1.0), 0.5 * at * (at + 1.0), 1.0 - at * at], vec![at - 0.5, at + 0.5, -2.0 * at])
    }
}
