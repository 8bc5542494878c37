//! Files that are part of the program, so that its pages need no network and no folder.

use crate::service::http::answer::gzip::{takes_gzip, unpacked};
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag::Tag;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use std::sync::OnceLock;
use tokio::task::spawn_blocking;

/// The media type of pages.
pub const PAGE: &str = "text/html; charset=utf-8";
/// The media type of scripts.
pub const SCRIPT: &str = "text/javascript; charset=utf-8";
/// The media type of styles.
pub const STYLE: &str = "text/css; charset=utf-8";

/// The media type of a file, by its extension.
pub fn media_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => PAGE,
        Some("js") => SCRIPT,
        Some("css") => STYLE,
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        _ => "application/octet-stream",
    }
}

/// A file as an answer with its entity tag.
///
/// # Errors
/// None of its own.
pub fn answer(
    media_type: &'static str,
    body: impl AsRef<[u8]> + IntoResponse,
    headers: &HeaderMap,
) -> Result<Response, Problem> {
    Tag::of(body.as_ref()).answer(headers, || Ok(([(header::CONTENT_TYPE, media_type)], body).into_response()))
}

/// A file that is kept compressed with gzip.
pub struct Packed {
    compressed: &'static [u8],
    media_type: &'static str,
    /// The tag of the compressed bytes.
    tag: OnceLock<Tag>,
    /// For clients that do not accept gzip, made when the first of them asks; `None` where the bytes are no gzip.
    plain: OnceLock<Option<(&'static [u8], Tag)>>,
}

impl Packed {
    pub const fn new(compressed: &'static [u8], media_type: &'static str) -> Self {
        Self { compressed, media_type, tag: OnceLock::new(), plain: OnceLock::new() }
    }

    /// The file, compressed for clients that accept it.
    ///
    /// # Errors
    /// The file cannot be unpacked.
    pub async fn answer(&'static self, headers: &HeaderMap) -> Result<Response, Problem> {
        let is_compressed = takes_gzip(headers);
        let made = move || if is_compressed { Some((self.compressed, self.tag().clone())) } else { self.plain() };
        let (bytes, tag) =
            spawn_blocking(made).await.ok().flatten().ok_or_else(|| Problem::not_found(format_args!("file")))?;
        let mut answer =
            tag.answer(headers, || Ok(([(header::CONTENT_TYPE, self.media_type)], bytes).into_response()))?;
        let own = answer.headers_mut();
        own.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        if is_compressed {
            own.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
        }
        Ok(answer)
    }

    fn tag(&self) -> &Tag {
        self.tag.get_or_init(|| Tag::of(self.compressed))
    }

    fn plain(&self) -> Option<(&'static [u8], Tag)> {
        let make = || {
            let plain: &'static [u8] = unpacked(self.compressed).ok()?.leak();
            Some((plain, Tag::of(plain)))
        };
        self.plain.get_or_init(make).clone()
    }

    /// The text, for tests of what is embedded.
    #[cfg(test)]
    pub fn text(&self) -> &'static str {
        std::str::from_utf8(self.plain().expect("it can be unpacked").0).expect("it is text")
    }

    /// The size as it is sent.
    #[cfg(test)]
    pub fn compressed_size(&self) -> usize {
        self.compressed.len()
    }
}
