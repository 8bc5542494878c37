//! `arcslip token`: a new token and the line that makes a service take it.

use crate::command::output::outcome::{Failure, Outcome, say};
use crate::service::http::access::tokens::{self, Scopes};
use std::io::Write;
use std::process::ExitCode;

/// Make a token: its line for the file of tokens on standard output, the token itself, once, on standard error.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Whose it is: jobs posted with it belong to this name.
    #[arg(value_parser = name)]
    name: String,
    /// `read`, `submit`, `admin`, or several with commas.
    #[arg(long, default_value = "read,submit", value_parser = Scopes::read)]
    scopes: Scopes,
}

fn name(text: &str) -> Result<String, String> {
    tokens::check_name(text).map(|()| text.to_owned())
}

pub fn run(arguments: &Arguments) -> Outcome {
    let (token, hash) = tokens::make().map_err(Failure::other)?;
    // The line first: a token that no file knows is of no use to anyone.
    say(format_args!("{} {} {hash}\n", arguments.name, arguments.scopes))?;
    writeln!(std::io::stderr(), "{token}").map_err(Failure::other)?;
    Ok(ExitCode::SUCCESS)
}
