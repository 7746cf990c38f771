//! Relays and drivers: turn what the processors command into the state of the contacts.

use protocol::injection::{Effect, Place};
use protocol::message::Outputs;
use protocol::{Duration, Instant};

use super::DelayQueue;
use crate::faults::Faults;

#[derive(Debug, Default)]
pub struct OutputStage {
    eb_relay: Contact,
    fsb: Contact,
}

/// A contact that follows what is wanted, late if its relay or driver is slow.
#[derive(Debug, Default)]
struct Contact {
    on: bool,
    wanted: bool,
    changes: DelayQueue<bool>,
}

impl OutputStage {
    /// States of the contacts for the wanted outputs.
    pub fn drive(&mut self, now: Instant, wanted: Outputs, faults: &Faults) -> Outputs {
        let mut contacts = wanted;
        for (output, contact, place) in [
            (Outputs::EB_RELAY, &mut self.eb_relay, Place::EbRelay),
            (Outputs::FSB, &mut self.fsb, Place::FsbOutput),
        ] {
            let on = contact.follow(now, wanted.contains(output), faults.at(place));
            contacts.set(output, on);
        }
        for (place, outputs) in [
            (
                Place::DoorOutput,
                Outputs::DOOR_ENABLE_LEFT | Outputs::DOOR_ENABLE_RIGHT,
            ),
            (
                Place::DoorOpenOutput,
                Outputs::OPEN_LEFT | Outputs::OPEN_RIGHT,
            ),
            (Place::DoorCloseOutput, Outputs::CLOSE_DOORS),
        ] {
            match faults.at(place) {
                Some(Effect::Dead | Effect::StuckOff) => contacts.remove(outputs),
                Some(Effect::StuckOn) => contacts.insert(outputs),
                _ => {}
            }
        }
        contacts
    }
}

impl Contact {
    fn follow(&mut self, now: Instant, wanted: bool, effect: Option<Effect>) -> bool {
        let delay = match effect {
            Some(Effect::Delay { ms }) => Duration::from_ms(u64::from(ms)),
            _ => Duration::ZERO,
        };
        if wanted != self.wanted {
            self.wanted = wanted;
            self.changes.push(now + delay, wanted);
        }
        while let Some(on) = self.changes.pop(now) {
            self.on = on;
        }
        match effect {
            Some(Effect::StuckOn) => true,
            Some(Effect::StuckOff | Effect::Dead) => false,
            _ => self.on,
        }
    }
}
