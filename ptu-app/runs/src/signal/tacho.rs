//! The lines of speed sensors in a recording, two channels each: pulses, direction, speed, and how the wheel wears.

use std::collections::BTreeSet;
use std::path::Path;

use ato_under_test::receivers::SensorInput;
use protocol::config::UnitConfig;

use super::meter::Meter;
use super::reading::{ASKED_EVERY_S, Level, MOST_CHANNELS, Reading, Source, Tacho, Why};
use super::wav::{End, Wav};
use crate::failure::Failure;

/// Ratio to the period before of a period that lacks a tooth, at a speed that changes gently.
const GAP: std::ops::RangeInclusive<f64> = 1.6..=2.4;
/// Ratio of a period to the one before it while a wheel turns, and the greatest share of other ratios, as at a turn back. With
/// more of them the lines are noise.
const EVEN: std::ops::RangeInclusive<f64> = 0.6..=1.6;
const MOST_UNEVEN: f64 = 0.2;

/// One sensor, sample by sample.
#[derive(Default)]
struct Sensor {
    input: SensorInput,
    was_high: [bool; 2],
    samples: u64,
    /// First pulse and last pulse, samples from the beginning, and the period that the last pulse ended, samples.
    first: Option<f64>,
    last: Option<f64>,
    period: Option<f64>,
    shortest: f64,
    longest: f64,
    /// Since the last pulse: samples for which each line was high, and when B rose.
    high: [u64; 2],
    b_rose: Option<f64>,
    /// Periods that lack a tooth, and which teeth of the wheel these are.
    gaps: u64,
    missing: BTreeSet<i64>,
    /// Missing teeth passed: how far the last tooth is ahead of the pulses forward less the pulses backward.
    ahead: i64,
    /// Direction at the last pulse, and at the last fall of line A.
    backward: Option<bool>,
    fell_backward: bool,
    /// Periods that are much longer or shorter than the one before, and all.
    uneven: (u64, u64),
    /// Sums over whole periods: length, samples for which each line was high, and phase, as a sum of shares and their count.
    length: f64,
    sum_high: [u64; 2],
    phases: (f64, u32),
    told: Tacho,
}

impl Sensor {
    fn take(&mut self, [a, b]: [f32; 2], teeth: u32) {
        let before = self.input.count;
        self.input.take(a, b);
        self.samples += 1;
        let high = self.input.high();
        // A line that is high from the beginning on has not risen.
        if self.input.count != before && self.samples > 1 {
            self.pulse(self.samples as f64 - f64::from(self.input.since), teeth);
        }
        if self.was_high[0] && !high[0] {
            self.fell_backward = !high[1];
        }
        if high[1] && !self.was_high[1] {
            self.b_rose = Some(self.samples as f64 - f64::from(self.input.since_b()));
        }
        for (sum, high) in self.high.iter_mut().zip(high) {
            *sum += u64::from(high);
        }
        self.was_high = high;
    }

    fn pulse(&mut self, at: f64, teeth: u32) {
        let backward = self.input.backward;
        let way = if backward { -1 } else { 1 };
        match backward {
            true => self.told.backward += 1,
            false => self.told.forward += 1,
        }
        let turned = self.backward.replace(backward) == Some(!backward);
        // The wheel turned back behind a tooth, which passes once more.
        if turned && self.fell_backward != backward {
            self.ahead -= way;
        }
        let high = std::mem::take(&mut self.high);
        let b_rose = self.b_rose.take();
        self.first.get_or_insert(at);
        let Some(last) = self.last.replace(at) else {
            return;
        };
        let period = at - last;
        let is_gap = (self.period).is_some_and(|before| GAP.contains(&(period / before)));
        if is_gap && !turned {
            self.gaps += 1;
            let pulses = self.told.forward as i64 - self.told.backward as i64;
            let tooth = pulses + self.ahead;
            self.missing
                .insert(tooth.rem_euclid(i64::from(teeth.max(1))));
            self.ahead += way;
            self.period = None;
            return;
        }
        if let Some(before) = self.period.replace(period) {
            let is_uneven = !EVEN.contains(&(period / before));
            self.uneven.0 += u64::from(is_uneven);
            self.uneven.1 += 1;
        }
        if turned {
            self.period = None;
        }
        self.longest = self.longest.max(period);
        self.shortest = match self.shortest {
            0.0 => period,
            shortest => shortest.min(period),
        };
        self.length += period;
        for (sum, high) in self.sum_high.iter_mut().zip(high) {
            *sum += high;
        }
        if let Some(rose) = b_rose {
            let share = (rose - last) / period;
            self.phases = (self.phases.0 + share, self.phases.1 + 1);
        }
    }

    /// The periods of the pulses vary as no wheel's do.
    fn is_noise(&self) -> bool {
        let (uneven, all) = self.uneven;
        uneven as f64 > MOST_UNEVEN * all as f64
    }

    /// What the sensor told, if there were two pulses.
    fn told(mut self, sample_hz: f64, unit: &UnitConfig) -> Option<(Tacho, [f64; 2])> {
        let (first, last) = (self.first?, self.last.filter(|_| self.length > 0.0)?);
        let kmh = |samples: f64| 3.6 * unit.metres_per_pulse() * sample_hz / samples;
        let periods = self.told.forward + self.told.backward + self.gaps - 1;
        self.told.mean_kmh = kmh((last - first) / periods as f64);
        self.told.missing_teeth = self.missing.len() as u64;
        self.told.kmh = [kmh(self.longest), kmh(self.shortest)];
        self.told.phase_deg = 360.0 * self.phases.0 / f64::from(self.phases.1.max(1));
        self.told.duty_percent = self.sum_high.map(|high| 100.0 * high as f64 / self.length);
        Some((self.told, [first, last].map(|at| at / sample_hz)))
    }
}

/// Reads the speed sensors in a WAV file, of which two channels each are lines A and B.
///
/// # Errors
/// The file cannot be read or is no WAV file.
pub fn read_tacho(path: &Path, unit: &UnitConfig, full_scale_mv: f64) -> Result<Reading, Failure> {
    let mut wav = Wav::open(path)?;
    let sample_hz = f64::from(wav.sample_hz());
    let channels = wav.channels().min(MOST_CHANNELS);
    let part = ((ASKED_EVERY_S * sample_hz) as usize).max(1);
    let mut meters: Vec<_> = (0..channels).map(|_| Meter::new(sample_hz)).collect();
    let mut sensors: Vec<_> = (0..channels / 2).map(|_| Sensor::default()).collect();
    let (mut reading, mut samples) = (Reading::default(), 0);
    loop {
        let (block, end) = wav.block(10 * part, channels, full_scale_mv);
        for (meter, of) in meters.iter_mut().zip(&block) {
            meter.take(of, part);
        }
        for (sensor, lines) in sensors.iter_mut().zip(block.chunks_exact(2)) {
            let both = lines[0].iter().zip(&lines[1]);
            both.for_each(|(a, b)| sensor.take([*a, *b], unit.tacho.pulses_per_turn));
        }
        samples += block.first().map_or(0, Vec::len);
        reading.duration_s = samples as f64 / sample_hz;
        if let Some(End::Broken(why)) = &end {
            reading.tell(reading.duration_s, Why::Broken(why.clone()));
        }
        if end.is_some() {
            break;
        }
    }
    let numbered = meters.iter().zip(1..);
    reading.levels = numbered
        .map(|(meter, number)| Level::of(meter, number))
        .collect();
    reading.tell_clipped(&wav);
    if channels < 2 {
        reading.tell(0.0, Why::OneLine);
    }
    for (place, sensor) in sensors.into_iter().enumerate() {
        if sensor.is_noise() {
            reading.tell(0.0, Why::NoSensor(2 * place + 1));
        }
        if let Some((tacho, [from_s, to_s])) = sensor.told(sample_hz, unit) {
            reading.sources.push(Source {
                kind: "tacho",
                channel: 2 * place + 1,
                from_s,
                to_s,
                rate_hz: tacho.mean_kmh / 3.6 / unit.metres_per_pulse(),
                level_mv: Some(meters[2 * place].levels_mv().0),
                tacho: Some(tacho),
                ..Source::default()
            });
        }
    }
    Ok(reading)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a missing tooth counts once, on the way forward and on the way back. Method: a wheel that turns back upon
    /// a tooth, and one that turns back between two.
    #[test]
    fn a_missing_tooth_is_the_same_one_on_the_way_back() {
        const TEETH: u32 = 20;
        for turns_at in [6_225, 6_275] {
            let mut sensor = Sensor::default();
            let there = 60..turns_at;
            for place in there.clone().chain(there.rev()) {
                // Hundredths of a tooth; line B is a quarter behind.
                let line = |place: u32| match place % 100 < 50 && place / 100 % TEETH != 7 {
                    true => 1_000.0,
                    false => -1_000.0,
                };
                sensor.take([line(place), line(place - 25)], TEETH);
            }
            let told = (sensor.told.forward, sensor.told.backward, sensor.gaps);
            assert!(told.0 > 50 && told.1 > 50 && told.2 == 6, "{told:?}");
            assert_eq!(sensor.missing.len(), 1, "{turns_at}: {:?}", sensor.missing);
        }
    }
}
