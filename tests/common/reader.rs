//! Reads the increments of a stream one by one, from server-sent events or from lines, without holding more than one chunk.

use reqwest::{Client, Response, StatusCode};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Events,
    Lines,
}

impl Format {
    fn media_type(self) -> &'static str {
        match self {
            Self::Events => "text/event-stream",
            Self::Lines => "application/x-ndjson",
        }
    }
}

/// What a stream says next.
#[derive(Debug, PartialEq, Eq)]
pub enum Said {
    /// Its index and its JSON text.
    Increment(u64, String),
    /// The stream is complete.
    End,
    /// Without an end of its own.
    BrokenOff,
}

pub struct Reader {
    response: Response,
    format: Format,
    bytes: Vec<u8>,
    /// What stands before it has been read.
    read: usize,
    event: String,
    id: Option<u64>,
}

impl Reader {
    /// Opens the stream of a job after that index.
    pub async fn open(client: &Client, url: &str, job: &str, format: Format, after: Option<u64>) -> Self {
        let mut ask = client.get(format!("{url}/v1/jobs/{job}/stream")).header("accept", format.media_type());
        if let Some(after) = after {
            ask = ask.header("last-event-id", after.to_string());
        }
        let response = ask.send().await.expect("an answer");
        assert_eq!(response.status(), StatusCode::OK);
        assert_eq!(response.headers()["content-type"], format.media_type());
        Self { response, format, bytes: Vec::new(), read: 0, event: String::new(), id: None }
    }

    pub async fn next(&mut self) -> Said {
        loop {
            let Some(length) = self.bytes[self.read..].iter().position(|byte| *byte == b'\n') else {
                self.bytes.drain(..self.read);
                self.read = 0;
                match self.response.chunk().await {
                    Ok(Some(chunk)) => self.bytes.extend_from_slice(&chunk),
                    // Lines end with the body; events say so themselves.
                    Ok(None) if self.format == Format::Lines && self.bytes.is_empty() => return Said::End,
                    Ok(None) | Err(_) => return Said::BrokenOff,
                }
                continue;
            };
            let line = std::str::from_utf8(&self.bytes[self.read..self.read + length]).expect("text").to_owned();
            self.read += length + 1;
            match self.format {
                Format::Lines => return Said::Increment(index(&line), line),
                Format::Events => {
                    if let Some(said) = self.take(line) {
                        return said;
                    }
                }
            }
        }
    }

    /// One line of an event; the data stand last.
    fn take(&mut self, line: String) -> Option<Said> {
        match line.split_once(": ") {
            Some(("event", name)) => name.clone_into(&mut self.event),
            Some(("id", id)) => self.id = Some(id.parse().expect("an index")),
            Some(("data", data)) => {
                return match self.event.as_str() {
                    "increment" => {
                        assert_eq!(self.id, Some(index(data)), "the id is the index");
                        Some(Said::Increment(index(data), data.to_owned()))
                    }
                    "end" => Some(Said::End),
                    other => panic!("an event {other:?}"),
                };
            }
            _ => {}
        }
        None
    }
}

/// It stands first in every increment.
fn index(line: &str) -> u64 {
    let digits = line.strip_prefix("{\"index\":").and_then(|rest| rest.split(',').next());
    digits.and_then(|digits| digits.parse().ok()).unwrap_or_else(|| panic!("an increment without an index: {line}"))
}
