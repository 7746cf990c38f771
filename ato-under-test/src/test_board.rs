//! TEST board: makes the test signals an armed tester asks for [S2 §2.2].
//!
//! Its code goes into the ATP test coil, its speed signal replaces the tachometers, its marker
//! pulse goes to the test marker, its station data to the TWC TEST module. It reads back what it
//! makes, for the status.

use protocol::message::{
    Answer, TestCode, TestMarker, TestRelease, TestSignals, TestSpeed, TestTwc, TwcWayside,
};
use protocol::{Duration, Instant, SCAN, Speed};

use crate::signals::{AntennaSignal, Pulses};

/// Greatest level of the code generator, mV.
const LEVEL_MAX_MV: u16 = 3000;
/// Greatest speed of the speed generator, cm/s.
const SPEED_MAX_CMS: u16 = 3000;
/// Acceleration of the speed generator when none is asked for, mm/s².
const OWN_ACCEL_MMS2: u16 = 3000;
/// Period in which the TWC TEST module repeats its station data.
const TWC_PERIOD: Duration = Duration::from_ms(250);

#[derive(Debug)]
pub struct TestBoard {
    metres_per_pulse: f64,
    code: Option<AntennaSignal>,
    speed: Option<SpeedGenerator>,
    marker: Option<u8>,
    twc: Option<(TwcWayside, Instant)>,
    dead: bool,
    /// Pulses made for one that should be.
    speed_gain: f64,
}

#[derive(Debug)]
struct SpeedGenerator {
    request: TestSpeed,
    speed: Speed,
    pulses: f64,
}

impl TestBoard {
    /// A board whose speed generator imitates tachometers of this resolution.
    pub fn new(metres_per_pulse: f64) -> Self {
        Self {
            metres_per_pulse,
            code: None,
            speed: None,
            marker: None,
            twc: None,
            dead: false,
            speed_gain: 1.0,
        }
    }

    /// Whether the board works; a dead one makes nothing.
    pub fn set_dead(&mut self, dead: bool) {
        self.dead = dead;
        if dead {
            self.release(TestRelease {
                session: 0,
                signals: TestSignals::all(),
            });
        }
    }

    /// How many pulses the speed generator makes for one that it should.
    pub fn set_speed_gain(&mut self, gain: f64) {
        self.speed_gain = gain;
    }

    /// The board answers its CPU.
    pub fn answers(&self) -> bool {
        !self.dead
    }

    fn take(&self, in_range: bool) -> Answer {
        match (self.dead, in_range) {
            (true, _) => Answer::BoardFailed,
            (false, false) => Answer::OutOfRange,
            (false, true) => Answer::Accepted,
        }
    }

    pub fn set_code(&mut self, request: TestCode) -> Answer {
        let answer = self.take(request.level_mv <= LEVEL_MAX_MV);
        if answer == Answer::Accepted {
            self.code = Some(AntennaSignal {
                carrier_hz: f64::from(request.carrier_hz),
                rate_hz: f64::from(request.code_rate_chz) / 100.0,
                level_mv: f64::from(request.level_mv),
            });
        }
        answer
    }

    pub fn set_speed(&mut self, mut request: TestSpeed) -> Answer {
        let in_range = request.speed_cms <= SPEED_MAX_CMS
            && matches!(request.channels, 1..=3)
            && request.backward <= 1;
        let answer = self.take(in_range);
        if answer == Answer::Accepted {
            if request.accel_mms2 == 0 {
                request.accel_mms2 = OWN_ACCEL_MMS2;
            }
            match &mut self.speed {
                Some(generator) => generator.request = request,
                none => {
                    *none = Some(SpeedGenerator {
                        request,
                        speed: Speed::ZERO,
                        pulses: 0.0,
                    });
                }
            }
        }
        answer
    }

    pub fn set_marker(&mut self, request: TestMarker) -> Answer {
        let answer = self.take(matches!(request.marker, 1..=4));
        if answer == Answer::Accepted {
            self.marker = Some(request.marker);
        }
        answer
    }

    pub fn set_twc(&mut self, now: Instant, request: TestTwc) -> Answer {
        let in_range = request.running_mode.is_known()
            && request.door_side.is_known()
            && request.departure <= 1;
        let answer = self.take(in_range);
        if answer == Answer::Accepted {
            let data = TwcWayside {
                route: request.route,
                section: request.section,
                station: request.station,
                next_station: request.next_station,
                loop_id: request.loop_id,
                fixed_speed_kmh: request.fixed_speed_kmh,
                running_mode: request.running_mode,
                door_side: request.door_side,
                departure: request.departure,
                train_number: request.train_number,
            };
            self.twc = Some((data, now));
        }
        answer
    }

    pub fn release(&mut self, request: TestRelease) {
        let signals = request.signals;
        if signals.contains(TestSignals::CODE) {
            self.code = None;
        }
        if signals.intersects(TestSignals::SPEED_1 | TestSignals::SPEED_2) {
            self.speed = None;
        }
        if signals.contains(TestSignals::TWC) {
            self.twc = None;
        }
        self.marker = None;
    }

    pub fn release_all(&mut self) {
        self.release(TestRelease {
            session: 0,
            signals: TestSignals::all(),
        });
    }

    /// Code in the test coil.
    pub fn code(&self) -> Option<AntennaSignal> {
        self.code
    }

    /// Speed the generator makes now.
    pub fn speed(&self) -> Option<Speed> {
        self.speed.as_ref().map(|generator| generator.speed)
    }

    pub fn signals(&self) -> TestSignals {
        let mut signals = TestSignals::empty();
        signals.set(TestSignals::CODE, self.code.is_some());
        signals.set(TestSignals::TWC, self.twc.is_some());
        if let Some(generator) = &self.speed {
            signals.set(TestSignals::SPEED_1, generator.request.channels & 1 != 0);
            signals.set(TestSignals::SPEED_2, generator.request.channels & 2 != 0);
        }
        signals
    }

    /// Pulses made in one scan for each input, `None` where the sensor stays connected.
    pub fn step_speed(&mut self, now: Instant) -> [Option<Pulses>; 2] {
        let Some(generator) = &mut self.speed else {
            return [None; 2];
        };
        let request = generator.request;
        let goal = f64::from(request.speed_cms) / 100.0;
        let step = f64::from(request.accel_mms2) / 1000.0 * SCAN.as_secs();
        let speed = generator.speed.mps();
        let speed = speed + (goal - speed).clamp(-step, step);
        generator.speed = Speed::from_mps(speed);

        let speed = speed * self.speed_gain;
        let made = speed * SCAN.as_secs() / self.metres_per_pulse;
        let before = libm::floor(generator.pulses);
        generator.pulses += made;
        let count = libm::floor(generator.pulses) - before;
        let beyond = generator.pulses - libm::floor(generator.pulses);
        let age_s = if speed > 0.0 {
            beyond * self.metres_per_pulse / speed
        } else {
            0.0
        };
        let pulses = Pulses {
            count: count as u32,
            edge_at: now.back(Duration::from_secs(age_s)),
            sampled_at: now,
            backward: request.backward != 0,
        };
        [
            (request.channels & 1 != 0).then_some(pulses),
            (request.channels & 2 != 0).then_some(pulses),
        ]
    }

    /// The marker pulse asked for, once.
    pub fn take_marker(&mut self) -> Option<u8> {
        self.marker.take()
    }

    /// Station data when they are due.
    pub fn take_twc(&mut self, now: Instant) -> Option<TwcWayside> {
        let (data, due) = self.twc.as_mut()?;
        if now < *due {
            return None;
        }
        *due = now + TWC_PERIOD;
        Some(*data)
    }

    /// A TEST module is making station data.
    pub fn makes_twc(&self) -> bool {
        self.twc.is_some()
    }
}
