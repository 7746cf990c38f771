//! Whether the receiver of a unit of some configuration hears each of its own codes.

use ato_under_test::receivers::{CodeReceiver, Heard, Reception};
use btu_rig::waveform::CodeWave;
use protocol::config::{SpeedCode, UnitConfig};

use super::SAMPLE_HZ;
use crate::words::Unheard;

/// What the receiver's filter takes beyond the time of detection, s.
const OF_FILTER_S: f64 = 0.1;
/// Askings in a period of the code: the code is to be heard wherever in its period the window begins.
const ASKINGS: usize = 6;

/// The first code that the receiver does not hear, on which carrier, Hz, and why. Method: each code is made at its
/// nominal level and received for its time of detection, and a period more.
pub fn unheard(unit: &UnitConfig) -> Option<(&SpeedCode, f64, Unheard)> {
    let sample_hz = f64::from(SAMPLE_HZ);
    let seconds = f64::from(unit.receiver.detect_ms) / 1_000.0 + OF_FILTER_S;
    for carrier_hz in unit.carriers_hz() {
        let reception = Reception::of(unit, carrier_hz);
        let codes = unit.codes.iter();
        let codes: Vec<_> = codes
            .filter(|code| unit.is_on_carrier(code, carrier_hz))
            .collect();
        let rates: Vec<_> = codes.iter().map(|code| code.rate_hz as f32).collect();
        let receiver = CodeReceiver::new(reception, sample_hz as f32);
        for code in codes {
            let level_mv = unit.receiver.level_nominal_mv;
            let mut wave = CodeWave::new(carrier_hz, code.rate_hz, level_mv, sample_hz)
                .shifted(unit.receiver.shift_hz, sample_hz);
            let mut receiver = receiver.clone();
            let mut hear = |samples: f64| {
                let samples = wave.by_ref().take(samples as usize);
                samples.for_each(|sample| receiver.take(sample as f32));
                receiver.heard(&rates)
            };
            let is_right = |heard: &Option<Heard>| {
                heard.is_some_and(|heard| {
                    let off_hz = (f64::from(heard.rate_hz) - code.rate_hz).abs();
                    off_hz <= unit.receiver.rate_tolerance_hz
                        && (f64::from(heard.carrier_hz) - carrier_hz).abs()
                            <= unit.receiver.carrier_tolerance_hz
                })
            };
            let least_ms = (reception.least_detect_s() * 1_000.0).ceil() as u32;
            let part = sample_hz / code.rate_hz / ASKINGS as f64;
            let mut askings = (0..ASKINGS).map(|asking| match asking {
                0 => hear(seconds * sample_hz),
                _ => hear(part),
            });
            let Some(heard) = askings.find(|heard| !is_right(heard)) else {
                continue;
            };
            let why = match heard {
                _ if unit.receiver.detect_ms < least_ms => {
                    Unheard::Short(unit.receiver.detect_ms, least_ms)
                }
                Some(heard) => Unheard::As(format!("{:.2}", heard.rate_hz)),
                None => Unheard::Nothing,
            };
            return Some((code, carrier_hz, why));
        }
    }
    None
}
