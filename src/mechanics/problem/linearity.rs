//! Whether the path is piecewise straight: linear elements, planes, and slip along lines.

use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::{ContactPair, Sliding};
use crate::mechanics::problem::loading::Loading;

/// Whether a contact leaves the path of linear elements piecewise straight.
pub(crate) fn is_straight(contact: &ContactPair) -> bool {
    let plane = matches!(contact.obstacle, RigidSurface::Plane { .. }) && contact.kinematics.node().is_some();
    plane && (!contact.friction.is_rough() || contact.sliding != Sliding::Plane)
}

/// Whether the path is piecewise straight, so that every direction of first order holds exactly over a finite length.
pub(crate) fn is_linear(loading: Loading<'_>) -> bool {
    loading.corners.is_empty() && loading.contacts.iter().all(is_straight) && loading.structure.is_linear()
}
