//! Entity tags (RFC 9110, section 8.8.3) of finished resources: a client that has one is not sent it again.

use crate::service::http::answer::problem::Problem;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use sha2::{Digest, Sha256};

/// Clients may keep an answer but must revalidate it each time, as a job can be deleted.
const ASKED_ABOUT: HeaderValue = HeaderValue::from_static("private, no-cache");
/// Bytes of the hash in a tag.
const SHOWN: usize = 16;

/// A strong tag: equal only for equal bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tag(String);

impl Tag {
    /// The tag of an answer, computed from its bytes or from what determines them.
    pub fn of(content: &[u8]) -> Self {
        let hash = Sha256::digest(content);
        let shown: String = hash.iter().take(SHOWN).map(|byte| format!("{byte:02x}")).collect();
        Self(format!("\"{shown}\""))
    }

    /// Whether the client has the answer with this tag (`If-None-Match`, weak comparison).
    fn is_known(&self, headers: &HeaderMap) -> bool {
        let values = headers.get_all(header::IF_NONE_MATCH).iter().filter_map(|value| value.to_str().ok());
        let known = |tag: &str| tag == "*" || tag.strip_prefix("W/").unwrap_or(tag) == self.0;
        values.flat_map(|value| value.split(',')).any(|tag| known(tag.trim()))
    }

    /// The answer, or 304 where the client has it already; `make` is only called where it is needed.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn answer(
        self,
        headers: &HeaderMap,
        make: impl FnOnce() -> Result<Response, Problem>,
    ) -> Result<Response, Problem> {
        let mut response = if self.is_known(headers) { StatusCode::NOT_MODIFIED.into_response() } else { make()? };
        if let Ok(tag) = HeaderValue::try_from(self.0) {
            response.headers_mut().insert(header::ETAG, tag);
            response.headers_mut().insert(header::CACHE_CONTROL, ASKED_ABOUT);
        }
        Ok(response)
    }
}

/// A value as JSON, with a tag where its resource is finished.
///
/// # Errors
/// The value cannot be written.
pub fn json(headers: &HeaderMap, is_finished: bool, value: &impl Serialize) -> Result<Response, Problem> {
    let body = serde_json::to_vec(value)?;
    bytes(headers, is_finished, [(header::CONTENT_TYPE, "application/json")], body)
}

/// Bytes with their headers, with a tag where their resource is finished.
///
/// # Errors
/// None of its own.
pub fn bytes<const N: usize, V: TryInto<HeaderValue>>(
    headers: &HeaderMap,
    is_finished: bool,
    own: [(HeaderName, V); N],
    body: impl Into<Vec<u8>>,
) -> Result<Response, Problem>
where
    [(HeaderName, V); N]: axum::response::IntoResponseParts,
{
    let body = body.into();
    if !is_finished {
        return Ok((own, body).into_response());
    }
    Tag::of(&body).answer(headers, || Ok((own, body).into_response()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_that_has_it_is_not_sent_it_again() {
        let tag = Tag::of(b"one");
        assert_ne!(tag, Tag::of(b"two"));
        let asks = |known: &str| tag.is_known(&[(header::IF_NONE_MATCH, known.parse().unwrap())].into_iter().collect());
        let Tag(text) = &tag;
        for known in [text.clone(), format!("W/{text}"), format!("\"other\", {text}"), "*".to_owned()] {
            assert!(asks(&known), "{known}");
        }
        for other in ["\"other\"", "", &text[1..], "W/"] {
            assert!(!asks(other), "{other}");
        }
        assert!(!tag.is_known(&HeaderMap::new()));
    }
}
