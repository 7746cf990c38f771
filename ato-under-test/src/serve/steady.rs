//! Passes samples from one clock to another: a sound card's second is not this computer's.

extern crate std;

use std::vec::Vec;

/// Two channels at one moment.
pub type Pair = [f32; 2];

/// Length of the filter between samples, in samples, and number of places between two samples for which it is computed.
pub const TAPS: usize = 32;
const PLACES: usize = 512;
/// Greatest difference between two clocks, as a share: samples given differ in number from those that came by no more.
const MOST: f64 = 5e-4;
/// Weight of the newest block in the mean number of samples that wait: the mean is over about 5 s.
const FOLLOWS: f64 = 0.002;
/// If more samples wait than this multiple of the aim, the oldest are dropped down to the aim.
const TOO_MUCH: usize = 4;

/// Takes samples as they come and gives as many as are asked for, at a slightly adapted rate, so that about `aim`
/// samples wait.
pub struct Steady {
    waiting: Vec<Pair>,
    aim: usize,
    /// Place of the next value between two samples that wait, 0 to 1.
    at: f64,
    mean: f64,
    flows: bool,
    filter: Vec<[f32; TAPS]>,
}

impl Steady {
    /// A buffer that keeps `aim` samples waiting.
    pub fn new(aim: usize) -> Self {
        let middle = (TAPS / 2 - 1) as f64;
        let tap = |place: usize, tap: usize| {
            let from = tap as f64 - middle - place as f64 / PLACES as f64;
            let angle = core::f64::consts::PI * from;
            let sinc = if from == 0.0 {
                1.0
            } else {
                libm::sin(angle) / angle
            };
            let window = 0.5 + 0.5 * libm::cos(2.0 * angle / TAPS as f64);
            (sinc * window) as f32
        };
        Self {
            waiting: Vec::new(),
            aim,
            at: 0.0,
            mean: aim as f64,
            flows: false,
            filter: (0..PLACES)
                .map(|place| core::array::from_fn(|at| tap(place, at)))
                .collect(),
        }
    }

    /// Adds samples that came from the sound card.
    pub fn push(&mut self, samples: impl Iterator<Item = Pair>) {
        self.waiting.extend(samples);
    }

    /// Samples that wait.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Fills `out`, with silence when too few samples wait; from then on samples wait until there are enough again.
    pub fn take(&mut self, out: &mut [Pair]) {
        out.fill([0.0; 2]);
        self.flows |= self.waiting.len() >= self.aim.max(out.len() + TAPS);
        if !self.flows {
            return;
        }
        if self.waiting.len() > TOO_MUCH * self.aim {
            let beyond = self.waiting.len() - self.aim.max(out.len() + TAPS);
            self.waiting.drain(..beyond);
            self.mean = self.aim as f64;
        }
        let aim = self.aim as f64;
        self.mean += FOLLOWS * (self.waiting.len() as f64 - self.mean);
        let step = 1.0 + MOST * ((self.mean - aim) / aim).clamp(-1.0, 1.0);
        let mut first = 0;
        for slot in out {
            let Some(samples) = self.waiting.get(first..first + TAPS) else {
                self.flows = false;
                break;
            };
            let taps = &self.filter[(self.at * PLACES as f64) as usize];
            for (sample, tap) in samples.iter().zip(taps) {
                slot[0] += sample[0] * tap;
                slot[1] += sample[1] * tap;
            }
            self.at += step;
            first += self.at as usize;
            self.at -= libm::floor(self.at);
        }
        self.waiting.drain(..first.min(self.waiting.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a tone stays what it is between two clocks that differ by 150 ppm, without a gap, and what waits stays near its
    /// aim. Method: a minute of 16 kHz, whose power beside the tone is measured.
    #[test]
    fn a_tone_stays_whole_between_two_clocks() {
        for ppm in [-150.0, 150.0] {
            let (mut steady, mut made, mut owed) = (Steady::new(1_440), 0u64, 0.0);
            let mut out = [[0.0f32; 2]; 480];
            let (mut worst, mut last) = (0.0f64, None);
            for block in 0..6_000 {
                owed += 480.0 * (1.0 + ppm * 1e-6);
                let tone = |at: u64| {
                    let turns = at as f64 / 3.0;
                    let sample = libm::cos(core::f64::consts::TAU * (turns - libm::floor(turns)));
                    [sample as f32, 0.0]
                };
                let until = owed as u64;
                steady.push((made..until).map(tone));
                made = until;
                steady.take(&mut out);
                // The squares of three samples a third of a turn apart add up to 1.5.
                let power: f32 = out.iter().map(|pair| pair[0] * pair[0]).sum();
                if block > 10 {
                    worst = worst.max((f64::from(power) / 240.0 - 1.0).abs());
                    last = Some(steady.waiting());
                }
            }
            assert!(worst < 0.02, "{ppm} ppm: {worst}");
            let waits = last.expect("blocks");
            assert!((700..2_600).contains(&waits), "{ppm} ppm: {waits}");
        }
    }

    #[test]
    fn what_ran_dry_waits_until_there_is_enough_and_what_piles_up_is_passed_over() {
        let mut steady = Steady::new(960);
        let mut out = [[1.0f32; 2]; 480];
        steady.push((0..900).map(|_| [1.0; 2]));
        steady.take(&mut out);
        assert_eq!((out[479], steady.waiting()), ([0.0; 2], 900));
        steady.push((0..9_000).map(|_| [1.0; 2]));
        steady.take(&mut out);
        assert!((out[479][0] - 1.0).abs() < 0.02 && steady.waiting() < 960);
    }
}
