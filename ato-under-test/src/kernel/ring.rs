//! Bounded ring buffer with indices that are never reused: when the oldest entry is dropped, the others keep
//! theirs.

use alloc::collections::VecDeque;

/// Keeps the newest `N` entries.
#[derive(Debug)]
pub struct Ring<T, const N: usize> {
    entries: VecDeque<T>,
    next_index: u32,
}

impl<T, const N: usize> Default for Ring<T, N> {
    /// Empty, beginning at index 0.
    fn default() -> Self {
        Self {
            entries: VecDeque::new(),
            next_index: 0,
        }
    }
}

impl<T, const N: usize> Ring<T, N> {
    /// Index the next entry will get.
    pub fn next_index(&self) -> u32 {
        self.next_index
    }

    /// Keeps an entry; the oldest falls off when there is no room.
    pub fn push(&mut self, entry: T) {
        if self.entries.len() == N {
            self.entries.pop_front();
        }
        self.entries.push_back(entry);
        self.next_index += 1;
    }

    /// The first kept entry with an index of at least `index`.
    pub fn at_or_after(&self, index: u32) -> Option<&T> {
        let skip = index.saturating_sub(self.oldest_index()) as usize;
        self.entries.get(skip)
    }

    pub fn newest(&self) -> Option<&T> {
        self.entries.back()
    }

    /// Oldest index kept; the next one when there is none.
    pub fn oldest_index(&self) -> u32 {
        self.next_index - self.entries.len() as u32
    }

    /// Forgets all entries; indices go on.
    pub fn clear(&mut self) {
        self.entries.clear();
    }
}
