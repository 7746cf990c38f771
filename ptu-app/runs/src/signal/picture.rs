//! What a person looks at beside the list of what was heard: waveform, spectrum over time, envelope of the carrier and eye
//! of the TWC bits, reduced as the recording goes on, so that an hour takes no more room than seconds do.

use std::collections::VecDeque;
use std::sync::Arc;

use ato_under_test::receivers::{Demodulator, Downmix, FskReceiver, Received, Tones};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::fit::downmix;

/// Most columns of a reduced curve; when they are full, each two become one.
const MOST_COLUMNS: usize = 1_024;
/// Columns of the spectrum over time at most.
const MOST_SPECTRA: usize = 512;
/// Resolution of the spectrum, Hz, at least: the sidebands of the slowest code rates stand apart.
const RESOLUTION_HZ: f64 = 12.0;
/// Spectra that each sample is part of.
const OVERLAP: usize = 4;
/// Lines beside a line, on either side, into which the window spreads its power, and the sum of all their powers over the
/// power of the line.
const BESIDE: usize = 2;
const OF_LINES: f64 = 1.5;
/// Rows of the spectrum over time.
const ROWS: usize = 512;
/// Least level that is shown, dB over 1 mV.
const FLOOR_DB: f32 = -40.0;
/// Bits of a byte, with start, parity and stop bit.
const BITS: usize = 11;
/// Curves of the eye at most; half of them go when there are more.
const MOST_CURVES: usize = 200;

/// Values in columns of equal length; one value stands for all that its column covers.
#[derive(Clone, Debug)]
pub struct Columns<T> {
    /// Values in each column.
    pub each: u64,
    /// Values in the last column.
    last: u64,
    most: usize,
    values: Vec<T>,
}

/// A column that can be merged with its neighbour when there are too many columns.
pub trait Merge: Clone {
    /// Makes this column stand for the values of the next column, too.
    fn merge(&mut self, other: &Self);
}

impl<T: Merge> Columns<T> {
    fn new(most: usize) -> Self {
        Self {
            each: 1,
            last: 0,
            most,
            values: Vec::new(),
        }
    }

    fn push(&mut self, value: T) {
        match self.values.last_mut() {
            Some(last) if self.last < self.each => {
                last.merge(&value);
                self.last += 1;
                return;
            }
            _ => {}
        }
        if self.values.len() == self.most {
            for pair in 0..self.most / 2 {
                let mut both = self.values[2 * pair].clone();
                both.merge(&self.values[2 * pair + 1]);
                self.values[pair] = both;
            }
            self.values.truncate(self.most / 2);
            self.each *= 2;
        }
        self.values.push(value);
        self.last = 1;
    }

    /// The columns, in order.
    pub fn values(&self) -> &[T] {
        &self.values
    }
}

/// Least and greatest value of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Least.
    pub low: f32,
    /// Greatest.
    pub high: f32,
}

impl Span {
    fn of(value: f32) -> Self {
        Self {
            low: value,
            high: value,
        }
    }
}

impl Merge for Span {
    fn merge(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }
}

/// Levels of a spectrum, dB over 1 mV rms, from 0 Hz on.
type Levels = Vec<f32>;

impl Merge for Levels {
    fn merge(&mut self, other: &Self) {
        for (level, other) in self.iter_mut().zip(other) {
            *level = level.max(*other);
        }
    }
}

/// Curves of one channel of a recording.
#[derive(Clone)]
pub struct Picture {
    sample_hz: f64,
    /// Frequency of the carrier whose level is the envelope, Hz.
    pub carrier_hz: f64,
    wave: Columns<Span>,
    spectrum: Spectrum,
    downmix: Downmix,
    levels: Columns<Span>,
    eye: Option<Eye>,
}

impl Picture {
    /// Picture of samples at the rate `sample_hz`: the envelope of the carrier with codes up to `fastest_hz`, and the eye of
    /// the TWC tones.
    pub fn new(sample_hz: f64, (carrier_hz, fastest_hz): (f64, f64), tones: Tones) -> Self {
        let highest = f64::from(tones.middle_hz + tones.apart_hz);
        Self {
            sample_hz,
            carrier_hz,
            wave: Columns::new(MOST_COLUMNS),
            spectrum: Spectrum::new(sample_hz, OVERLAP),
            downmix: downmix(carrier_hz, fastest_hz, sample_hz).0,
            levels: Columns::new(MOST_COLUMNS),
            eye: (sample_hz > 2.2 * highest).then(|| Eye::new(sample_hz, tones)),
        }
    }

    /// Takes samples, mV.
    pub fn take(&mut self, samples: &[f32]) {
        for sample in samples {
            self.wave.push(Span::of(*sample));
            if let Some(value) = self.downmix.take(*sample) {
                self.levels
                    .push(Span::of(value.abs() / std::f32::consts::SQRT_2));
            }
            self.spectrum.take(*sample);
            if let Some(eye) = &mut self.eye {
                eye.take(*sample);
            }
        }
    }

    /// The waveform, mV, and seconds of a column.
    pub fn wave(&self) -> (&[Span], f64) {
        (self.wave.values(), self.wave.each as f64 / self.sample_hz)
    }

    /// Level of the carrier, mV rms, and seconds of a column.
    pub fn envelope(&self) -> (&[Span], f64) {
        let each_s = self.levels.each as f64 / f64::from(self.downmix.envelope_hz);
        (self.levels.values(), each_s)
    }

    /// Spectra over time, dB over 1 mV rms, and seconds of each.
    pub fn spectra(&self) -> (&[Vec<f32>], f64) {
        let Spectrum { columns, hop, .. } = &self.spectrum;
        let each_s = columns.each as f64 * *hop as f64 / self.sample_hz;
        (columns.values(), each_s)
    }

    /// Beginning and end of the spectra, s: a spectrum stands in the middle of the samples that it is made of.
    pub fn spectra_s(&self) -> (f64, f64) {
        let Spectrum { hop, window, .. } = &self.spectrum;
        let (spectra, each_s) = self.spectra();
        let from_s = (window.len() - hop) as f64 / 2.0 / self.sample_hz;
        (from_s, from_s + spectra.len() as f64 * each_s)
    }

    /// Width of a spectrum's row, Hz.
    pub fn row_hz(&self) -> f64 {
        self.sample_hz / 2.0 / ROWS as f64
    }

    /// Mean spectrum of the whole, dB over 1 mV rms, and Hz between its values.
    pub fn mean_spectrum(&self) -> (Vec<f32>, f64) {
        let Spectrum {
            powers,
            count,
            window,
            ..
        } = &self.spectrum;
        let levels = powers
            .iter()
            .map(|power| level_db(power / (*count).max(1) as f64));
        (levels.collect(), self.sample_hz / window.len() as f64)
    }

    /// The eye of the TWC bits: curves of how much the upper tone is stronger, −1 to 1, from one decision to the second
    /// after it; empty without TWC.
    pub fn eye(&self) -> &[Vec<f32>] {
        self.eye.as_ref().map_or(&[], |eye| &eye.curves)
    }
}

/// Level of a power, mV², in dB over 1 mV rms.
fn level_db(power: f64) -> f32 {
    (10.0 * power.max(1e-12).log10()).max(f64::from(FLOOR_DB)) as f32
}

/// Spectra over time.
#[derive(Clone)]
pub(super) struct Spectrum {
    fft: Arc<dyn Fft<f32>>,
    window: Vec<f32>,
    line: Vec<f32>,
    work: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
    /// Samples between spectra.
    hop: usize,
    columns: Columns<Levels>,
    /// Sum of powers, mV², of each frequency that is shown: up to half of the sample rate.
    powers: Vec<f64>,
    count: u64,
    /// Factor from a squared value to mV².
    scale: f64,
    /// Frequency of the first line beside 0 Hz.
    line_hz: f64,
}

impl Spectrum {
    /// Spectrum of samples at the rate `sample_hz`; each sample is in `overlap` spectra.
    pub(super) fn new(sample_hz: f64, overlap: usize) -> Self {
        let length = ((sample_hz / RESOLUTION_HZ) as usize)
            .next_power_of_two()
            .clamp(64, 1 << 16);
        let fft = FftPlanner::new().plan_fft_forward(length);
        let turn = std::f64::consts::TAU / length as f64;
        let window: Vec<_> = (0..length)
            .map(|n| (0.5 - 0.5 * (turn * (n as f64 + 0.5)).cos()) as f32)
            .collect();
        // A sine of 1 mV rms has 1 mV² at its frequency: half of its amplitude is at the negative one.
        let sum: f64 = window.iter().map(|w| f64::from(*w)).sum();
        Self {
            scratch: vec![Complex::default(); fft.get_inplace_scratch_len()],
            fft,
            line: Vec::with_capacity(length),
            work: Vec::with_capacity(length),
            hop: length / overlap,
            columns: Columns::new(MOST_SPECTRA),
            powers: vec![0.0; length / 2],
            count: 0,
            scale: 2.0 / (sum * sum),
            line_hz: sample_hz / length as f64,
            window,
        }
    }

    /// Frequency of the strongest line, Hz, and its mean level, mV rms; `None` for silence, and for fewer samples than
    /// a spectrum takes.
    pub(super) fn strongest(&self) -> Option<(f64, f64)> {
        let lines = self.powers.windows(2 * BESIDE + 1).enumerate().skip(1);
        let (first, around) = lines.max_by(|a, b| a.1[BESIDE].total_cmp(&b.1[BESIDE]))?;
        let sum: f64 = around.iter().sum();
        let placed = (first..).zip(around).map(|(place, of)| place as f64 * of);
        let at = placed.sum::<f64>() / sum;
        let level_mv = (sum / OF_LINES / self.count as f64).sqrt();
        (sum > 0.0).then_some((at * self.line_hz, level_mv))
    }

    pub(super) fn take(&mut self, sample_mv: f32) {
        self.line.push(sample_mv);
        let length = self.window.len();
        if self.line.len() < length {
            return;
        }
        self.work.clear();
        let windowed = self.line.iter().zip(&self.window);
        (self.work).extend(windowed.map(|(sample, w)| Complex::new(sample * w, 0.0)));
        self.fft
            .process_with_scratch(&mut self.work, &mut self.scratch);
        let powers = (self.work.iter()).map(|value| f64::from(value.norm_sqr()) * self.scale);
        let (mut levels, shown) = (vec![f64::MIN; ROWS], self.powers.len());
        for (place, (sum, power)) in self.powers.iter_mut().zip(powers).enumerate() {
            *sum += power;
            let level = &mut levels[place * ROWS / shown];
            *level = level.max(power);
        }
        self.count += 1;
        // The spectra of a long recording do not overlap.
        let hops = match self.columns.each {
            1 => 1,
            _ => length / self.hop,
        };
        let levels: Levels = levels.into_iter().map(level_db).collect();
        for _ in 0..hops {
            self.columns.push(levels.clone());
        }
        self.line.drain(..hops * self.hop);
    }
}

/// The eye of the TWC bits: the values by which the receiver decides.
#[derive(Clone)]
struct Eye {
    receiver: FskReceiver,
    demodulator: Demodulator,
    per_bit: f32,
    /// Samples of the last byte.
    line: VecDeque<f32>,
    curves: Vec<Vec<f32>>,
    /// One in `every` curves is kept; `passed` = curves since the last one kept.
    every: usize,
    passed: usize,
}

impl Eye {
    fn new(sample_hz: f64, tones: Tones) -> Self {
        let demodulator = Demodulator::new(tones, sample_hz as f32);
        Self {
            receiver: FskReceiver::new(tones, sample_hz as f32, 0.0),
            per_bit: demodulator.values_per_bit(tones.bit_rate),
            demodulator,
            line: VecDeque::new(),
            curves: Vec::new(),
            every: 1,
            passed: 0,
        }
    }

    fn take(&mut self, sample_mv: f32) {
        if let Some(bit) = self.demodulator.take(sample_mv) {
            self.line.push_back(bit.lean);
            let longest = (self.per_bit * BITS as f32) as usize + 1;
            if self.line.len() > longest {
                self.line.pop_front();
            }
        }
        if let Some(Received::Byte(_)) = self.receiver.take(sample_mv) {
            self.keep();
        }
    }

    /// Keeps the curves, of two bits each, of a byte that has just ended with the decision of its stop bit.
    fn keep(&mut self) {
        let two = (2.0 * self.per_bit).round() as usize;
        let line: Vec<f32> = self.line.iter().copied().collect();
        for pair in 0..BITS / 2 {
            let back = (2.0 * self.per_bit * pair as f32).round() as usize;
            let Some(end) = line.len().checked_sub(back).filter(|end| *end > two) else {
                return;
            };
            self.passed += 1;
            if self.passed < self.every {
                continue;
            }
            self.passed = 0;
            if self.curves.len() == MOST_CURVES {
                let mut place = 0;
                self.curves.retain(|_| {
                    place += 1;
                    place % 2 == 0
                });
                self.every *= 2;
            }
            self.curves.push(line[end - two - 1..end].to_vec());
        }
    }
}
