//! The service's HTTP face; version 1 of the interface.
//!
//! [`listen`] takes connections, [`access`] says who may call, [`problem`](answer::problem) is the one edge where errors become answers,
//! [`extract`], [`parameters`] and [`accept`] read requests, [`bodies`] makes room for their bodies, [`aside`] is where large answers are made, [`view`], [`view_study`] and [`view_sweep`] hold what is
//! answered, [`tag`](answer::tag) spares it to those who have it, [`tasks`] and [`findings`] are what several calls share; [`jobs`],
//! [`request`], [`follow`], [`increments`], [`columns`], [`exact`], [`stream`], [`csv`], [`studies`], [`sweeps`], [`scenes`],
//! [`probes`], [`metrics`] and [`pages`] are the calls, [`dashboard`] what a browser sees, [`document`] their OpenAPI
//! description, [`request_id`] what names each request, [`server`] all of it, and going down in good order.
//! Called by `command`; knows `jobs` and, for reading, `store`.

pub mod accept;
pub mod access;
pub mod answer;
pub mod aside;
pub mod bodies;
pub mod columns;
pub mod csv;
pub mod dashboard;
pub mod document;
pub mod exact;
pub mod extract;
pub mod findings;
pub mod follow;
pub mod increments;
pub mod jobs;
pub mod listen;
pub mod metrics;
pub mod pages;
pub mod parameters;
pub mod probes;
pub mod request;
pub mod request_id;
pub mod scenes;
pub mod server;
pub(crate) mod service;
pub mod stream;
pub mod studies;
pub mod sweeps;
pub mod tasks;
pub mod view;
pub mod view_study;
pub mod view_sweep;

use crate::service::http::service::Service;
use crate::service::jobs::Limits;
use access::{admission, headers};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::{Router, routing};
use parameters::Without;
use std::sync::Arc;
use tower_http::catch_panic::CatchPanicLayer;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use utoipa_swagger_ui::{Config, SwaggerUi};

fn api() -> OpenApiRouter<Service> {
    OpenApiRouter::with_openapi(document::base())
        .routes(routes!(jobs::submit, jobs::list))
        .routes(routes!(jobs::get, jobs::delete))
        .routes(routes!(jobs::cancel))
        .routes(routes!(jobs::retry))
        .routes(routes!(request::request))
        .routes(routes!(follow::follow))
        .routes(routes!(increments::page))
        .routes(routes!(columns::columns))
        .routes(routes!(exact::exact))
        .routes(routes!(stream::stream))
        .routes(routes!(csv::path_csv))
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
        .routes(routes!(scenes::list))
        .routes(routes!(scenes::get))
        .routes(routes!(probes::alive))
        .routes(routes!(probes::ready))
        .routes(routes!(metrics::metrics))
}

/// The OpenAPI document as it is committed, and served where the limits are the defaults.
pub fn openapi_json() -> serde_json::Result<String> {
    document::finish(api().into_openapi(), &Limits::default(), false)
}

/// Every route, with what applies to all of them.
pub fn router(service: Service) -> serde_json::Result<Router> {
    let (routes, description) = api().split_for_parts();
    let limits = service.jobs.settings.limits;
    let (access, jobs) = (service.access.clone(), service.jobs.clone());
    let without = Without::of(&description);
    dashboard::prepare();
    let description: Arc<str> = document::finish(description, &limits, access.asks_tokens())?.into();
    let routes = routes
        .route_layer(from_fn_with_state(without, parameters::refuse_unknown))
        .route("/", routing::get(dashboard::index))
        .route("/assets/{*name}", routing::get(dashboard::asset))
        .route("/openapi.json", routing::get(move || pages::openapi(description.clone())))
        .with_state(service)
        .merge(SwaggerUi::new("/docs").config(Config::from("/openapi.json")))
        .layer(from_fn_with_state(access.clone(), admission::admit))
        .layer(CatchPanicLayer::custom(answer::problem::from_panic))
        .layer(from_fn(answer::problem::every_error));
    // Outside of what refuses: a page that may call may also read why it was refused.
    let routes = match access.origins().layer() {
        Some(layer) => routes.layer(layer),
        None => routes,
    };
    Ok(routes
        .layer(from_fn_with_state(jobs, metrics::observe))
        .layer(from_fn(headers::secure))
        .layer(from_fn(request_id::name_request)))
}
