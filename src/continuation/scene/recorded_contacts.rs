//! The contacts that have a row in every increment, and the speed at which their gaps can close.

use crate::continuation::scene::Scene;
use crate::mechanics::contact::vector::size;
use crate::mechanics::problem::contact_jacobian;
use crate::model::JobRequest;
use crate::model::input::limits::MAX_ROWS_UNASKED;
use crate::model::request::{ContactRange, Method, RecordedContacts};
use std::collections::HashSet;

/// The arc length before which a contact with this gap cannot close, in any stage.
pub(crate) fn way_to_contact(scene: &Scene, contact: usize, displacement: &[f64], gap: f64) -> f64 {
    let shift = scene.stages.iter().fold(0.0_f64, |most, stage| most.max(size(&stage.pattern.shifts[contact])));
    let (distance, fastest) =
        contact_jacobian::clearance(&scene.structure, &scene.contacts[contact], displacement, gap);
    distance / shift.hypot(fastest)
}

/// Indices of the request's contacts that have a row in every increment, in reach or not; `None`: all.
pub(crate) fn asked_rows(request: &JobRequest) -> Option<Vec<usize>> {
    let (analysis, contacts) = (&request.analysis, &request.model.contacts);
    if analysis.keep_all || analysis.method == Method::Regularised {
        return None;
    }
    match analysis.record.as_ref().and_then(|record| record.contacts.as_ref()) {
        None if contacts.len() <= MAX_ROWS_UNASKED => None,
        Some(RecordedContacts::Range(ContactRange::All)) => None,
        None | Some(RecordedContacts::Range(ContactRange::InReach)) => Some(Vec::new()),
        Some(RecordedContacts::Named(named)) => {
            let named: HashSet<(&str, &str)> =
                named.iter().map(|one| (one.node.as_str(), one.obstacle.as_str())).collect();
            let is_named = |index: &usize| {
                let contact = &contacts[*index];
                named.contains(&(contact.node.as_str(), contact.counterpart()))
            };
            Some((0..contacts.len()).filter(is_named).collect())
        }
    }
}
