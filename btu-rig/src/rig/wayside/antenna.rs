//! Speed code in the ATP antenna: carrier, code rate and level, steady or drifting.

use protocol::message::Crosstalk;
use protocol::{Duration, Instant, Random, SCAN};

use crate::conditions::Sensors;

use crate::procedure::Refusal;
use crate::random::normal;
use crate::stimulus::CodeSignal;
use crate::stimulus::ranges::{U16_MAX, in_range};

/// Highest code rate, Hz: the catalogue's range, just below what 0.01 Hz in 16 bits can say.
const MAX_RATE_HZ: f64 = 655.0;

/// Time from one frame that tells of a second code to the next.
const CROSSTALK_PERIOD: Duration = Duration::from_ms(50);

/// Signals put into the antenna, and signals that arrive there.
#[derive(Debug)]
pub struct Antenna {
    /// The signal that is put in.
    wanted: CodeSignal,
    /// Its drift, Hz/s and mV/s.
    drift: (f64, f64),
    /// Signal of a neighbouring track circuit.
    second: Second,
    sensors: Sensors,
    random: Random,
    /// Noise of this scan: of the rate, Hz, and of the level as a share of it.
    rate_noise_hz: f64,
    level_noise: f64,
}

/// A second, steady signal.
#[derive(Debug, Default)]
struct Second {
    signal: CodeSignal,
    /// The signal was sent to the unit, and its end was not.
    told: bool,
    due: Instant,
}

impl Antenna {
    /// No signal; `random` is for noise.
    pub fn new(random: Random) -> Self {
        Self {
            wanted: CodeSignal::default(),
            drift: (0.0, 0.0),
            second: Second::default(),
            sensors: Sensors::default(),
            random,
            rate_noise_hz: 0.0,
            level_noise: 0.0,
        }
    }

    /// Sets how arriving signals differ from those that are put in.
    pub fn set_sensors(&mut self, sensors: Sensors) {
        self.sensors = sensors;
    }

    /// Puts a steady signal into the antenna.
    pub fn set(&mut self, signal: CodeSignal) {
        self.wanted = signal;
        self.drift = (0.0, 0.0);
    }

    /// Lets rate and level drift from where they are.
    pub fn drift(&mut self, rate_hz_per_s: f64, level_mv_per_s: f64) {
        self.drift = (rate_hz_per_s, level_mv_per_s);
    }

    /// Puts a second signal beside the first; level 0 takes it away.
    pub fn set_second(&mut self, now: Instant, signal: CodeSignal) {
        self.second.signal = signal;
        self.second.due = now;
    }

    /// Takes all out.
    pub fn off(&mut self) {
        self.set(CodeSignal::default());
        self.second.signal = CodeSignal::default();
    }

    /// The second signal, when it is due to be sent: while it is there, and once at its end.
    pub fn second_due(&mut self, now: Instant) -> Option<Crosstalk> {
        let second = &mut self.second;
        let there = second.signal.level_mv > 0.0;
        if !there && !second.told || there && now < second.due {
            return None;
        }
        second.told = there;
        second.due = now + CROSSTALK_PERIOD;
        Some(Crosstalk {
            carrier_hz: self.arriving_hz(self.second.signal.carrier_hz),
            code_rate_chz: self.arriving_chz(self.second.signal.rate_hz),
            level_mv: self.second_mv(),
        })
    }

    /// The wanted code and the second code, with the carrier and rate that reach the unit.
    pub fn arriving(&self) -> [CodeSignal; 2] {
        [self.wanted, self.second.signal].map(|signal| CodeSignal {
            carrier_hz: self.arriving_hz(signal.carrier_hz).into(),
            rate_hz: f64::from(self.arriving_chz(signal.rate_hz)) / 100.0,
            level_mv: self.arriving_mv(signal.level_mv).into(),
        })
    }

    /// Level of the second signal as sent, mV.
    pub fn second_mv(&self) -> u16 {
        self.arriving_mv(self.second.signal.level_mv)
    }

    /// One scan of drift and noise.
    pub fn step(&mut self) {
        let seconds = SCAN.as_secs();
        let (rate_hz_per_s, level_mv_per_s) = self.drift;
        let wanted = &mut self.wanted;
        wanted.rate_hz = (wanted.rate_hz + rate_hz_per_s * seconds).clamp(0.0, MAX_RATE_HZ);
        wanted.level_mv = (wanted.level_mv + level_mv_per_s * seconds).clamp(0.0, U16_MAX);
        if self.sensors != Sensors::default() {
            self.rate_noise_hz = self.sensors.rate_jitter_hz * normal(&mut self.random);
            self.level_noise = self.sensors.level_noise * normal(&mut self.random);
        }
    }

    /// Carrier as sent, Hz.
    pub fn carrier_hz(&self) -> u16 {
        self.arriving_hz(self.wanted.carrier_hz)
    }

    /// Code rate as sent, 0.01 Hz.
    pub fn rate_chz(&self) -> u16 {
        self.arriving_chz(self.wanted.rate_hz)
    }

    /// Level as sent, mV.
    pub fn level_mv(&self) -> u16 {
        self.arriving_mv(self.wanted.level_mv)
    }

    fn arriving_hz(&self, carrier_hz: f64) -> u16 {
        off_by(carrier_hz, self.sensors.carrier_offset_hz).round() as u16
    }

    fn arriving_chz(&self, rate_hz: f64) -> u16 {
        let off_hz = self.sensors.rate_offset_hz + self.rate_noise_hz;
        (off_by(rate_hz, off_hz) * 100.0).round() as u16
    }

    fn arriving_mv(&self, level_mv: f64) -> u16 {
        let factor = self.sensors.level_factor * (1.0 + self.level_noise);
        (level_mv * factor).round() as u16
    }
}

/// The signal, if the antenna can have it.
pub fn in_antenna(signal: CodeSignal) -> Result<CodeSignal, Refusal> {
    in_range("carrier", signal.carrier_hz, 0.0, U16_MAX, "Hz")?;
    in_range("code rate", signal.rate_hz, 0.0, MAX_RATE_HZ, "Hz")?;
    in_range("level", signal.level_mv, 0.0, U16_MAX, "mV")?;
    Ok(signal)
}

/// A frequency with its offset; a frequency of 0, that is no signal, stays 0.
fn off_by(hz: f64, off_hz: f64) -> f64 {
    if hz > 0.0 { hz + off_hz } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_is_linear_and_stops_at_nothing() {
        let mut antenna = Antenna::new(Random::new(1));
        antenna.set(CodeSignal::new(3000.0, 15.0, 500.0));
        antenna.drift(-0.5, -100.0);
        for _ in 0..200 {
            antenna.step();
        }
        assert_eq!((antenna.rate_chz(), antenna.level_mv()), (1400, 300));
        for _ in 0..10_000 {
            antenna.step();
        }
        assert_eq!((antenna.rate_chz(), antenna.level_mv()), (0, 0));
        assert_eq!(antenna.carrier_hz(), 3000);
        antenna.off();
        assert_eq!(antenna.carrier_hz(), 0);
    }

    /// Level and frequencies are off as the sensors say, noise has its spread, and no signal stays no signal.
    #[test]
    fn the_received_signal_is_off_its_nominal_value_and_noisy() {
        let mut antenna = Antenna::new(Random::new(3));
        antenna.set_sensors(Sensors {
            level_factor: 0.8,
            level_noise: 0.01,
            carrier_offset_hz: -4.0,
            rate_offset_hz: 0.1,
            rate_jitter_hz: 0.05,
            ..Sensors::default()
        });
        antenna.step();
        assert_eq!(
            (antenna.carrier_hz(), antenna.rate_chz(), antenna.level_mv()),
            (0, 0, 0)
        );
        antenna.set(CodeSignal::new(3000.0, 15.0, 500.0));
        let scans: Vec<_> = (0..10_000)
            .map(|_| {
                antenna.step();
                (f64::from(antenna.rate_chz()), f64::from(antenna.level_mv()))
            })
            .collect();
        let spread = |of: fn(&(f64, f64)) -> f64| {
            let mean = scans.iter().map(of).sum::<f64>() / 1e4;
            let var = scans.iter().map(|s| (of(s) - mean).powi(2)).sum::<f64>() / 1e4;
            (mean, var.sqrt())
        };
        let ((rate, rate_noise), (level, level_noise)) = (spread(|s| s.0), spread(|s| s.1));
        assert!((rate - 1510.0).abs() < 0.5 && (rate_noise - 5.0).abs() < 0.2);
        assert!((level - 400.0).abs() < 0.5 && (level_noise - 4.0).abs() < 0.2);
        assert_eq!(antenna.carrier_hz(), 2996);
    }
}
