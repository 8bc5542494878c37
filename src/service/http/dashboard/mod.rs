//! The dashboard: a page with scripts and styles that are part of the program, so that it needs no network and no files.
//!
//! The page is in `page/`: plain ES modules that use the calls of version 1 and nothing else. The plotting library, Plotly,
//! comes from its crate. Called by [`crate::service::http::router`].

use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag::Tag;
use axum::extract::Path;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use plotly::Plot;
use rust_embed::RustEmbed;
use std::io::{self, Write};
use std::sync::LazyLock;
use std::thread;
use tokio::task::spawn_blocking;

/// Read from the folder in a debug build, part of the program in a release build.
#[derive(RustEmbed)]
#[folder = "src/service/http/dashboard/page/"]
struct Page;

/// The name of Plotly's script in the page.
const PLOTLY: &str = "plotly.js";
/// The tags that the crate puts around the script.
const OPENING: &str = "<script type=\"text/javascript\">";
const CLOSING: &str = "</script>";
/// Marks in the script: the end of the licence, the beginning and end of the library, the beginning of its list of trace types.
const LICENCE_END: &str = "*/";
const OWN_BEGINS: &str = "\"use strict\";var Plotly=";
const OWN_ENDS: &str = "\nreturn Plotly;\n}));";
const REGISTERED: &str = ".register([";
const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Compresses the script in the background when the service starts, so that the first reader does not wait for it.
pub fn prepare() {
    // A script that cannot be compressed is sent uncompressed.
    thread::spawn(|| LazyLock::force(&COMPRESSED));
}

/// The page.
pub async fn index(headers: HeaderMap) -> Result<Response, Problem> {
    embedded("index.html", &headers)
}

/// Scripts, styles and pictures of the page.
pub async fn asset(Path(name): Path<String>, headers: HeaderMap) -> Result<Response, Problem> {
    if name == PLOTLY { plotly(&headers).await } else { embedded(&name, &headers) }
}

fn embedded(name: &str, headers: &HeaderMap) -> Result<Response, Problem> {
    let file = Page::get(name).ok_or_else(|| Problem::not_found(format_args!("part of the page of that name")))?;
    let media_type = match name.rsplit_once('.').map(|(_, ending)| ending) {
        Some("html") => HTML,
        Some("js") => SCRIPT,
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    };
    let own = [(header::CONTENT_TYPE, media_type)];
    Tag::of(&file.data).answer(headers, || Ok((own, file.data.into_owned()).into_response()))
}

/// Plotly's script without the parts that slow down its start: the wrapper for other module loaders, because of which a browser
/// parses the script three times, and the trace types that the page does not draw. Scatter plots are part of the core.
/// `None` for a script without the expected marks.
fn quick_to_start(script: &str) -> Option<String> {
    let (licence, _) = script.split_once(LICENCE_END)?;
    let own = script.get(script.find(OWN_BEGINS)?..)?;
    let (own, _) = own.split_once(OWN_ENDS)?;
    let (before, kinds_of_plot) = own.split_once(REGISTERED)?;
    let (_, after) = kinds_of_plot.split_once("])")?;
    Some([licence, LICENCE_END, "\n", before, REGISTERED, "])", after].concat())
}

/// A script as it is sent, and its entity tag.
struct Sent {
    bytes: &'static [u8],
    tag: Tag,
}

impl Sent {
    fn of(bytes: Vec<u8>) -> Self {
        let bytes: &'static [u8] = bytes.leak();
        Self { bytes, tag: Tag::of(bytes) }
    }
}

/// Plotly's script without MathJax, which the crate adds; `None` if the crate's text has another form.
static PLAIN: LazyLock<Option<Sent>> = LazyLock::new(|| {
    let fragment = Plot::offline_js_sources();
    let (_, rest) = fragment.split_once(OPENING)?;
    let (script, _) = rest.split_once(CLOSING)?;
    Some(Sent::of(quick_to_start(script).unwrap_or_else(|| script.to_owned()).into_bytes()))
});

/// The script compressed with gzip, made once.
static COMPRESSED: LazyLock<Option<Sent>> = LazyLock::new(|| {
    let compress = |plain: &[u8]| -> io::Result<Vec<u8>> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(plain)?;
        encoder.finish()
    };
    PLAIN.as_ref().and_then(|plain| compress(plain.bytes).ok()).map(Sent::of)
});

async fn plotly(headers: &HeaderMap) -> Result<Response, Problem> {
    let takes_gzip = takes_gzip(headers);
    let found = spawn_blocking(move || {
        let compressed = if takes_gzip { COMPRESSED.as_ref() } else { None };
        compressed.map(|sent| (sent, true)).or_else(|| PLAIN.as_ref().map(|sent| (sent, false)))
    });
    let (sent, is_compressed) =
        found.await.ok().flatten().ok_or_else(|| Problem::not_found(format_args!("script to draw with")))?;
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
        let plain = PLAIN.as_ref().expect("the crate has it");
        let text = std::str::from_utf8(plain.bytes).unwrap();
        assert!(text.contains("plotly.js v") && !text.contains("</script"));
        assert!(text.contains("Licensed under the MIT license"));
        assert!(text.contains(".register([])") && text.ends_with("window.Plotly = Plotly;"), "it is quick to start");
        assert!((3_000_000..5_000_000).contains(&text.len()), "{}", text.len());
    }
}
