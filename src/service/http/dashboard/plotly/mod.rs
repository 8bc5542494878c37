//! Plotly's script (MIT licence, see `LICENSE`): `plotly.js.gz`, which `trim.py` makes of the released one.

use crate::service::http::answer::gzip::{takes_gzip, unpacked};
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag::Tag;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use std::sync::LazyLock;
use tokio::task::spawn_blocking;

/// The name of the script in the page.
pub const NAME: &str = "plotly.js";
/// The media type of scripts.
pub const SCRIPT: &str = "text/javascript; charset=utf-8";

/// A script as it is sent, and its entity tag.
struct Sent {
    bytes: &'static [u8],
    tag: Tag,
}

impl Sent {
    fn of(bytes: &'static [u8]) -> Self {
        Self { bytes, tag: Tag::of(bytes) }
    }
}

/// The script compressed with gzip.
static COMPRESSED: LazyLock<Sent> = LazyLock::new(|| Sent::of(include_bytes!("plotly.js.gz")));

/// The script for clients that do not accept gzip, made when the first of them asks.
static PLAIN: LazyLock<Option<Sent>> = LazyLock::new(|| Some(Sent::of(unpacked(COMPRESSED.bytes).ok()?.leak())));

pub async fn script(headers: &HeaderMap) -> Result<Response, Problem> {
    let is_compressed = takes_gzip(headers);
    let found = spawn_blocking(move || if is_compressed { Some(&*COMPRESSED) } else { PLAIN.as_ref() });
    let sent = found.await.ok().flatten().ok_or_else(|| Problem::not_found(format_args!("script to draw with")))?;
    let mut answer =
        sent.tag.clone().answer(headers, || Ok(([(header::CONTENT_TYPE, SCRIPT)], sent.bytes).into_response()))?;
    let own = answer.headers_mut();
    own.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    if is_compressed {
        own.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    }
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plotly_is_one_script_without_mathjax_and_quick_to_start() {
        let plain = PLAIN.as_ref().expect("it can be read");
        let text = std::str::from_utf8(plain.bytes).unwrap();
        assert!(text.contains("plotly.js v") && !text.contains("</script"));
        assert!(text.contains("Licensed under the MIT license"));
        assert!(text.contains(".register([])") && text.ends_with("window.Plotly = Plotly;"), "it is quick to start");
        assert!((3_000_000..5_000_000).contains(&text.len()), "{}", text.len());
        assert!(3 * COMPRESSED.bytes.len() < text.len());
    }
}
