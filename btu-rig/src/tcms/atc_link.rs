//! The RS-485 link to the unit as TCMS sees it: orders that are fresh and make sense.

use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode};
use protocol::{Duration, Instant};

use super::controller::{FULL_BRAKE, FULL_POWER};

/// Orders of ATO as TCMS takes them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AtoOrder {
    /// Powering (DRXAOP).
    pub power: bool,
    /// Braking (DRXAOB).
    pub brake: bool,
    /// Value (DRXTEBE), −1024..1023.
    pub value: i16,
    pub holding: bool,
    /// Powering is to drive the train backward.
    pub backward: bool,
    /// The unit drives, or is about to: Automatic or Automatic Run, as last heard.
    pub automatic: bool,
    /// ATO has failed, or the unit is silent.
    pub failed: bool,
    /// The unit asks for the change of cabs.
    pub change_of_cabs: bool,
    /// The unit says that the train is put away.
    pub put_away: bool,
}

#[derive(Clone, Debug)]
pub struct AtcLink {
    timeout: Duration,
    heard: Option<(Instant, AtcToTcms)>,
    /// No frames for too long.
    pub silent: bool,
    /// Times the unit began to contradict itself.
    pub contradictions: u32,
    contradicts: bool,
}

impl AtcLink {
    /// A link on which nothing was heard yet; orders count for `timeout`.
    pub fn new(timeout: Duration) -> Self {
        Self {
            timeout,
            heard: None,
            silent: true,
            contradictions: 0,
            contradicts: false,
        }
    }

    /// Takes a frame. A frame that contradicts itself is taken, too: [`driving_control`] acts on the safe side.
    ///
    /// [`driving_control`]: super::driving_control()
    pub fn receive(&mut self, now: Instant, frame: &AtcToTcms) {
        let power = frame.bits.contains(AtcToTcmsBits::POWER);
        let brake = frame.bits.contains(AtcToTcmsBits::BRAKE);
        let beyond = !(FULL_BRAKE..=FULL_POWER).contains(&frame.effort);
        let against = match (power, brake) {
            (true, true) => true,
            (true, false) => frame.effort < 0,
            (false, true) => frame.effort > 0,
            (false, false) => frame.effort != 0,
        };
        let contradicts = beyond || against;
        if contradicts && !self.contradicts {
            self.contradictions = self.contradictions.saturating_add(1);
        }
        self.contradicts = contradicts;
        self.heard = Some((now, *frame));
    }

    pub fn step(&mut self, now: Instant) -> AtoOrder {
        let fresh = self
            .heard
            .filter(|(heard, _)| now.since(*heard) <= self.timeout);
        self.silent = fresh.is_none();
        let mode = self.heard.map_or(Mode::Off, |(_, frame)| frame.mode);
        let runs = fresh.filter(|(_, frame)| frame.mode == Mode::AutomaticRun);
        let bits = fresh.map_or(AtcToTcmsBits::empty(), |(_, frame)| frame.bits);
        AtoOrder {
            power: runs.is_some() && bits.contains(AtcToTcmsBits::POWER),
            brake: runs.is_some() && bits.contains(AtcToTcmsBits::BRAKE),
            value: runs.map_or(0, |(_, frame)| frame.effort),
            backward: runs.is_some() && bits.contains(AtcToTcmsBits::BACKWARD),
            holding: bits.contains(AtcToTcmsBits::HOLDING_BRAKE),
            automatic: matches!(mode, Mode::Automatic | Mode::AutomaticRun),
            failed: self.silent || bits.contains(AtcToTcmsBits::ATO_FAILED),
            change_of_cabs: bits.contains(AtcToTcmsBits::CHANGE_OF_CABS),
            put_away: bits.contains(AtcToTcmsBits::PUT_AWAY),
        }
    }

    /// Effort last ordered, for the event.
    pub fn effort(&self) -> i16 {
        self.heard.map_or(0, |(_, frame)| frame.effort)
    }
}
