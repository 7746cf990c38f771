//! Messages in which the unit reports its identity and state to the tester and TCMS.

use alloc::vec::Vec;

use protocol::Instant;
use protocol::injection::{Effect, Place};
use protocol::message::{
    AtcToTcms, AtcToTcmsBits, EbCause, Identity, Message, Outputs, Status, StatusBits, TrainState,
};

use super::Unit;
use super::train_state::StateReport;
use crate::atp::{Code, shown_cause};
use crate::kernel::hundredths;

/// Software version in the identity.
const SOFTWARE: [u8; 3] = [0, 1, 0];
/// Index that means no code.
const NO_CODE: u8 = 255;

pub fn identity(unit: &Unit, now: Instant) -> Message {
    Identity {
        serial: padded(&unit.setup.serial),
        config: padded(&unit.setup.config.name),
        config_crc: unit.setup.config_crc,
        tdb_crc: unit.setup.tdb_crc,
        software: SOFTWARE,
        uptime_ms: now.stamp_ms(),
        self_test: unit.self_tester.failed(),
    }
    .into()
}

/// The unit's state.
pub fn status(unit: &Unit) -> Message {
    let tested = unit.tested();
    let tachometers = tested.atp.tachometers();
    let sequence = tested.atp.sequence();
    let board_code = unit.board.code().unwrap_or_default();
    Status {
        bits: status_bits(unit),
        mode: sequence.mode(),
        refusals: sequence.refusals(),
        code_index: code_index(unit),
        eb_cause: eb_cause(unit),
        fsb_cause: tested.atp.fsb_cause(),
        speed1_cms: tachometers.channel(0).to_cms(),
        speed2_cms: tachometers.channel(1).to_cms(),
        target_cms: tested.ato_outputs.target.to_cms(),
        effort: tested.ato_outputs.effort,
        position_cm: hundredths(tested.locator.position_m()),
        events: unit.log.next_index(),
        rejected_frames: unit.ports.rejected_total() as u16,
        twc_received: tested.twc.received,
        self_test: unit.self_tester.failed(),
        test_signals: unit.board.signals(),
        test_carrier_hz: libm::round(board_code.carrier_hz) as u16,
        test_code_rate_chz: libm::round(board_code.rate_hz * 100.0) as u16,
        test_level_mv: libm::round(board_code.level_mv) as u16,
        test_speed_cms: unit.board.speed().unwrap_or_default().to_cms(),
        ato_state: tested.ato.state,
        wheel_correction_10ppm: libm::round(tested.locator.wheel.correction() * 1e5) as i16,
    }
    .into()
}

fn code_index(unit: &Unit) -> u8 {
    match unit.tested().atp.decoder().code {
        Code::Known(index) => index,
        Code::None | Code::AbsoluteStop => NO_CODE,
    }
}

/// State that the unit reports to a tester at the end of a scan: its outputs to the train and its
/// inputs from it.
pub fn train_state(unit: &Unit, now: Instant) -> TrainState {
    let (train, tested) = (&unit.functions, unit.tested());
    let speeds = [0, 1].map(|channel| train.atp.tachometers().channel(channel).to_cms());
    let tcms = &unit.tcms.last;
    let station = tested.twc.data.as_ref().copied().unwrap_or_default();
    let (effort, mode) = unit.commands(now);
    let modem = &unit.board.modem;
    let test_answer = modem.last_answer();
    TrainState {
        held: 0,
        outputs: unit.contacts,
        asked: unit.asked(),
        mode,
        asked_mode: tested.atp.sequence().mode(),
        effort,
        asked_effort: tested.ato_outputs.effort,
        code_index: code_index(unit),
        eb_cause: eb_cause(unit),
        fsb_cause: tested.atp.fsb_cause(),
        limit_cms: tested.atp.limit().to_cms(),
        speed_cms: tested.atp.tachometers().speed().to_cms(),
        train_speed1_cms: speeds[0],
        train_speed2_cms: speeds[1],
        lines: train.inputs.lines,
        mode_switch: train.inputs.mode_switch,
        controller: train.inputs.controller,
        marker: tested.locator.last_marker,
        marker_count: tested.locator.count,
        marker_at_ms: unit.marker_at.1,
        tcms_bits: tcms.bits,
        tcms_effort: tcms.effort,
        load_100kg: tcms.load_100kg,
        twc_station: station.station,
        twc_section: station.section,
        twc_loop: station.loop_id,
        twc_train_number: station.train_number,
        twc_answers: train.twc.answers,
        test_answers: modem.answers,
        test_answer_station: test_answer.station,
        test_answer_train: test_answer.train_number,
        test_pulses: unit.board.pulses,
        test_markers: unit.board.markers,
    }
}

impl Unit {
    /// Sends the state at the end of a scan if it is due; `cycle`: `Status` is sent in this scan.
    pub(super) fn tell_train_state(&mut self, now: Instant, cycle: bool, out: &mut Vec<u8>) {
        if self.tested().locator.count != self.marker_at.0 {
            self.marker_at = (self.tested().locator.count, now.stamp_ms());
        }
        let Some(changes) = self.maintenance.subscribed(now) else {
            self.state_report = StateReport::default();
            return;
        };
        let mut state = train_state(self, now);
        let received = self.tested().twc.received;
        if let Some(held) = (self.state_report).step((&state, received), changes, cycle) {
            state.held = held;
            self.ports.send(now, &Message::from(state), out);
        }
    }
}

/// Cause for which the relay is open.
fn eb_cause(unit: &Unit) -> EbCause {
    let held = unit.test_mode.is_some() && !unit.commanded.contains(Outputs::EB_RELAY);
    shown_cause(&unit.tested().atp, &unit.functions.atp, held)
}

fn status_bits(unit: &Unit) -> StatusBits {
    let tested = unit.tested();
    let mut bits = StatusBits::empty();
    bits.set(StatusBits::ARMED, unit.maintenance.armed());
    bits.set(StatusBits::TWC_OK, tested.twc.up);
    bits.set(StatusBits::TCMS_OK, unit.tcms.alive);
    bits.set(StatusBits::STATION_VALID, tested.twc.valid);
    bits.set(StatusBits::ALIGNED, tested.aligned());
    bits.set(StatusBits::TRA_OK, unit.tra.ok());
    bits.set(StatusBits::ATO_READY, tested.ato_outputs.ready);
    bits.set(StatusBits::STARTED, unit.self_tester.finished());
    bits.set(StatusBits::INPUTS_OK, unit.image.alive);
    bits
}

pub fn to_tcms(unit: &Unit, now: Instant) -> Message {
    let train = &unit.functions;
    let ato = train.ato_outputs;
    let (effort, mode) = unit.commands(now);
    let mut bits = AtcToTcmsBits::empty();
    bits.set(AtcToTcmsBits::POWER, effort > 0);
    bits.set(AtcToTcmsBits::BRAKE, effort < 0);
    bits.set(AtcToTcmsBits::HOLDING_BRAKE, train.holds());
    bits.set(AtcToTcmsBits::CHANGE_OF_CABS, train.cabs.asks());
    bits.set(AtcToTcmsBits::PUT_AWAY, train.stabling.sleeps());
    bits.set(AtcToTcmsBits::ATO_READY, ato.ready);
    bits.set(
        AtcToTcmsBits::ATO_FAILED,
        unit.self_tester.finished() && !ato.ready,
    );
    let lost = unit.faults.at(Place::Jog) == Some(Effect::StuckOff);
    bits.set(
        AtcToTcmsBits::BACKWARD,
        ato.jogs_backward == Some(true) && !lost,
    );
    AtcToTcms {
        bits,
        mode,
        effort,
        target_cms: ato.target.to_cms(),
        speed_cms: train.atp.tachometers().speed().to_cms(),
    }
    .into()
}

/// Text cut to 16 bytes and filled up with zeros.
fn padded(text: &str) -> [u8; 16] {
    let mut field = [0; 16];
    for (cell, byte) in field.iter_mut().zip(text.bytes()) {
        *cell = byte;
    }
    field
}
