//! Cross-origin requests: a page of another origin may call only if its origin is listed.
//!
//! A browser lets any page send some requests to any address, and hides only the answers; the header `Origin` names the
//! page. A page may also resolve its own name to the address of this machine ("DNS rebinding"); then `Host` has that name.

use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, Uri, header};
use std::net::IpAddr;
use std::time::Duration;
use tower_http::cors::{AllowOrigin, CorsLayer};

/// How long a browser may cache the answer to a preflight request.
const ASKED_AGAIN: Duration = Duration::from_secs(600);

/// Origins of pages that may call from elsewhere, such as `https://dashboards.example.org`.
#[derive(Debug, Clone, Default)]
pub struct Origins(Vec<HeaderValue>);

impl Origins {
    /// # Errors
    /// The text is no origin, which is a scheme, a name and optionally a port.
    pub fn read<'a>(origins: impl IntoIterator<Item = &'a str>) -> Result<Self, String> {
        origins.into_iter().map(origin).collect::<Result<_, _>>().map(Self)
    }

    /// The layer that answers with CORS headers; `None` where no page of another origin may call.
    pub fn layer(&self) -> Option<CorsLayer> {
        let named = |name: &'static str| HeaderName::from_static(name);
        (!self.0.is_empty()).then(|| {
            CorsLayer::new()
                .allow_origin(AllowOrigin::list(self.0.iter().cloned()))
                .allow_methods([Method::GET, Method::POST, Method::DELETE])
                .allow_headers([
                    header::ACCEPT,
                    header::AUTHORIZATION,
                    header::CONTENT_TYPE,
                    header::IF_NONE_MATCH,
                    named("idempotency-key"),
                    named("last-event-id"),
                    named("x-request-id"),
                ])
                .expose_headers([header::ETAG, header::LOCATION, header::RETRY_AFTER, named("x-request-id")])
                .max_age(ASKED_AGAIN)
        })
    }

    /// Whether a modifying request comes from a page whose origin is not allowed.
    pub fn is_foreign(&self, headers: &HeaderMap) -> bool {
        let Some(origin) = headers.get(header::ORIGIN) else { return false };
        if self.0.contains(origin) {
            return false;
        }
        let page = origin.to_str().ok().and_then(|origin| origin.split_once("://")).map(|(_, page)| page);
        page.is_none_or(|page| headers.get(header::HOST).is_none_or(|host| host.as_bytes() != page.as_bytes()))
    }
}

fn origin(text: &str) -> Result<HeaderValue, String> {
    let wrong = || format!("{text:?} is no origin; one is written like https://dashboards.example.org:8443");
    let uri: Uri = text.parse().map_err(|_| wrong())?;
    let written = format!("{}://{}", uri.scheme_str().unwrap_or_default(), uri.host().unwrap_or_default());
    let written = uri.port().map_or_else(|| written.clone(), |port| format!("{written}:{port}"));
    if written != text {
        return Err(wrong());
    }
    text.parse().map_err(|_| wrong())
}

/// Whether the request names this machine by an IP address or as `localhost`, and not by another name, which anyone may have
/// assigned to the address.
pub fn names_this_machine(headers: &HeaderMap) -> bool {
    let mut hosts = headers.get_all(header::HOST).iter();
    let (Some(host), None) = (hosts.next(), hosts.next()) else { return headers.get(header::HOST).is_none() };
    let host = host.to_str().ok().filter(|host| !host.contains('@')).and_then(|host| host.parse::<Uri>().ok());
    host.as_ref().and_then(Uri::host).is_some_and(|host| {
        let bare = host.trim_start_matches('[').trim_end_matches(']');
        host.eq_ignore_ascii_case("localhost") || bare.parse::<IpAddr>().is_ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(HeaderName, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect()
    }

    #[test]
    fn pages_of_this_service_and_listed_ones_may_call() {
        let origins = Origins::read(["https://plots.example"]).unwrap();
        let foreign = |origin: &str| {
            origins.is_foreign(&headers(&[(header::HOST, "arcslip.example:8080"), (header::ORIGIN, origin)]))
        };
        assert!(!foreign("http://arcslip.example:8080") && !foreign("https://plots.example"));
        for other in ["http://arcslip.example", "https://evil.example", "null", "", "https://plots.example.evil"] {
            assert!(foreign(other), "{other}");
        }
        assert!(!origins.is_foreign(&headers(&[])), "what is no browser names no origin");
        assert!(Origins::default().layer().is_none());
    }

    #[test]
    fn an_origin_is_a_scheme_a_name_and_a_port() {
        assert!(Origins::read(["https://a.example", "http://localhost:3000"]).is_ok());
        for wrong in ["*", "a.example", "https://a.example/", "https://a.example/page", "https://", ""] {
            assert!(Origins::read([wrong]).is_err(), "{wrong}");
        }
    }

    #[test]
    fn names_that_somebody_may_have_given_are_told_from_addresses() {
        let named = |host: &str| names_this_machine(&headers(&[(header::HOST, host)]));
        for this in ["127.0.0.1", "127.0.0.1:8080", "localhost:8080", "LOCALHOST", "[::1]:8080", "[::1]"] {
            assert!(named(this), "{this}");
        }
        for other in [
            "evil.example",
            "evil.example:8080",
            "127.0.0.1.evil.example",
            "localhost.evil.example",
            "",
            "evil@localhost",
        ] {
            assert!(!named(other), "{other}");
        }
        assert!(names_this_machine(&headers(&[])));
    }
}
