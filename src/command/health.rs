//! `arcslip health`: asks a running service whether it is ready, for containers without another HTTP client.

use crate::command::output::outcome::{Failure, Outcome, say};
use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::process::ExitCode;
use std::time::Duration;

const PATIENCE: Duration = Duration::from_secs(5);
/// Only the status line is read.
const ENOUGH: u64 = 4096;

/// Ask a running service whether it is ready; exit status 0 if so.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[arg(long, default_value = "http://127.0.0.1:8080/readyz")]
    url: String,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let status = status_line(&arguments.url)?;
    say(format_args!("{status}\n"))?;
    match status.split(' ').nth(1) {
        Some("200") => Ok(ExitCode::SUCCESS),
        _ => Ok(ExitCode::from(crate::command::output::outcome::FAILED)),
    }
}

fn status_line(url: &str) -> Result<String, Failure> {
    let rest = url.strip_prefix("http://").ok_or_else(|| Failure::Input(vec![format!("{url}: not an http:// URL")]))?;
    let (authority, path) = rest.split_at(rest.find('/').unwrap_or(rest.len()));
    let path = if path.is_empty() { "/" } else { path };
    let with_port = if authority.contains(':') { authority.to_owned() } else { format!("{authority}:80") };
    let address = with_port
        .to_socket_addrs()
        .map_err(Failure::other)?
        .next()
        .ok_or_else(|| Failure::Other(format!("{authority} has no address")))?;
    let mut stream = TcpStream::connect_timeout(&address, PATIENCE).map_err(Failure::other)?;
    stream.set_read_timeout(Some(PATIENCE)).map_err(Failure::other)?;
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {authority}\r\nConnection: close\r\n\r\n").map_err(Failure::other)?;
    let mut answer = Vec::new();
    stream.take(ENOUGH).read_to_end(&mut answer).map_err(Failure::other)?;
    Ok(String::from_utf8_lossy(&answer).lines().next().unwrap_or_default().to_owned())
}
