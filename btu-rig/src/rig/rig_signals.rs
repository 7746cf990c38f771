//! Signals that the rig makes itself: what it sends, and the true motion of the train.

use protocol::signal::Signal;

use super::Rig;
use crate::stimulus::TachoCondition;

impl Rig {
    /// Sets the signals that the rig makes in the latest sample, as it sends them in this scan. Without a harness it sends
    /// none.
    pub(super) fn record(&mut self) {
        let refusal = f64::from(self.tester.exchange.refusal.code());
        self.latest.sample.set(Signal::ArmRefusal, refusal);
        self.identity.record(&mut self.latest.sample);
        if !self.harness.is_there() {
            return;
        }
        self.latest.note_lines(self.desk.lines(self.now));
        let data = &self.wayside.data;
        let sample = &mut self.latest.sample;
        for (signal, value) in [
            (Signal::CarrierHz, f64::from(self.antenna.carrier_hz())),
            (
                Signal::CodeRateHz,
                f64::from(self.antenna.rate_chz()) / 100.0,
            ),
            (Signal::LevelMv, f64::from(self.antenna.level_mv())),
            (Signal::CrosstalkMv, f64::from(self.antenna.second_mv())),
            (Signal::TrainSpeed, self.wheel.speed().kmh()),
            (Signal::TrainPosition, self.wheel.motion.position_m),
            (Signal::TrainAccel, self.speeds.accel_mps2()),
            (Signal::TrainJerk, self.speeds.jerk_mps3()),
            (Signal::Tacho1, condition_index(self.tachos[0].condition())),
            (Signal::Tacho2, condition_index(self.tachos[1].condition())),
            (Signal::MarkerCoil, f64::from(self.markers.last)),
            (Signal::Wayside, f64::from(self.wayside.condition as u8)),
            (Signal::WaysideStation, f64::from(data.station)),
            (Signal::WaysideLoop, f64::from(data.loop_id)),
            (Signal::WaysideDoorSide, f64::from(data.door_side.code())),
            (Signal::WaysideMode, f64::from(data.running_mode.code())),
            (
                Signal::WaysideOrder,
                f64::from(self.wayside.orders.order().code()),
            ),
            (Signal::Departure, f64::from(data.departure)),
            (Signal::ModeSwitch, f64::from(self.desk.mode_switch.code())),
            (Signal::Controller, f64::from(self.desk.lever.wire())),
            (Signal::TwcAnswers, f64::from(self.wayside.answers())),
        ] {
            sample.set(signal, value);
        }
        if let Some(answered) = self.wayside.orders.answered {
            sample.set_bit(Signal::OrdersAnswered, answered);
        }
        match &self.track {
            Some(track) => {
                let to_stop_m = track.to_stop_m(self.wheel.motion.position_m);
                sample.set(Signal::ToStop, to_stop_m);
            }
            None => sample.forget(Signal::ToStop),
        }
        self.record_tcms();
    }
}

/// Place of a tachometer condition among the catalogue's labels.
fn condition_index(condition: TachoCondition) -> f64 {
    match condition {
        TachoCondition::Good => 0.0,
        TachoCondition::Dead => 1.0,
        TachoCondition::Noisy { .. } => 2.0,
        TachoCondition::Scaled { .. } => 3.0,
        TachoCondition::Reversed => 4.0,
    }
}
