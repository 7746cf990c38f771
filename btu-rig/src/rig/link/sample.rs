//! The latest value of every signal: what the rig makes, and what the unit last sent.

use protocol::message::{
    AtcToTcms, IoOutput, Outputs, Status, TrainLines, TrainState, TwcReport, TwcTrain,
};
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant};

use super::signal_sources::{CARRIED, Carries, LINE_SIGNALS, Source, kmh};

/// Age at which values from the unit are forgotten.
const FORGOTTEN: Duration = Duration::from_ms(500);

/// The latest value of every signal, and when each source of the unit was last heard.
#[derive(Debug, Default)]
pub struct LatestSample {
    pub sample: Sample,
    heard: [Option<Instant>; CARRIED.len()],
    outputs: Outputs,
}

impl LatestSample {
    /// Contacts of the unit, unless it has not been heard lately.
    pub fn outputs(&self) -> Option<Outputs> {
        self.heard[Source::IoOutput as usize].map(|_| self.outputs)
    }

    /// Forgets values that the unit has not repeated for too long; `harness`: the rig sets the train lines and plays
    /// TCMS.
    pub fn step(&mut self, now: Instant, harness: bool) {
        let both_ways = [Source::AtcToTcms as usize, Source::Status as usize];
        for (source, signals) in CARRIED {
            let heard = &mut self.heard[source as usize];
            if heard.is_some_and(|at| now.since(at) >= FORGOTTEN) {
                *heard = None;
                signals
                    .iter()
                    .for_each(|&signal| self.sample.forget(signal));
                if both_ways.iter().all(|&source| self.heard[source].is_none()) {
                    self.sample.forget(Signal::Mode);
                    self.sample.forget(Signal::Target);
                }
            }
        }
        if harness {
            let tcms_hears = self.heard[Source::AtcToTcms as usize].is_some();
            self.sample.set_bit(Signal::TcmsHears, tcms_hears);
        } else if self.heard[Source::TrainState as usize].is_none() {
            let told = LINE_SIGNALS.iter();
            told.for_each(|&signal| self.sample.forget(signal));
        }
    }

    fn take<Frame: Carries>(&mut self, now: Instant, frame: &Frame) {
        self.heard[Frame::SOURCE as usize] = Some(now);
        frame.record(&mut self.sample);
    }

    /// Takes the unit's contacts and cab display.
    pub fn on_io(&mut self, now: Instant, io: &IoOutput) {
        self.take(now, io);
        self.outputs = io.outputs;
    }

    /// Takes the unit's commands to TCMS.
    pub fn on_tcms(&mut self, now: Instant, tcms: &AtcToTcms) {
        self.take(now, tcms);
        // `Status` counts more: while test signals act, it is about the functions under test.
        if self.heard[Source::Status as usize].is_none() {
            self.sample.set(Signal::Mode, tcms.mode.code().into());
            self.sample.set(Signal::Target, kmh(tcms.target_cms));
        }
    }

    /// Takes the unit's status.
    pub fn on_status(&mut self, now: Instant, status: &Status) {
        self.take(now, status);
        self.sample.set(Signal::Mode, status.mode.code().into());
        self.sample.set(Signal::Target, kmh(status.target_cms));
    }

    /// Takes the unit's outputs to the train and its inputs from the train; with a `harness`, the unit's contacts, its
    /// frames to TCMS and the train lines are known at first hand.
    pub fn on_train_state(&mut self, now: Instant, state: &TrainState, harness: bool) {
        self.take(now, state);
        if !harness {
            self.on_train_alone(now, state);
        }
    }

    /// Takes the values that a harness would carry from `TrainState`.
    fn on_train_alone(&mut self, now: Instant, state: &TrainState) {
        let io = IoOutput {
            outputs: state.outputs,
            limit_cms: state.limit_cms,
            speed_cms: state.speed_cms,
            marker: state.marker,
            marker_count: state.marker_count,
        };
        self.on_io(now, &io);
        self.heard[Source::AtcToTcms as usize] = Some(now);
        self.note_lines(state.lines);
        for (signal, value) in [
            (Signal::Effort, f64::from(state.effort)),
            (Signal::Power, f64::from(state.effort > 0)),
            (Signal::Brake, f64::from(state.effort < 0)),
            (Signal::ModeSwitch, f64::from(state.mode_switch.code())),
            (Signal::Controller, f64::from(state.controller)),
            // `TrainState` is dated to the scan, `Status` is not.
            (Signal::CodeIndex, f64::from(state.code_index)),
            (Signal::EbCause, f64::from(state.eb_cause.code())),
            (Signal::FsbCause, f64::from(state.fsb_cause.code())),
            (Signal::Mode, f64::from(state.asked_mode.code())),
        ] {
            self.sample.set(signal, value);
        }
    }

    /// Takes the train's answer to the wayside, one of `answers` so far.
    pub fn on_twc(&mut self, now: Instant, answer: &TwcTrain, answers: u16) {
        self.take(now, answer);
        self.sample.set(Signal::TwcAnswers, answers.into());
    }

    /// Takes the train's report to the wayside's orders.
    pub fn on_report(&mut self, now: Instant, report: &TwcReport) {
        self.take(now, report);
    }

    /// Takes the train lines as sent.
    pub fn note_lines(&mut self, lines: TrainLines) {
        for (signal, line) in [
            (Signal::Doors, TrainLines::DOORS_CLOSED),
            (Signal::Hcr, TrainLines::HCR),
            (Signal::MaintenanceKey, TrainLines::MAINTENANCE_KEY),
        ] {
            self.sample.set_bit(signal, lines.contains(line));
        }
        let by_side = lines.contains(TrainLines::DOORS_BY_SIDE);
        for (signal, closed, locked) in [
            (
                Signal::DoorsLeft,
                TrainLines::LEFT_CLOSED,
                TrainLines::LEFT_LOCKED,
            ),
            (
                Signal::DoorsRight,
                TrainLines::RIGHT_CLOSED,
                TrainLines::RIGHT_LOCKED,
            ),
        ] {
            let state = match (lines.contains(closed), lines.contains(locked)) {
                _ if !by_side => f64::NAN,
                (false, _) => 0.0,
                (true, false) => 1.0,
                (true, true) => 2.0,
            };
            self.sample.set(signal, state);
        }
        self.sample
            .set_bit(Signal::EbLoop, !lines.contains(TrainLines::EB_LOOP));
    }
}

#[cfg(test)]
mod tests {
    use protocol::signal::Origin;

    use super::*;

    /// Every signal of the unit is heard in some frame and forgotten 500 ms after the last; the
    /// count of TWC answers is the wayside's own knowledge and stays.
    #[test]
    fn a_value_that_is_not_received_again_is_forgotten() {
        let mut latest = LatestSample::default();
        latest.on_io(Instant::ZERO, &IoOutput::default());
        latest.on_tcms(Instant::ZERO, &AtcToTcms::default());
        latest.on_status(Instant::ZERO, &Status::default());
        latest.on_twc(Instant::ZERO, &TwcTrain::default(), 1);
        latest.on_report(Instant::ZERO, &TwcReport::default());
        latest.on_train_state(Instant::ZERO, &TrainState::default(), true);
        let known = |latest: &LatestSample| {
            let all = Signal::ALL.iter().copied();
            all.filter(|&s| s.definition().origin == Origin::Unit && s != Signal::TwcAnswers)
                .filter(|&s| latest.sample.get(s).is_some())
                .count()
        };
        let unit_signals = Signal::ALL
            .iter()
            .filter(|s| s.definition().origin == Origin::Unit);
        let expected = unit_signals.count() - 1;
        latest.step(Instant::from_ms(490), true);
        assert_eq!(known(&latest), expected);
        latest.on_tcms(Instant::from_ms(490), &AtcToTcms::default());
        latest.step(Instant::from_ms(500), true);
        assert_eq!(
            known(&latest),
            5,
            "effort, power, brake, and mode and target with them"
        );
        latest.step(Instant::from_ms(990), true);
        assert_eq!(known(&latest), 0);
    }
}
