//! What increments report: the contacts of the request, and the elements and supports with their forces.

use crate::model::JobRequest;
use crate::model::request::recorded_forces::recorded_elements;
use crate::result::nodal_values::NodalValues;
use std::sync::Arc;

/// A contact of the request and its share of the contact that is solved for.
#[derive(Debug, Clone)]
pub(crate) struct Reported {
    pub node: Arc<str>,
    pub obstacle: Arc<str>,
    /// Index of the scene's contact.
    pub contact: usize,
    /// Shares of the normal and tangential reaction; 1 unless contacts coincide.
    pub normal_share: f64,
    pub tangential_share: f64,
    /// Whether other contacts of the request share the scene's contact.
    pub shared: bool,
}

/// What of the forces an increment has. The reactions of all supports are computed, since the measure needs them for the
/// balance of the whole structure; those that the request does not ask for are left out after the increment is measured.
#[derive(Debug, Clone)]
pub(crate) struct RecordedForces {
    /// Places of the elements, ascending, with their names.
    pub elements: Vec<(usize, Option<Arc<str>>)>,
    /// Node numbers of the supports, in the order of the request.
    pub supported_nodes: Vec<usize>,
    /// Reactions without values, whose names those of each increment share.
    pub no_reactions: NodalValues,
}

impl RecordedForces {
    pub fn of(request: &JobRequest) -> Self {
        let model = &request.model;
        let named = |place: usize| (place, model.elements[place].name().map(Arc::from));
        let rotating = model.rotating_nodes();
        let reactions = |name: &String| {
            let rotates = model.nodes.get_index_of(name).is_some_and(|number| rotating[number]);
            (Arc::from(name.as_str()), vec![0.0; model.dimension + if rotates { model.rotations() } else { 0 }])
        };
        Self {
            elements: recorded_elements(request).into_iter().map(named).collect(),
            supported_nodes: model.supports.keys().filter_map(|name| model.nodes.get_index_of(name)).collect(),
            no_reactions: model.supports.keys().map(reactions).collect(),
        }
    }
}
