//! Progress of long work, and notes, on standard error.

use std::fmt;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::support::text::plain;

/// Progress bar, shown on a terminal once the work takes more than 0.2 s.
#[must_use]
pub fn bar(what: &str, steps: usize, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(Some(steps as u64), target).with_style(style);
    bar.set_message(plain(what));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Prints one line on standard error, unless quiet.
pub fn note(quiet: bool, line: impl fmt::Display) {
    if !quiet {
        eprintln!("{}", plain(&line.to_string()));
    }
}
