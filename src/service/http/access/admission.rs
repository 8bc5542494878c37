//! Admission of requests before any call is reached: request rates, origins of pages, and tokens.
//!
//! Every address that is not listed as public needs a token, so that a new call is protected by default.

use crate::service::http::access::tokens::Scope;
use crate::service::http::access::{Access, AccessPolicy, origins};
use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::jobs::Caller;
use axum::extract::{ConnectInfo, Request, State};
use axum::http::{HeaderMap, Method, Version, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::SocketAddr;

/// Public addresses: pages without data of users, and probes.
const PUBLIC: [&str; 6] = ["/", "/docs", "/manual", "/openapi.json", "/healthz", "/readyz"];
const PUBLIC_FOLDERS: [&str; 3] = ["/docs/", "/manual/", "/assets/"];

/// Passes a request on with its [`Caller`], or answers why it is refused.
pub async fn admit(State(access): State<Access>, mut request: Request, next: Next) -> Response {
    match access.caller(&request) {
        Ok(caller) => {
            // A call that needs a caller fails without one, and shows nothing.
            if let Some(caller) = caller {
                request.extensions_mut().insert(caller);
            }
            next.run(request).await
        }
        Err(problem) => problem.into_response(),
    }
}

/// The scope that a request needs; `None` for public addresses.
fn needed(method: &Method, path: &str) -> Option<Scope> {
    let reads = matches!(*method, Method::GET | Method::HEAD);
    match (reads, is_public(path)) {
        (true, true) => None,
        (true, false) => Some(Scope::Read),
        (false, _) => Some(Scope::Submit),
    }
}

/// Whether the address may be read without a token.
pub fn is_public(path: &str) -> bool {
    PUBLIC.contains(&path) || PUBLIC_FOLDERS.iter().any(|folder| path.starts_with(folder))
}

impl Access {
    fn caller(&self, request: &Request) -> Result<Option<Caller>, Problem> {
        let rules = &self.0;
        if let Some(ConnectInfo(address)) = request.extensions().get::<ConnectInfo<SocketAddr>>() {
            rules.rates.of_address(address.ip()).map_err(|wait| Problem::too_often("this address", wait))?;
        }
        let headers = request.headers();
        // RFC 9112, section 3.2.
        if request.version() == Version::HTTP_11 && headers.get_all(header::HOST).iter().count() != 1 {
            return Err(Problem::new(Kind::InvalidParameter, "one header Host, the name of the service, is expected"));
        }
        let needed = needed(request.method(), request.uri().path());
        if needed == Some(Scope::Submit) && rules.origins.is_foreign(headers) {
            return Err(Problem::new(
                Kind::Forbidden,
                "the request comes from a page of another origin; the operator of the service can allow it (--allow-origin)",
            ));
        }
        let Some(tokens) = self.tokens() else {
            if matches!(rules.policy, AccessPolicy::Loopback) && !origins::names_this_machine(headers) {
                return Err(Problem::new(
                    Kind::Forbidden,
                    "without tokens this service answers to the address of its own machine, or to localhost, and to no \
                     other name; --tokens-file or --open lifts that",
                ));
            }
            return Ok(Some(Caller::Anyone));
        };
        let Some(needed) = needed else { return Ok(None) };
        let shown = bearer(headers).ok_or_else(|| {
            Problem::new(Kind::Unauthorized, "send the header Authorization: Bearer, and a token of this service")
        })?;
        let token = tokens
            .find(shown)
            .ok_or_else(|| Problem::new(Kind::Unauthorized, "the token is not valid, or no longer valid"))?;
        rules.rates.of_token(&token.name).map_err(|wait| Problem::too_often("this token", wait))?;
        if !token.scopes.allow(needed) {
            let detail = format!("the token has the scopes {}; `{}` is needed", token.scopes, needed.name());
            return Err(Problem::new(Kind::Forbidden, detail));
        }
        Ok(Some(Caller::Named { owner: token.name.clone(), sees_all: token.scopes.allow(Scope::Admin) }))
    }
}

/// The token of the `Authorization` header (RFC 6750, section 2.1).
fn bearer(headers: &HeaderMap) -> Option<&str> {
    let (scheme, token) = headers.get(header::AUTHORIZATION)?.to_str().ok()?.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| token.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_public_needs_a_token() {
        for public in [
            "/",
            "/assets/main.js",
            "/docs",
            "/docs/",
            "/docs/swagger-ui.css",
            "/manual",
            "/manual/model",
            "/openapi.json",
            "/healthz",
            "/readyz",
        ] {
            assert_eq!(needed(&Method::GET, public), None, "{public}");
            assert_eq!(needed(&Method::POST, public), Some(Scope::Submit), "{public}");
        }
        for path in
            ["/v1/jobs", "/metrics", "//", "/docsx", "/manuals", "/assets", "/v1/docs/", "/nothing", "/healthz/", ""]
        {
            assert_eq!(needed(&Method::GET, path), Some(Scope::Read), "{path}");
        }
        for method in [Method::POST, Method::DELETE, Method::PUT, Method::PATCH, Method::OPTIONS] {
            assert_eq!(needed(&method, "/v1/jobs"), Some(Scope::Submit), "{method}");
        }
        assert_eq!(needed(&Method::HEAD, "/v1/jobs"), Some(Scope::Read));
    }
}
