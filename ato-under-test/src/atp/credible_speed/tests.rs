//! Speeds that are believed, and speeds that are not.

use super::*;
use crate::for_tests::sg100;
use protocol::config::UnitConfig;

struct Train {
    credible: CredibleSpeed,
    config: UnitConfig,
    log: EventLog,
    now: Instant,
    speed: f64,
}

impl Train {
    fn at(kmh: f64) -> Self {
        let mut train = Self {
            credible: CredibleSpeed::default(),
            config: sg100(),
            log: EventLog::default(),
            now: Instant::ZERO,
            speed: 0.0,
        };
        train.go(kmh / 3.6, 1.0, SpeedEvidence::default());
        train.run(1.0, SpeedEvidence::default());
        train
    }

    fn run(&mut self, seconds: f64, evidence: SpeedEvidence) {
        for _ in 0..(seconds * 100.0) as u32 {
            self.now += SCAN;
            let speed = Speed::from_mps(self.speed);
            let config = &self.config.tacho;
            self.credible.step(
                self.now,
                [speed; 2],
                self.speed > 0.0,
                evidence,
                config,
                &mut self.log,
            );
        }
    }

    /// Drives to a speed at this rate, m/s and m/s².
    fn go(&mut self, to: f64, mps2: f64, evidence: SpeedEvidence) {
        while (self.speed - to).abs() > 1e-9 {
            let step = (to - self.speed).clamp(-mps2 * 0.01, mps2 * 0.01);
            self.speed += step;
            self.run(0.01, evidence);
        }
    }

    fn doubts(&self) -> bool {
        self.credible.doubted().is_some()
    }
}

#[test]
fn a_train_that_brakes_is_believed_and_one_whose_pulses_vanish_is_not() {
    for kmh in [5.0, 15.0, 60.0] {
        let mut train = Train::at(kmh);
        train.go(0.0, 3.3, SpeedEvidence::default());
        train.run(3.0, SpeedEvidence::default());
        assert!(!train.doubts(), "{kmh}");
        let mut train = Train::at(kmh);
        train.go(0.0, 100.0, SpeedEvidence::default());
        train.run(0.2, SpeedEvidence::default());
        assert!(train.doubts(), "{kmh}");
        // As long as a stop takes at the least rate, 0.8 m/s².
        train.run(kmh / 3.6 / 0.8 - 0.5, SpeedEvidence::default());
        assert!(train.doubts(), "{kmh}");
        train.run(2.0, told(15.0));
        assert!(train.doubts(), "TCMS says that it moves");
        train.run(0.02, SpeedEvidence::default());
        assert!(!train.doubts(), "{kmh}");
    }
}

/// A tachometer that counted too much is in order again while the train brakes; the other one
/// shows that.
#[test]
fn noise_that_ends_is_no_fall() {
    let mut train = Train::at(30.0);
    for scan in 0..400 {
        let mps = (30.0 / 3.6 - 0.03 * f64::from(scan)).max(0.0);
        let noise = if scan < 20 { 3.0 } else { 0.0 };
        let speeds = [mps + noise, mps].map(Speed::from_mps);
        train.now += SCAN;
        let config = &train.config.tacho;
        let evidence = SpeedEvidence::default();
        train.credible.step(
            train.now,
            speeds,
            mps > 0.0,
            evidence,
            config,
            &mut train.log,
        );
        assert!(!train.doubts(), "{scan}");
    }
}

#[test]
fn half_of_the_speed_gone_at_once_is_not_believed_either() {
    let mut train = Train::at(60.0);
    train.go(30.0 / 3.6, 100.0, SpeedEvidence::default());
    train.run(0.7, SpeedEvidence::default());
    assert!(train.doubts());
    train.run(5.0, SpeedEvidence::default());
    assert!(!train.doubts(), "pulses are back");
}

/// A TCMS that tells of axles at this speed, km/h.
fn told(kmh: f64) -> SpeedEvidence {
    SpeedEvidence {
        tcms_speed: Some(Speed::from_kmh(kmh)),
        ..SpeedEvidence::default()
    }
}

/// As long as TCMS tells of motion, the train counts as moving at that speed.
#[test]
fn tcms_that_tells_of_motion_is_believed() {
    let mut train = Train::at(0.0);
    train.run(0.7, told(15.0));
    assert!(!train.doubts());
    train.run(0.2, told(15.0));
    let doubted_kmh = train.credible.doubted().map(Speed::kmh);
    assert!(
        doubted_kmh.is_some_and(|kmh| (kmh - 15.0).abs() < 0.1),
        "{doubted_kmh:?}"
    );
    train.run(6.0, told(3.0));
    assert!(train.doubts(), "TCMS says that it moves");
    train.run(0.1, told(1.0));
    assert!(!train.doubts());
}

/// Both tachometers read low alike, which only TCMS can show: a train at 60 km/h that measures 45. Less than 10
/// km/h is what axles slip and slide, and a TCMS slower than the tachometers does not contradict them.
#[test]
fn tachometers_that_both_read_much_less_than_tcms_are_not_believed() {
    for (kmh, doubts) in [(60.0, true), (54.0, false), (0.0, false)] {
        let mut train = Train::at(45.0);
        train.run(3.0, told(kmh));
        assert_eq!(train.doubts(), doubts, "TCMS at {kmh}");
    }
    let mut train = Train::at(45.0);
    train.run(30.0, SpeedEvidence::default());
    assert!(!train.doubts(), "it does not tell");
}

#[test]
fn power_that_moves_nothing_is_cut_until_it_is_acknowledged() {
    let mut train = Train::at(0.0);
    let powers = SpeedEvidence {
        powers: true,
        ..SpeedEvidence::default()
    };
    let ms = f64::from(train.config.tacho.no_pulses_ms);
    train.run(ms / 1e3 - 0.1, powers);
    assert!(!train.credible.cuts_power());
    train.run(0.2, powers);
    assert!(train.credible.cuts_power());
    train.run(1.0, SpeedEvidence::default());
    assert!(train.credible.cuts_power());
    train.run(
        0.1,
        SpeedEvidence {
            acknowledge: true,
            ..SpeedEvidence::default()
        },
    );
    assert!(!train.credible.cuts_power());
}

#[test]
fn test_signals_and_a_dead_guard_are_not_compared() {
    for (tested, unguarded) in [(true, false), (false, true)] {
        let mut train = Train::at(60.0);
        let evidence = SpeedEvidence {
            tested,
            unguarded,
            powers: true,
            ..told(60.0)
        };
        train.go(0.0, 100.0, evidence);
        train.run(10.0, evidence);
        assert!(!train.doubts() && !train.credible.cuts_power());
    }
}
