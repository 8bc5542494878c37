//! What is found in a file of gmsh, section by section.

use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::data::label_index::LabelIndex;
use crate::model::mesh::data::mesh_data::MeshElements;
use crate::model::mesh::data::unread::Unread;
use crate::model::mesh::gmsh::cursor::{Cursor, RecordSize};
use std::collections::HashMap;

/// Elements one after another in the file that belong to the same groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GroupRun {
    /// Dimension of the geometrical entity (4.1) or the physical group (2.2).
    pub dimension: usize,
    /// Tag of the entity (4.1) or of the group (2.2; 0 for none).
    pub tag: i64,
    /// The first element.
    pub first: usize,
    /// Number of elements.
    pub count: usize,
}

/// What has been read so far.
#[derive(Debug, Default)]
pub struct GmshContents {
    /// Names of physical groups by dimension and tag.
    pub names: HashMap<(usize, i64), String>,
    /// Physical groups of each entity by dimension and tag; none before `$Entities` is read.
    pub entities: Option<HashMap<(usize, i64), Vec<i64>>>,
    /// Labels of nodes.
    pub node_labels: Vec<u64>,
    /// Coordinates of nodes.
    pub coordinates: Vec<[f64; 3]>,
    /// Places of nodes by label; none before `$Nodes` is read.
    pub node_index: Option<LabelIndex>,
    /// Elements of all dimensions.
    pub elements: MeshElements,
    /// Their groups; every element is in one run, in order.
    pub runs: Vec<GroupRun>,
    /// Whether `$Elements` has been read.
    pub has_elements: bool,
    /// Sections that are not read.
    pub unread: Unread,
}

impl GmshContents {
    /// Makes room for nodes, as many as the rest of the file can hold.
    ///
    /// # Errors
    /// It is too short for so many.
    pub fn reserve_nodes(&mut self, cursor: &Cursor, count: u64, record: RecordSize) -> Result<usize, MeshError> {
        let count = cursor.fitting(count, record, "nodes")?;
        self.node_labels.reserve(count);
        self.coordinates.reserve(count);
        Ok(count)
    }

    /// Ends the nodes.
    ///
    /// # Errors
    /// A label is given twice.
    pub fn index_nodes(&mut self, place: MeshPlace) -> Result<(), MeshError> {
        let index =
            LabelIndex::new(&self.node_labels).map_err(|second| repeated(&self.node_labels, second, "node", place))?;
        self.node_index = Some(index);
        Ok(())
    }

    /// Appends an element to the runs.
    pub fn extend_run(&mut self, dimension: usize, tag: i64, count: usize) {
        if count == 0 {
            return;
        }
        match self.runs.last_mut() {
            Some(run) if (run.dimension, run.tag) == (dimension, tag) => run.count += count,
            _ => {
                let first = self.runs.last().map_or(0, |run| run.first + run.count);
                self.runs.push(GroupRun { dimension, tag, first, count });
            }
        }
    }
}

/// The mistake of a label that is given twice, or of too many labels.
pub fn repeated(labels: &[u64], second: usize, what: &str, place: MeshPlace) -> MeshError {
    match labels.get(second) {
        Some(label) => MeshError::new(place, format!("{what} {label} is given twice; labels are unique")),
        None => MeshError::new(place, format!("too many: at most {} of a kind", u32::MAX - 1)),
    }
}
