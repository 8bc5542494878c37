//! Every call at its address, and the layers around all of them.

use crate::service::http::access::{admission, headers};
use crate::service::http::calls::{
    changes, curves, follow, increments, jobs, metrics, openapi, probes, request, scenes, studies, sweeps,
};
use crate::service::http::input::parameters::{self, CallsWithoutParameters};
use crate::service::http::state::service::Service;
use crate::service::http::{answer, dashboard, docs, document, manual, request_id};
use crate::service::jobs::Limits;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::{Router, routing};
use std::sync::Arc;
use tower_http::catch_panic::CatchPanicLayer;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

fn api() -> OpenApiRouter<Service> {
    OpenApiRouter::with_openapi(document::base())
        .routes(routes!(jobs::submit, jobs::list))
        .routes(routes!(jobs::get, jobs::delete))
        .routes(routes!(jobs::cancel))
        .routes(routes!(jobs::retry))
        .routes(routes!(request::request))
        .routes(routes!(follow::follow))
        .routes(routes!(increments::page::page))
        .routes(routes!(increments::columns::columns))
        .routes(routes!(increments::exact::exact))
        .routes(routes!(increments::stream::stream))
        .routes(routes!(increments::csv::path_csv))
        .routes(routes!(increments::results::pvd))
        .routes(routes!(increments::results::parquet))
        .routes(routes!(increments::picture::svg))
        .routes(routes!(increments::picture::raster))
        .routes(routes!(studies::submit, studies::list))
        .routes(routes!(studies::get, studies::delete))
        .routes(routes!(studies::cancel))
        .routes(routes!(studies::stream))
        .routes(routes!(studies::table_csv))
        .routes(routes!(studies::table_txt))
        .routes(routes!(studies::picture))
        .routes(routes!(sweeps::submit, sweeps::list))
        .routes(routes!(sweeps::get, sweeps::delete))
        .routes(routes!(sweeps::cancel))
        .routes(routes!(sweeps::rows))
        .routes(routes!(sweeps::stream))
        .routes(routes!(sweeps::table_csv))
        .routes(routes!(sweeps::table_txt))
        .routes(routes!(sweeps::picture))
        .routes(routes!(curves::submit, curves::list))
        .routes(routes!(curves::continue_job))
        .routes(routes!(curves::get, curves::delete))
        .routes(routes!(curves::cancel))
        .routes(routes!(curves::rows))
        .routes(routes!(curves::stream))
        .routes(routes!(curves::table_csv))
        .routes(routes!(curves::table_txt))
        .routes(routes!(curves::picture))
        .routes(routes!(changes::changes))
        .routes(routes!(scenes::list))
        .routes(routes!(scenes::get))
        .routes(routes!(probes::alive))
        .routes(routes!(probes::ready))
        .routes(routes!(metrics::metrics))
}

/// The OpenAPI document with the default limits, as it is committed.
pub fn openapi_json() -> serde_json::Result<String> {
    document::finish(api().into_openapi(), &Limits::default(), false)
}

/// Every route, and the layers that apply to all of them.
pub fn router(service: Service) -> serde_json::Result<Router> {
    let (routes, description) = api().split_for_parts();
    let limits = service.jobs.settings.limits;
    let (access, jobs) = (service.access.clone(), service.jobs.clone());
    let without = CallsWithoutParameters::of(&description);
    let description: Arc<str> = document::finish(description, &limits, access.asks_tokens())?.into();
    let routes = routes
        .route_layer(from_fn_with_state(without, parameters::refuse_unknown))
        .route("/", routing::get(dashboard::index))
        .route("/assets/{*name}", routing::get(dashboard::asset))
        .route("/docs", routing::get(docs::folder))
        .route("/docs/", routing::get(docs::index))
        .route("/docs/{name}", routing::get(docs::asset))
        .route("/manual", routing::get(manual::contents))
        .route("/manual/", routing::get(manual::contents))
        .route("/manual/{chapter}", routing::get(manual::chapter))
        .route("/manual/style.css", routing::get(manual::style))
        .route("/manual/pictures/{name}", routing::get(manual::picture))
        .route("/openapi.json", routing::get(move || openapi::openapi(description.clone())))
        .with_state(service)
        .layer(from_fn_with_state(access.clone(), admission::admit))
        .layer(CatchPanicLayer::custom(answer::problem::from_panic))
        .layer(from_fn(answer::problem::every_error));
    // Outside of the layers that refuse requests: an allowed page may also read why a request was refused.
    let routes = match access.origins().layer() {
        Some(layer) => routes.layer(layer),
        None => routes,
    };
    Ok(routes
        .layer(from_fn_with_state(jobs, metrics::observe))
        .layer(from_fn(headers::secure))
        .layer(from_fn(request_id::name_request)))
}
