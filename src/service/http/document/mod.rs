//! The OpenAPI description: collected from the calls and completed with what all calls share; `operations` completes each
//! operation.

pub(crate) mod operations;

use crate::service::http::access::admission;
use crate::service::http::answer::problem::{Document, Kind};
use crate::service::http::view::change::{ChangedTask, DeletedTask};
use crate::service::jobs::Limits;
use std::fmt::Write;
use utoipa::OpenApi;
use utoipa::openapi::security::{Http, HttpAuthScheme, SecurityRequirement, SecurityScheme};

pub const JOBS: &str = "jobs";
pub const INCREMENTS: &str = "increments";
pub const STUDIES: &str = "studies";
pub const SWEEPS: &str = "sweeps";
pub const CURVES: &str = "curves";
pub const SCENES: &str = "scenes";
pub const PROBES: &str = "probes";

const DESCRIPTION: &str = "\
Takes structural models with unilateral contact and Coulomb friction and traces their equilibrium paths.

A job is queued by `POST /v1/jobs`; its increments can be followed as they converge (`/stream`) or read later \
(`/increments`, `/path.csv`). An increment is the same bytes everywhere, and the same as `arcslip solve` prints, but for \
`elapsed_s`.

Where the service asks for tokens, send `Authorization: Bearer` and the token; `read` lets look, `submit` queue, follow, \
cancel and delete, `admin` all that of every owner. Other owners' jobs are answered as if they were not there, and \
idempotency keys of different owners do not meet. Too many requests of one address or token are answered 429; \
`Retry-After` says when to come back.

Finished jobs and studies, and what belongs to them, carry an `ETag`; `If-None-Match` with it is answered 304.

Every answer carries an `x-request-id`; a short plain one that a request brings is kept. Bodies are `application/json`; \
unknown members and unknown query parameters are refused. Every error is `application/problem+json` \
(RFC 9457) with one of these types:

| type | status | title |
|---|---|---|
";

/// The name of the security scheme.
const TOKEN: &str = "token";

#[derive(OpenApi)]
#[openapi(
    info(title = "arcslip"),
    external_docs(url = "/manual", description = "The manual: models, method, results, operation"),
    components(schemas(Document, ChangedTask, DeletedTask)),
    tags(
        (name = JOBS, description = "Paths to be traced"),
        (name = INCREMENTS, description = "Points of a path, as they converge or later"),
        (name = STUDIES, description = "One scene over a ladder of settings and over methods: error against run time"),
        (name = SWEEPS, description = "One model with other values in its places: limit loads"),
        (name = CURVES, description = "Limit points followed in a parameter of a model"),
        (name = SCENES, description = "Built-in models, ready to post"),
        (name = PROBES, description = "For whoever runs the service"),
    )
)]
struct Base;

pub fn base() -> utoipa::openapi::OpenApi {
    Base::openapi()
}

/// The document as text, completed with the kinds of problems and the limits; `asks_tokens`: every call needs a token.
pub fn finish(
    mut document: utoipa::openapi::OpenApi,
    limits: &Limits,
    asks_tokens: bool,
) -> serde_json::Result<String> {
    let mut description = DESCRIPTION.to_owned();
    for kind in Kind::ALL {
        let (name, status, title) = kind.parts();
        // Writing to a string does not fail.
        let _ = writeln!(description, "| `{name}` | {} | {title} |", status.as_u16());
    }
    let _ = write!(description, "\nThis service's limits, within those of the model's schema:\n\n{limits}");
    document.info.description = Some(description);
    for (path, item) in &mut document.paths.paths {
        for operation in [&mut item.get, &mut item.post, &mut item.delete].into_iter().flatten() {
            operations::complete(path, operation)?;
            if admission::is_public(path) {
                operation.security = Some(Vec::new());
            }
        }
    }
    let scheme = Http::builder().scheme(HttpAuthScheme::Bearer).description(Some("Of `arcslip token`.")).build();
    let components = document.components.get_or_insert_default();
    components.security_schemes.insert(TOKEN.to_owned(), SecurityScheme::Http(scheme).into());
    let token = SecurityRequirement::new(TOKEN, Vec::<String>::new());
    // Where the service asks for no tokens, a token is allowed.
    document.security = Some(if asks_tokens { vec![token] } else { vec![SecurityRequirement::default(), token] });
    let mut text = serde_json::to_string_pretty(&document)?;
    text.push('\n');
    Ok(text)
}
