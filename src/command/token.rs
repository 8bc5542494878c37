//! `arcslip token`: makes a new token and its line for the file of tokens.

use crate::command::output::outcome::{Failure, Outcome, say};
use crate::service::http::access::tokens::{self, Scopes};
use std::io::Write;
use std::process::ExitCode;

/// Make a token. Its line for the file of tokens goes to standard output, the token itself, once, to standard error.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The owner: jobs posted with the token belong to this name.
    #[arg(value_parser = name)]
    name: String,
    /// `read`, `submit`, `admin`, or several separated by commas.
    #[arg(long, default_value = "read,submit", value_parser = Scopes::read)]
    scopes: Scopes,
}

fn name(text: &str) -> Result<String, String> {
    tokens::check_name(text).map(|()| text.to_owned())
}

pub fn run(arguments: &Arguments) -> Outcome {
    let (token, hash) = tokens::make().map_err(Failure::other)?;
    // The line first: a token without its line is useless.
    say(format_args!("{} {} {hash}\n", arguments.name, arguments.scopes))?;
    writeln!(std::io::stderr(), "{token}").map_err(Failure::other)?;
    Ok(ExitCode::SUCCESS)
}
