//! The faces of the solids that a model's surfaces name.

use crate::mechanics::structure::elements::solid::shapes::faces::{FaceKind, faces_of};
use crate::model::request::{Element, Model, Surface};
use itertools::Itertools;
use std::collections::HashMap;

/// A face of a solid as the solid has it: its normal points out of the solid.
#[derive(Debug, Clone)]
pub(crate) struct SolidFace {
    /// The solid's place among the model's elements.
    pub element: usize,
    pub kind: FaceKind,
    /// Numbers of the nodes, in the order of VTK's file format.
    pub nodes: Vec<usize>,
}

/// What a list of nodes is among the faces of solids.
#[derive(Debug, Clone)]
pub(crate) enum FaceMatch {
    /// The face of one solid.
    Face(SolidFace),
    /// A bar or a beam between two nodes, its side to the left of their order.
    Side([usize; 2]),
    /// No solid has it.
    None,
    /// Two solids have it, or more: it is inside the body.
    Inside,
}

/// For each surface its faces, in order. Linear in the size of the model.
pub(crate) fn surface_faces(model: &Model) -> Vec<Vec<FaceMatch>> {
    let sorted = |nodes: &[String]| -> Option<Vec<usize>> {
        let numbers = nodes.iter().map(|name| model.nodes.get_index_of(name));
        let mut numbers: Vec<usize> = numbers.collect::<Option<_>>()?;
        numbers.sort_unstable();
        Some(numbers)
    };
    let wanted: Vec<Vec<Option<Vec<usize>>>> =
        model.surfaces.values().map(|Surface { faces, .. }| faces.iter().map(|face| sorted(face)).collect()).collect();
    let mut found: HashMap<&[usize], FaceMatch> =
        wanted.iter().flatten().flatten().map(|nodes| (nodes.as_slice(), FaceMatch::None)).collect();
    if !found.is_empty() {
        for (element, (kind, solid)) in model.elements.iter().enumerate().filter_map(|(place, element)| {
            let solid = element.solid()?;
            Some((place, solid))
        }) {
            let (face_kind, faces) = faces_of(kind);
            let numbers = solid.nodes.iter().map(|name| model.nodes.get_index_of(name));
            let Some(numbers) = numbers.collect::<Option<Vec<usize>>>() else { continue };
            if numbers.len() != kind.nodes() {
                continue;
            }
            for face in faces {
                let nodes: Vec<usize> = face.iter().map(|place| numbers[*place]).collect();
                let mut key = nodes.clone();
                key.sort_unstable();
                if let Some(entry) = found.get_mut(key.as_slice()) {
                    *entry = match entry {
                        FaceMatch::None => FaceMatch::Face(SolidFace { element, kind: face_kind, nodes }),
                        FaceMatch::Face(_) | FaceMatch::Inside => FaceMatch::Inside,
                        FaceMatch::Side(_) => continue,
                    };
                }
            }
        }
        for element in &model.elements {
            let (Element::Bar { nodes, .. } | Element::Beam { nodes, .. }, 2) = (element, model.dimension) else {
                continue;
            };
            let numbers = nodes.iter().filter_map(|name| model.nodes.get_index_of(name)).sorted_unstable();
            if let Some(entry @ FaceMatch::None) = found.get_mut(numbers.collect::<Vec<_>>().as_slice())
                && nodes.len() == 2
            {
                *entry = FaceMatch::Side([0; 2]);
            }
        }
    }
    let of_face = |(nodes, names): (&Option<Vec<usize>>, &Vec<String>)| {
        let found = nodes.as_ref().and_then(|nodes| found.get(nodes.as_slice())).cloned().unwrap_or(FaceMatch::None);
        match (found, names.as_slice()) {
            (FaceMatch::Side(_), [first, last]) => {
                let numbers = [first, last].map(|name| model.nodes.get_index_of(name).unwrap_or(0));
                FaceMatch::Side(numbers)
            }
            (found, _) => found,
        }
    };
    let named = wanted.iter().zip(model.surfaces.values());
    named.map(|(wanted, surface)| wanted.iter().zip(&surface.faces).map(of_face).collect()).collect()
}
