//! Signals as they pass from terminals to processors.

use protocol::message::{ModeSwitch, TrainLines};
use protocol::{Duration, Instant};

/// Signal in the ATP antenna.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AntennaSignal {
    /// Carrier, Hz; 0 = none.
    pub carrier_hz: f64,
    /// Code rate, Hz; 0 = unmodulated.
    pub rate_hz: f64,
    /// Level, mV.
    pub level_mv: f64,
    /// Time for which the signal had been there when a receiver of waveforms heard it.
    pub heard_for: Duration,
    /// Time for which the signal may be over already: a receiver of waveforms hears it for longer than it is there.
    pub lags: Duration,
}

/// Pulses of one tachometer input in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pulses {
    pub count: u32,
    /// Time of the last pulse, on the sender's clock.
    pub edge_at: Instant,
    /// Time up to which pulses were counted, on the same clock.
    pub sampled_at: Instant,
    pub backward: bool,
}

impl Pulses {
    /// Way that the pulses stand for, m, backward negative.
    pub fn way_m(&self, metres_per_pulse: f64) -> f64 {
        let way_m = f64::from(self.count) * metres_per_pulse;
        if self.backward { -way_m } else { way_m }
    }
}

/// A marker pulse as TRA hands it on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MarkerPulse {
    /// 1 to 4 = PSM1 to PSM4.
    pub marker: u8,
    /// Age when the inputs were sampled, s × 10⁻⁶.
    pub age_us: u32,
}

/// The inputs as the processors see them in one scan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inputs {
    pub alive: bool,
    /// Signal at the receiver's output filter; none while the self-test feeds the receiver.
    pub signal: AntennaSignal,
    /// Signal at the receiver's output filter of the code that the self-test feeds in.
    pub self_test_signal: Option<AntennaSignal>,
    pub pulses: [Pulses; 2],
    /// Tachometer inputs fed by the TEST board.
    pub test_speed: [bool; 2],
    pub marker: Option<MarkerPulse>,
    /// TRA answers its test pulse.
    pub tra_answers: bool,
    pub lines: TrainLines,
    pub mode_switch: ModeSwitch,
    /// Master controller notch.
    pub controller: i8,
}
