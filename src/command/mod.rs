//! The command line: one file per command.
//!
//! Exit status: 0 done, 1 stopped or failed, 2 bad input. Called by `main` alone.

mod backup;
mod check;
mod convert;
mod critical_curve;
mod health;
mod openapi;
mod options;
pub(crate) mod output;
mod paths;
mod scenes;
mod serve;
mod study;
mod sweep;
mod token;
mod verify;
mod work;

use crate::command::options::input::MistakeFormat;
use crate::command::output::outcome::{BAD_INPUT, FAILED, Failure, Outcome};
use crate::command::paths::{export, solve};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;

/// The version, and the commit that the program is built from.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("ARCSLIP_COMMIT"), ")");

/// Equilibrium paths of structures with unilateral contact and Coulomb friction.
#[derive(Debug, Parser)]
#[command(name = "arcslip", version = VERSION)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Serve(serve::Arguments),
    Work(work::Arguments),
    Solve(solve::Arguments),
    Study(study::Arguments),
    Sweep(sweep::Arguments),
    Continue(critical_curve::Arguments),
    Check(check::Arguments),
    Export(export::Arguments),
    Convert(convert::Arguments),
    Scenes(scenes::Arguments),
    Verify(verify::Arguments),
    Health(health::Arguments),
    Token(token::Arguments),
    Backup(backup::Arguments),
    #[command(hide = true)]
    Openapi(openapi::Arguments),
}

fn arguments() -> Result<(Arguments, ArgMatches), Failure> {
    let matches = options::settings::parse(Arguments::command)?;
    Ok((Arguments::from_arg_matches(&matches).map_err(Failure::other)?, matches))
}

fn run_command(command: Command, matches: &ArgMatches) -> Outcome {
    match command {
        Command::Serve(arguments) => {
            serve::run(&arguments, &options::settings::in_force(Arguments::command(), matches))
        }
        Command::Work(arguments) => work::run(&arguments, &options::settings::in_force(Arguments::command(), matches)),
        Command::Solve(arguments) => arguments.bounds.within(|| solve::run(&arguments)),
        Command::Study(arguments) => arguments.bounds.within(|| study::run(&arguments)),
        Command::Sweep(arguments) => arguments.bounds.within(|| sweep::run(&arguments)),
        Command::Continue(arguments) => arguments.bounds.within(|| critical_curve::run(&arguments)),
        Command::Check(arguments) => arguments.bounds.within(|| check::run(&arguments)),
        Command::Export(arguments) => export::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Scenes(arguments) => scenes::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Health(arguments) => health::run(&arguments),
        Command::Token(arguments) => token::run(&arguments),
        Command::Backup(arguments) => backup::run(&arguments),
        Command::Openapi(arguments) => openapi::run(&arguments),
    }
}

/// Runs the command given on the command line.
pub fn run() -> ExitCode {
    let mut mistakes = MistakeFormat::Text;
    let outcome = arguments().and_then(|(arguments, matches)| {
        mistakes = MistakeFormat::asked(&matches);
        run_command(arguments.command, &matches)
    });
    match outcome {
        Ok(code) => code,
        Err(Failure::Document(errors)) => {
            eprintln!("{}", mistakes.write(&errors));
            ExitCode::from(BAD_INPUT)
        }
        Err(Failure::Input(lines)) => {
            for line in lines {
                eprintln!("{line}");
            }
            ExitCode::from(BAD_INPUT)
        }
        Err(Failure::Other(text)) => {
            eprintln!("arcslip: {text}");
            ExitCode::from(FAILED)
        }
    }
}
