//! What the files of all increments of a path share: points, cells, and the arrays that they have.

use crate::model::JobRequest;
use crate::model::request::recorded_forces::{recorded_elements, recorded_supports};
use crate::model::request::{Element, Record, SolidKind, Units};
use crate::output::vtk::arrays::{DataArray, text_array};
use crate::output::vtk::contact_areas::contact_areas;
use crate::output::vtk::strains::StrainedSolids;
use std::collections::HashMap;

/// Types of cells: a point, for a spring to the ground, a line, and a line through several points.
const VERTEX: u8 = 1;
const LINE: u8 = 3;
/// Of a beam of three nodes.
const LINE_OF_SEVERAL: u8 = 4;

/// The type of a solid's cell, whose nodes are in the same order.
fn type_of_solid(kind: SolidKind) -> u8 {
    match kind {
        SolidKind::Triangle3 => 5,
        SolidKind::Quadrilateral4 => 9,
        SolidKind::Tetrahedron4 => 10,
        SolidKind::Hexahedron8 => 12,
        SolidKind::Triangle6 => 22,
        SolidKind::Quadrilateral8 => 23,
        SolidKind::Tetrahedron10 => 24,
        SolidKind::Hexahedron20 => 25,
    }
}

/// The nodes and elements of a model as a grid.
#[derive(Debug, Clone)]
pub struct Grid {
    pub(super) dimension: usize,
    pub(super) points: DataArray,
    pub(super) cells: [DataArray; 3],
    /// Place of each element in the model.
    pub(super) elements: DataArray,
    /// Names of the nodes, and of the elements where some have one; as they are written.
    pub(super) node_names: String,
    pub(super) element_names: Option<String>,
    pub(super) has_rotations: bool,
    pub(super) place_of_node: HashMap<String, usize>,
    pub(super) number_of_elements: usize,
    pub(super) has_contacts: bool,
    pub(super) has_supports: bool,
    pub(super) has_bar_forces: bool,
    pub(super) has_spring_forces: bool,
    pub(super) has_beam_forces: bool,
    /// The solids whose stresses are recorded; none where none are.
    pub(super) strained: Option<StrainedSolids>,
    /// The areas that contacts stand for: for the place of a node the names of what it touches, each with the area. None where
    /// no contact is recorded.
    pub(super) contact_areas: HashMap<usize, Vec<(String, f64)>>,
    /// Labels of the model's units.
    pub(super) units: Units,
    /// What the path is called, written to every file.
    pub(super) branch: String,
}

impl Grid {
    /// The grid of a request; `branch` tells this path from those that leave it.
    pub fn of(request: &JobRequest, branch: impl Into<String>) -> Self {
        let model = &request.model;
        let place_of_node: HashMap<String, usize> =
            model.nodes.keys().enumerate().map(|(place, name)| (name.clone(), place)).collect();
        let points: Vec<f64> = model
            .nodes
            .values()
            .flat_map(|position| (0..3).map(|axis| position.get(axis).copied().unwrap_or_default()))
            .collect();
        let ends = |element: &Element| -> Vec<i64> {
            element.nodes().iter().filter_map(|node| place_of_node.get(node)).map(|place| *place as i64).collect()
        };
        let nodes: Vec<Vec<i64>> = model.elements.iter().map(ends).collect();
        let offsets = nodes.iter().scan(0, |end, nodes| {
            *end += nodes.len() as i64;
            Some(*end)
        });
        let type_of = |element: &Element| match (element.solid(), element.nodes().len()) {
            (Some((kind, _)), _) => type_of_solid(kind),
            (None, 1) => VERTEX,
            (None, 2) => LINE,
            (None, _) => LINE_OF_SEVERAL,
        };
        let types = model.elements.iter().map(type_of);
        let recorded = recorded_elements(request);
        let has = |is: fn(&Element) -> bool| recorded.iter().any(|place| is(&model.elements[*place]));
        let named = request.analysis.record.as_ref().and_then(Record::named_contacts);
        let has_contacts = named.map_or(!model.contacts.is_empty(), |named| !named.is_empty());
        let areas = has_contacts.then(|| contact_areas(model)).into_iter().flatten();
        let mut areas_of: HashMap<usize, Vec<(String, f64)>> = HashMap::new();
        for ((node, touched), area) in areas {
            areas_of.entry(node).or_default().push((touched.to_owned(), area));
        }
        Self {
            dimension: model.dimension,
            points: DataArray::numbers("points", 3, &points),
            cells: [
                DataArray::integers("connectivity", nodes.iter().flatten().copied()),
                DataArray::integers("offsets", offsets),
                DataArray::bytes("types", types),
            ],
            elements: DataArray::integers("element", (0..).take(nodes.len())),
            node_names: text_array(model.nodes.keys().map(String::as_str)),
            element_names: model
                .elements
                .iter()
                .any(|element| element.name().is_some())
                .then(|| text_array(model.elements.iter().map(|element| element.name().unwrap_or_default()))),
            has_rotations: model
                .elements
                .iter()
                .any(|element| matches!(element, Element::Beam { .. } | Element::RotationalSpring { .. })),
            number_of_elements: nodes.len(),
            has_contacts,
            contact_areas: areas_of,
            has_supports: !recorded_supports(request).is_empty(),
            has_bar_forces: has(|element| matches!(element, Element::Bar { .. })),
            has_spring_forces: has(|element| matches!(element, Element::Spring { .. })),
            has_beam_forces: has(|element| matches!(element, Element::Beam { .. })),
            strained: has(|element| element.solid().is_some()).then(|| StrainedSolids::of(request)),
            place_of_node,
            units: model.units.clone().unwrap_or_default(),
            branch: branch.into(),
        }
    }
}
