//! Two tachometers on one wheel: counts, and the exact age of each channel's last pulse.

use protocol::Random;
use protocol::SCAN;

use crate::conditions::Sensors;
use crate::stimulus::TachoCondition;

use super::motion::Motion;
use crate::random::{normal, waiting_time_s};

/// Phase at which each channel starts, pulses: a quarter apart, and clear of an edge.
const PHASES: [f64; 2] = [0.5, 0.75];
/// Greatest age of a pulse, µs: ages are sent in 16 bits.
pub const MAX_AGE_US: f64 = u16::MAX as f64;
/// Most spurious pulses in one scan; a counter input cannot count more.
const MAX_NOISE_PER_SCAN: usize = 100;

/// Farthest a tooth may lie from its place, pitches: never on the other side of its neighbour.
const MAX_DISPLACED: f64 = 0.3;

/// One channel's generator.
#[derive(Debug)]
pub struct Tacho {
    condition: TachoCondition,
    metres_per_pulse: f64,
    random: Random,
    /// Distance at which the present condition began, and the phase there: no error adds up.
    base_distance_m: f64,
    base_phase: f64,
    phase: f64,
    /// Distance of each tooth of a turn from its place, pitches; empty = all teeth are in place.
    teeth: Vec<f64>,
    /// The last tooth that passed.
    passed: f64,
    /// Spurious pulses of a good channel, 1/s.
    spurious_per_s: f64,
    /// Time until the next spurious pulse, s.
    noise_in_s: f64,
    /// Pulses so far, wrapping.
    pub count: u16,
    age_us: f64,
}

impl Tacho {
    pub fn condition(&self) -> TachoCondition {
        self.condition
    }

    /// Channel 0 or 1 at rest, that has not made a pulse for long.
    pub fn new(channel: usize, metres_per_pulse: f64, random: Random) -> Self {
        Self {
            condition: TachoCondition::Good,
            metres_per_pulse,
            random,
            base_distance_m: 0.0,
            base_phase: PHASES[channel],
            phase: PHASES[channel],
            teeth: Vec::new(),
            passed: PHASES[channel].floor(),
            spurious_per_s: 0.0,
            noise_in_s: f64::INFINITY,
            count: 0,
            age_us: MAX_AGE_US,
        }
    }

    /// Sets how far the wheel rolls for a pulse from now on.
    pub fn set_metres_per_pulse(&mut self, metres_per_pulse: f64, distance_m: f64) {
        self.base_phase = self.phase;
        self.base_distance_m = distance_m;
        self.metres_per_pulse = metres_per_pulse;
    }

    /// Sets the condition from now on.
    pub fn set_condition(&mut self, condition: TachoCondition, distance_m: f64) {
        self.base_phase = self.phase;
        self.base_distance_m = distance_m;
        self.condition = condition;
        self.await_noise();
    }

    /// Sets how a good channel with a wheel of this number of teeth differs from an ideal one.
    pub fn set_sensors(&mut self, sensors: &Sensors, teeth: u32, random: &mut Random) {
        let places = (0..teeth).map(|_| sensors.tooth_pitch * normal(random));
        self.teeth = places
            .map(|place| place.clamp(-MAX_DISPLACED, MAX_DISPLACED))
            .collect();
        self.passed = self.tooth_at(self.phase);
        self.spurious_per_s = sensors.spurious_pulses_per_s;
        self.await_noise();
    }

    fn await_noise(&mut self) {
        let per_s = self.noise_per_s();
        self.noise_in_s = if per_s > 0.0 {
            waiting_time_s(&mut self.random, per_s)
        } else {
            f64::INFINITY
        };
    }

    fn noise_per_s(&self) -> f64 {
        match self.condition {
            TachoCondition::Noisy { per_s } => self.spurious_per_s + per_s,
            _ => self.spurious_per_s,
        }
    }

    /// Distance of a tooth from its place, pitches.
    fn displaced(&self, tooth: f64) -> f64 {
        let place = tooth.rem_euclid(self.teeth.len().max(1) as f64);
        self.teeth.get(place as usize).copied().unwrap_or_default()
    }

    /// The last tooth that has passed at this phase.
    fn tooth_at(&self, phase: f64) -> f64 {
        let nearest = phase.floor();
        if phase < nearest + self.displaced(nearest) {
            nearest - 1.0
        } else if phase >= nearest + 1.0 + self.displaced(nearest + 1.0) {
            nearest + 1.0
        } else {
            nearest
        }
    }

    /// Whether the tachometer reports backward rotation of a wheel that turns `backward` or forward.
    pub fn tells_backward(&self, backward: bool) -> bool {
        backward != (self.condition == TachoCondition::Reversed)
    }

    /// Makes the pulses of one scan.
    pub fn step(&mut self, motion: &Motion) {
        self.age_us = (self.age_us + SCAN.as_us() as f64).min(MAX_AGE_US);
        let factor = match self.condition {
            TachoCondition::Scaled { factor } => factor,
            _ => 1.0,
        };
        let pulse_m = self.metres_per_pulse / factor;
        let phase = self.base_phase + (motion.distance_m - self.base_distance_m) / pulse_m;
        let passed = self.tooth_at(phase);
        let edges = passed - self.passed;
        (self.phase, self.passed) = (phase, passed);
        if self.condition == TachoCondition::Dead {
            return;
        }
        if edges > 0.0 {
            let edge_distance_m =
                motion.distance_m - (phase - (passed + self.displaced(passed))) * pulse_m;
            self.count = self.count.wrapping_add(edges as u16);
            self.age_us = self
                .age_us
                .min(motion.age_of_distance_s(edge_distance_m) * 1e6);
        }
        let per_s = self.noise_per_s();
        if per_s > 0.0 {
            self.add_noise(per_s);
        }
    }

    fn add_noise(&mut self, per_s: f64) {
        let scan_s = SCAN.as_secs();
        for _ in 0..MAX_NOISE_PER_SCAN {
            if self.noise_in_s >= scan_s {
                break;
            }
            self.count = self.count.wrapping_add(1);
            self.age_us = self.age_us.min((scan_s - self.noise_in_s) * 1e6);
            self.noise_in_s += waiting_time_s(&mut self.random, per_s);
        }
        self.noise_in_s = (self.noise_in_s - scan_s).max(0.0);
    }

    /// Age of the last pulse, µs, at most 65535.
    pub fn age_us(&self) -> u16 {
        self.age_us.round() as u16
    }
}

#[cfg(test)]
mod tests {
    use protocol::Speed;

    use super::super::Wheel;
    use super::*;

    /// 860 mm and 100 pulses per turn, as in the default configuration.
    const PULSE_M: f64 = std::f64::consts::PI * 0.86 / 100.0;

    fn channels() -> [Tacho; 2] {
        [0, 1].map(|i| Tacho::new(i, PULSE_M, Random::new(7)))
    }

    #[test]
    fn counts_are_the_distance_to_a_pulse() {
        let (mut wheel, [mut one, mut two]) = (Wheel::default(), channels());
        wheel.travel(850.03, Speed::from_kmh(60.0), 0.83).unwrap();
        let mut counts = [0u64; 2];
        while !wheel.settled() {
            let before = [one.count, two.count];
            wheel.step();
            one.step(&wheel.motion);
            two.step(&wheel.motion);
            counts[0] += u64::from(one.count.wrapping_sub(before[0]));
            counts[1] += u64::from(two.count.wrapping_sub(before[1]));
        }
        let expected = 850.03 / PULSE_M;
        for (count, phase) in counts.into_iter().zip(PHASES) {
            assert_eq!(count, (expected + phase).floor() as u64);
        }
    }

    /// Method: as a measuring instrument would, speed = pulses · distance / time between first and last
    /// edge of a 100 ms window, at constant speed, against the true speed.
    #[test]
    fn edge_ages_agree_with_speed() {
        for kmh in [3.0, 25.0, 61.7, 108.0] {
            let (mut wheel, [mut tacho, _]) = (Wheel::default(), channels());
            wheel.go_to(Speed::from_kmh(kmh), 3.0);
            for scan in 0..2000u32 {
                wheel.step();
                tacho.step(&wheel.motion);
                if scan == 1900 {
                    assert!(wheel.settled());
                }
            }
            let (count, age) = (tacho.count, f64::from(tacho.age_us()));
            for _ in 0..10 {
                wheel.step();
                tacho.step(&wheel.motion);
            }
            let pulses = f64::from(tacho.count.wrapping_sub(count));
            let seconds = (100_000.0 + age - f64::from(tacho.age_us())) / 1e6;
            let measured = pulses * PULSE_M / seconds;
            assert!(
                (measured * 3.6 / kmh - 1.0).abs() < 1e-3,
                "{kmh}: {}",
                measured * 3.6
            );
        }
    }

    /// While the wheel speeds up, each edge is younger than the last one plus the time passed.
    #[test]
    fn edge_times_never_go_back() {
        let (mut wheel, [mut tacho, _]) = (Wheel::default(), channels());
        wheel.go_to(Speed::from_kmh(30.0), 0.5);
        let mut last_edge_us = f64::NEG_INFINITY;
        for scan in 1..3000u32 {
            let before = tacho.count;
            wheel.step();
            tacho.step(&wheel.motion);
            let edge_us = f64::from(scan) * 1e4 - f64::from(tacho.age_us());
            if tacho.count != before {
                assert!(edge_us > last_edge_us && tacho.age_us() <= 10_000);
                last_edge_us = edge_us;
            }
        }
    }

    #[test]
    fn conditions_act_on_their_channel_only() {
        let (mut wheel, [mut good, mut bad]) = (Wheel::default(), channels());
        wheel.go_to(Speed::from_mps(10.0), 1000.0);
        let mut run = |good: &mut Tacho, bad: &mut Tacho| {
            let before = (good.count, bad.count);
            for _ in 0..1000 {
                wheel.step();
                good.step(&wheel.motion);
                bad.step(&wheel.motion);
            }
            (
                f64::from(good.count.wrapping_sub(before.0)),
                f64::from(bad.count.wrapping_sub(before.1)),
                wheel.motion.distance_m,
            )
        };
        let (a, b, distance) = run(&mut good, &mut bad);
        assert!((a - b).abs() <= 1.0);
        bad.set_condition(TachoCondition::Scaled { factor: 0.5 }, distance);
        let (a, b, distance) = run(&mut good, &mut bad);
        assert!((a / 2.0 - b).abs() <= 1.0);
        bad.set_condition(TachoCondition::Noisy { per_s: 100.0 }, distance);
        let (a, b, distance) = run(&mut good, &mut bad);
        assert!((b - a - 1000.0).abs() < 100.0, "{}", b - a);
        bad.set_condition(TachoCondition::Dead, distance);
        let (_, b, distance) = run(&mut good, &mut bad);
        assert_eq!((b, bad.age_us()), (0.0, u16::MAX));
        bad.set_condition(TachoCondition::Reversed, distance);
        let (a, b, distance) = run(&mut good, &mut bad);
        assert!((a - b).abs() <= 1.0);
        assert!(bad.tells_backward(false) && !bad.tells_backward(true));
        bad.set_condition(TachoCondition::Good, distance);
        let (a, b, _) = run(&mut good, &mut bad);
        assert!((a - b).abs() <= 1.0);
        assert!(!bad.tells_backward(false) && bad.tells_backward(true));
    }

    /// Goal: uneven teeth move edges and nothing else. Method: at constant speed a whole turn takes its
    /// time to the microsecond, while single pitches differ by the spread that was asked for.
    #[test]
    fn uneven_teeth_repeat_with_the_turn_and_lose_no_pulse() {
        let (mut wheel, [mut tacho, _]) = (Wheel::default(), channels());
        let sensors = Sensors {
            tooth_pitch: 0.05,
            ..Sensors::default()
        };
        tacho.set_sensors(&sensors, 100, &mut Random::new(5));
        // One pulse takes 4.05 scans, so each scan tells of one edge at most.
        wheel.go_to(Speed::from_mps(PULSE_M / 0.0405), 1000.0);
        let mut edges_us = Vec::new();
        for scan in 1..2000u32 {
            let before = tacho.count;
            wheel.step();
            tacho.step(&wheel.motion);
            if tacho.count != before {
                edges_us.push(f64::from(scan) * 1e4 - f64::from(tacho.age_us()));
            }
        }
        let steady = &edges_us[2..];
        let pitches: Vec<_> = steady.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(
            steady
                .windows(101)
                .all(|w| (w[100] - w[0] - 4.05e6).abs() <= 2.0)
        );
        let var = pitches.iter().map(|p| (p - 40_500.0).powi(2)).sum::<f64>();
        let sigma = (var / pitches.len() as f64).sqrt() / 40_500.0;
        // Each pitch is the difference of two places, each uncertain by 5 %.
        assert!((sigma - 0.0707).abs() < 0.015, "{sigma}");
    }

    #[test]
    fn a_good_channel_has_spurious_pulses_at_the_rate_asked_for() {
        let (mut wheel, [mut tacho, _]) = (Wheel::default(), channels());
        let sensors = Sensors {
            spurious_pulses_per_s: 0.5,
            ..Sensors::default()
        };
        tacho.set_sensors(&sensors, 100, &mut Random::new(5));
        for _ in 0..100_000 {
            wheel.step();
            tacho.step(&wheel.motion);
        }
        let pulses = i32::from(tacho.count);
        assert!((pulses - 500).abs() < 70, "{pulses}");
    }
}
