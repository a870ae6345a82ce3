//! The command `goniochrome merge`.
//!
//! The records of all parts become the checkpoint of the table, from which `estimate` then makes the table as if it
//! went on after an interruption: nothing is left to compute.

use std::path::Path;

use clap::Parser;

use crate::commands::args::{Command, CommandLine, EstimateArgs, MergeArgs};
use crate::commands::estimate;
use crate::solve::checkpoint::{Checkpoint, Identity};
use crate::solve::sealed_part::SealedPart;
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::bar;

pub fn run(args: &MergeArgs) -> Result<()> {
    output::check_destination(&args.output, &args.parts)?;
    let parts = parts(args)?;
    let estimate = request(&parts[0], args)?;
    let identity = Identity::of_head(&parts[0].head);
    let Some(checkpoint) = Checkpoint::open(&args.output, &identity, false)? else {
        return Err(Error::usage("--output: a table is a file, which no device or pipe holds; name one"));
    };
    let progress = bar("parts", parts.len(), args.running.quiet);
    for part in &parts {
        part.records(|number, record| checkpoint.keep(number, record)).inspect_err(|_| checkpoint.abandon())?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    drop(checkpoint);
    estimate::run(&estimate).map_err(|error| {
        // The parts themselves remain.
        if let Ok(Some(checkpoint)) = Checkpoint::open(&args.output, &identity, true) {
            checkpoint.abandon();
        }
        Error::failed(format_args!("the parts cannot be joined: {error}"))
    })
}

/// Opens all parts: each of one table, once.
fn parts(args: &MergeArgs) -> Result<Vec<SealedPart>> {
    let first = SealedPart::open(&args.parts[0])?;
    let (of, wanted) = (first.share().of, asked(&first)?);
    let mut found: Vec<Option<&Path>> = vec![None; of as usize];
    let mut parts = Vec::with_capacity(args.parts.len());
    for path in &args.parts {
        let mut part = SealedPart::open(path)?;
        let name = path.display();
        let place = part.share().number.checked_sub(1).and_then(|place| found.get_mut(place as usize));
        let Some(place) = place.filter(|_| part.share().of == of) else {
            return Err(Error::failed(format_args!(
                "{name}: is part {} where {} is one of {of}; join parts of one table",
                part.share(),
                first.path().display()
            )));
        };
        if part.head != first.head || asked(&part)? != wanted {
            return Err(Error::failed(format_args!(
                "{name}: belongs to another table than {}: another scene, other options or another version",
                first.path().display()
            )));
        }
        if let Some(other) = place.replace(path) {
            return Err(Error::failed(format_args!(
                "{name}: is part {} as {} is; leave one of them out",
                part.share(),
                other.display()
            )));
        }
        // The first stands for what all have in common: of thousands of parts, a kilobyte each.
        if !parts.is_empty() {
            (part.head, part.seal.arguments) = (Vec::new(), Vec::new());
        }
        parts.push(part);
    }
    let missing: Vec<String> =
        found.iter().zip(1..).filter(|(part, _)| part.is_none()).map(|(_, number)| number.to_string()).collect();
    match missing.as_slice() {
        [] => Ok(parts),
        [one] => Err(Error::failed(format_args!("part {one}/{of} is missing; compute it, or name its file"))),
        several => Err(Error::failed(format_args!(
            "{} of {of} parts are missing, the first is {}/{of}; compute them, or name their files",
            several.len(),
            several[0]
        ))),
    }
}

/// The request that a part was made by, without what differs from part to part.
fn parsed(part: &SealedPart) -> Result<EstimateArgs> {
    let words = std::iter::once("goniochrome").chain(part.seal.arguments.iter().map(String::as_str));
    let line = CommandLine::try_parse_from(words).map(|line| line.command);
    let Ok(Command::Estimate(mut args)) = line else {
        return Err(Error::failed(format_args!(
            "{}: the command that made it is no estimate of this version",
            part.path().display()
        )));
    };
    args.farm.part = None;
    args.cell.restart = false;
    args.scene.clone_from(&part.seal.scene);
    Ok(args)
}

/// What a part was asked for, to be compared.
fn asked(part: &SealedPart) -> Result<String> {
    let mut args = parsed(part)?;
    args.output.clear();
    (args.computing.running.threads, args.computing.running.quiet) = (None, false);
    Ok(format!("{args:?}"))
}

/// The request for the whole table.
fn request(part: &SealedPart, args: &MergeArgs) -> Result<EstimateArgs> {
    let mut estimate = parsed(part)?;
    estimate.output.clone_from(&args.output);
    estimate.computing.running = args.running;
    Ok(estimate)
}
