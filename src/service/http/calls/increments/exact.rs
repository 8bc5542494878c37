//! The path of a job in closed form, where its model belongs to a family with an exact solution, for plots over the computed
//! path.

use crate::check::scenes::exact::{self, CurvePlace, Reach};
use crate::model::JobRequest;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use axum::response::Response;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Points on each smooth piece of the path.
const POINTS: usize = 96;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ExactParameters {
    /// Unbounded branches go up to this load factor, in size.
    #[param(exclusive_minimum = 0, default = 10)]
    load: Option<f64>,
    /// Unbounded branches go up to this displacement (length), in size.
    #[param(exclusive_minimum = 0, default = 10)]
    displacement: Option<f64>,
}

impl QueryParameters for ExactParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] =
        &[("load", "a number above 0"), ("displacement", "a number above 0")];
}

const FAR: f64 = 10.0;

/// A path in closed form.
#[derive(Debug, Serialize, ToSchema)]
pub struct ExactPath {
    /// The family's name; null where the model is of none.
    pub name: Option<&'static str>,
    /// The formula in a line.
    pub formula: Option<&'static str>,
    /// Of the model's stages, in order; those past the last that is known are left out.
    pub stages: Vec<ExactStage>,
}

/// Points along a stage, close enough to be joined by lines.
#[derive(Debug, Serialize, ToSchema)]
pub struct ExactStage {
    pub name: String,
    pub load_factor: Vec<f64>,
    /// Node name to its components, each an array with a number for every point (length).
    pub displacements: IndexMap<String, Vec<Vec<f64>>>,
}

/// The job's path in closed form, if it is of a family with one.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/exact", tag = document::INCREMENTS, operation_id = "get_exact_path",
    params(ExactParameters),
    responses((status = 200, description = "The path; without stages where none is known.", body = ExactPath))
)]
pub async fn exact(
    target: Target<Job>,
    Parameters(parameters): Parameters<ExactParameters>,
) -> Result<Response, Problem> {
    let reach = Reach {
        load: positive("load", parameters.load)?,
        displacement: positive("displacement", parameters.displacement)?,
    };
    let job = target.find().await?;
    let Target { service, id, headers, .. } = target;
    let text = service.jobs.store().request(id).await?.ok_or_else(|| Problem::not_found(format_args!("job {id}")))?;
    let bytes = text.len();
    // The path of a job that follows a direction of another job is not known in closed form.
    let is_whole = job.parent.is_none();
    let make = move || {
        let request: Option<JobRequest> = if is_whole { Some(serde_json::from_str(&text)?) } else { None };
        tag::json(&headers, true, &path(request.as_ref(), reach))
    };
    service.offload.run(bytes, make).await
}

fn path(request: Option<&JobRequest>, reach: Reach) -> ExactPath {
    let known = request.and_then(|request| Some((request, exact::recognise(request)?)));
    let Some((request, known)) = known else {
        return ExactPath { name: None, formula: None, stages: Vec::new() };
    };
    let stages = known.stages(reach).iter().map(|stage| sampled(request, stage)).collect();
    ExactPath { name: Some(known.name()), formula: Some(known.formula()), stages }
}

fn positive(name: &str, given: Option<f64>) -> Result<f64, Problem> {
    match given {
        None => Ok(FAR),
        Some(number) if number.is_finite() && number > 0.0 => Ok(number),
        Some(number) => Err(Problem::parameter(name, format_args!("found {number}; a number above 0 is expected"))),
    }
}

fn sampled(request: &JobRequest, stage: &exact::CurveStage) -> ExactStage {
    let pieces = stage.pieces.iter();
    let places: Vec<CurvePlace> = pieces
        .flat_map(|piece| (0..=POINTS).map(|point| piece.at(piece.parameter(point as f64 / POINTS as f64))))
        .filter(|place| place.load.is_finite() && place.displacements.iter().all(|component| component.is_finite()))
        .collect();
    let dimension = request.model.dimension;
    let along = |freedom: usize| places.iter().filter_map(|place| place.displacements.get(freedom).copied()).collect();
    let nodes = request.model.nodes.keys().enumerate();
    ExactStage {
        name: stage.name.clone(),
        load_factor: places.iter().map(|place| place.load).collect(),
        displacements: nodes
            .map(|(node, name)| {
                (name.clone(), (0..dimension).map(|component| along(dimension * node + component)).collect())
            })
            .collect(),
    }
}
