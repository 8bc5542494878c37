//! Content negotiation: which of the offered media types a client prefers (`Accept`, RFC 9110, section 12.5.1).

use axum::http::{HeaderMap, header};
use std::cmp::Reverse;

/// A media range of the header and its weight.
struct Range<'a> {
    kind: &'a str,
    subtype: &'a str,
    /// In thousandths; 0 refuses the range.
    weight: u16,
}

/// The index of the media type that the client prefers. The largest weight decides, then the most specific range, then the
/// order of the ranges, then the order of the offers. `Some(0)` without the header; `None` if the client accepts no offer.
pub fn preferred(headers: &HeaderMap, offered: &[&str]) -> Option<usize> {
    let values: Vec<&str> =
        headers.get_all(header::ACCEPT).iter().map(|value| value.to_str().unwrap_or_default()).collect();
    if values.is_empty() {
        return Some(0);
    }
    let ranges: Vec<Range> = values.iter().flat_map(|value| value.split(',')).filter_map(range).collect();
    let standings = offered.iter().enumerate().filter_map(|(number, media_type)| {
        let (kind, subtype) = media_type.split_once('/')?;
        let named = ranges
            .iter()
            .enumerate()
            .filter_map(|(place, range)| Some((exactness(range, kind, subtype)?, Reverse(place), range.weight)));
        // The most specific range decides, even if it refuses what a wider range accepts.
        let (exactness, place, weight) = named.max()?;
        (weight > 0).then_some((weight, exactness, place, Reverse(number)))
    });
    standings.max().map(|(_, _, _, Reverse(number))| number)
}

/// Parses a media range; `None` if it is malformed.
fn range(text: &str) -> Option<Range<'_>> {
    let mut parts = text.split(';').map(str::trim);
    let (kind, subtype) = parts.next()?.split_once('/')?;
    let weight = parts.find_map(|parameter| {
        let (name, value) = parameter.split_once('=')?;
        name.trim().eq_ignore_ascii_case("q").then(|| value.trim())
    });
    let weight = match weight {
        None => 1.0,
        Some(value) => value.parse::<f32>().ok().filter(|weight| (0.0..=1.0).contains(weight))?,
    };
    Some(Range { kind, subtype, weight: (weight * 1000.0).round() as u16 })
}

fn exactness(range: &Range, kind: &str, subtype: &str) -> Option<u8> {
    let same = |found: &str, offered: &str| found.eq_ignore_ascii_case(offered);
    match (range.kind, range.subtype) {
        ("*", "*") => Some(0),
        (found, "*") if same(found, kind) => Some(1),
        (found, name) if same(found, kind) && same(name, subtype) => Some(2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(accept: &str) -> Option<usize> {
        let headers = [(header::ACCEPT, accept.parse().unwrap())].into_iter().collect();
        preferred(&headers, &["text/event-stream", "application/x-ndjson"])
    }

    #[test]
    fn weights_exactness_and_order_decide() {
        assert_eq!(preferred(&HeaderMap::new(), &["text/event-stream"]), Some(0));
        for first in ["*/*", "text/*", "TEXT/Event-Stream;charset=utf-8", "text/event-stream, application/x-ndjson"] {
            assert_eq!(choice(first), Some(0), "{first}");
        }
        for second in [
            "application/x-ndjson",
            "application/*",
            "*/*, application/x-ndjson",
            "text/event-stream;q=0.5, application/x-ndjson ; Q=0.501",
            "text/event-stream;q=0, */*",
            "text/event-stream;level=1;q=0.0, */*;q=0.1",
        ] {
            assert_eq!(choice(second), Some(1), "{second}");
        }
    }

    #[test]
    fn what_is_refused_or_malformed_is_not_taken() {
        for none in ["", "image/png", "*/*;q=0", "application/x-ndjson;q=0", "*/*;q=2", "*/*;q=nan", "*/*;q=", "*"] {
            assert_eq!(choice(none), None, "{none}");
        }
    }
}
