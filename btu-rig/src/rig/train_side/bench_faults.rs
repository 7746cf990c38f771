//! Faults of the bench itself and of its wires to the unit: what is sent is not what was asked for, and what is read is
//! not what the unit says. The signals that are recorded are those that were asked for, as on a bench that does not know of
//! its fault.

use protocol::injection::{Effect, FaultMode, Place};
use protocol::message::{Crosstalk, IoInput, Outputs, TrainLines};

/// Inputs of the unit that a broken door wire leaves without voltage.
const DOOR_LINES: TrainLines = TrainLines::DOORS_CLOSED
    .union(TrainLines::LEFT_CLOSED)
    .union(TrainLines::LEFT_LOCKED)
    .union(TrainLines::RIGHT_CLOSED)
    .union(TrainLines::RIGHT_LOCKED);
const DOOR_ENABLES: Outputs = Outputs::DOOR_ENABLE_LEFT.union(Outputs::DOOR_ENABLE_RIGHT);

/// Faults of the bench that act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchFaults {
    /// Factor on the level of the code; 0 = no code comes.
    level_factor: f64,
    carrier_offset_hz: f64,
    rate_offset_hz: f64,
    /// Pulses sent for each that was asked for.
    pulse_factor: f64,
    /// Nothing comes through the wire of speed sensor 1.
    speed_1_dead: bool,
    markers_dead: bool,
    /// No frame of the wayside leaves the bench's loop.
    pub twc_dead: bool,
    /// Lines of the unit without voltage.
    dead_lines: TrainLines,
    /// Contacts that are read as closed; those of `read_open` are read as open.
    read_closed: Outputs,
    read_open: Outputs,
}

impl Default for BenchFaults {
    fn default() -> Self {
        Self {
            level_factor: 1.0,
            carrier_offset_hz: 0.0,
            rate_offset_hz: 0.0,
            pulse_factor: 1.0,
            speed_1_dead: false,
            markers_dead: false,
            twc_dead: false,
            dead_lines: TrainLines::empty(),
            read_closed: Outputs::empty(),
            read_open: Outputs::empty(),
        }
    }
}

impl BenchFaults {
    /// Adds a fault mode of the bench; the catalogue lets only these effects happen at these places.
    pub fn add(&mut self, mode: &FaultMode, effect: Effect) {
        match (mode.place, effect) {
            (Place::BenchLevel, Effect::Dead) => self.level_factor = 0.0,
            (Place::BenchLevel, Effect::Gain { factor }) => self.level_factor *= factor,
            (Place::BenchCarrier, Effect::Offset { by }) => self.carrier_offset_hz += by,
            (Place::BenchRate, Effect::Offset { by }) => self.rate_offset_hz += by,
            (Place::BenchSpeed, Effect::Gain { factor }) => self.pulse_factor *= factor,
            (Place::WireSpeed1, Effect::Dead) => self.speed_1_dead = true,
            (Place::BenchMarker, Effect::Dead) => self.markers_dead = true,
            (Place::BenchTwc, Effect::Dead) => self.twc_dead = true,
            (Place::WireDoors, Effect::StuckOff) => self.dead_lines |= DOOR_LINES,
            (Place::WireHcr, Effect::StuckOff) => self.dead_lines |= TrainLines::HCR,
            // The relay's contact is closed while the emergency brake is released.
            (Place::BenchEb, Effect::StuckOn) => self.read_closed |= Outputs::EB_RELAY,
            (Place::BenchEb, Effect::StuckOff) => self.read_open |= Outputs::EB_RELAY,
            (Place::BenchFsb, Effect::StuckOn) => self.read_closed |= Outputs::FSB,
            (Place::BenchFsb, Effect::StuckOff) => self.read_open |= Outputs::FSB,
            (Place::BenchDoors, Effect::StuckOff) => self.read_open |= DOOR_ENABLES,
            _ => {}
        }
    }

    /// Contacts of the unit as the bench reads them.
    pub fn read(&self, outputs: Outputs) -> Outputs {
        (outputs | self.read_closed) - self.read_open
    }

    /// The second code (of a neighbouring track circuit) as it leaves the bench.
    pub fn second(&self, second: Crosstalk) -> Crosstalk {
        Crosstalk {
            carrier_hz: self.carrier_hz(second.carrier_hz),
            code_rate_chz: self.rate_chz(second.code_rate_chz),
            level_mv: self.level_mv(second.level_mv),
        }
    }

    fn carrier_hz(&self, asked_hz: u16) -> u16 {
        moved(asked_hz, self.carrier_offset_hz)
    }

    fn rate_chz(&self, asked_chz: u16) -> u16 {
        moved(asked_chz, 100.0 * self.rate_offset_hz)
    }

    fn level_mv(&self, asked_mv: u16) -> u16 {
        (f64::from(asked_mv) * self.level_factor).round() as u16
    }
}

/// `asked` Hz moved by `by` Hz; 0, which stands for no signal, stays 0.
fn moved(asked: u16, by: f64) -> u16 {
    match asked {
        0 => 0,
        asked => (f64::from(asked) + by).round().max(1.0) as u16,
    }
}

/// The bench's outputs on their way to the unit.
#[derive(Debug, Default)]
pub struct Wires {
    /// Pulses asked for so far, and those sent, of each speed sensor.
    asked: [u16; 2],
    sent: [f64; 2],
}

impl Wires {
    /// Inputs of one scan as they arrive.
    pub fn carry(&mut self, faults: &BenchFaults, input: &mut IoInput) {
        input.carrier_hz = faults.carrier_hz(input.carrier_hz);
        input.code_rate_chz = faults.rate_chz(input.code_rate_chz);
        input.level_mv = faults.level_mv(input.level_mv);
        input.lines -= faults.dead_lines;
        if faults.markers_dead {
            (input.marker, input.marker_edges, input.marker_edge_us) = (0, 0, u16::MAX);
        }
        let counts = [&mut input.tacho1_count, &mut input.tacho2_count];
        for (channel, count) in counts.into_iter().enumerate() {
            let dead = channel == 0 && faults.speed_1_dead;
            let factor = if dead { 0.0 } else { faults.pulse_factor };
            let more = count.wrapping_sub(self.asked[channel]);
            self.asked[channel] = *count;
            let sent = &mut self.sent[channel];
            *sent = (*sent + f64::from(more) * factor).rem_euclid(f64::from(u16::MAX) + 1.0);
            *count = *sent as u16;
        }
        if faults.speed_1_dead {
            input.tacho1_edge_us = u16::MAX;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sound bench sends what was asked for, over the wrap of its counters, too.
    #[test]
    fn a_sound_bench_changes_nothing() {
        let (mut wires, faults) = (Wires::default(), BenchFaults::default());
        for step in 0..2_000_u32 {
            let asked = IoInput {
                carrier_hz: 3000,
                code_rate_chz: 1500,
                level_mv: 500,
                tacho1_count: (step * 97) as u16,
                tacho2_count: (step * 61) as u16,
                lines: TrainLines::HCR | DOOR_LINES,
                ..IoInput::default()
            };
            let mut sent = asked;
            wires.carry(&faults, &mut sent);
            assert_eq!(sent, asked);
        }
        assert_eq!(faults.read(Outputs::FSB), Outputs::FSB);
    }

    /// Pulses of a generator that is off add up to its share of those that were asked for.
    #[test]
    fn a_generator_that_is_off_sends_its_share_of_pulses() {
        let faults = BenchFaults {
            pulse_factor: 1.03,
            ..BenchFaults::default()
        };
        let (mut wires, mut input) = (Wires::default(), IoInput::default());
        for step in 1..=100 {
            input.tacho2_count = 10 * step;
            wires.carry(&faults, &mut input);
        }
        assert!((1029..=1030).contains(&input.tacho2_count));
    }
}
