//! The material of each element.

use crate::model::mesh::data::mesh_data::{MeshData, MeshSection};
use std::collections::HashMap;

/// The material of elements that are in no set.
const UNNAMED: &str = "material";

/// Names of materials by element.
#[derive(Debug)]
pub struct MaterialNames {
    names: Vec<String>,
    /// Places in `names`.
    by_element: Vec<usize>,
}

impl MaterialNames {
    /// The material of an element is that of its section. Without a section it has the name of the first set that the
    /// element is in, so that a file of gmsh leads to one material for each group.
    pub fn new(mesh: &MeshData) -> Self {
        let mut known = Known::default();
        let mut by_element: Vec<Option<usize>> = Vec::with_capacity(mesh.elements.len());
        // Upper and lower case are alike in decks.
        let written: HashMap<String, &str> =
            mesh.materials.keys().map(|name| (name.to_ascii_uppercase(), name.as_str())).collect();
        let sections: Vec<usize> = mesh
            .sections
            .iter()
            .map(|MeshSection { material, .. }| {
                known.place(written.get(&material.to_ascii_uppercase()).copied().unwrap_or(material))
            })
            .collect();
        for section in &mesh.elements.sections {
            by_element.push(section.and_then(|section| sections.get(section as usize)).copied());
        }
        for (name, members) in &mesh.element_sets {
            for member in members {
                if let Some(entry) = by_element.get_mut(*member as usize).filter(|entry| entry.is_none()) {
                    *entry = Some(known.place(name));
                }
            }
        }
        let by_element = by_element.into_iter().map(|place| place.unwrap_or_else(|| known.place(UNNAMED))).collect();
        Self { names: known.names, by_element }
    }

    /// The material of an element.
    pub fn of(&self, element: usize) -> &str {
        self.by_element.get(element).and_then(|place| self.names.get(*place)).map_or(UNNAMED, String::as_str)
    }

    /// Materials that elements name and the file does not describe.
    pub fn missing<'a>(&'a self, mesh: &'a MeshData) -> impl Iterator<Item = &'a str> {
        let described = |name: &str| mesh.materials.get(name).is_some_and(|material| material.law.is_some());
        self.names.iter().map(String::as_str).filter(move |name| !described(name))
    }
}

/// Names and their places.
#[derive(Default)]
struct Known {
    names: Vec<String>,
    places: HashMap<String, usize>,
}

impl Known {
    fn place(&mut self, name: &str) -> usize {
        if let Some(place) = self.places.get(name) {
            return *place;
        }
        self.names.push(name.to_owned());
        self.places.insert(name.to_owned(), self.names.len() - 1);
        self.names.len() - 1
    }
}
