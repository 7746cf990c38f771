//! Compares two tachometers: speed, distance, direction and standstill, which of the two has failed, and whether both
//! are believed.

use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::{Duration, Instant, Speed};

use crate::atp::credible_speed::{CredibleSpeed, SpeedEvidence};
use crate::kernel::{EventLog, hundredths};
use crate::signals::Inputs;
use crate::speedometer::Speedometer;
use crate::timer::{Burst, OnDelay, ms};

/// A channel slower than this beside a turning one counts as dead rather than as different.
const DEAD_BELOW: Speed = Speed::from_kmh(1.0);
/// Scans with an impossible jump within [`NOISE_SPAN`] that make a channel noisy: more than one spurious pulse can
/// make. Beside the first pulses after standstill, a spurious one shows for less than 50 ms: for as long as one pulse
/// more in so short a window is a jump, and until the pulse after that.
const NOISE_SCANS: u32 = 6;
/// Span in which scans with a jump are counted.
const NOISE_SPAN: Duration = Duration::from_ms(1000);

#[derive(Clone, Debug)]
pub struct Tachometers {
    meters: [Speedometer; 2],
    noise: [Burst; 2],
    from_board: [bool; 2],
    differ: OnDelay,
    opposed: OnDelay,
    faulty: bool,
    slow: OnDelay,
    standstill: bool,
    silent: OnDelay,
    still: bool,
    last_pulse: Instant,
    /// Way by each channel at a speed that counts as standing, since the wheels last stood still, m.
    crept_m: [f64; 2],
    /// The greater of the channels' changes of speed that adhesion does not explain, m/s²; `None` = both roll.
    pub loose_mps2: Option<f64>,
    /// Way by each channel in this scan, m, backward negative.
    pub ways_m: [f64; 2],
    /// The channel that counts the distance, 0 or 1.
    pub distance_channel: usize,
    pub credible: CredibleSpeed,
    /// Share by which the train is faster than its wheels tell.
    farther: f64,
}

impl Tachometers {
    /// No wheel has made more than a lone pulse for the time of standstill.
    pub fn still(&self) -> bool {
        self.still
    }

    pub fn standstill(&self) -> bool {
        self.standstill
    }

    /// Tachometers of a train that stands.
    pub fn new(config: &UnitConfig) -> Self {
        let window = ms(config.tacho.window_ms);
        let meter = || Speedometer::new(window, config.metres_per_pulse());
        Self {
            meters: [meter(), meter()],
            noise: Default::default(),
            from_board: [false; 2],
            differ: OnDelay::default(),
            opposed: OnDelay::default(),
            faulty: false,
            slow: OnDelay::default(),
            standstill: false,
            silent: OnDelay::default(),
            still: false,
            last_pulse: Instant::ZERO,
            crept_m: [0.0; 2],
            loose_mps2: None,
            ways_m: [0.0; 2],
            distance_channel: 0,
            credible: CredibleSpeed::default(),
            farther: 0.0,
        }
    }

    /// Sets the share by which the wheels run farther than is measured, as markers have proved.
    pub fn correct(&mut self, farther: f64) {
        self.farther = farther;
    }

    /// Sets the way that a pulse stands for, m, while the train stands.
    pub fn set_pulse(&mut self, pulse_m: f64) {
        self.meters
            .iter_mut()
            .for_each(|meter| meter.set_pulse(pulse_m));
    }

    /// One scan; `evidence` is of the same `inputs`.
    pub fn step(
        &mut self,
        now: Instant,
        inputs: &Inputs,
        evidence: SpeedEvidence,
        config: &UnitConfig,
        log: &mut EventLog,
    ) {
        self.loose_mps2 = None;
        let metres_per_pulse = config.metres_per_pulse();
        self.ways_m = inputs.pulses.map(|pulses| pulses.way_m(metres_per_pulse));
        for i in 0..2 {
            if self.from_board[i] != inputs.test_speed[i] {
                self.from_board[i] = inputs.test_speed[i];
                self.meters[i].reset();
                self.noise[i] = Burst::default();
            }
            let jump = self.meters[i].step(&inputs.pulses[i]);
            let impossible = Speedometer::impossible(jump, config.tacho.plausible_accel_mps2);
            let loose = Speedometer::accel_beyond(jump, config.tacho.adhesion);
            if loose.is_some_and(|mps2| mps2 > self.loose_mps2.unwrap_or_default()) {
                self.loose_mps2 = loose;
            }
            let event = [Event::TachoNoise1, Event::TachoNoise2][i];
            if self.noise[i].tells_many(now, impossible, NOISE_SCANS, NOISE_SPAN) {
                log.push(now, event, hundredths(jump));
            }
        }
        self.compare(now, inputs, config, log);
        // Channel 1 counts the distance, or channel 2 when it alone turns.
        let first_dead = self.meters[0].speed < DEAD_BELOW && self.meters[1].speed > DEAD_BELOW;
        self.distance_channel = usize::from(first_dead);
        let silent = inputs.pulses.iter().all(|pulses| pulses.count == 0);
        let speeds = [0, 1].map(|i| self.meters[i].speed);
        self.credible
            .step(now, speeds, !silent, evidence, &config.tacho, log);
        let told = evidence.tcms_moves(&config.tacho) && !evidence.tested && !evidence.unguarded;
        let doubted = self.credible.doubted().is_some();
        let slow = self.speed().kmh() <= config.tacho.standstill_kmh && !told && !doubted;
        let span = ms(config.tacho.standstill_ms);
        self.standstill = self.slow.update(now, slow, span);
        // A train that creeps makes pulses in both channels, and more than one: a lone one is spurious.
        let pulses: u64 = inputs.pulses.iter().map(|of| u64::from(of.count)).sum();
        let lone = pulses == 1 && now.since(self.last_pulse) >= span;
        if pulses > 0 {
            self.last_pulse = now;
        }
        let quiet = (pulses == 0 || lone) && !told && !doubted;
        self.still = self.silent.update(now, quiet, span);
        for (crept_m, way_m) in self.crept_m.iter_mut().zip(self.ways_m) {
            *crept_m = match slow && !self.still {
                true => *crept_m + way_m,
                false => 0.0,
            };
        }
    }

    fn compare(&mut self, now: Instant, inputs: &Inputs, config: &UnitConfig, log: &mut EventLog) {
        let tacho = &config.tacho;
        let (one, two) = (self.meters[0].speed, self.meters[1].speed);
        let difference = one.difference(two);
        let span = ms(tacho.difference_ms);
        let differ = self
            .differ
            .update(now, difference.kmh() > tacho.difference_kmh, span);
        let turning = one.kmh() > tacho.standstill_kmh && two.kmh() > tacho.standstill_kmh;
        let against = inputs.pulses[0].backward != inputs.pulses[1].backward;
        let opposed = self.opposed.update(now, turning && against, span);
        let faulty = differ || opposed;
        if faulty && !self.faulty {
            // Beside a noisy channel a silent one need not be dead.
            let believed = [!self.noise[0].told(), !self.noise[1].told()];
            match (one < DEAD_BELOW, two < DEAD_BELOW) {
                (true, false) if believed[1] => {
                    log.push(now, Event::TachoDead1, i32::from(two.to_cms()));
                }
                (false, true) if believed[0] => {
                    log.push(now, Event::TachoDead2, i32::from(one.to_cms()));
                }
                _ if opposed => log.push(now, Event::TachoDirection, 0),
                _ => log.push(now, Event::TachoDisagree, i32::from(difference.to_cms())),
            }
        }
        self.faulty = faulty;
    }

    /// The greater of the two channels' speeds.
    fn measured(&self) -> Speed {
        let greater = self.meters[0].speed.max(self.meters[1].speed);
        Speed::from_mps(greater.mps() * (1.0 + self.farther) * (1.0 + self.credible.clock_fast))
    }

    /// The safe speed: the greater of the two, or the speed that the train may still have where they are not believed.
    pub fn speed(&self) -> Speed {
        self.measured()
            .max(self.credible.doubted().unwrap_or(Speed::ZERO))
    }

    /// Speed of channel 0 or 1.
    pub fn channel(&self, i: usize) -> Speed {
        self.meters[i].speed
    }

    /// The channels cannot both be right, or neither is believed.
    pub fn faulty(&self) -> bool {
        self.faulty || self.credible.doubted().is_some()
    }

    /// The train moves: it is faster than a standing one can be, or creeps farther without a stop.
    pub fn moves(&self, config: &UnitConfig) -> bool {
        let far = |way_m: &f64| libm::fabs(*way_m) > config.tacho.creep_m;
        self.speed().kmh() > config.tacho.standstill_kmh || self.crept_m.iter().any(far)
    }

    /// Distance run in this scan, m, backward negative.
    pub fn moved_m(&self) -> f64 {
        self.ways_m[self.distance_channel]
    }

    /// The greater way in this scan, m.
    pub fn farthest_m(&self) -> f64 {
        libm::fabs(self.ways_m[0]).max(libm::fabs(self.ways_m[1]))
    }
}
