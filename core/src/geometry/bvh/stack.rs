//! The stack of children that a single ray has still to visit.

use super::node::{Child, MAX_WAITING};

/// A child whose box the ray enters at the parameter `near`.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub(super) near: f32,
    pub(super) child: Child,
}

/// The children that wait to be visited, the nearest of each node on top. It has room for those of the deepest tree.
pub(super) struct EntryStack<'e> {
    /// Borrowed, so that the height stays in a register.
    entries: &'e mut [Entry; MAX_WAITING],
    height: usize,
}

impl<'e> EntryStack<'e> {
    /// Memory of an empty stack.
    pub(super) const EMPTY: [Entry; MAX_WAITING] = [Entry { near: 0.0, child: Child::ROOT }; MAX_WAITING];

    #[inline]
    pub(super) fn new(entries: &'e mut [Entry; MAX_WAITING]) -> Self {
        Self { entries, height: 0 }
    }

    #[inline]
    pub(super) fn height(&self) -> usize {
        self.height
    }

    #[inline]
    pub(super) fn push(&mut self, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(self.height) {
            *slot = entry;
            self.height += 1;
        }
    }

    /// Moves the top entry below those above `base` that are nearer.
    #[inline]
    pub(super) fn sink(&mut self, base: usize) {
        let mut place = self.height.saturating_sub(1);
        while place > base {
            let Some([below, above]) = self.entries.get_mut(place - 1..=place) else { return };
            if below.near >= above.near {
                return;
            }
            core::mem::swap(below, above);
            place -= 1;
        }
    }

    /// Pops entries until one is entered before `far`, and returns its child.
    #[inline]
    pub(super) fn pop_before(&mut self, far: f32) -> Option<Child> {
        loop {
            self.height = self.height.checked_sub(1)?;
            let entry = self.entries.get(self.height)?;
            if entry.near <= far {
                return Some(entry.child);
            }
        }
    }
}
