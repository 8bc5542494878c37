//! What a scene needs and what is left out, said before anything is solved.

use super::scene::Scene;
use super::{near, regularised, straight};
use crate::model::request::Method;
use crate::structure::MOST_ANALYSED;
use crate::structure::element::Element;
use serde::{Deserialize, Serialize};

/// The plan of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Plan {
    /// Free displacement components.
    pub unknowns: u64,
    pub contacts: u64,
    pub stages: u64,
    /// Length that makes displacements dimensionless.
    pub displacement_scale: f64,
    /// Force that makes forces dimensionless.
    pub force_scale: f64,
    /// Load factor that makes the load dimensionless, one a stage.
    pub load_scales: Vec<f64>,
    /// What this scene does not need, and why.
    pub left_out: Vec<LeftOut>,
}

/// Something that is not done, and the reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct LeftOut {
    pub what: String,
    pub why: String,
}

/// What this scene does not need, but for what is found while its contacts are read.
pub(super) fn left_out(scene: &Scene) -> Vec<LeftOut> {
    let (contacts, analysis) = (&scene.contacts, &scene.analysis);
    let mut left_out = Vec::new();
    let mut leave = |what: &str, why: &str| left_out.push(LeftOut { what: what.to_owned(), why: why.to_owned() });
    let frictionless = contacts.iter().all(|contact| contact.friction == 0.0);
    if contacts.is_empty() {
        leave("contact unknowns, directions and complementarity programs", "the scene has no contacts");
    } else if frictionless {
        leave("tangential reactions and slip", "no contact has friction");
    }
    if scene.structure.dimension == 2 && !contacts.is_empty() {
        leave("second-order cones", "in two dimensions the friction cone is polyhedral");
    }
    if !frictionless && !analysis.keep_all && analysis.method != Method::Regularised {
        leave(
            "the search for other directions, where a certificate finds one for each sign of the load rate",
            "a linear complementarity problem with a P-matrix has one solution",
        );
    }
    if !contacts.is_empty() && analysis.method == Method::Mpec && !analysis.skips_certificate() {
        leave(
            "the program of an increment, where a certificate shows that a point of the expected contact mode solves it",
            "first and second derivatives along the mode's curve prove a strict local solution; `mpec.certificate: \"skip\"` \
             finds every increment by its program alone",
        );
    }
    if !scene.structure.allows_dense() {
        leave(
            "smooth bifurcation points, and directions at points where the held structure is singular",
            &format!("they are looked for up to {MOST_ANALYSED} unknowns"),
        );
    }
    if scene.structure.elements.iter().all(Element::is_linear) {
        leave("nonlinear iterations", "every element is linear: one correction is exact");
    }
    left_out.extend(regularised::left_out(analysis));
    left_out.extend(near::left_out(scene));
    left_out.extend(straight::left_out(scene));
    left_out
}
