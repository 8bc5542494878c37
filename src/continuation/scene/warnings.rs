//! What is valid in a model and may be a mistake.

use crate::model::Model;
use crate::model::request::{Contact, Element};
use crate::model::solids::contact_surfaces::ContactSurfaces;
use crate::result::plan::Warning;
use std::collections::HashMap;

/// Coefficients of friction above this value are rather angles in degrees.
const LARGEST_USUAL_FRICTION: f64 = 5.0;

/// Warnings of one kind that are listed.
const MOST_LISTED: usize = 5;

/// The warnings of a checked model.
pub(crate) fn warnings(model: &Model) -> Vec<Warning> {
    let mut warnings = large_friction(model);
    warnings.extend(doubled_bars(model));
    warnings.extend(overlapping_meshes(model));
    warnings
}

fn large_friction(model: &Model) -> Vec<Warning> {
    let large = model.contacts.iter().enumerate().filter(|(_, contact)| contact.friction > LARGEST_USUAL_FRICTION);
    let warning = |(place, contact): (usize, &Contact)| Warning {
        pointer: format!("/model/contacts/{place}/friction"),
        detail: format!(
            "the coefficient {:?} is unusually large; of an angle in degrees the coefficient is the tangent",
            contact.friction
        ),
    };
    large.take(MOST_LISTED).map(warning).collect()
}

/// Surfaces whose meshes overlap where they touch at the start.
fn overlapping_meshes(model: &Model) -> Vec<Warning> {
    let surfaces = ContactSurfaces::new(model, 1.0);
    let bodies = model.contacts.iter().enumerate().filter(|(_, contact)| contact.against.is_some());
    let overlap = |(place, contact): (usize, &Contact)| {
        let body = surfaces.contact(contact, model.nodes.get_index_of(&contact.node)?).ok()?;
        (body.overlap > 0.0).then_some((place, body.overlap))
    };
    let overlaps: Vec<(usize, f64)> = bodies.filter_map(overlap).collect();
    let Some((place, _)) = overlaps.first() else { return Vec::new() };
    let most = overlaps.iter().fold(0.0_f64, |most, (_, overlap)| most.max(*overlap));
    let detail = format!(
        "the meshes overlap at the start: {} contacts of bodies by up to {most:e}; they begin closed, without reaction",
        overlaps.len()
    );
    vec![Warning { pointer: format!("/model/contacts/{place}"), detail }]
}

/// Bars that join the same two nodes as one before them.
fn doubled_bars(model: &Model) -> Vec<Warning> {
    let mut first_between: HashMap<[&str; 2], usize> = HashMap::new();
    let mut warnings = Vec::new();
    for (place, element) in model.elements.iter().enumerate() {
        let (Element::Bar { .. }, [one, other]) = (element, element.nodes()) else { continue };
        let ends = if one <= other { [one.as_str(), other.as_str()] } else { [other.as_str(), one.as_str()] };
        let first = *first_between.entry(ends).or_insert(place);
        if first != place && warnings.len() < MOST_LISTED {
            let detail = format!("bar {first} joins the same nodes; both carry force");
            warnings.push(Warning { pointer: format!("/model/elements/{place}"), detail });
        }
    }
    warnings
}
