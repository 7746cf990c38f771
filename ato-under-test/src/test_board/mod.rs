//! TEST board: makes the test signals an armed tester asks for [S2 §2.2].
//!
//! Its code goes into the ATP test coil, its speed signal replaces the tachometers, its marker
//! pulse goes to the test marker; its TEST modem talks to the unit through the TWC antenna. What it reads
//! back for the tester is measured where the signals leave it.

mod defects;
mod modem;
mod speed_generator;

use protocol::injection::Place;
use protocol::message::{
    Answer, TestCode, TestMarker, TestRelease, TestSignals, TestSpeed, TestTwc, TwcWayside,
};
use protocol::{Instant, Speed};

use crate::faults::Faults;
use crate::signals::{AntennaSignal, Pulses};
use defects::Defects;
use modem::TestModem;
use speed_generator::SpeedGenerator;

/// Greatest level of the code generator, mV.
const LEVEL_MAX_MV: u16 = 3000;
/// Greatest speed of the speed generator, cm/s.
const SPEED_MAX_CMS: u16 = 3000;

#[derive(Debug, Default)]
pub struct TestBoard {
    metres_per_pulse: f64,
    code: Option<AntennaSignal>,
    speed: Option<SpeedGenerator>,
    marker: Option<u8>,
    pub modem: TestModem,
    defects: Defects,
    /// Speed pulses made since power-up, wrapping.
    pub pulses: u16,
    /// Marker pulses made since power-up, wrapping.
    pub markers: u8,
}

impl TestBoard {
    /// A board whose speed generator imitates tachometers of this resolution.
    pub fn new(metres_per_pulse: f64) -> Self {
        Self {
            metres_per_pulse,
            ..Self::default()
        }
    }

    /// Sets the way that a pulse stands for, m, while the board makes none.
    pub fn set_pulse(&mut self, pulse_m: f64) {
        self.metres_per_pulse = pulse_m;
    }

    /// Takes over the board's injected faults of this scan; a dead board makes no signal.
    pub fn suffer(&mut self, faults: &Faults) {
        self.defects = Defects::of(faults);
        if self.defects.dead {
            self.release_all();
        }
    }

    /// The board answers its CPU.
    pub fn answers(&self) -> bool {
        !self.defects.dead
    }

    fn take(&self, in_range: bool) -> Answer {
        match (self.defects.dead, in_range) {
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
                ..AntennaSignal::default()
            });
        }
        answer
    }

    pub fn set_speed(&mut self, request: TestSpeed) -> Answer {
        let in_range = request.speed_cms <= SPEED_MAX_CMS
            && matches!(request.channels, 1..=3)
            && request.backward <= 1;
        let answer = self.take(in_range);
        if answer == Answer::Accepted {
            let metres_per_pulse = self.metres_per_pulse;
            self.speed
                .get_or_insert_with(|| SpeedGenerator::new(metres_per_pulse))
                .go(request);
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
            self.modem.send(now, data);
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
            self.modem.stop();
        }
        self.marker = None;
    }

    pub fn release_all(&mut self) {
        self.release(TestRelease {
            session: 0,
            signals: TestSignals::all(),
        });
    }

    /// Signal that leaves the code generator, into the ATP test coil.
    pub fn code(&self) -> Option<AntennaSignal> {
        self.code.map(|asked| self.defects.leaves(asked))
    }

    /// Speed of the pulses that leave the speed generator.
    pub fn speed(&self) -> Option<Speed> {
        self.speed.as_ref().map(SpeedGenerator::measured)
    }

    pub fn signals(&self) -> TestSignals {
        let mut signals = TestSignals::empty();
        signals.set(TestSignals::CODE, self.code.is_some());
        signals.set(TestSignals::TWC, self.modem.sends());
        if let Some(generator) = &self.speed {
            signals.set(TestSignals::SPEED_1, generator.drives(0));
            signals.set(TestSignals::SPEED_2, generator.drives(1));
        }
        signals
    }

    /// Pulses made in one scan for each input, `None` where the sensor stays connected.
    pub fn step_speed(&mut self, now: Instant) -> [Option<Pulses>; 2] {
        let Some(generator) = &mut self.speed else {
            return [None; 2];
        };
        let pulses = generator.step(now, self.defects.speed_gain);
        self.pulses = self.pulses.wrapping_add(pulses.count as u16);
        [0, 1].map(|channel| generator.drives(channel).then_some(pulses))
    }

    /// The marker pulse asked for, once, if one leaves the board.
    pub fn take_marker(&mut self, faults: &mut Faults) -> Option<u8> {
        let marker = self
            .marker
            .take()
            .filter(|_| !faults.loses(Place::TestMarker))?;
        self.markers = self.markers.wrapping_add(1);
        Some(marker)
    }
}
