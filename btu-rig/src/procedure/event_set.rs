//! A set of events, small enough to copy.

use protocol::event::Event;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct EventSet(u128);

const _: () = assert!(Event::ALL.len() <= 128);

impl EventSet {
    pub(super) fn insert(&mut self, event: Event) {
        self.0 |= 1 << (event as u32);
    }

    pub(super) fn contains(self, event: Event) -> bool {
        self.0 & (1 << (event as u32)) != 0
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(super) fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

impl FromIterator<Event> for EventSet {
    fn from_iter<I: IntoIterator<Item = Event>>(events: I) -> Self {
        let mut set = Self::default();
        events.into_iter().for_each(|event| set.insert(event));
        set
    }
}
