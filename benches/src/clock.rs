//! Processor time, which other programs on the machine do not lengthen as they do wall-clock time.

use std::fs;
use std::time::{Duration, Instant};

/// Runs `work` and returns its result and the processor time that the process spent on it, of all threads; wall-clock time
/// where the system does not tell.
pub fn processor_time<R>(work: impl FnOnce() -> R) -> (R, Duration) {
    let (start, before) = (Instant::now(), used());
    let result = work();
    let elapsed = start.elapsed();
    (result, used().zip(before).map_or(elapsed, |(after, before)| after.saturating_sub(before)))
}

/// Nanoseconds on a processor, the first number of Linux's schedstat, for each thread that still runs.
fn used() -> Option<Duration> {
    let tasks = fs::read_dir("/proc/self/task").ok()?;
    let of = |task: fs::DirEntry| {
        let text = fs::read_to_string(task.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<u64>().ok()
    };
    Some(Duration::from_nanos(tasks.filter_map(|task| of(task.ok()?)).sum()))
}
