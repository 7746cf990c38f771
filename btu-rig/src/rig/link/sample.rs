//! The latest value of every signal: what the rig makes, and what the unit last sent.

use protocol::message::{
    AtcToTcms, AtcToTcmsBits, IoOutput, Outputs, Status, StatusBits, TcmsToAtcBits, TrainLines,
    TrainState, TwcReport, TwcTrain,
};
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant, Speed};

use super::signal_sources::{CARRIED, LINE_SIGNALS, Source};

/// Age at which what the unit said is forgotten.
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
        self.heard[Source::Io as usize].map(|_| self.outputs)
    }

    /// Forgets what the unit has not said again for too long; `harness`: the rig sets the train lines and plays TCMS.
    pub fn step(&mut self, now: Instant, harness: bool) {
        let both_ways = [Source::Tcms as usize, Source::Status as usize];
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
            let tcms_hears = self.heard[Source::Tcms as usize].is_some();
            self.sample.set_bit(Signal::TcmsHears, tcms_hears);
        } else if self.heard[Source::TrainState as usize].is_none() {
            let told = LINE_SIGNALS.iter();
            told.for_each(|&signal| self.sample.forget(signal));
        }
    }

    /// Takes the unit's contacts and cab display.
    pub fn on_io(&mut self, now: Instant, io: &IoOutput) {
        self.heard[Source::Io as usize] = Some(now);
        self.outputs = io.outputs;
        let sample = &mut self.sample;
        sample.set_bit(Signal::Eb, !io.outputs.contains(Outputs::EB_RELAY));
        for (signal, output) in [
            (Signal::Fsb, Outputs::FSB),
            (Signal::PowerCut, Outputs::POWER_CUT),
            (Signal::Alarm, Outputs::ALARM),
            (Signal::HoldingBrake, Outputs::HOLDING_BRAKE),
            (Signal::DoorEnableLeft, Outputs::DOOR_ENABLE_LEFT),
            (Signal::DoorEnableRight, Outputs::DOOR_ENABLE_RIGHT),
            (Signal::DoorOrderLeft, Outputs::OPEN_LEFT),
            (Signal::DoorOrderRight, Outputs::OPEN_RIGHT),
            (Signal::DoorOrderClose, Outputs::CLOSE_DOORS),
            (Signal::CodeValid, Outputs::CODE_VALID),
            (Signal::Standstill, Outputs::STANDSTILL),
            (Signal::Healthy, Outputs::HEALTHY),
        ] {
            sample.set_bit(signal, io.outputs.contains(output));
        }
        sample.set(Signal::Limit, kmh(io.limit_cms));
        sample.set(Signal::Speed, kmh(io.speed_cms));
        sample.set(Signal::Marker, f64::from(io.marker));
        sample.set(Signal::MarkerCount, f64::from(io.marker_count));
    }

    /// Takes the unit's commands to TCMS.
    pub fn on_tcms(&mut self, now: Instant, tcms: &AtcToTcms) {
        self.heard[Source::Tcms as usize] = Some(now);
        let by_status = self.heard[Source::Status as usize].is_some();
        let sample = &mut self.sample;
        if !by_status {
            // While test signals act, `Status` is about the functions under test.
            sample.set(Signal::Mode, f64::from(tcms.mode.code()));
            sample.set(Signal::Target, kmh(tcms.target_cms));
        }
        sample.set(Signal::Effort, f64::from(tcms.effort));
        sample.set_bit(Signal::Power, tcms.bits.contains(AtcToTcmsBits::POWER));
        sample.set_bit(Signal::Brake, tcms.bits.contains(AtcToTcmsBits::BRAKE));
    }

    /// Takes the unit's status.
    pub fn on_status(&mut self, now: Instant, status: &Status) {
        self.heard[Source::Status as usize] = Some(now);
        let sample = &mut self.sample;
        for (signal, bit) in [
            (Signal::Armed, StatusBits::ARMED),
            (Signal::TwcOk, StatusBits::TWC_OK),
            (Signal::TcmsOk, StatusBits::TCMS_OK),
            (Signal::StationValid, StatusBits::STATION_VALID),
            (Signal::Aligned, StatusBits::ALIGNED),
            (Signal::TraOk, StatusBits::TRA_OK),
            (Signal::AtoReady, StatusBits::ATO_READY),
            (Signal::Started, StatusBits::STARTED),
        ] {
            sample.set_bit(signal, status.bits.contains(bit));
        }
        for (signal, value) in [
            (Signal::Mode, f64::from(status.mode.code())),
            (Signal::Target, kmh(status.target_cms)),
            (Signal::Refusals, f64::from(status.refusals.bits())),
            (Signal::CodeIndex, f64::from(status.code_index)),
            (Signal::EbCause, f64::from(status.eb_cause.code())),
            (Signal::FsbCause, f64::from(status.fsb_cause.code())),
            (Signal::Speed1, kmh(status.speed1_cms)),
            (Signal::Speed2, kmh(status.speed2_cms)),
            (Signal::Position, f64::from(status.position_cm) / 100.0),
            (Signal::AtoState, f64::from(status.ato_state.code())),
            (
                Signal::WheelCorrection,
                f64::from(status.wheel_correction_10ppm) / 1000.0,
            ),
            (Signal::Events, f64::from(status.events)),
            (Signal::RejectedFrames, f64::from(status.rejected_frames)),
            (Signal::TwcReceived, f64::from(status.twc_received)),
            (Signal::SelfTest, f64::from(status.self_test.bits())),
            (Signal::TestCarrier, f64::from(status.test_carrier_hz)),
            (
                Signal::TestCodeRate,
                f64::from(status.test_code_rate_chz) / 100.0,
            ),
            (Signal::TestLevel, f64::from(status.test_level_mv)),
            (Signal::TestSpeed, kmh(status.test_speed_cms)),
        ] {
            sample.set(signal, value);
        }
    }

    /// Takes what the unit does to the train and has from it; `harness`: its contacts, its frames to TCMS and the train
    /// lines are known at first hand.
    pub fn on_train_state(&mut self, now: Instant, state: &TrainState, harness: bool) {
        self.heard[Source::TrainState as usize] = Some(now);
        let asked = |output| state.asked.contains(output);
        let tcms = |bit| state.tcms_bits.contains(bit);
        for (signal, on) in [
            (Signal::AskedEb, !asked(Outputs::EB_RELAY)),
            (Signal::AskedFsb, asked(Outputs::FSB)),
            (Signal::AskedPowerCut, asked(Outputs::POWER_CUT)),
            (Signal::AskedAlarm, asked(Outputs::ALARM)),
            (Signal::AskedDoorLeft, asked(Outputs::DOOR_ENABLE_LEFT)),
            (Signal::AskedDoorRight, asked(Outputs::DOOR_ENABLE_RIGHT)),
            (Signal::AskedDoorClose, asked(Outputs::CLOSE_DOORS)),
            (Signal::AskedPower, state.asked_effort > 0),
            (
                Signal::TcmsBraking,
                tcms(TcmsToAtcBits::SERVICE_BRAKE_APPLIED),
            ),
            (
                Signal::TcmsLineOpen,
                tcms(TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED),
            ),
            (Signal::TcmsTellsLines, tcms(TcmsToAtcBits::TELLS_LINES)),
            (Signal::TcmsDoors, tcms(TcmsToAtcBits::DOORS_CLOSED)),
            (Signal::TcmsHcr, tcms(TcmsToAtcBits::CAB_MANNED)),
        ] {
            self.sample.set_bit(signal, on);
        }
        for (signal, value) in [
            (Signal::AskedEffort, f64::from(state.asked_effort)),
            (Signal::AskedMode, f64::from(state.asked_mode.code())),
            (Signal::TrainMode, f64::from(state.mode.code())),
            (Signal::TrainSpeed1, kmh(state.train_speed1_cms)),
            (Signal::TrainSpeed2, kmh(state.train_speed2_cms)),
            (Signal::MarkerAt, f64::from(state.marker_at_ms) / 1000.0),
            (Signal::TcmsGiven, f64::from(state.tcms_effort)),
            (Signal::TcmsLoad, f64::from(state.load_100kg) / 10.0),
            (Signal::TwcStation, f64::from(state.twc_station)),
            (Signal::TwcSection, f64::from(state.twc_section)),
            (Signal::TwcLoop, f64::from(state.twc_loop)),
            (Signal::TwcTrain, f64::from(state.twc_train_number)),
            (Signal::TwcSent, f64::from(state.twc_answers)),
            (Signal::TestAnswers, f64::from(state.test_answers)),
            (
                Signal::TestAnswerStation,
                f64::from(state.test_answer_station),
            ),
            (Signal::TestAnswerTrain, f64::from(state.test_answer_train)),
            (Signal::TestPulses, f64::from(state.test_pulses)),
            (Signal::TestMarkers, f64::from(state.test_markers)),
        ] {
            self.sample.set(signal, value);
        }
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
        self.heard[Source::Tcms as usize] = Some(now);
        self.note_lines(state.lines);
        for (signal, value) in [
            (Signal::Effort, f64::from(state.effort)),
            (Signal::Power, f64::from(u8::from(state.effort > 0))),
            (Signal::Brake, f64::from(u8::from(state.effort < 0))),
            (Signal::ModeSwitch, f64::from(state.mode_switch.code())),
            (Signal::Controller, f64::from(state.controller)),
            // Dated to the scan, `Status` is not.
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
        self.heard[Source::Twc as usize] = Some(now);
        self.sample.set(Signal::TwcAnswers, f64::from(answers));
        self.sample
            .set(Signal::TwcAnswerStation, f64::from(answer.station));
        self.sample
            .set(Signal::TwcAnswerTrain, f64::from(answer.train_number));
    }

    /// Takes the train's report to the wayside's orders.
    pub fn on_report(&mut self, now: Instant, report: &TwcReport) {
        self.heard[Source::Report as usize] = Some(now);
        for (signal, value) in [
            (Signal::OwnTrain, report.train_number),
            (Signal::NumberState, u16::from(report.number_state.code())),
            (Signal::Destination, report.destination),
            (Signal::OrderState, u16::from(report.order_state.code())),
            (Signal::TwcHeard, report.received),
            (Signal::TwcRefused, report.refused),
            (Signal::TwcOthers, report.others),
        ] {
            self.sample.set(signal, f64::from(value));
        }
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

fn kmh(cms: u16) -> f64 {
    Speed::from_cms(cms).kmh()
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
