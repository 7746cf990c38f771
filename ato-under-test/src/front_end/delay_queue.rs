//! Delay queue: items become available at a given time.

use alloc::collections::VecDeque;

use protocol::Instant;

/// Things that can wait at once; of more the oldest are lost.
const MOST: usize = 32;

/// A queue of things that are due at a time.
#[derive(Clone, Debug)]
pub struct DelayQueue<T> {
    waiting: VecDeque<(Instant, T)>,
}

impl<T> Default for DelayQueue<T> {
    fn default() -> Self {
        Self {
            waiting: VecDeque::new(),
        }
    }
}

impl<T> DelayQueue<T> {
    /// Lets a thing wait until `due`.
    pub fn push(&mut self, due: Instant, thing: T) {
        if self.waiting.len() == MOST {
            self.waiting.pop_front();
        }
        self.waiting.push_back((due, thing));
    }

    /// The next thing that is due by now, in the order they went in.
    pub fn pop(&mut self, now: Instant) -> Option<T> {
        let (due, _) = self.waiting.front()?;
        if *due > now {
            return None;
        }
        self.waiting.pop_front().map(|(_, thing)| thing)
    }
}
