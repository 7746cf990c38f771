//! Recorded stimuli: every stimulus a procedure gave the bench, with its time, so that a run can be repeated
//! open loop, whatever the unit answers this time.

use protocol::message::{SelfTest, SelfTestItem};
use protocol::signal::Signal;
use protocol::{Duration, Instant, SCAN};
use serde::{Deserialize, Serialize};

use crate::procedure::{Driver, Evidence, Refusal};
use crate::rig::Rig;
use crate::stimulus::Stimulus;

/// Entries kept of one procedure. Further entries are only counted, and the record then cannot be
/// replayed.
pub const MAX_RECORDED: usize = 100_000;

/// What a procedure can do to a bench.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BenchAction {
    /// A stimulus, whether the bench took it or refused it.
    Apply(Stimulus),
    /// Number of scans in a row in which the bench was made safe.
    MakeSafe {
        /// Number of scans of 10 ms.
        scans: u32,
    },
}

/// One action, with its time on the bench's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedStimulus {
    /// Time of the scan after which it was done, µs.
    pub at_us: u64,
    /// Act of the bench; `act` in stored recordings.
    #[serde(rename = "act")]
    pub action: BenchAction,
}

/// All actions of one procedure, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StimulusRecord {
    /// The actions; `deeds` in stored recordings.
    #[serde(rename = "deeds")]
    pub entries: Vec<RecordedStimulus>,
    /// Actions that found no room.
    pub lost: u32,
}

impl StimulusRecord {
    fn note(&mut self, now: Instant, action: BenchAction) {
        if self.entries.len() == MAX_RECORDED {
            self.lost += 1;
            return;
        }
        let at_us = now.as_us();
        self.entries.push(RecordedStimulus { at_us, action });
    }

    fn note_safe(&mut self, now: Instant) {
        if let Some(RecordedStimulus { at_us, action }) = self.entries.last_mut()
            && let BenchAction::MakeSafe { scans } = action
            && now.as_us() == *at_us + u64::from(*scans) * SCAN.as_us()
        {
            *scans += 1;
            return;
        }
        self.note(now, BenchAction::MakeSafe { scans: 1 });
    }

    /// Time of the last entry, µs; making safe counts to its last scan.
    pub fn end_us(&self) -> u64 {
        let end = |entry: &RecordedStimulus| match entry.action {
            BenchAction::Apply(_) => entry.at_us,
            BenchAction::MakeSafe { scans } => {
                entry.at_us + u64::from(scans.saturating_sub(1)) * SCAN.as_us()
            }
        };
        self.entries.last().map_or(0, end)
    }
}

/// A driver of the rig that records every action.
pub struct RecordingDriver<'a> {
    rig: &'a mut Rig,
    record: &'a mut StimulusRecord,
}

impl<'a> RecordingDriver<'a> {
    /// Drives `rig` and appends every action to `record`.
    pub fn new(rig: &'a mut Rig, record: &'a mut StimulusRecord) -> Self {
        Self { rig, record }
    }
}

impl Driver for RecordingDriver<'_> {
    fn apply(&mut self, now: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        self.record.note(now, BenchAction::Apply(*stimulus));
        self.rig.apply(now, stimulus)
    }

    fn settled(&mut self) -> Result<bool, Refusal> {
        self.rig.settled()
    }

    fn make_safe(&mut self, now: Instant) {
        self.record.note_safe(now);
        self.rig.make_safe(now);
    }

    fn safe(&self) -> bool {
        self.rig.safe()
    }

    fn has_harness(&self) -> bool {
        self.rig.has_harness()
    }

    fn evidence(&self) -> Evidence {
        self.rig.evidence()
    }

    fn self_test_item(&self, item: SelfTest) -> Option<SelfTestItem> {
        self.rig.self_test_item(item)
    }

    fn said(&self, signal: Signal) -> Option<&str> {
        self.rig.said(signal)
    }
}

/// Repeats a recorded sequence of actions.
#[derive(Clone, Debug)]
pub struct StimulusPlayer<'a> {
    record: &'a StimulusRecord,
    next: usize,
    /// Scans already done of the `MakeSafe` in progress.
    safe_scans: u32,
    /// How much later than recorded, µs; negative = earlier.
    shift_us: i64,
}

impl<'a> StimulusPlayer<'a> {
    /// Starts at the first entry; every entry is due `shift_us` later than recorded.
    pub fn new(record: &'a StimulusRecord, shift_us: i64) -> Self {
        Self {
            record,
            next: 0,
            safe_scans: 0,
            shift_us,
        }
    }

    /// Performs what is due at `now`; call it after every scan. A stimulus that this bench refuses is
    /// skipped, because the next one may not depend on it; the refusals are returned.
    pub fn play(&mut self, now: Instant, rig: &mut Rig) -> Vec<Refusal> {
        let mut refused = Vec::new();
        while let Some(entry) = self.due(now) {
            match entry.action {
                BenchAction::Apply(stimulus) => refused.extend(rig.apply(now, &stimulus).err()),
                BenchAction::MakeSafe { scans } => {
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

    /// Whether every entry has been performed.
    pub fn done(&self) -> bool {
        self.next == self.record.entries.len()
    }

    fn due(&self, now: Instant) -> Option<RecordedStimulus> {
        let entry = *self.record.entries.get(self.next)?;
        let at_us = entry.at_us.saturating_add_signed(self.shift_us);
        (Instant::from_us(at_us) + self.safe_time() <= now).then_some(entry)
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

    /// Goal: a record read back moves a rig exactly as when it was recorded. Method: compare bytes and
    /// samples of a rig driven through the recorder with those of one that replays the stored text.
    #[test]
    fn a_stored_record_moves_a_rig_exactly_as_when_it_was_recorded() {
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
        let run = |drive: &mut dyn FnMut(Instant, &mut Rig)| {
            let mut rig = rig();
            let mut bytes = Vec::new();
            let mut seen = Vec::new();
            for scan in 1..4_000 {
                let now = Instant::from_us(scan * SCAN.as_us());
                rig.step(now, &mut bytes);
                drive(now, &mut rig);
                seen.push(format!("{:?}", rig.sample().values()));
            }
            (bytes, seen)
        };
        let mut record = StimulusRecord::default();
        let mut to_come = stimuli.iter();
        let first = run(&mut |now, rig| {
            let mut driver = RecordingDriver::new(rig, &mut record);
            if now.as_us().is_multiple_of(500_000)
                && let Some(stimulus) = to_come.next()
            {
                driver.apply(now, stimulus).expect("taken");
            }
            if now >= Instant::from_ms(20_000) && !driver.safe() {
                driver.make_safe(now);
            }
        });
        let text = serde_json::to_string(&record).expect("JSON");
        let read: StimulusRecord = serde_json::from_str(&text).expect("a stimulus record");
        assert_eq!(read, record);
        assert!(
            record.entries.len() < 10,
            "making safe is one entry: {text}"
        );
        let mut player = StimulusPlayer::new(&read, 0);
        let again = run(&mut |now, rig| assert!(player.play(now, rig).is_empty()));
        assert!(player.done());
        assert_eq!(first, again);
    }
}
