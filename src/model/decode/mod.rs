//! Decodes JSON text into a request and lists all mistakes of form.
//!
//! The types and their names are those of [`crate::model::request`]; a test compares both. serde's derived code is not used,
//! because it stops at the first mistake and does not report its place.

mod analysis;
mod curve;
mod follow;
mod meshes;
mod model;
mod obstacles;
mod reader;
mod sets;
mod solids;
mod study;
mod sweep;
#[cfg(test)]
mod tests;

use crate::model::input::json::Json;
use crate::model::input::mistakes::Mistakes;
use crate::model::request::curve::CurveSettings;
use crate::model::solids::middle_nodes::straighten;
use crate::model::{Analysis, FollowRequest, InputError, InputErrors, JobRequest, Model, StudyRequest};
use reader::{Fields, Input, Object};

const JOB_REQUEST: Fields = Fields { what: "a job request", known: &["model", "analysis"], later: &[] };
const SWEEP_REQUEST: Fields = Fields { what: "a sweep", known: &["model", "analysis", "sweep"], later: &[] };
const CURVE_REQUEST: Fields =
    Fields { what: "a curve of limit points", known: &["model", "analysis", "curve"], later: &[] };
const STUDY_REQUEST: Fields = Fields { what: "a study", known: &["model", "analysis", "study"], later: &[] };

/// Reads a job request from JSON text and only checks its form; [`crate::model::check::check`] checks the rest.
///
/// # Errors
/// Text that cannot be read as JSON is one error. Otherwise every mistake is listed (up to
/// [`MAX_LISTED_MISTAKES`](crate::model::input::limits::MAX_LISTED_MISTAKES)): missing, unknown and duplicate members, wrong types,
/// unknown values, and what this version does not have.
pub fn decode(text: &[u8]) -> Result<JobRequest, InputErrors> {
    read(text, JOB_REQUEST.what, job_request)
}

/// Reads a study from JSON text and only checks its form; [`crate::model::check::study`] checks the rest.
///
/// # Errors
/// As for [`decode`].
pub fn study(text: &[u8]) -> Result<StudyRequest, InputErrors> {
    read(text, STUDY_REQUEST.what, study_request)
}

/// Reads the replacements in the JSON text of a sweep; its model is read later, with the values inserted.
///
/// # Errors
/// As for [`decode`].
pub fn replacements(text: &[u8]) -> Result<sweep::Form, InputErrors> {
    read(text, SWEEP_REQUEST.what, |input, mistakes| {
        let object = request(input, &SWEEP_REQUEST, mistakes)?;
        object.required("model", mistakes, |_, _| Some(()))?;
        if !input.has("sweep") {
            let example = r#"{"replace": {"/model/contacts/0/friction": [0.1, 0.2]}}"#;
            return input.note(&format!("the field `sweep` is missing; it says what varies, as `{example}`"), mistakes);
        }
        object.required("sweep", mistakes, sweep::sweep)
    })
}

/// Reads the settings in the JSON text of a curve of limit points; its model is read later, with the values inserted.
///
/// # Errors
/// As for [`decode`].
pub fn curve(text: &[u8]) -> Result<CurveSettings, InputErrors> {
    read(text, CURVE_REQUEST.what, |input, mistakes| {
        let object = request(input, &CURVE_REQUEST, mistakes)?;
        object.required("model", mistakes, |_, _| Some(()))?;
        if !input.has("curve") {
            let example = r#"{"parameter": "/model/contacts/0/friction", "range": [0.1, 0.5]}"#;
            return input.note(&format!("the field `curve` is missing; it says what varies, as `{example}`"), mistakes);
        }
        object.required("curve", mistakes, curve::curve)
    })
}

/// Reads the settings of a curve of limit points by themselves, as `POST /v1/jobs/{id}/continue` takes them.
///
/// # Errors
/// As for [`decode`].
pub fn curve_settings(text: &[u8]) -> Result<CurveSettings, InputErrors> {
    read(text, "what a curve follows", curve::curve)
}

/// The outermost object of a document, which can be changed before it is decoded.
///
/// # Errors
/// The text is no JSON object, or a member occurs twice.
pub fn object(text: &[u8]) -> Result<serde_json::Map<String, serde_json::Value>, InputErrors> {
    read(text, "an object", |input, mistakes| input.map(mistakes, |_, _| Some(())).map(drop))?;
    serde_json::from_slice(text).map_err(|error| InputErrors(vec![InputError::new("", error.to_string())]))
}

/// Reads a request to follow a direction from JSON text, and checks what does not depend on the job.
///
/// # Errors
/// As for [`decode`].
pub fn follow(text: &[u8]) -> Result<FollowRequest, InputErrors> {
    read(text, follow::FOLLOW.what, follow::follow)
}

fn read<T>(text: &[u8], what: &str, reader: fn(&Input, &mut Mistakes) -> Option<T>) -> Result<T, InputErrors> {
    let document = Json::parse(text, what).map_err(|error| InputErrors(vec![error]))?;
    let root = Input::root(&document);
    let mut mistakes = Mistakes::default();
    reader::note_duplicates(&root, &mut mistakes);
    let request = reader(&root, &mut mistakes);
    mistakes.into_result()?;
    // A reader that returns `None` has noted a mistake; the error here only covers a defect.
    request.ok_or_else(|| InputErrors(vec![InputError::new("", format!("the document could not be read as {what}"))]))
}

/// The members of a request; a model that stands alone is one mistake, not one for each of its members.
fn request<'a>(input: &Input<'a>, fields: &Fields, mistakes: &mut Mistakes) -> Option<Object<'a>> {
    if input.has("nodes") && !input.has("model") {
        let detail = "the fields of a model stand where `model` is expected: put them into it, `{\"model\": {...}}`";
        return input.note(detail, mistakes);
    }
    input.object(fields, mistakes)
}

fn job_request(input: &Input, mistakes: &mut Mistakes) -> Option<JobRequest> {
    let object = request(input, &JOB_REQUEST, mistakes)?;
    let model = object.required("model", mistakes, model::model);
    let analysis = object.with_default("analysis", Default::default(), mistakes, analysis::analysis);
    let (mut model, mut analysis) = (model?, analysis?);
    expand(&mut model, &mut analysis, mistakes);
    Some(JobRequest { model, analysis })
}

/// The request with the parts of its mesh, and with the nodes of sets and surfaces in place of their names, `@name`: in
/// supports, loads, contacts and in what is recorded. Where bodies of quadratic solids touch each other the middles of the
/// edges of their surfaces are put on the chords. Requests read from JSON are expanded already.
///
/// # Errors
///
/// Mistakes in the mesh, every name that is unknown, every set without nodes, and every node that is given two values.
///
/// ```
/// use arcslip::{Component, JobRequest, Model, NamedSet, Stage};
///
/// let mut model = Model::new(2).node("a", [0.0, 0.0]).node("b", [1.0, 0.0]);
/// model.sets.insert("foot".into(), NamedSet { nodes: vec!["a".into(), "b".into()], elements: vec![] });
/// let request = JobRequest::from(model.support("@foot", [Component::Y]));
/// assert_eq!(arcslip::expanded(request)?.model.supports.len(), 2);
/// # Ok::<(), arcslip::InputErrors>(())
/// ```
pub fn expanded(mut request: JobRequest) -> Result<JobRequest, InputErrors> {
    let mut mistakes = Mistakes::default();
    expand(&mut request.model, &mut request.analysis, &mut mistakes);
    mistakes.into_result().map(|()| request)
}

/// Puts the parts of a mesh, then the nodes of sets and surfaces, in place of their names; and the middles of edges that follow
/// their ends onto the chords between these.
fn expand(model: &mut Model, analysis: &mut Analysis, mistakes: &mut Mistakes) {
    if meshes::expand(model, mistakes) {
        sets::expand(model, analysis, mistakes);
        straighten(model);
    }
}

fn study_request(input: &Input, mistakes: &mut Mistakes) -> Option<StudyRequest> {
    let object = request(input, &STUDY_REQUEST, mistakes)?;
    let model = object.required("model", mistakes, model::model);
    let analysis = object.with_default("analysis", Default::default(), mistakes, analysis::analysis);
    let study = object.with_default("study", Default::default(), mistakes, study::study);
    let (mut model, mut analysis) = (model?, analysis?);
    expand(&mut model, &mut analysis, mistakes);
    Some(StudyRequest { model, analysis, study: study? })
}
