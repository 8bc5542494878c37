//! The OpenAPI description: collected from the calls, completed with what holds for all of them.

use super::problem::{Document, Kind};
use crate::jobs::Limits;
use std::fmt::Write;
use utoipa::OpenApi;
use utoipa::openapi::path::{Operation, PathItem};
use utoipa::openapi::{ContentBuilder, Ref, RefOr, ResponseBuilder};

pub const JOBS: &str = "jobs";
pub const INCREMENTS: &str = "increments";
pub const STUDIES: &str = "studies";
pub const SCENES: &str = "scenes";
pub const PROBES: &str = "probes";

const DESCRIPTION: &str = "\
Takes structural models with unilateral contact and Coulomb friction and traces their equilibrium paths.

A job is queued by `POST /v1/jobs`; its increments can be followed as they converge (`/stream`) or read later \
(`/increments`, `/path.csv`). An increment is the same bytes everywhere, and the same as `arcslip solve` prints, but for \
`elapsed_s`.

Every answer carries an `x-request-id`; a short plain one that a request brings is kept. Bodies are `application/json`; \
unknown members and unknown query parameters are refused. Every error is `application/problem+json` \
(RFC 9457) with one of these types:

| type | status | title |
|---|---|---|
";

#[derive(OpenApi)]
#[openapi(
    info(title = "arcslip"),
    components(schemas(Document)),
    tags(
        (name = JOBS, description = "Paths to be traced"),
        (name = INCREMENTS, description = "Points of a path, as they converge or later"),
        (name = STUDIES, description = "One scene over a ladder of settings and over methods: error against run time"),
        (name = SCENES, description = "Built-in models, ready to post"),
        (name = PROBES, description = "For whoever runs the service"),
    )
)]
struct Base;

pub fn base() -> utoipa::openapi::OpenApi {
    Base::openapi()
}

/// The document as text, with the problems and the limits in it.
pub fn finish(mut document: utoipa::openapi::OpenApi, limits: &Limits) -> serde_json::Result<String> {
    let mut description = DESCRIPTION.to_owned();
    for kind in Kind::ALL {
        let (name, status, title) = kind.parts();
        // Writing to a string does not fail.
        let _ = writeln!(description, "| `{name}` | {} | {title} |", status.as_u16());
    }
    let _ = write!(description, "\nThis service's limits, within those of the model's schema:\n\n{limits}");
    document.info.description = Some(description);
    for operation in document.paths.paths.values_mut().flat_map(operations) {
        let content = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem"))).build();
        let problem =
            ResponseBuilder::new().description("A problem.").content("application/problem+json", content).build();
        operation.responses.responses.insert("default".to_owned(), RefOr::T(problem));
    }
    let mut text = serde_json::to_string_pretty(&document)?;
    text.push('\n');
    Ok(text)
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = &mut Operation> {
    [&mut item.get, &mut item.post, &mut item.delete].into_iter().flatten()
}
