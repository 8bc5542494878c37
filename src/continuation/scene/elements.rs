//! The elements of a request, dimensionless: lengths over `ℓ`, forces over `φ`, moments over `φ ℓ`.

use crate::mechanics::structure::basis_transformation::BasisTransformation;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::bar::Bar;
use crate::mechanics::structure::elements::beam::Beam;
use crate::mechanics::structure::elements::beam::segment::SectionStiffness;
use crate::mechanics::structure::elements::rotational_spring::RotationalSpring;
use crate::mechanics::structure::elements::solid::any::AnySolid;
use crate::mechanics::structure::elements::space_beam::SpaceBeam;
use crate::mechanics::structure::elements::space_beam::segment::SpaceSectionStiffness;
use crate::mechanics::structure::elements::spring::Spring;
use crate::model::Model;
use crate::model::request::{BendingStiffness, Element};
use crate::model::solids::data;
use std::collections::HashMap;

/// Builds the elements of a model, one after the other.
pub(super) struct ElementBuilder<'a> {
    pub model: &'a Model,
    pub numbers: &'a HashMap<&'a str, usize>,
    pub length: f64,
    pub force: f64,
    /// For each node the number of its rotations that are used so far, with the one that elements share.
    rotations: Vec<usize>,
}

impl<'a> ElementBuilder<'a> {
    pub fn new(model: &'a Model, numbers: &'a HashMap<&'a str, usize>, length: f64, force: f64) -> Self {
        let rotations = model.rotating_nodes().into_iter().map(usize::from).collect();
        Self { model, numbers, length, force, rotations }
    }

    /// `basis`: of the unknowns of solids.
    pub fn build(mut self, basis: &BasisTransformation) -> ElementList {
        let mut elements = ElementList::default();
        for element in &self.model.elements {
            match element {
                Element::Bar { .. } => elements.extend(self.bar(element)),
                Element::Spring { nodes, stiffness, name: _ } => elements.push(self.spring(nodes, stiffness)),
                Element::Beam { .. } if self.model.dimension == 3 => elements.extend(self.space_beam(element)),
                Element::Beam { .. } => elements.extend(self.beam(element)),
                Element::RotationalSpring { nodes, stiffness, name: _ } => {
                    let nodes: Vec<usize> = nodes.iter().map(|node| self.numbers[node.as_str()]).collect();
                    elements.push(RotationalSpring::new(&nodes, stiffness / self.force / self.length));
                }
                _ => {
                    if let Some(solid) = self.solid(element) {
                        solid.add_to(&mut elements, basis);
                    }
                }
            }
        }
        elements
    }

    /// A solid; `None` where it is none, which a checked model has not.
    pub fn solid(&self, element: &Element) -> Option<AnySolid> {
        let nodes: Vec<usize> = element.nodes().iter().map(|node| self.numbers[node.as_str()]).collect();
        data::solid(self.model, element, &nodes, (self.length, self.force))
    }

    /// From one node to another. A difference of the places as given: a place far from the origin causes no loss of
    /// digits.
    fn vector(&self, from: &str, to: &str) -> [f64; 3] {
        let mut vector = [0.0; 3];
        (0..self.model.dimension)
            .for_each(|k| vector[k] = (self.model.nodes[to][k] - self.model.nodes[from][k]) / self.length);
        vector
    }

    fn bar(&self, element: &Element) -> Option<Bar> {
        let Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain, name: _ } = element else {
            return None;
        };
        let vector = self.vector(&nodes[0], &nodes[1]);
        let apart = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
        Some(Bar {
            nodes: [self.numbers[nodes[0].as_str()], self.numbers[nodes[1].as_str()]],
            reference: vector,
            reference_length: apart,
            axial_stiffness: axial_stiffness / self.force,
            rest_length: rest_length.map_or(apart, |rest| rest / self.length),
            prestress: prestress / self.force,
            strain: *strain,
        })
    }

    fn spring(&self, nodes: &[String], stiffness: &[Vec<f64>]) -> Spring {
        let mut matrix = [[0.0; 3]; 3];
        for (row, values) in stiffness.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                matrix[row][column] = value / self.force * self.length;
            }
        }
        let node = self.numbers[nodes[0].as_str()];
        match nodes.get(1) {
            Some(other) => Spring::between([node, self.numbers[other.as_str()]], matrix),
            None => Spring::to_ground(node, matrix),
        }
    }

    fn space_beam(&self, element: &Element) -> Option<SpaceBeam> {
        let Element::Beam { nodes, axial_stiffness, bending_stiffness, torsional_stiffness, orientation, .. } = element
        else {
            return None;
        };
        let Element::Beam { shear_stiffness, .. } = element else { return None };
        let (BendingStiffness::Space(bending), Some(torsional)) = (bending_stiffness, torsional_stiffness) else {
            return None;
        };
        let of_moments = self.force * self.length * self.length;
        let stiffness = SpaceSectionStiffness {
            axial: axial_stiffness / self.force,
            bending: bending.map(|stiffness| stiffness / of_moments),
            torsional: torsional / of_moments,
            shear: shear_stiffness.map(|shear| shear / self.force),
        };
        let orientation: [f64; 3] = orientation.as_deref()?.try_into().ok()?;
        let chords: Vec<[f64; 3]> = nodes.windows(2).map(|pair| self.vector(&pair[0], &pair[1])).collect();
        let numbers: Vec<usize> = nodes.iter().map(|node| self.numbers[node.as_str()]).collect();
        match (&numbers[..], &chords[..]) {
            (&[first, middle, last], &[one, other]) => {
                Some(SpaceBeam::curved([first, middle, last], [one, other], orientation, stiffness))
            }
            (&[first, last], &[chord]) => Some(SpaceBeam::straight([first, last], chord, orientation, stiffness)),
            _ => None,
        }
    }

    /// At a release the beam takes a rotation of the node that no other element uses.
    fn beam(&mut self, element: &Element) -> Option<Beam> {
        let Element::Beam { nodes, axial_stiffness, bending_stiffness, shear_stiffness, .. } = element else {
            return None;
        };
        let BendingStiffness::Plane(bending_stiffness) = bending_stiffness else { return None };
        let stiffness = SectionStiffness {
            axial: axial_stiffness / self.force,
            bending: bending_stiffness / self.force / self.length / self.length,
            shear: shear_stiffness.map(|shear| shear / self.force),
        };
        let chords: Vec<[f64; 2]> = nodes
            .windows(2)
            .map(|pair| {
                let [x, y, _] = self.vector(&pair[0], &pair[1]);
                [x, y]
            })
            .collect();
        let numbers: Vec<usize> = nodes.iter().map(|node| self.numbers[node.as_str()]).collect();
        let mut beam = match (&numbers[..], &chords[..]) {
            (&[first, middle, last], &[one, other]) => Beam::curved([first, middle, last], [one, other], stiffness),
            (&[first, last], &[chord]) => Beam::straight([first, last], chord, stiffness),
            _ => return None,
        };
        for (place, (node, name)) in numbers.iter().zip(nodes).enumerate() {
            if !element.turns_with(name) {
                beam = beam.with_rotation_at(place, self.rotations[*node]);
                self.rotations[*node] += 1;
            }
        }
        Some(beam)
    }
}
