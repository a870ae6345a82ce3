//! The `goniochrome` command: parses its arguments, runs them, and returns an exit code.

use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
use goniochrome_cli::commands;
use goniochrome_cli::commands::args::CommandLine;
use goniochrome_cli::support::error::Error;

fn main() -> ExitCode {
    let result = match CommandLine::try_parse() {
        Ok(line) => commands::run(&line.command),
        // Help and version are not errors. Wrong usage is reported in one line, as all errors are.
        Err(error) if !error.use_stderr() => return if error.print().is_ok() { 0 } else { 1 }.into(),
        Err(error) if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            Err(Error::usage("a command is missing; goniochrome --help lists them"))
        }
        Err(error) => Err(usage(&error.to_string())),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("goniochrome: {error}");
            error.exit_code().into()
        }
    }
}

/// A usage error with the first paragraph of clap's message, and clap's hint if it has one.
fn usage(message: &str) -> Error {
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let said: Vec<&str> =
        message.split("\n\n").take_while(|part| !part.starts_with("Usage:") && !part.starts_with("For more")).collect();
    Error::usage(format_args!("{} (goniochrome --help tells more)", said.join("; ")))
}
