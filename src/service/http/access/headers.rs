//! What browsers are told about every answer (OWASP's list of secure headers, what of it concerns a service that is reached
//! through HTTP; `Strict-Transport-Security` is for whoever ends TLS in front of it).

use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, header};
use axum::middleware::Next;
use axum::response::Response;

const ALWAYS: [(HeaderName, &str); 6] = [
    // The pages bring their own scripts and nothing from elsewhere; Swagger's has styles and pictures inline, and Plotly
    // makes the picture that a reader saves from a blob.
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; object-src 'none'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("permissions-policy"), "camera=(), geolocation=(), microphone=()"),
];
/// What a call does not say may be kept is not.
const KEPT_BY_NO_ONE: HeaderValue = HeaderValue::from_static("no-store");

pub async fn secure(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    for (name, value) in ALWAYS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers.entry(header::CACHE_CONTROL).or_insert(KEPT_BY_NO_ONE);
    response
}
