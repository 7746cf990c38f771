//! Contacts of the desk that chatter, or contradict each other by turns, come to rest at no position: no delay and
//! no sum of the supervision would ever end.

use protocol::event::Event;
use protocol::{Duration, Instant};

use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Time at a position by which it was chosen, and not passed on the way to another [default].
pub const CHOSEN: Duration = Duration::from_ms(1_000);
/// Time in which a person has chosen a position: contacts that go on changing chatter [default].
const CHOOSES: Duration = Duration::from_ms(3 * CHOSEN.as_ms());

/// Contacts that tell a position.
#[derive(Clone, Debug, Default)]
pub struct Contacts<T> {
    position: T,
    stays: OnDelay,
    changes: OnDelay,
    chatters: Edge,
}

impl<T: Copy + PartialEq> Contacts<T> {
    /// One scan; logs the event once no position has been chosen for too long on a train that moves. At rest a person may turn
    /// the switch as often as they like.
    pub fn step(
        &mut self,
        now: Instant,
        (position, moves): (T, bool),
        event: Event,
        log: &mut EventLog,
    ) {
        let same = core::mem::replace(&mut self.position, position) == position;
        let chosen = self.stays.update(now, same, CHOSEN);
        let changes = self.changes.update(now, !chosen, CHOOSES);
        if (self.chatters).rises(changes && (moves || self.chatters.value())) {
            log.push(now, event, 0);
        }
    }

    /// The contacts chatter, until a position has been chosen.
    pub fn chatters(&self) -> bool {
        self.chatters.value()
    }
}
