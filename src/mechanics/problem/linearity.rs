//! Whether nothing bends the path: linear elements, planes, and slip along lines.

use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::{ContactPair, Sliding};
use crate::mechanics::problem::loading::Loading;

/// Whether nothing about a contact bends a path of linear elements.
pub(crate) fn is_straight(contact: &ContactPair) -> bool {
    let plane = matches!(contact.obstacle, RigidSurface::Plane { .. });
    plane && (!contact.friction.is_rough() || contact.sliding != Sliding::Plane)
}

/// Whether every direction of first order holds exactly over some way: nothing bends it.
pub(crate) fn is_linear(loading: Loading<'_>) -> bool {
    loading.corners.is_empty() && loading.contacts.iter().all(is_straight) && loading.structure.is_linear()
}
