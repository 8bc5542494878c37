//! What is valid in a model and may be a mistake.

use crate::model::input::names::quoted;
use crate::model::request::recorded_forces::MAX_FORCES_UNASKED;
use crate::model::request::{Contact, Element};
use crate::model::solids::contact_surfaces::ContactSurfaces;
use crate::model::{JobRequest, Model};
use crate::result::plan::Warning;
use std::collections::{HashMap, HashSet};

/// Coefficients of friction above this value are rather angles in degrees.
const LARGEST_USUAL_FRICTION: f64 = 5.0;

/// Warnings of one kind that are listed.
const MOST_LISTED: usize = 5;

/// The warnings of a checked request.
pub(crate) fn warnings(request: &JobRequest) -> Vec<Warning> {
    let model = &request.model;
    let mut warnings = large_friction(model);
    warnings.extend(unrecorded_forces(request));
    warnings.extend(doubled_bars(model));
    let surfaces = ContactSurfaces::new(model, 1.0);
    warnings.extend(overlapping_meshes(model, &surfaces));
    warnings.extend(exchanged_surfaces(model, &surfaces));
    warnings
}

fn large_friction(model: &Model) -> Vec<Warning> {
    let large = model.contacts.iter().enumerate().filter(|(_, contact)| contact.friction > LARGEST_USUAL_FRICTION);
    let warning = |(place, contact): (usize, &Contact)| Warning {
        pointer: format!("/model/contacts/{}/friction", model.posted_contact(place)),
        detail: format!(
            "the coefficient {:?} is unusually large; of an angle in degrees the coefficient is the tangent",
            contact.friction
        ),
    };
    let mut warnings: Vec<Warning> = large.map(warning).collect();
    warnings.dedup_by(|one, other| one.pointer == other.pointer);
    cut(warnings)
}

/// The first warnings of a kind; the last of them says how many there are besides.
fn cut(mut warnings: Vec<Warning>) -> Vec<Warning> {
    let more = warnings.len().saturating_sub(MOST_LISTED);
    warnings.truncate(MOST_LISTED);
    if let Some(last) = warnings.last_mut().filter(|_| more > 0) {
        last.detail.push_str(&format!("; the same holds at {more} more places"));
    }
    warnings
}

/// Forces that an increment does not have, though nobody has said so.
fn unrecorded_forces(request: &JobRequest) -> Vec<Warning> {
    let (model, record) = (&request.model, request.analysis.record.as_ref());
    let warning = |member: &str, what: &str, count: usize| Warning {
        pointer: format!("/analysis/record/{member}"),
        detail: format!(
            "the forces of {count} {what} are not recorded, as there are more than {MAX_FORCES_UNASKED}: ask for them by \
             \"record\": {{\"{member}\": \"all\"}} in the analysis, or a list of them"
        ),
    };
    let elements = record.is_none_or(|record| record.elements.is_none()) && model.elements.len() > MAX_FORCES_UNASKED;
    let supports = record.is_none_or(|record| record.supports.is_none()) && model.supports.len() > MAX_FORCES_UNASKED;
    let elements = elements.then(|| warning("elements", "elements", model.elements.len()));
    elements.into_iter().chain(supports.then(|| warning("supports", "supports", model.supports.len()))).collect()
}

/// Surfaces whose meshes overlap where they touch at the start.
fn overlapping_meshes(model: &Model, surfaces: &ContactSurfaces<'_>) -> Vec<Warning> {
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
    vec![Warning { pointer: format!("/model/contacts/{}", model.posted_contact(*place)), detail }]
}

/// Mortar contacts whose `surface` reaches beyond an end of the other, which stays within its own.
fn exchanged_surfaces(model: &Model, surfaces: &ContactSurfaces<'_>) -> Vec<Warning> {
    let mut seen: HashSet<(Option<&str>, Option<&str>)> = HashSet::new();
    let mut warnings = Vec::new();
    for (place, contact) in model.contacts.iter().enumerate().filter(|(_, contact)| contact.against.is_some()) {
        let names = (contact.surface.as_deref(), contact.against.as_deref());
        if !seen.insert(names) || !surfaces.reaches_beyond(contact) {
            continue;
        }
        let [own, other] = [names.0, names.1].map(|name| quoted(name.unwrap_or_default()));
        let detail = format!(
            "{own} reaches beyond an end of {other}: where that end passes a node of {own}, gaps jump and the path \
             may end; with {other} as `surface` and {own} as `against` it does not"
        );
        warnings.push(Warning { pointer: format!("/model/contacts/{}/surface", model.posted_contact(place)), detail });
    }
    cut(warnings)
}

/// Bars that join the same two nodes as one before them.
fn doubled_bars(model: &Model) -> Vec<Warning> {
    let mut first_between: HashMap<[&str; 2], usize> = HashMap::new();
    let mut warnings = Vec::new();
    for (place, element) in model.elements.iter().enumerate() {
        let (Element::Bar { .. }, [one, other]) = (element, element.nodes()) else { continue };
        let ends = if one <= other { [one.as_str(), other.as_str()] } else { [other.as_str(), one.as_str()] };
        let first = *first_between.entry(ends).or_insert(place);
        if first != place {
            let detail = format!("bar {first} joins the same nodes; both carry force");
            warnings.push(Warning { pointer: format!("/model/elements/{place}"), detail });
        }
    }
    cut(warnings)
}

#[cfg(test)]
mod tests {
    use super::{MAX_FORCES_UNASKED, warnings};
    use crate::model::JobRequest;
    use serde_json::{Map, Value, json};

    /// A row of bars, with `record` in its analysis.
    fn row_of(bars: usize, record: &Value) -> JobRequest {
        let nodes: Map<String, Value> = (0..=bars).map(|k| (format!("n{k}"), json!([k as f64, 0.0]))).collect();
        let bar = |k: usize| json!({"kind": "bar", "nodes": [format!("n{k}"), format!("n{}", k + 1)], "axial_stiffness": 1.0});
        let model = json!({
            "dimension": 2, "nodes": nodes, "elements": (0..bars).map(bar).collect::<Vec<Value>>(),
            "supports": {"n0": ["x", "y"]}, "stages": [{"name": "pull", "forces": {"n1": [1, 0]}, "until": {"load_above": 1}}],
        });
        serde_json::from_value(json!({"model": model, "analysis": {"record": record}})).expect("a request")
    }

    #[test]
    fn warnings_that_are_not_listed_are_counted() {
        let mut request = row_of(1, &json!({}));
        let bar = request.model.elements[0].clone();
        request.model.elements.extend((0..40).map(|_| bar.clone()));
        let told = warnings(&request);
        assert_eq!(told.len(), 5);
        assert!(told[4].detail.ends_with("; the same holds at 35 more places"), "{}", told[4].detail);
    }

    /// Two blocks, each a row of square elements as wide as `widths` says, the upper one in the middle of the lower one.
    fn blocks(widths: [usize; 2], surface: usize, discretisation: &str) -> JobRequest {
        let (mut nodes, mut elements, mut faces) = (Map::new(), Vec::new(), Vec::new());
        for (body, width) in widths.into_iter().enumerate() {
            let name = |x: usize, y: usize| format!("{body}_{x}_{y}");
            for (x, y) in (0..=width).flat_map(|x| [(x, 0), (x, 1)]) {
                nodes.insert(name(x, y), json!([x as f64 - 0.5 * width as f64, body + y]));
            }
            for x in 0..width {
                let corners = [name(x, 0), name(x + 1, 0), name(x + 1, 1), name(x, 1)];
                elements.push(json!({"kind": "quadrilateral4", "nodes": corners, "material": "rubber"}));
            }
            let side = 1 - body;
            faces.push((0..width).map(|x| [name(x, side), name(x + 1, side)]).collect::<Vec<_>>());
        }
        let names = ["lower", "upper"];
        let model = json!({
            "dimension": 2, "nodes": nodes, "elements": elements,
            "materials": {"rubber": {"kind": "neo_hookean", "young": 1.0, "poisson": 0.3}},
            "surfaces": {"lower": {"faces": faces[0]}, "upper": {"faces": faces[1]}},
            "contacts": [{"surface": names[surface], "against": names[1 - surface], "friction": 0.3,
                          "discretisation": discretisation}],
            "stages": [{"name": "push", "forces": {"1_0_1": [1, 0]}, "until": {"load_above": 1}}],
        });
        let text = serde_json::to_vec(&json!({"model": model})).expect("JSON");
        crate::model::decode::decode(&text).expect("a request")
    }

    #[test]
    fn a_surface_that_reaches_beyond_the_other_is_told() {
        let told =
            |request: JobRequest| warnings(&request).into_iter().map(|warning| warning.pointer).collect::<Vec<_>>();
        let is = ["/model/contacts/0/surface"];
        assert_eq!(told(blocks([4, 2], 0, "mortar")), is);
        assert_eq!(told(blocks([2, 4], 1, "mortar")), is);
        for request in [
            blocks([4, 2], 1, "mortar"),
            blocks([2, 4], 0, "mortar"),
            blocks([3, 3], 0, "mortar"),
            blocks([4, 2], 0, "node_to_surface"),
        ] {
            assert_eq!(told(request), Vec::<String>::new());
        }
        // Both begin at the same place, as on an axis of symmetry.
        let mut aligned = blocks([4, 2], 0, "mortar");
        for (_, place) in aligned.model.nodes.iter_mut().filter(|(name, _)| name.starts_with("1_")) {
            place[0] -= 1.0;
        }
        assert_eq!(told(aligned), is);
    }

    #[test]
    fn forces_that_nobody_has_asked_for_are_told() {
        let told = |bars: usize, record: Value| warnings(&row_of(bars, &record)).len();
        assert_eq!(told(MAX_FORCES_UNASKED, json!({})), 0);
        let [warning] = &warnings(&row_of(MAX_FORCES_UNASKED + 1, &json!({})))[..] else { panic!("one warning") };
        assert_eq!(warning.pointer, "/analysis/record/elements");
        assert!(warning.detail.starts_with("the forces of 201 elements are not recorded"), "{}", warning.detail);
        for said in [json!("all"), json!("none"), json!([3])] {
            assert_eq!(told(MAX_FORCES_UNASKED + 1, json!({"elements": said})), 0);
        }
    }
}
