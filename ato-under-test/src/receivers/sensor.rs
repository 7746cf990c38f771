//! The input of a speed sensor: two lines with a square wave each, a quarter of a period apart.

/// A line is high above this voltage and low below its negative, mV: noise between them changes nothing.
const HYSTERESIS_MV: f32 = 100.0;

/// Counts the pulses of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub struct SensorInput {
    a: Line,
    b: Line,
    /// Pulses so far, wrapping.
    pub count: u16,
    /// B was high at the last pulse: the wheel turns backward.
    pub backward: bool,
    /// Samples since the last pulse.
    pub since: f32,
}

/// One line.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    high: bool,
    last_mv: f32,
    /// Samples since the voltage last rose through zero.
    zero: f32,
}

impl Line {
    /// Takes a sample; whether the line has become high. Its edge is where the voltage rose through zero.
    fn rises(&mut self, sample_mv: f32) -> bool {
        let last = core::mem::replace(&mut self.last_mv, sample_mv);
        self.zero += 1.0;
        if last <= 0.0 && sample_mv > 0.0 {
            self.zero = sample_mv / (sample_mv - last);
        }
        let was = self.high;
        self.high = match self.high {
            true => sample_mv > -HYSTERESIS_MV,
            false => sample_mv > HYSTERESIS_MV,
        };
        self.high && !was
    }
}

impl SensorInput {
    /// Takes a sample of each line, mV.
    pub fn take(&mut self, a_mv: f32, b_mv: f32) {
        self.since += 1.0;
        let rises = self.a.rises(a_mv);
        self.b.rises(b_mv);
        if rises {
            self.count = self.count.wrapping_add(1);
            self.since = self.a.zero;
            // Forward, B follows A by a quarter of a period.
            self.backward = self.b.high;
        }
    }

    /// Samples from where line B rose through zero to the sample at which it became high.
    pub fn since_b(&self) -> f32 {
        self.b.zero
    }

    /// Which lines are high.
    pub fn high(&self) -> [bool; 2] {
        [self.a.high, self.b.high]
    }
}
