//! Extractors of bodies, parameters and headers; every rejection is a problem.

use crate::model::input::names::{quoted, suggestion};
use crate::service::http::access::rates::subscriber;
use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::state::bodies::Read;
use crate::service::http::state::service::Service;
use crate::service::http::view::change;
use crate::service::jobs::{Caller, Client, Posted};
use crate::service::store::FeedPosition;
use axum::extract::{ConnectInfo, FromRequest, FromRequestParts, Path, Query, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, Uri, header};
use serde::de::DeserializeOwned;
use std::net::SocketAddr;
use uuid::Uuid;

/// Characters of the longest idempotency key.
pub const LONGEST_KEY: usize = 255;
/// The largest index of an increment or row that can be stored.
const LARGEST_INDEX: u64 = i64::MAX as u64;

/// The unparsed text of a JSON body, and the room that it takes among all bodies held.
pub struct JsonText(pub Posted);

impl FromRequest<Service> for JsonText {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &Service) -> Result<Self, Problem> {
        if !is_json(request.headers()) {
            return Err(Problem::new(Kind::UnsupportedMediaType, "send the header Content-Type: application/json"));
        }
        if request.headers().get(header::CONTENT_ENCODING).is_some_and(|coding| coding != "identity") {
            return Err(Problem::new(Kind::UnsupportedMediaType, "send the body as it is, without a Content-Encoding"));
        }
        let client = client(&request);
        let Read { text, taken } =
            state.bodies.read(request.into_body(), state.jobs.settings.limits.body_bytes).await?;
        Ok(Self(Posted { text, room: Some(Box::new(taken)), client }))
    }
}

/// The client for whom a request is checked: its owner, or its address where the service asks for no tokens.
fn client(request: &Request) -> Client {
    if let Some(Caller::Named { owner, .. }) = request.extensions().get::<Caller>() {
        return Client(owner.clone());
    }
    let place = request.extensions().get::<ConnectInfo<SocketAddr>>();
    Client(place.map_or_else(String::new, |ConnectInfo(place)| subscriber(place.ip()).to_string()))
}

fn is_json(headers: &HeaderMap) -> bool {
    let media_type = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let essence = media_type.split(';').next().unwrap_or_default();
    essence.trim().eq_ignore_ascii_case("application/json")
}

/// The id of a job, study or sweep in the address.
pub struct JobId(pub Uuid);

impl<S: Send + Sync> FromRequestParts<S> for JobId {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        match Path::<Uuid>::from_request_parts(parts, state).await {
            Ok(Path(id)) => Ok(Self(id)),
            Err(_) => Err(Problem::parameter("id", "a UUID is expected, as in the answer to the POST request")),
        }
    }
}

/// The parameters of a query, all of them optional.
pub trait QueryParameters: DeserializeOwned {
    /// The names of the parameters, each with the values that are expected.
    const EXPECTED: &'static [(&'static str, &'static str)];
}

/// Extracts the parameters of the query.
pub struct Parameters<T>(pub T);

impl<S: Send + Sync, T: QueryParameters> FromRequestParts<S> for Parameters<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        match Query::<T>::from_request_parts(parts, state).await {
            Ok(Query(parameters)) => Ok(Self(parameters)),
            Err(_) => Err(refused_query::<T>(parts.uri.query().unwrap_or_default())),
        }
    }
}

/// Names the first wrong parameter: each is parsed by itself.
fn refused_query<T: QueryParameters>(query: &str) -> Problem {
    let mut seen = Vec::new();
    for part in query.split('&') {
        let Ok(alone) = Uri::builder().path_and_query(format!("/?{part}")).build() else { continue };
        let pairs = Query::<Vec<(String, String)>>::try_from_uri(&alone).map(|Query(pairs)| pairs);
        let Some((name, value)) = pairs.unwrap_or_default().into_iter().next() else { continue };
        let Some((_, takes)) = T::EXPECTED.iter().find(|(known, _)| *known == name) else {
            let known = suggestion(&name, T::EXPECTED.iter().map(|(known, _)| *known));
            return Problem::new(Kind::InvalidParameter, format!("there is no parameter {}{known}", quoted(&name)));
        };
        if Query::<T>::try_from_uri(&alone).is_err() {
            return Problem::parameter(&name, format_args!("found {}; {takes} is expected", quoted(&value)));
        }
        if seen.contains(&name) {
            return Problem::parameter(&name, "it stands twice; once would do");
        }
        seen.push(name);
    }
    Problem::new(Kind::InvalidParameter, "the query cannot be read; `name=value` joined by `&` is expected")
}

/// A header that may occur only once.
fn only<'a>(name: &str, headers: &'a HeaderMap) -> Result<Option<&'a HeaderValue>, Problem> {
    let mut all = headers.get_all(name).iter();
    match (all.next(), all.next()) {
        (_, Some(_)) => Err(Problem::parameter(name, "it stands twice; once would do")),
        (value, None) => Ok(value),
    }
}

/// The `Idempotency-Key` header, if there is one.
pub fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>, Problem> {
    let Some(value) = only("Idempotency-Key", headers)? else { return Ok(None) };
    let refuse = || Problem::parameter("Idempotency-Key", "1 to 255 printable ASCII characters");
    let key = value.to_str().map_err(|_| refuse())?;
    let is_printable = key.bytes().all(|byte| (b' '..=b'~').contains(&byte));
    if is_printable && (1..=LONGEST_KEY).contains(&key.len()) { Ok(Some(key.to_owned())) } else { Err(refuse()) }
}

/// The `Last-Event-ID` header: the index of the last event the client has; `event` is its name.
pub fn last_event_id(event: &str, headers: &HeaderMap) -> Result<Option<u64>, Problem> {
    let Some(value) = only("Last-Event-ID", headers)? else { return Ok(None) };
    let refuse = || {
        Problem::parameter(
            "Last-Event-ID",
            format_args!("the index of the last {event} received, 0 to {LARGEST_INDEX}, is expected"),
        )
    };
    let text = value.to_str().map_err(|_| refuse())?;
    text.parse().ok().filter(|index| *index <= LARGEST_INDEX).map(Some).ok_or_else(refuse)
}

/// The `Last-Event-ID` header of the feed of changes: the place of the last event the client has; `None` too where no event
/// of such a feed has this id, so that a client begins anew instead of failing for good.
pub fn feed_position(headers: &HeaderMap) -> Result<Option<FeedPosition>, Problem> {
    Ok(only("Last-Event-ID", headers)?.and_then(|value| change::position(value.to_str().ok()?)))
}

/// An index that is not larger than the largest one.
pub fn index(name: &str, given: Option<u64>) -> Result<Option<u64>, Problem> {
    match given {
        Some(found) if found > LARGEST_INDEX => {
            Err(Problem::parameter(name, format_args!("{found} is not in 0 to {LARGEST_INDEX}")))
        }
        given => Ok(given),
    }
}

/// A number from 1 to `largest`, or the default.
pub fn bounded(name: &str, given: Option<u32>, default: u32, largest: u32) -> Result<u32, Problem> {
    match given {
        None => Ok(default),
        Some(number) if (1..=largest).contains(&number) => Ok(number),
        Some(number) => Err(Problem::parameter(name, format_args!("{number} is not in 1 to {largest}"))),
    }
}
