//! A speed sensor: two lines with a square wave each, line B a quarter of a period behind line A, or ahead of line A
//! when the wheel turns backward.

use std::collections::VecDeque;

/// Time in which a line goes from low to high, samples of the line.
const RISE: f64 = 2.5;
/// Longest time for which a line stays high, s, at a wheel that only just moves.
const LONGEST_S: f64 = 0.02;
/// A line is this much above or below the middle, mV.
const AMPLITUDE_MV: f64 = 1_000.0;

/// The samples of both lines, mV.
#[derive(Clone, Debug)]
pub struct SensorWave {
    sample_hz: f64,
    lines: [Line; 2],
    /// Coming changes of the lines: time in samples from now on, line, high or low.
    changes: VecDeque<(f64, usize, bool)>,
    /// Time since the last pulse, samples.
    since: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Line {
    high: bool,
    /// Samples since the line changed.
    since: f64,
}

impl Line {
    fn value_mv(self) -> f64 {
        let way = (self.since / RISE).min(1.0);
        let up = if self.high { 1.0 } else { -1.0 };
        AMPLITUDE_MV * up * (2.0 * way - 1.0)
    }
}

impl SensorWave {
    /// A wheel at rest, with this number of samples a second for each line.
    pub fn new(sample_hz: f64) -> Self {
        let low = Line {
            high: false,
            since: RISE,
        };
        Self {
            sample_hz,
            lines: [low; 2],
            changes: VecDeque::new(),
            since: 2.0 * LONGEST_S * sample_hz,
        }
    }

    /// Makes this number of pulses in the next samples, evenly, the last of them `last` samples from now.
    pub fn pulse(&mut self, count: u16, last: f64, backward: bool) {
        if count == 0 {
            return;
        }
        let count = f64::from(count);
        // The longest period with which all pulses are still to come.
        let fits = if count > 1.0 {
            last / (count - 1.0)
        } else {
            last + self.since
        };
        let period = ((self.since + last) / count)
            .min(fits)
            .min(2.0 * LONGEST_S * self.sample_hz);
        let mut before = -self.since;
        for place in 0..count as u16 {
            let at = last - period * (count - 1.0 - f64::from(place));
            self.end_pulse(before, at);
            self.changes.extend([
                (at, 0, true),
                (at + period / 4.0, 1, !backward),
                (at + period / 2.0, 0, false),
                (at + period * 0.75, 1, backward),
            ]);
            before = at;
        }
        self.since = -last;
    }

    /// Ends the pulse that began at `began` before the next one begins at `at`, even if the wheel now turns faster.
    fn end_pulse(&mut self, began: f64, at: f64) {
        let middle = ((began + at) / 2.0).max(0.0);
        let late = |line| {
            let mut changes = self.changes.iter().rev();
            changes
                .find(|change| change.0 >= at && change.1 == line)
                .copied()
        };
        let late = [late(0), late(1)];
        self.changes.retain(|change| change.0 < at);
        for (_, line, high) in late.into_iter().flatten() {
            self.changes.push_back((middle, line, high));
        }
    }

    /// The next sample of both lines.
    pub fn step(&mut self) -> [f64; 2] {
        while let Some(&(at, line, high)) = self.changes.front()
            && at <= 0.0
        {
            self.changes.pop_front();
            let line = &mut self.lines[line];
            if line.high != high {
                *line = Line { high, since: -at };
            }
        }
        let values = self.lines.map(Line::value_mv);
        for line in &mut self.lines {
            line.since += 1.0;
        }
        for change in &mut self.changes {
            change.0 -= 1.0;
        }
        self.since += 1.0;
        values
    }
}
