//! Refuses queries of calls that have no query parameters, as their parameters would be ignored. Calls that have some read
//! them with [`extract`](crate::service::http::input::extract), which refuses others.

use crate::model::input::names::quoted;
use crate::service::http::answer::problem::{Kind, Problem};
use axum::extract::{MatchedPath, Query, Request, State};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::collections::HashSet;
use std::sync::Arc;
use utoipa::openapi::path::{Operation, ParameterIn};
use utoipa::openapi::{OpenApi, RefOr};

/// The calls without query parameters, by method and route.
#[derive(Debug, Clone)]
pub struct CallsWithoutParameters(Arc<HashSet<(Method, String)>>);

impl CallsWithoutParameters {
    pub fn of(description: &OpenApi) -> Self {
        let mut without = HashSet::new();
        for (path, item) in &description.paths.paths {
            let calls = [(Method::GET, &item.get), (Method::POST, &item.post), (Method::DELETE, &item.delete)];
            for (method, operation) in calls {
                if operation.as_ref().is_some_and(|operation| !has_parameters(operation)) {
                    without.insert((method, path.clone()));
                }
            }
        }
        Self(Arc::new(without))
    }
}

fn has_parameters(operation: &Operation) -> bool {
    operation.parameters.iter().flatten().any(|parameter| match parameter {
        RefOr::T(parameter) => parameter.parameter_in == ParameterIn::Query,
        RefOr::Ref(_) => true,
    })
}

/// Refuses a query of a call that has no parameters.
pub async fn refuse_unknown(State(without): State<CallsWithoutParameters>, request: Request, next: Next) -> Response {
    match unknown(&without, &request) {
        Some(problem) => problem.into_response(),
        None => next.run(request).await,
    }
}

fn unknown(without: &CallsWithoutParameters, request: &Request) -> Option<Problem> {
    request.uri().query().filter(|query| !query.is_empty())?;
    let path = request.extensions().get::<MatchedPath>()?.as_str().to_owned();
    // HEAD is answered by the calls for GET.
    let method = if request.method() == Method::HEAD { Method::GET } else { request.method().clone() };
    if !without.0.contains(&(method, path)) {
        return None;
    }
    let pairs = Query::<Vec<(String, String)>>::try_from_uri(request.uri()).map(|Query(pairs)| pairs);
    let (found, _) = pairs.unwrap_or_default().into_iter().next()?;
    let detail = format!("there is no parameter {}; this call has none", quoted(&found));
    Some(Problem::new(Kind::InvalidParameter, detail))
}
