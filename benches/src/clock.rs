//! Processor time, which other programs on the machine lengthen less than wall-clock time.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// Runs `work`. Returns its result and the processor time that all threads of the process took meanwhile.
pub fn processor_time<R>(work: impl FnOnce() -> R) -> (R, Duration) {
    let used = || Duration::try_from(clock_gettime(ClockId::ProcessCPUTime)).unwrap_or_default();
    let before = used();
    let result = work();
    (result, used().saturating_sub(before))
}
