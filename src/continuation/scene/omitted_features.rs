//! Features that a scene does not need, and why: the text of the plan.

use crate::continuation::scene::Scene;
use crate::continuation::scene::recorded_contacts::way_to_contact;
use crate::continuation::scene::tolerances::REACH_IN_STEPS;
use crate::mechanics::contact::ContactPair;
use crate::mechanics::structure::{MOST_ANALYSED, Structure};
use crate::model::input::limits::MAX_ROWS_UNASKED;
use crate::model::request::{Analysis, Method};
use crate::result::plan::LeftOut;

/// Whether straight stretches are traced as one increment each.
pub(crate) fn jumps(analysis: &Analysis, structure: &Structure) -> bool {
    analysis.arc_length.jump && !analysis.keep_all && analysis.method != Method::Regularised && structure.is_linear()
}

/// Features that this scene does not need, except those found while its contacts are read.
pub(crate) fn left_out(scene: &Scene) -> Vec<LeftOut> {
    let (contacts, analysis) = (&scene.contacts, &scene.analysis);
    let mut left_out = Vec::new();
    let mut leave = |what: &str, why: &str| left_out.push(LeftOut { what: what.to_owned(), why: why.to_owned() });
    let frictionless = !contacts.iter().any(|contact| contact.friction.is_rough());
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
    if scene.structure.is_linear() && !scene.contacts.iter().any(ContactPair::is_curved) {
        leave("nonlinear iterations", "every element is linear: one correction is exact");
    }
    left_out.extend(penalty_method(analysis));
    left_out.extend(contacts_out_of_reach(scene));
    left_out.extend(straight_stretches(scene));
    left_out
}

/// Entries of the plan on the contacts that are out of reach where the path begins.
fn contacts_out_of_reach(scene: &Scene) -> Vec<LeftOut> {
    let analysis = &scene.analysis;
    if analysis.keep_all || analysis.method == Method::Regularised {
        return Vec::new();
    }
    let reach = REACH_IN_STEPS * analysis.arc_length.initial;
    let gap = |contact: usize| scene.contacts[contact].gap(&[0.0; 3]);
    let still = vec![0.0; scene.structure.freedoms()];
    let is_far = |contact: &usize| way_to_contact(scene, *contact, &still, gap(*contact)) > reach;
    let far = (0..scene.contacts.len()).filter(is_far).count();
    let mut left_out = Vec::new();
    if far > 0 {
        left_out.push(LeftOut {
            what: format!("{far} of {} contacts, each until the path comes near it", scene.contacts.len()),
            why: format!("their gaps cannot close within {REACH_IN_STEPS} steps"),
        });
    }
    if let (true, Some(asked)) = (far > 0, &scene.asked_rows)
        && asked.is_empty()
    {
        left_out.push(LeftOut {
            what: "rows of contacts out of reach, each until the path comes near it".to_owned(),
            why: match analysis.record.as_ref().and_then(|record| record.contacts.as_ref()) {
                None => {
                    format!("of more than {MAX_ROWS_UNASKED} contacts, only rows in `record.contacts` are given before")
                }
                Some(_) => "`record.contacts` asks for those in reach".to_owned(),
            },
        });
    }
    left_out
}

/// Entry of the plan on straight stretches.
fn straight_stretches(scene: &Scene) -> Option<LeftOut> {
    scene.jumps.then(|| LeftOut {
        what: "increments between events, but for stretches of bifurcations".to_owned(),
        why: "every element is linear: the path is straight while the obstacles in reach are planes and no slip turns; give \
              `arc_length.max` to have points in between"
            .to_owned(),
    })
}

/// Entry of the plan on the simplifications of the penalty method.
fn penalty_method(analysis: &Analysis) -> Option<LeftOut> {
    let parameters = analysis.regularised.unwrap_or_default();
    (analysis.method == Method::Regularised).then(|| LeftOut {
        what: "exact contact and friction laws, located events and directions".to_owned(),
        why: format!(
            "method `regularised`: a normal penalty of {:e} and a tangential one of {:e} times force_scale over \
             displacement_scale stand for the laws",
            parameters.normal_penalty, parameters.tangential_penalty
        ),
    })
}
