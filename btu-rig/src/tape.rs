//! What was done to a bench and when, so that it can be done again: open loop, whatever the unit
//! answers this time.

use protocol::{Duration, Instant, SCAN};
use serde::{Deserialize, Serialize};

use crate::procedure::{Driver, Evidence, Refusal};
use crate::rig::Rig;
use crate::stimulus::Stimulus;

/// Deeds kept of one procedure; those beyond are counted, and the tape is then of no use for a replay.
pub const MAX_DEEDS: usize = 100_000;

/// Something that was done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Act {
    /// A stimulus, whether the bench took it or refused it.
    Apply(Stimulus),
    /// The bench was made safe in so many scans one after the other.
    MakeSafe {
        /// Scans.
        scans: u32,
    },
}

/// What was done, and when on the bench's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deed {
    /// Time of the scan after which it was done, µs.
    pub at_us: u64,
    /// What.
    pub act: Act,
}

/// All that was done to a bench, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tape {
    /// The deeds.
    pub deeds: Vec<Deed>,
    /// Deeds that found no room.
    pub lost: u32,
}

impl Tape {
    fn note(&mut self, now: Instant, act: Act) {
        if self.deeds.len() == MAX_DEEDS {
            self.lost += 1;
            return;
        }
        let at_us = now.as_us();
        self.deeds.push(Deed { at_us, act });
    }

    fn note_safe(&mut self, now: Instant) {
        if let Some(Deed { at_us, act }) = self.deeds.last_mut()
            && let Act::MakeSafe { scans } = act
            && now.as_us() == *at_us + u64::from(*scans) * SCAN.as_us()
        {
            *scans += 1;
            return;
        }
        self.note(now, Act::MakeSafe { scans: 1 });
    }

    /// Time of the last deed, µs; making safe counts to its last scan.
    pub fn end_us(&self) -> u64 {
        let end = |deed: &Deed| match deed.act {
            Act::Apply(_) => deed.at_us,
            Act::MakeSafe { scans } => {
                deed.at_us + u64::from(scans.saturating_sub(1)) * SCAN.as_us()
            }
        };
        self.deeds.last().map_or(0, end)
    }
}

/// The rig, with all that is done to it going on the tape.
pub struct Taping<'a> {
    rig: &'a mut Rig,
    tape: &'a mut Tape,
}

impl<'a> Taping<'a> {
    /// Drives `rig` and keeps what is done on `tape`.
    pub fn new(rig: &'a mut Rig, tape: &'a mut Tape) -> Self {
        Self { rig, tape }
    }
}

impl Driver for Taping<'_> {
    fn apply(&mut self, now: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        self.tape.note(now, Act::Apply(*stimulus));
        self.rig.apply(now, stimulus)
    }

    fn settled(&mut self) -> Result<bool, Refusal> {
        self.rig.settled()
    }

    fn make_safe(&mut self, now: Instant) {
        self.tape.note_safe(now);
        self.rig.make_safe(now);
    }

    fn safe(&self) -> bool {
        self.rig.safe()
    }

    fn evidence(&self) -> Evidence {
        self.rig.evidence()
    }
}

/// Does again what is on a tape.
#[derive(Clone, Debug)]
pub struct Player<'a> {
    tape: &'a Tape,
    next: usize,
    /// Scans of the present making safe that were done.
    safe_scans: u32,
    /// How much later, or earlier, than on the tape, µs.
    shift_us: i64,
}

impl<'a> Player<'a> {
    /// A player at the beginning of the tape; deeds come `shift_us` later than on it.
    pub fn new(tape: &'a Tape, shift_us: i64) -> Self {
        Self {
            tape,
            next: 0,
            safe_scans: 0,
            shift_us,
        }
    }

    /// Does what is due at `now`, after the scan; to be called in each. What this bench refuses is left
    /// out: the next deed may not need it. Refusals come back for whoever wants to tell.
    pub fn play(&mut self, now: Instant, rig: &mut Rig) -> Vec<Refusal> {
        let mut refused = Vec::new();
        while let Some(deed) = self.due(now) {
            match deed.act {
                Act::Apply(stimulus) => refused.extend(rig.apply(now, &stimulus).err()),
                Act::MakeSafe { scans } => {
                    rig.make_safe(now);
                    self.safe_scans += 1;
                    if self.safe_scans < scans {
                        break;
                    }
                    self.safe_scans = 0;
                }
            }
            self.next += 1;
        }
        refused
    }

    /// Everything on the tape is done.
    pub fn done(&self) -> bool {
        self.next == self.tape.deeds.len()
    }

    fn due(&self, now: Instant) -> Option<Deed> {
        let deed = *self.tape.deeds.get(self.next)?;
        let at_us = deed.at_us.saturating_add_signed(self.shift_us);
        (Instant::from_us(at_us) + self.safe_time() <= now).then_some(deed)
    }

    fn safe_time(&self) -> Duration {
        Duration::from_us(u64::from(self.safe_scans) * SCAN.as_us())
    }
}

#[cfg(test)]
mod tests {
    use protocol::Speed;
    use protocol::config::UnitConfig;
    use protocol::line::Line;
    use protocol::message::{DoorSide, ModeSwitch, RunningMode};

    use super::*;
    use crate::lever::Lever;
    use crate::stimulus::{StationData, TachoCondition, TrainSwitch};

    const SPEED_MPS: f64 = 64.0 / 3.6;

    fn rig() -> Rig {
        let config = UnitConfig::from_toml(include_str!("../../scripts/units/sg100.toml"));
        let line = Line::from_toml(include_str!("../../scripts/lines/line8.toml"));
        Rig::new(&config.expect("configuration"), &line.expect("line"), 7)
    }

    fn station() -> StationData {
        StationData {
            route: 1,
            section: 61,
            station: 12,
            next_station: 13,
            loop_id: 5,
            fixed_speed_kmh: None,
            running_mode: RunningMode::Recovery,
            door_side: DoorSide::Unknown(9),
            departure: true,
            train_number: 77,
        }
    }

    /// Goal: a tape read back does to a rig bit by bit what was done when it was made. Method: the wheel
    /// of a rig driven through the tape, and of one that plays it from its text, at each scan.
    #[test]
    fn a_tape_read_back_moves_a_rig_the_same_way() {
        let stimuli = [
            Stimulus::ModeSwitch(ModeSwitch::Manual),
            Stimulus::Controller {
                lever: Lever::Power(3),
            },
            Stimulus::Station(station()),
            Stimulus::Switch {
                switch: TrainSwitch::DeadMan,
                on: true,
            },
            Stimulus::Tacho {
                channel: 2,
                condition: TachoCondition::Noisy { per_s: 12.3 },
            },
            Stimulus::Speed {
                to: Speed::from_mps(SPEED_MPS),
                accel_mps2: 3.0 / 3.6,
            },
        ];
        let run = |deed: &mut dyn FnMut(Instant, &mut Rig)| {
            let mut rig = rig();
            let mut bytes = Vec::new();
            let mut seen = Vec::new();
            for scan in 1..4_000 {
                let now = Instant::from_us(scan * SCAN.as_us());
                rig.step(now, &mut bytes);
                deed(now, &mut rig);
                seen.push(format!("{:?}", rig.sample().values()));
            }
            (bytes, seen)
        };
        let mut tape = Tape::default();
        let mut to_come = stimuli.iter();
        let first = run(&mut |now, rig| {
            let mut driver = Taping::new(rig, &mut tape);
            if now.as_us().is_multiple_of(500_000)
                && let Some(stimulus) = to_come.next()
            {
                driver.apply(now, stimulus).expect("taken");
            }
            if now >= Instant::from_ms(20_000) && !driver.safe() {
                driver.make_safe(now);
            }
        });
        let text = serde_json::to_string(&tape).expect("JSON");
        let read: Tape = serde_json::from_str(&text).expect("a tape");
        assert_eq!(read, tape);
        assert!(tape.deeds.len() < 10, "making safe is one deed: {text}");
        let mut player = Player::new(&read, 0);
        let again = run(&mut |now, rig| assert!(player.play(now, rig).is_empty()));
        assert!(player.done());
        assert_eq!(first, again);
    }
}
