//! Waveforms in the coils and sensors of the train, in the place of numbers: each scan's samples as frames.

use protocol::config::UnitConfig;
use protocol::link::Link;
use protocol::message::{
    COIL_PART, COIL_SAMPLE_HZ, COIL_SAMPLES, COIL_STEP_MV, Coil, CoilSamples, IoInput,
};
use protocol::{Instant, Random, SCAN};

use super::motion::Motion;
use crate::stimulus::CodeSignal;
use crate::waveform::{Channel, ChannelConfig, CodeWave, FskWave, MarkerWave, SensorWave};

const SAMPLES: usize = COIL_SAMPLES;
const SAMPLE_HZ: f64 = COIL_SAMPLE_HZ as f64;
/// Speed at which a marker passes that was asked for, m/s.
const ASKED_MPS: f64 = 20.0;

/// Content of the coils in one scan.
pub struct InCoils<'a> {
    /// Both codes in the ATP antenna.
    pub codes: [CodeSignal; 2],
    /// Frames that the wayside sends through the loop.
    pub twc: &'a [u8],
    /// Motion of the train over its markers.
    pub motion: &'a Motion,
    /// Number and place of each marker along the way.
    pub markers: &'a mut dyn Iterator<Item = (u8, f64)>,
    pub asked_marker: Option<u8>,
}

/// Makes the samples.
#[derive(Debug)]
pub struct Coils {
    codes: [CodeWave; 2],
    twc: FskWave,
    markers: [MarkerWave; 4],
    /// Markers that were asked for, and how far the train is past their middles, m.
    asked: Vec<(u8, f64)>,
    sensors: [SensorWave; 2],
    counts: [u16; 2],
    channels: [Channel; Coil::ALL.len()],
    /// Coils whose signals are waveforms; the signals of the others are numbers.
    made: Vec<Coil>,
}

impl Coils {
    /// Silent coils for a unit of this configuration. The coils `made` have waveforms; `random` starts their
    /// disturbances.
    pub fn new(
        config: &UnitConfig,
        channel: &ChannelConfig,
        random: &mut Random,
        made: &[Coil],
    ) -> Self {
        let (marker, twc) = (&config.marker, &config.twc);
        let silent =
            CodeWave::new(0.0, 0.0, 0.0, SAMPLE_HZ).shifted(config.receiver.shift_hz, SAMPLE_HZ);
        let tones = (twc.middle_hz, twc.apart_hz);
        Self {
            codes: [silent.clone(), silent],
            twc: FskWave::new(&[], tones, twc.bits_per_s, twc.level_mv, SAMPLE_HZ),
            markers: marker
                .tones_hz
                .map(|tone| MarkerWave::new(tone, marker.level_mv, marker.reach_m, SAMPLE_HZ)),
            asked: Vec::new(),
            sensors: [SensorWave::new(SAMPLE_HZ), SensorWave::new(SAMPLE_HZ)],
            counts: [0; 2],
            channels: [(); Coil::ALL.len()]
                .map(|()| Channel::new(channel, SAMPLE_HZ, random.fork())),
            made: made.to_vec(),
        }
    }

    /// Whether this coil has a waveform.
    pub fn makes(&self, coil: Coil) -> bool {
        self.made.contains(&coil)
    }

    /// Sends the samples of the scan that ends now, and removes the values that they carry from its input frame.
    pub fn send(
        &mut self,
        now: Instant,
        input: &mut IoInput,
        coils: InCoils<'_>,
        link: &mut Link,
        out: &mut Vec<u8>,
    ) {
        let mut samples = [0.0; SAMPLES];
        for (wave, code) in self.codes.iter_mut().zip(coils.codes) {
            wave.set(code.carrier_hz, code.rate_hz, code.level_mv, SAMPLE_HZ);
            for (sample, value) in samples.iter_mut().zip(wave) {
                *sample += value;
            }
        }
        if self.makes(Coil::AtpAntenna) {
            self.finish(now, Coil::AtpAntenna, &mut samples, link, out);
            (input.carrier_hz, input.code_rate_chz, input.level_mv) = (0, 0, 0);
        }

        if !coils.twc.is_empty() {
            self.twc.send(coils.twc);
        }
        samples.fill(0.0);
        for (sample, value) in samples.iter_mut().zip(&mut self.twc) {
            *sample = value;
        }
        if self.makes(Coil::TwcAntenna) {
            self.finish(now, Coil::TwcAntenna, &mut samples, link, out);
        }

        samples.fill(0.0);
        self.add_markers(coils, &mut samples);
        if self.makes(Coil::MarkerAntenna) {
            self.finish(now, Coil::MarkerAntenna, &mut samples, link, out);
            (input.marker, input.marker_edges, input.marker_edge_us) = (0, 0, u16::MAX);
        }
        if !self.makes(Coil::Sensor1A) {
            return;
        }
        let lines = [
            [Coil::Sensor1A, Coil::Sensor1B],
            [Coil::Sensor2A, Coil::Sensor2B],
        ];
        for (sensor, lines) in lines.into_iter().enumerate() {
            let [mut a, mut b] = self.pulses(sensor, input);
            self.finish(now, lines[0], &mut a, link, out);
            self.finish(now, lines[1], &mut b, link, out);
        }
        (input.tacho1_count, input.tacho2_count) = (0, 0);
        (input.tacho1_edge_us, input.tacho2_edge_us) = (u16::MAX, u16::MAX);
        input.tacho_backward = 0;
    }

    fn add_markers(&mut self, coils: InCoils<'_>, samples: &mut [f64; SAMPLES]) {
        let motion = coils.motion;
        let step_m = (motion.position_m - motion.position_before_m) / SAMPLES as f64;
        for (marker, at_m) in coils.markers {
            let Some(wave) = self.markers.get_mut(usize::from(marker) - 1) else {
                continue;
            };
            let from_m = motion.position_before_m - at_m;
            if from_m.abs() > wave.heard_within_m() + (motion.position_m - at_m - from_m).abs() {
                continue;
            }
            for (place, sample) in samples.iter_mut().enumerate() {
                *sample += wave.at(from_m + step_m * (place + 1) as f64).unwrap_or(0.0);
            }
        }
        if let Some(marker) = coils.asked_marker {
            let wave = self.markers.get(usize::from(marker).wrapping_sub(1));
            let from_m = wave.map(|wave| -wave.heard_within_m());
            self.asked.extend(from_m.map(|from_m| (marker, from_m)));
        }
        for (marker, away_m) in &mut self.asked {
            let wave = &mut self.markers[usize::from(*marker) - 1];
            for sample in samples.iter_mut() {
                *sample += wave.at(*away_m).unwrap_or(0.0);
                *away_m += ASKED_MPS / SAMPLE_HZ;
            }
        }
        let markers = &self.markers;
        (self.asked).retain(|(marker, away_m)| {
            *away_m < markers[usize::from(*marker) - 1].heard_within_m()
        });
    }

    /// Both lines of a speed sensor.
    fn pulses(&mut self, sensor: usize, input: &IoInput) -> [[f64; SAMPLES]; 2] {
        let counted = [input.tacho1_count, input.tacho2_count][sensor];
        let age_us = [input.tacho1_edge_us, input.tacho2_edge_us][sensor];
        let before = std::mem::replace(&mut self.counts[sensor], counted);
        let left = 1.0 - f64::from(age_us) / SCAN.as_us() as f64;
        let last = left.clamp(0.0, 1.0) * SAMPLES as f64;
        let backward = input.tacho_backward & 1 << sensor != 0;
        let wave = &mut self.sensors[sensor];
        wave.pulse(counted.wrapping_sub(before), last, backward);
        let (mut line_a, mut line_b) = ([0.0; SAMPLES], [0.0; SAMPLES]);
        for (a, b) in line_a.iter_mut().zip(&mut line_b) {
            [*a, *b] = wave.step();
        }
        [line_a, line_b]
    }

    /// Adds the disturbances of a coil; silence is not sent.
    fn finish(
        &mut self,
        now: Instant,
        coil: Coil,
        samples: &mut [f64; SAMPLES],
        link: &mut Link,
        out: &mut Vec<u8>,
    ) {
        self.channels[usize::from(coil.code())].disturb(samples);
        let always = !matches!(coil, Coil::TwcAntenna | Coil::MarkerAntenna);
        if !always && samples.iter().all(|sample| *sample == 0.0) {
            return;
        }
        for (part, samples) in (0..).zip(samples.chunks_exact(COIL_PART)) {
            let mut message = CoilSamples {
                coil,
                part,
                ..CoilSamples::default()
            };
            for (step, sample) in message.samples.0.iter_mut().zip(samples) {
                // Beyond its range an input is driven to its limit.
                *step = (sample / f64::from(COIL_STEP_MV)).round() as i16;
            }
            link.send(now, &message.into(), out);
        }
    }
}
