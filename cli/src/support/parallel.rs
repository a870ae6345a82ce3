//! Work distributed over threads.

use std::sync::Mutex;

/// Does `work` on every item, on `threads` threads; each thread calls `local` once for its own memory.
///
/// Chance decides which thread takes an item. Results are the same for any number of threads as long as `work` depends
/// on its item alone.
pub fn for_each<T: Send, L>(
    threads: usize,
    items: impl Iterator<Item = T> + Send,
    local: impl Fn() -> L + Sync,
    work: impl Fn(&mut L, T) + Sync,
) {
    let items = Mutex::new(items);
    let worker = || {
        let mut memory = local();
        loop {
            // A worker that panicked has not touched the iterator's state, which `next` alone changes.
            let item = items.lock().unwrap_or_else(std::sync::PoisonError::into_inner).next();
            let Some(item) = item else { break };
            work(&mut memory, item);
        }
    };
    if threads <= 1 {
        return worker();
    }
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(worker);
        }
    });
}

/// Default number of threads: as many as the machine runs at once.
#[must_use]
pub fn available() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once() {
        for threads in [1, 2, 5] {
            let mut squares = vec![0usize; 100];
            for_each(threads, squares.iter_mut().enumerate(), || (), |(), (i, out)| *out += i * i);
            assert!(squares.iter().enumerate().all(|(i, &square)| square == i * i));
        }
    }
}
