//! Compressed answers, and the same for clients that do not read them.

use axum::body::{Body, to_bytes};
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use flate2::read::GzDecoder;
use std::io::Read;
use tokio::task::spawn_blocking;

/// Bytes of a compressed answer that is unpacked; the scripts of `/docs` are far below.
const MOST: usize = 16 * 1024 * 1024;

/// Whether the client accepts gzip (`Accept-Encoding`, RFC 9110, section 12.5.3).
pub fn takes_gzip(headers: &HeaderMap) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).any(|coding| {
        let mut parts = coding.split(';').map(str::trim);
        let is_gzip = parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip"));
        let weight = parts.find_map(|parameter| parameter.strip_prefix("q="));
        is_gzip && weight.is_none_or(|weight| weight.parse::<f32>().is_ok_and(|weight| weight > 0.0))
    })
}

/// # Errors
/// This is no gzip.
pub fn unpacked(compressed: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut plain = Vec::new();
    GzDecoder::new(compressed).read_to_end(&mut plain)?;
    Ok(plain)
}

/// Answers that are compressed in any case, as the files of `/docs` are, are unpacked for clients that do not accept gzip.
pub async fn unpack_where_not_accepted(request: Request, next: Next) -> Response {
    let is_accepted = takes_gzip(request.headers());
    let mut answer = next.run(request).await;
    if answer.headers().get(header::CONTENT_ENCODING).is_none_or(|coding| coding != "gzip") {
        return answer;
    }
    answer.headers_mut().insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    if is_accepted {
        return answer;
    }
    let (mut parts, body) = answer.into_parts();
    let Ok(compressed) = to_bytes(body, MOST).await else { return StatusCode::INTERNAL_SERVER_ERROR.into_response() };
    let Ok(Ok(plain)) = spawn_blocking(move || unpacked(&compressed)).await else {
        return StatusCode::INTERNAL_SERVER_ERROR.into_response();
    };
    parts.headers.remove(header::CONTENT_ENCODING);
    parts.headers.remove(header::CONTENT_LENGTH);
    Response::from_parts(parts, Body::from(plain))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gzip_is_sent_to_those_who_read_it() {
        let takes = |value: &str| {
            takes_gzip(&[(header::ACCEPT_ENCODING, value.parse().unwrap())].into_iter().collect::<HeaderMap>())
        };
        for yes in ["gzip", "deflate, GZIP;q=0.5", "br;q=1, gzip ; q=1"] {
            assert!(takes(yes), "{yes}");
        }
        for no in ["", "br", "gzip;q=0", "gzip; q=0.0", "xgzip", "gzip;q=x"] {
            assert!(!takes(no), "{no}");
        }
        assert!(!takes_gzip(&HeaderMap::new()));
    }
}
