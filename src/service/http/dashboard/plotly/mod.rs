//! Plotly's script (MIT licence, see `LICENSE`): `plotly.js.gz`, which `trim.py` makes of the released one.

use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag::Tag;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use flate2::read::GzDecoder;
use std::io::Read;
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
static PLAIN: LazyLock<Option<Sent>> = LazyLock::new(|| {
    let mut plain = Vec::new();
    GzDecoder::new(COMPRESSED.bytes).read_to_end(&mut plain).ok()?;
    Some(Sent::of(plain.leak()))
});

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

/// Whether the client accepts gzip (`Accept-Encoding`, RFC 9110, section 12.5.3).
fn takes_gzip(headers: &HeaderMap) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).any(|coding| {
        let mut parts = coding.split(';').map(str::trim);
        let is_gzip = parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip"));
        let weight = parts.find_map(|parameter| parameter.strip_prefix("q="));
        is_gzip && weight.is_none_or(|weight| weight.parse::<f32>().is_ok_and(|weight| weight > 0.0))
    })
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
