//! The receivers of one unit, from the samples in its coils to what an input frame tells as numbers.

use alloc::vec::Vec;

use protocol::Duration;
use protocol::config::UnitConfig;
use protocol::message::{
    COIL_PART, COIL_PARTS, COIL_SAMPLE_HZ, COIL_SAMPLES, COIL_STEP_MV, Coil, CoilSamples, IoInput,
};

use super::code::{CodeReceiver, Heard, Reception};
use super::fsk::{FskReceiver, Received, Tones};
use super::marker::MarkerReceiver;
use super::sensor::SensorInput;

const SAMPLE_HZ: f32 = COIL_SAMPLE_HZ as f32;
/// Number of coils, lines of speed sensors included.
const COILS: usize = Coil::ALL.len();
/// Coils of antennas; the others are lines of speed sensors.
const IN_ANTENNAS: [Coil; 3] = [Coil::AtpAntenna, Coil::TwcAntenna, Coil::MarkerAntenna];
/// Scans without samples after which a coil's receiver rests.
const RESTS_AFTER: u8 = 100;
/// Part of its window that a code need not fill to be heard, ms: the window's ends count for little.
const HEARD_EARLY_MS: u64 = 150;
/// Part of its window that a slow code, or a code that shifts its carrier, need not fill to be heard, %.
const HEARD_EARLY_PERCENT: u64 = 38;
/// Time for which a code may be over when it is still heard: where noise may hide its end, ms; and where the code does
/// not go on through the window, one tenth of the window more.
const HEARD_LATE_MS: u64 = 40;
const HEARD_LATE_PART: u64 = 10;
/// Longest window for which these times hold as they are, ms.
const LONG_MS: u64 = 620;
/// Scans for which the last code stands in for a code that noise hides.
const STANDS_IN: u8 = 3;
/// Weakest level of TWC and of a marker that is heard, as a share of its configured level.
const WEAKEST: f64 = 0.1;

/// Result of the receivers in one scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// The input frame with code, pulses and marker as received.
    pub input: IoInput,
    /// Time for which the code was there already when it was heard.
    pub heard_for: Duration,
    /// Time for which the code may be over already.
    pub lags: Duration,
    /// Time since the last marker was passed.
    pub marker_age: Duration,
}

/// Coils, sensors and their receivers.
#[derive(Debug)]
pub struct Coils {
    codes: Vec<(CodeReceiver, Vec<f32>)>,
    twc: FskReceiver,
    /// Bytes received by TWC since they were forgotten last.
    pub twc_bytes: Vec<u8>,
    markers: MarkerReceiver,
    sensors: [SensorInput; 2],
    /// Line A of each speed sensor in this scan, kept for its line B: both lines of a sample are looked at together.
    lines_a: [[i16; COIL_SAMPLES]; 2],
    /// Last marker passed, count of markers, and samples since the last one.
    marker: (u8, u8, f32),
    /// For each coil: parts of its samples that have come in this scan, and scans since the last ones.
    parts: [u8; COILS],
    silent: [u8; COILS],
    /// Factor of the level that injected faults leave between rail and ATP receiver.
    atp_gain: f32,
    /// The antennas' samples come as sound, not in frames.
    by_sound: bool,
    /// Codes shift their carrier.
    shifts: bool,
    /// An injected fault has the ATP receiver hear the weaker of two codes.
    unselective: bool,
    /// The last code that was heard, and scans since.
    heard: Option<(Heard, u8)>,
}

impl Coils {
    /// Coils of a unit of this configuration, in which nothing was heard yet.
    pub fn new(config: &UnitConfig) -> Self {
        let codes = config.carriers_hz().into_iter().map(|carrier_hz| {
            let reception = Reception::of(config, carrier_hz);
            let on_it = (config.codes.iter()).filter(|code| config.is_on_carrier(code, carrier_hz));
            let rates = on_it.map(|code| code.rate_hz as f32).collect();
            (CodeReceiver::new(reception, SAMPLE_HZ), rates)
        });
        let twc = &config.twc;
        let weakest = |level_mv: f64| (WEAKEST * level_mv) as f32;
        let marker = &config.marker;
        Self {
            codes: codes.collect(),
            twc: FskReceiver::new(Tones::of(twc), SAMPLE_HZ, weakest(twc.level_mv)),
            twc_bytes: Vec::new(),
            markers: MarkerReceiver::new(marker.tones_hz, SAMPLE_HZ, weakest(marker.level_mv)),
            sensors: [SensorInput::default(); 2],
            lines_a: [[0; COIL_SAMPLES]; 2],
            marker: (0, 0, f32::MAX),
            parts: [0; COILS],
            silent: [RESTS_AFTER; COILS],
            atp_gain: 1.0,
            by_sound: false,
            shifts: config.receiver.shift_hz > 0.0,
            unselective: false,
            heard: None,
        }
    }

    /// Sets the factor of the level that injected faults leave between rail and ATP receiver, and whether the weaker of
    /// two codes is heard.
    pub fn suffer(&mut self, gain: f32, unselective: bool) {
        self.atp_gain = gain;
        self.unselective = unselective;
    }

    /// Takes samples of this scan; one that comes too late or twice is passed over.
    pub fn take(&mut self, samples: &CoilSamples) {
        let place = usize::from(samples.coil.code());
        if place >= COILS {
            return;
        }
        if samples.part < self.parts[place] || usize::from(samples.part) >= COIL_PARTS {
            return;
        }
        while self.parts[place] < samples.part {
            self.receive(samples.coil, &[0; COIL_PART]);
        }
        self.receive(samples.coil, &samples.samples.0);
        self.silent[place] = 0;
    }

    /// Takes a scan of sound: of the ATP antenna, and of the TWC and marker antennas together.
    pub fn hear(&mut self, heard: &[[i16; COIL_SAMPLES]; 2]) {
        self.by_sound = true;
        self.marker.2 += COIL_SAMPLES as f32;
        let [atp, others] = heard;
        let antennas = [
            (Coil::AtpAntenna, atp),
            (Coil::TwcAntenna, others),
            (Coil::MarkerAntenna, others),
        ];
        for (coil, samples) in antennas {
            let place = usize::from(coil.code());
            (self.parts[place], self.silent[place]) = (0, 0);
            for part in samples.as_chunks().0 {
                self.receive(coil, part);
            }
        }
    }

    /// Ends a scan: its input frame with what was received in it; `None` if no samples came of late.
    pub fn end_scan(&mut self, mut input: IoInput) -> Option<Sampled> {
        for (place, coil) in Coil::ALL.iter().enumerate() {
            let by_sound = self.by_sound && IN_ANTENNAS.contains(coil);
            if self.silent[place] < RESTS_AFTER {
                while !by_sound && usize::from(self.parts[place]) < COIL_PARTS {
                    self.receive(*coil, &[0; COIL_PART]);
                }
                self.silent[place] += 1;
            }
            self.parts[place] = 0;
        }
        let [antenna_rests, sensors_rest] = [Coil::AtpAntenna, Coil::Sensor1A]
            .map(|coil| self.silent[usize::from(coil.code())] == RESTS_AFTER);
        if antenna_rests && sensors_rest {
            return None;
        }
        let (mut heard_for, mut lags) = (Duration::ZERO, Duration::ZERO);
        if let Some((heard, stands_in)) = self.hear_code() {
            let whole = |value: f32| libm::roundf(value) as u16;
            input.carrier_hz = whole(heard.carrier_hz);
            input.code_rate_chz = whole(100.0 * heard.rate_hz);
            input.level_mv = whole(heard.level_mv);
            let window_s = (self.codes.first()).map_or(0.0, |(receiver, _)| receiver.window_s());
            let window_ms = (window_s * 1000.0) as u64;
            // The ends of a longer window are longer in proportion.
            let of_ends = |ms: u64| ms.max(ms * window_ms / LONG_MS);
            let early_ms = match self.shifts || window_ms > LONG_MS {
                true => window_ms * HEARD_EARLY_PERCENT / 100,
                false => HEARD_EARLY_MS,
            };
            let [there_s, over_s] = (heard.spell_s)
                .unwrap_or([window_ms.saturating_sub(early_ms) as f32 / 1000.0, 0.0]);
            heard_for = Duration::from_ms((there_s * 1000.0) as u64);
            let ends = stands_in > 0 || !heard.goes_on;
            lags = Duration::from_ms(match (ends, heard.is_clear) {
                (true, _) => of_ends(HEARD_LATE_MS) + window_ms / HEARD_LATE_PART,
                (false, false) => of_ends(HEARD_LATE_MS),
                (false, true) => (over_s * 1000.0) as u64,
            });
        }
        if !sensors_rest {
            let [one, two] = &self.sensors;
            let sample_us = 1e6 / SAMPLE_HZ;
            let age_us = |since: f32| (since * sample_us).min(f32::from(u16::MAX)) as u16;
            (input.tacho1_count, input.tacho1_edge_us) = (one.count, age_us(one.since));
            (input.tacho2_count, input.tacho2_edge_us) = (two.count, age_us(two.since));
            input.tacho_backward = u8::from(one.backward) | u8::from(two.backward) << 1;
        }
        let age = (self.marker.2 / SAMPLE_HZ * 1e6) as u64;
        (input.marker, input.marker_edges) = (self.marker.0, self.marker.1);
        input.marker_edge_us = age.min(u64::from(u16::MAX)) as u16;
        if !self.by_sound {
            self.marker.2 += COIL_SAMPLES as f32;
        }
        Some(Sampled {
            input,
            heard_for,
            lags,
            marker_age: Duration::from_us(age),
        })
    }

    /// The code in the antenna now, and for how many scans it has stood in.
    fn hear_code(&mut self) -> Option<(Heard, u8)> {
        let unselective = self.unselective;
        let now = (self.codes.iter()).find_map(|(receiver, rates)| {
            let weaker = unselective.then(|| receiver.weaker(rates)).flatten();
            weaker.or_else(|| receiver.heard(rates))
        });
        self.heard = match (now, self.heard) {
            (Some(heard), _) => Some((heard, 0)),
            (None, Some((last, since))) if since < STANDS_IN => Some((last, since + 1)),
            _ => None,
        };
        self.heard
    }

    /// Forgets the bytes received by TWC.
    pub fn forget_twc_bytes(&mut self) {
        self.twc_bytes.clear();
    }

    /// One part of a coil's samples.
    fn receive(&mut self, coil: Coil, samples: &[i16; COIL_PART]) {
        let parts = &mut self.parts[usize::from(coil.code())];
        let from = usize::from(*parts) * COIL_PART;
        *parts += 1;
        match coil {
            Coil::AtpAntenna => {
                for sample in samples {
                    for (receiver, _) in &mut self.codes {
                        receiver.take(in_mv(*sample) * self.atp_gain);
                    }
                }
            }
            Coil::TwcAntenna => {
                for sample in samples {
                    if let Some(Received::Byte(byte)) = self.twc.take(in_mv(*sample)) {
                        self.twc_bytes.push(byte);
                    }
                }
            }
            Coil::MarkerAntenna => {
                for (until_end, sample) in (0..COIL_SAMPLES - from).rev().zip(samples) {
                    if let Some(passed) = self.markers.take(in_mv(*sample)) {
                        let since = until_end as f32 + passed.ago_s * SAMPLE_HZ;
                        self.marker = (passed.marker, self.marker.1.wrapping_add(1), since);
                    }
                }
            }
            Coil::Sensor1A => self.keep_line_a(0, from, samples),
            Coil::Sensor1B => self.receive_sensor(0, from, samples),
            Coil::Sensor2A => self.keep_line_a(1, from, samples),
            Coil::Sensor2B => self.receive_sensor(1, from, samples),
            Coil::Unknown(_) => {}
        }
    }

    fn keep_line_a(&mut self, sensor: usize, from: usize, samples: &[i16; COIL_PART]) {
        self.lines_a[sensor][from..from + COIL_PART].copy_from_slice(samples);
    }

    /// Receives both lines of a sensor when its line B comes.
    fn receive_sensor(&mut self, sensor: usize, from: usize, line_b: &[i16; COIL_PART]) {
        let line_a = &self.lines_a[sensor][from..from + COIL_PART];
        for (a, b) in line_a.iter().zip(line_b) {
            self.sensors[sensor].take(in_mv(*a), in_mv(*b));
        }
    }
}

fn in_mv(sample: i16) -> f32 {
    f32::from(sample) * COIL_STEP_MV
}
