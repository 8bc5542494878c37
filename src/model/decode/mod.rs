//! JSON text to a job request, with all mistakes of form.
//!
//! The types and their names are those of [`crate::model::request`]; a test holds the two equal. They are not read by serde's
//! derived code because that stops at the first mistake and does not say where it is.

mod analysis;
mod follow;
mod model;
mod reader;
mod study;
mod sweep;
#[cfg(test)]
mod tests;

use crate::model::input::json::Json;
use crate::model::input::mistakes::Mistakes;
use crate::model::{FollowRequest, InputError, InputErrors, JobRequest, StudyRequest};
use reader::{Fields, Input};

const JOB_REQUEST: Fields = Fields { what: "a job request", known: &["model", "analysis"], later: &[] };
const SWEEP_REQUEST: Fields = Fields { what: "a sweep", known: &["model", "analysis", "sweep"], later: &[] };
const STUDY_REQUEST: Fields = Fields { what: "a study", known: &["model", "analysis", "study"], later: &[] };

/// Reads a job request from JSON text and checks nothing but form; [`crate::model::check::check`] looks at the rest.
///
/// # Errors
/// Text that cannot be read as JSON is one error. Otherwise every mistake is listed (up to
/// [`MAX_LISTED_MISTAKES`](crate::model::input::limits::MAX_LISTED_MISTAKES)): missing, unknown and duplicate members, wrong types,
/// unknown values, and what this version does not have.
pub fn decode(text: &[u8]) -> Result<JobRequest, InputErrors> {
    read(text, JOB_REQUEST.what, job_request)
}

/// Reads a study from JSON text and checks nothing but form; [`crate::model::check::study`] looks at the rest.
///
/// # Errors
/// As for [`decode`].
pub fn study(text: &[u8]) -> Result<StudyRequest, InputErrors> {
    read(text, STUDY_REQUEST.what, study_request)
}

/// Reads from a sweep's JSON text what it replaces; its model is read with the values put in it.
///
/// # Errors
/// As for [`decode`].
pub fn replacements(text: &[u8]) -> Result<sweep::Form, InputErrors> {
    read(text, SWEEP_REQUEST.what, |input, mistakes| {
        let object = input.object(&SWEEP_REQUEST, mistakes)?;
        object.required("model", mistakes, |_, _| Some(()))?;
        object.required("sweep", mistakes, sweep::sweep)
    })
}

/// The outermost object of a document, for whoever changes something in it before it is read.
///
/// # Errors
/// Text that is no JSON object, and members that stand twice in it: who reads them otherwise takes one of them.
pub fn object(text: &[u8]) -> Result<serde_json::Map<String, serde_json::Value>, InputErrors> {
    read(text, "an object", |input, mistakes| input.map(mistakes, |_, _| Some(())).map(drop))?;
    serde_json::from_slice(text).map_err(|error| InputErrors(vec![InputError::new("", error.to_string())]))
}

/// Reads a request to follow a direction from JSON text, and checks it as far as it goes by itself.
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
    // A reader that returns nothing has noted why, so the error here is for a defect: a refusal, not a panic.
    request.ok_or_else(|| InputErrors(vec![InputError::new("", format!("the document could not be read as {what}"))]))
}

fn job_request(input: &Input, mistakes: &mut Mistakes) -> Option<JobRequest> {
    let object = input.object(&JOB_REQUEST, mistakes)?;
    let model = object.required("model", mistakes, model::model);
    let analysis = object.with_default("analysis", Default::default(), mistakes, analysis::analysis);
    Some(JobRequest { model: model?, analysis: analysis? })
}

fn study_request(input: &Input, mistakes: &mut Mistakes) -> Option<StudyRequest> {
    let object = input.object(&STUDY_REQUEST, mistakes)?;
    let model = object.required("model", mistakes, model::model);
    let analysis = object.with_default("analysis", Default::default(), mistakes, analysis::analysis);
    let study = object.with_default("study", Default::default(), mistakes, study::study);
    Some(StudyRequest { model: model?, analysis: analysis?, study: study? })
}
