//! The receiver of markers: each has a tone of its own, which swells and fades as the train passes over it.
//!
//! A marker is passed where its tone was strongest. Noise moves the strongest value, so the place is the top of a
//! parabola through the logarithms of all values near it: the logarithm of a bell curve is exactly a parabola.

use super::downmix::{Downmix, Phasor};

/// Nominal sample rate and pass band of the envelope, Hz: a marker at 100 km/h swells within milliseconds.
const ENVELOPE_HZ: f32 = 1_500.0;
const PASS_HZ: f32 = 220.0;
/// Delay of the envelope's filter: half of its eight values.
const DELAY_VALUES: f32 = 4.0;
/// Values that are kept of a passage; in a slow one each stands for several values of the envelope.
const MOST: usize = 128;
/// Values above this share of the strongest tell the place.
const NEAR: f32 = 0.6;
/// The tone has faded when it was below this share of its strongest value, or of the least level, for the last eighth
/// of the passage: in a slow passage noise crosses any level more than once.
const FADED: f32 = 0.35;
const FADED_FOR: u32 = 8;
/// Fall of the logarithm from the top to where [`NEAR`] ends, over the fall of a bell curve there.
const OF_BELL: core::ops::RangeInclusive<f32> = 0.4..=2.5;
/// Least ratio of a marker's level to the loudest other tone's at its begin, and over its passage: noise is in all.
const LEAST_RATIO: f32 = 2.0;
const LEAST_RATIO_OF_ALL: f32 = 4.0;
/// Greatest deviation of a marker's tone from its nominal frequency, Hz.
const OFF_HZ: f32 = 60.0;
/// Fewest values of a passage: at 120 km/h a marker has nine.
const FEWEST: u32 = 6;

/// A marker that was passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// 1 to 4 = PSM1 to PSM4.
    pub marker: u8,
    /// Time since it was passed, s.
    pub ago_s: f32,
    /// Strongest level, mV rms.
    pub level_mv: f32,
}

/// Receives the tones of four markers.
#[derive(Clone, Debug)]
pub struct MarkerReceiver {
    tones: [Downmix; 4],
    level_min_mv: f32,
    /// The last value of each tone.
    last: [Phasor; 4],
    passage: Option<Passage>,
    /// A marker was passed, and its tone is not silent yet.
    fading: bool,
}

/// A marker that is being passed.
#[derive(Clone, Debug)]
struct Passage {
    marker: u8,
    strongest: f32,
    values: [f32; MOST],
    length: usize,
    /// Envelope values that each kept value stands for; sum and number of those that do not fill one yet.
    each: usize,
    sum: (f32, usize),
    /// Sums of the marker's level and of the loudest other tone's, and the number of values in them.
    own: f32,
    others: f32,
    count: u32,
    /// Number of values since the tone was last above the faded level.
    faded: u32,
    /// How far the tone's phase turns from value to value.
    turned: Phasor,
}

impl MarkerReceiver {
    /// Receiver of tones in samples at this rate, Hz. What is weaker than `level_min_mv`, rms, is silence.
    pub fn new(tones_hz: [f64; 4], sample_hz: f32, level_min_mv: f32) -> Self {
        Self {
            tones: tones_hz.map(|tone| Downmix::new(tone as f32, sample_hz, ENVELOPE_HZ, PASS_HZ)),
            level_min_mv,
            last: [Phasor::default(); 4],
            passage: None,
            fading: false,
        }
    }

    /// Takes a sample, mV.
    pub fn take(&mut self, sample_mv: f32) -> Option<Passed> {
        let mut values = [None; 4];
        for (value, tone) in values.iter_mut().zip(&mut self.tones) {
            *value = tone.take(sample_mv);
        }
        // All tones are filtered from the same samples: either each has a value, or none.
        let [Some(_), ..] = values else {
            return None;
        };
        self.value(values.map(Option::unwrap_or_default))
    }

    fn value(&mut self, values: [Phasor; 4]) -> Option<Passed> {
        let levels = values.map(|value| value.abs() / core::f32::consts::SQRT_2);
        let last = core::mem::replace(&mut self.last, values);
        if let Some(passage) = &mut self.passage {
            let own = usize::from(passage.marker - 1);
            let level = levels[own];
            let others = (levels.into_iter().enumerate()).filter(|other| other.0 != own);
            passage.others += others.map(|other| other.1).fold(0.0, f32::max);
            passage.own += level;
            passage.count += 1;
            passage.add(level);
            passage.turned = passage.turned.plus(values[own].times_conj(last[own]));
            let is_faded = level < FADED * passage.strongest.max(self.level_min_mv);
            passage.faded = if is_faded { passage.faded + 1 } else { 0 };
            if passage.faded * FADED_FOR <= passage.count {
                // Noise, which is in all tones, would never fade.
                if passage.count > FEWEST && passage.own < LEAST_RATIO * passage.others {
                    self.passage = None;
                }
                return None;
            }
            let value_hz = self.tones[0].envelope_hz;
            let (passed, is_bell) = passage.passed(1.0 / value_hz);
            let off_hz = passage.turned.angle() / core::f32::consts::TAU * value_hz;
            let is_marker = passage.count >= FEWEST
                && passage.own >= LEAST_RATIO_OF_ALL * passage.others
                && off_hz.abs() < OFF_HZ;
            self.passage = None;
            self.fading = is_marker && is_bell;
            return self.fading.then_some(passed);
        }
        let (place, level) = (levels.into_iter().enumerate()).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let others = (levels.into_iter().enumerate()).filter(|other| other.0 != place);
        let loudest_other = others.map(|other| other.1).fold(0.0, f32::max);
        self.fading &= level >= NEAR * self.level_min_mv;
        if !self.fading && level >= self.level_min_mv && level >= LEAST_RATIO * loudest_other {
            let mut passage = Passage {
                marker: place as u8 + 1,
                strongest: 0.0,
                values: [0.0; MOST],
                length: 0,
                each: 1,
                sum: (0.0, 0),
                own: 0.0,
                others: 0.0,
                count: 0,
                faded: 0,
                turned: Phasor::default(),
            };
            passage.add(level);
            self.passage = Some(passage);
        }
        None
    }

    /// Whether a marker is being passed.
    pub fn is_passing(&self) -> bool {
        self.passage.is_some()
    }
}

impl Passage {
    fn add(&mut self, level: f32) {
        self.sum = (self.sum.0 + level, self.sum.1 + 1);
        if self.sum.1 < self.each {
            return;
        }
        let level = self.sum.0 / self.each as f32;
        self.strongest = self.strongest.max(level);
        self.values[self.length] = level;
        self.sum = (0.0, 0);
        self.length += 1;
        if self.length == MOST {
            for place in 0..MOST / 2 {
                self.values[place] = (self.values[2 * place] + self.values[2 * place + 1]) / 2.0;
            }
            self.length = MOST / 2;
            self.each *= 2;
            let values = self.values[..self.length].iter().copied();
            self.strongest = values.fold(0.0, f32::max);
        }
    }

    /// Where the top of the parabola lies, by weighted least squares around the middle of the values near the top, and
    /// whether it falls on either side as a bell does: a tone that begins and ends at once, or fades alone, is no marker.
    fn passed(&self, value_s: f32) -> (Passed, bool) {
        let values = &self.values[..self.length];
        let near = |level: &f32| *level >= NEAR * self.strongest;
        let first = values.iter().position(near).unwrap_or(0);
        let last = values.iter().rposition(near).unwrap_or(0);
        let middle = (first + last) as f32 / 2.0;
        let mut sums = [0.0f32; 5];
        let mut logs = [0.0f32; 3];
        for (place, level) in (first..).zip(&values[first..=last]) {
            // The logarithm of a weak value has more noise.
            let share = level / self.strongest;
            let (x, weight) = (place as f32 - middle, share * share);
            let log = libm::logf(share.max(1e-3));
            let mut power = weight;
            for (degree, sum) in sums.iter_mut().enumerate() {
                *sum += power;
                if degree < 3 {
                    logs[degree] += power * log;
                }
                power *= x;
            }
        }
        let (top, curve) = top_of_parabola(sums, logs).unwrap_or_default();
        let half = (last - first) as f32 / 2.0;
        let is_bell = OF_BELL.contains(&(curve * half * half / libm::logf(NEAR)));
        let top = middle + top.clamp(-half, half);
        // A value that stands for several is in their middle.
        let each = self.each as f32;
        let since =
            (self.length as f32 - top - 1.0) * each + (each - 1.0) / 2.0 + self.sum.1 as f32;
        let passed = Passed {
            marker: self.marker,
            ago_s: (since + DELAY_VALUES) * value_s,
            level_mv: self.strongest,
        };
        (passed, is_bell)
    }
}

/// Top −b / 2c of y = a + b x + c x², and c, by normal equations: sums of x⁰ to x⁴, y x⁰ to y x²; a line has none.
fn top_of_parabola([s0, s1, s2, s3, s4]: [f32; 5], [t0, t1, t2]: [f32; 3]) -> Option<(f32, f32)> {
    let determinant = |m: [[f32; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let b = determinant([[s0, t0, s2], [s1, t1, s3], [s2, t2, s4]]);
    let c = determinant([[s0, s1, t0], [s1, s2, t1], [s2, s3, t2]]);
    let whole = determinant([[s0, s1, s2], [s1, s2, s3], [s2, s3, s4]]);
    (c != 0.0 && whole != 0.0).then(|| (-b / (2.0 * c), c / whole))
}
