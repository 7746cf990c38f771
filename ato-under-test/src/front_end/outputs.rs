//! Relays and drivers: what the processors want becomes what the contacts do.

use alloc::collections::VecDeque;

use protocol::injection::{Effect, Place};
use protocol::message::Outputs;
use protocol::{Duration, Instant};

use super::Faults;

/// Changes an EB relay can be behind; a relay that is later than this many changes skips some.
const RELAY_QUEUE: usize = 16;

/// The output side.
#[derive(Debug, Default)]
pub struct OutputStage {
    relay_energised: bool,
    relay_wanted: bool,
    relay_changes: VecDeque<(Instant, bool)>,
}

impl OutputStage {
    /// The contacts for what is wanted.
    pub fn drive(&mut self, now: Instant, wanted: Outputs, faults: &Faults) -> Outputs {
        let mut contacts = wanted;
        let relay = self.relay(
            now,
            wanted.contains(Outputs::EB_RELAY),
            faults.at(Place::EbRelay),
        );
        contacts.set(Outputs::EB_RELAY, relay);
        match faults.at(Place::FsbOutput) {
            Some(Effect::Dead | Effect::StuckOff) => contacts.remove(Outputs::FSB),
            Some(Effect::StuckOn) => contacts.insert(Outputs::FSB),
            _ => {}
        }
        let doors = Outputs::DOOR_ENABLE_LEFT | Outputs::DOOR_ENABLE_RIGHT;
        match faults.at(Place::DoorOutput) {
            Some(Effect::Dead | Effect::StuckOff) => contacts.remove(doors),
            Some(Effect::StuckOn) => contacts.insert(doors),
            _ => {}
        }
        contacts
    }

    fn relay(&mut self, now: Instant, wanted: bool, effect: Option<Effect>) -> bool {
        let delay = match effect {
            Some(Effect::StuckOn) => return true,
            Some(Effect::StuckOff | Effect::Dead) => return false,
            Some(Effect::Delay { ms }) => Duration::from_ms(u64::from(ms)),
            _ => Duration::ZERO,
        };
        if wanted != self.relay_wanted {
            self.relay_wanted = wanted;
            if self.relay_changes.len() == RELAY_QUEUE {
                self.relay_changes.pop_front();
            }
            self.relay_changes.push_back((now + delay, wanted));
        }
        while self.relay_changes.front().is_some_and(|(at, _)| *at <= now) {
            self.relay_energised = self.relay_changes.pop_front().is_some_and(|(_, on)| on);
        }
        self.relay_energised
    }
}
