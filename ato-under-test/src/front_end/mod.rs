//! Antennas, sensors, contacts and relays: everything between the terminals and the processors.
//!
//! Test signals join here, and injected faults act here, each at its own place in the signal path.

mod delay_queue;
mod effort;
mod outputs;
mod relay_watch;
mod sensors;
mod stored_data;
mod supply;

use protocol::injection::{Effect, Place};
use protocol::message::{IoInput, ModeSwitch, TrainLines};
use protocol::{Duration, Instant};

pub use delay_queue::DelayQueue;
pub use effort::EffortOutput;
pub use outputs::OutputStage;
pub use relay_watch::RelayWatch;
pub use sensors::PulseSensor;
pub use stored_data::apply_stored_data_faults;
pub use supply::{PowerAndClock, Supply};

use crate::com::IoImage;
use crate::faults::Faults;
use crate::signals::{AntennaSignal, Inputs, MarkerPulse, Pulses};
use crate::test_board::TestBoard;
use crate::timer::at_rate;

/// The inputs of one scan, with the test signals and without.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScannedInputs {
    /// Inputs of receiver and pulse inputs: the TEST board's signal where the board makes one.
    pub tested: Inputs,
    /// Inputs from the train and the track alone. A receiver that hears a test signal hears no track.
    pub train: Inputs,
    /// The track's signal behind the antenna, also while the receiver hears another.
    pub track: AntennaSignal,
    /// The receiver hears a test signal.
    pub receiver_taken: bool,
}

/// Signal that the receiver hands on, and signal in the rail.
struct Received {
    signal: AntennaSignal,
    track: AntennaSignal,
    from_track: bool,
}

#[derive(Debug)]
pub struct FrontEnd {
    sensors: [PulseSensor; 2],
    marker_edges: Option<u8>,
    /// Pulses that a bouncing TRA gives a second time, and whether they are of the test marker.
    bounces: DelayQueue<(MarkerPulse, bool)>,
    held_signal: AntennaSignal,
    metres_per_pulse: f64,
    /// Least ratio of the levels of two codes of which the stronger is heard.
    apart: f64,
}

impl FrontEnd {
    /// Two speed sensors of this resolution, one ATP antenna whose receiver tells codes apart that differ by so many
    /// dB, one marker antenna with TRA.
    pub fn new(metres_per_pulse: f64, apart_db: f64) -> Self {
        Self {
            sensors: [PulseSensor::default(), PulseSensor::default()],
            marker_edges: None,
            bounces: DelayQueue::default(),
            held_signal: AntennaSignal::default(),
            metres_per_pulse,
            apart: libm::pow(10.0, apart_db / 20.0),
        }
    }

    /// Reads all inputs once: with the test signals, as the receiver and the pulse inputs have them.
    ///
    /// `built_in` is what the self-test feeds into the ATP receiver in the antenna's place.
    pub fn scan(
        &mut self,
        now: Instant,
        image: &IoImage,
        board: &mut TestBoard,
        built_in: Option<AntennaSignal>,
        faults: &mut Faults,
    ) -> ScannedInputs {
        let input = image.input();
        board.suffer(faults);
        let test_pulses = board.step_speed(now);
        let mut pulses = [Pulses::default(); 2];
        let mut train_pulses = pulses;
        for (i, sensor) in self.sensors.iter_mut().enumerate() {
            let place = [Place::SpeedSensor1, Place::SpeedSensor2][i];
            let raw = input.map(|(frame, at)| raw_pulses(frame, at, i, image.clock_rate));
            train_pulses[i] = sensor.read(raw, place, faults);
            if !image.alive {
                train_pulses[i].sampled_at = now;
            }
            pulses[i] = test_pulses[i].unwrap_or(train_pulses[i]);
        }
        let turned = self.sensors.iter().map(|sensor| sensor.turned).max();
        faults.roll(f64::from(turned.unwrap_or(0)) * self.metres_per_pulse);
        let alive = input.filter(|_| image.alive);
        let frame = alive.map(|(frame, _)| *frame).unwrap_or_default();
        let mut own = in_antenna(frame.carrier_hz, frame.code_rate_chz, frame.level_mv);
        if let Some(sampled) = image.sampled.as_ref() {
            (own.heard_for, own.lags) = (sampled.heard_for, sampled.lags);
        }
        let second = image.crosstalk();
        let second = second.map(|it| in_antenna(it.carrier_hz, it.code_rate_chz, it.level_mv));
        let track = self.separate(own, second, faults);
        let is_wave = image.sampled.as_ref().is_some();
        let received = self.receive((track, is_wave), board.code(), built_in, faults);
        let marker_age = image.sampled.as_ref().map(|sampled| sampled.marker_age);
        let frame_of_marker = input.map(|(frame, _)| (frame, marker_age));
        let (marker, from_board) = self.marker(now, frame_of_marker, board, faults);
        let tested = Inputs {
            alive: image.alive,
            signal: match built_in {
                Some(_) => AntennaSignal::default(),
                None => received.signal,
            },
            self_test_signal: built_in.map(|_| received.signal),
            pulses,
            test_speed: test_pulses.map(|pulses| pulses.is_some()),
            marker,
            tra_answers: !faults.loses(Place::Tra),
            lines: lines(frame.lines, faults),
            mode_switch: match faults.at(Place::ModeInput) {
                Some(_) => ModeSwitch::Off,
                None => frame.mode_switch,
            },
            controller: match faults.at(Place::ControllerInput) {
                Some(_) => 0,
                None => frame.controller,
            },
        };
        let train = Inputs {
            signal: match received.from_track {
                true => received.signal,
                false => AntennaSignal::default(),
            },
            pulses: train_pulses,
            test_speed: [false; 2],
            marker: marker.filter(|_| !from_board),
            ..tested
        };
        ScannedInputs {
            tested,
            train,
            track: received.track,
            receiver_taken: !received.from_track,
        }
    }

    /// Signal that is heard of a code and the code of a neighbouring track circuit: the stronger, if the weaker does
    /// not come near to it. Otherwise they disturb each other, and nothing is heard.
    fn separate(
        &self,
        own: AntennaSignal,
        second: Option<AntennaSignal>,
        faults: &Faults,
    ) -> AntennaSignal {
        let Some(second) = second.filter(|second| second.level_mv > 0.0) else {
            return own;
        };
        let (stronger, weaker) = match second.level_mv > own.level_mv {
            true => (second, own),
            false => (own, second),
        };
        if faults.dead(Place::CodeSeparation) && weaker.level_mv > 0.0 {
            return weaker;
        }
        match stronger.level_mv >= weaker.level_mv * self.apart {
            true => stronger,
            false => AntennaSignal::default(),
        }
    }

    /// Antenna and receiver: the stronger of track and test coil through the antenna; the self-test's built-in code
    /// enters behind the antenna and is heard alone. A track signal that `is_wave` comes from a waveform, which the
    /// faults that weaken it have weakened already.
    fn receive(
        &mut self,
        (mut track, is_wave): (AntennaSignal, bool),
        coil: Option<AntennaSignal>,
        built_in: Option<AntennaSignal>,
        faults: &mut Faults,
    ) -> Received {
        let coil = coil.filter(|coil| coil.level_mv >= track.level_mv);
        let through_antenna = match faults.at(Place::AtpAntenna) {
            Some(Effect::Dead) => 0.0,
            Some(Effect::Gain { factor }) => factor,
            _ => 1.0,
        };
        if !is_wave {
            track.level_mv *= through_antenna;
        }
        let coil = coil.map(|coil| AntennaSignal {
            level_mv: coil.level_mv * through_antenna,
            ..coil
        });
        let from_track = coil.is_none() && built_in.is_none();
        let mut signal = built_in.or(coil).unwrap_or(track);
        match faults.at(Place::AtpReceiver) {
            Some(Effect::Dead) => signal = AntennaSignal::default(),
            Some(Effect::Gain { .. }) if is_wave && from_track => {}
            Some(Effect::Gain { factor }) => signal.level_mv *= factor,
            Some(Effect::Limit { to }) => signal.rate_hz = signal.rate_hz.min(to),
            Some(Effect::Offset { by }) if signal.rate_hz > 0.0 => signal.rate_hz += by,
            Some(Effect::StuckOn) if self.held_signal.level_mv > 0.0 => signal = self.held_signal,
            _ => {}
        }
        self.held_signal = signal;
        Received {
            signal,
            track,
            from_track,
        }
    }

    /// Marker antenna and TRA: the pulse, and whether it is of the test marker.
    fn marker(
        &mut self,
        now: Instant,
        frame: Option<(&IoInput, Option<Duration>)>,
        board: &mut TestBoard,
        faults: &mut Faults,
    ) -> (Option<MarkerPulse>, bool) {
        let before = self.marker_edges;
        self.marker_edges = frame.map(|(frame, _)| frame.marker_edges);
        let passed = match (before, frame) {
            (Some(before), Some((frame, age))) if before != frame.marker_edges => {
                Some(MarkerPulse {
                    marker: frame.marker,
                    age_us: age.map_or(u32::from(frame.marker_edge_us), |age| {
                        u32::try_from(age.as_us()).unwrap_or(u32::MAX)
                    }),
                })
            }
            _ => None,
        };
        let made = board
            .take_marker(faults)
            .map(|marker| MarkerPulse { marker, age_us: 0 });
        let pulse = made
            .or(passed)
            // TRA has four inputs; anything else on the wire is no marker.
            .filter(|pulse| matches!(pulse.marker, 1..=4));
        let Some(pulse) = pulse else {
            let again = self.bounces.pop(now);
            return again.map_or((None, false), |(pulse, made)| (Some(pulse), made));
        };
        let deaf = match faults.at(Place::MarkerAntenna) {
            Some(Effect::Deaf { to_marker }) => pulse.marker == to_marker,
            _ => faults.loses(Place::MarkerAntenna),
        };
        let heard = !deaf && !faults.loses(Place::Tra);
        if let (true, Some(Effect::Bounce { ms })) = (heard, faults.at(Place::Tra)) {
            let again = MarkerPulse { age_us: 0, ..pulse };
            let due = now + Duration::from_ms(u64::from(ms));
            self.bounces.push(due, (again, made.is_some()));
        }
        (heard.then_some(pulse), made.is_some())
    }
}

/// Share of a waveform's level that injected faults leave between rail and ATP receiver.
pub fn atp_gain(faults: &Faults) -> f32 {
    let of = |place| match faults.at(place) {
        Some(Effect::Dead) => 0.0,
        Some(Effect::Gain { factor }) => factor as f32,
        _ => 1.0,
    };
    of(Place::AtpAntenna) * of(Place::AtpReceiver)
}

/// Signal in the antenna, from the numbers of an input frame.
fn in_antenna(carrier_hz: u16, rate_chz: u16, level_mv: u16) -> AntennaSignal {
    AntennaSignal {
        carrier_hz: f64::from(carrier_hz),
        rate_hz: f64::from(rate_chz) / 100.0,
        level_mv: f64::from(level_mv),
        heard_for: Duration::ZERO,
        lags: Duration::ZERO,
    }
}

/// One tachometer's part of an input frame: wrapping count, edge and sampling time, phase.
fn raw_pulses(frame: &IoInput, at: Instant, channel: usize, clock_rate: f64) -> (u16, Pulses) {
    let (count, edge_us) = match channel {
        0 => (frame.tacho1_count, frame.tacho1_edge_us),
        _ => (frame.tacho2_count, frame.tacho2_edge_us),
    };
    let pulses = Pulses {
        count: 0,
        edge_at: at.back(at_rate(Duration::from_us(u64::from(edge_us)), clock_rate)),
        sampled_at: at,
        backward: frame.tacho_backward & (1 << channel) != 0,
    };
    (count, pulses)
}

const LEFT_DOORS: TrainLines = TrainLines::LEFT_CLOSED.union(TrainLines::LEFT_LOCKED);
const RIGHT_DOORS: TrainLines = TrainLines::RIGHT_CLOSED.union(TrainLines::RIGHT_LOCKED);

fn lines(mut lines: TrainLines, faults: &Faults) -> TrainLines {
    for (place, line) in [
        (
            Place::DoorInput,
            TrainLines::DOORS_CLOSED | LEFT_DOORS | RIGHT_DOORS,
        ),
        (Place::DoorInputLeft, LEFT_DOORS),
        (Place::DoorInputRight, RIGHT_DOORS),
        (Place::CabInput, TrainLines::HCR),
    ] {
        match faults.at(place) {
            Some(Effect::StuckOn) => lines.insert(line),
            Some(Effect::StuckOff | Effect::Dead) => lines.remove(line),
            _ => {}
        }
    }
    lines
}
