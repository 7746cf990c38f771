//! Speed sensors and their inputs: wrapping counts become the pulses of this scan.

use protocol::injection::{Effect, Place};

use crate::faults::{Faults, one_in_scan};
use crate::signals::Pulses;

#[derive(Debug, Default)]
pub struct PulseSensor {
    last_count: Option<u16>,
    /// Fraction of a pulse not emitted yet, for a sensor that gives too many or too few.
    owed: f64,
    last: Pulses,
    /// Pulses the wheel has made in this scan, whatever the sensor gives of them.
    pub turned: u32,
}

impl PulseSensor {
    /// The pulses since the last scan; without an input frame the last sample stands.
    pub fn read(
        &mut self,
        raw: Option<(u16, Pulses)>,
        place: Place,
        faults: &mut Faults,
    ) -> Pulses {
        let Some((count, mut pulses)) = raw else {
            self.last_count = None;
            self.turned = 0;
            return Pulses {
                count: 0,
                ..self.last
            };
        };
        let before = self.last_count.replace(count).unwrap_or(count);
        pulses.count = u32::from(count.wrapping_sub(before));
        self.turned = pulses.count;
        // A dead part that feeds both sensors stops each of them.
        let place = match faults.dead(Place::SpeedSensors) {
            true => Place::SpeedSensors,
            false => place,
        };
        match faults.at(place) {
            Some(Effect::Dead) => pulses.count = 0,
            Some(Effect::Gain { factor }) => {
                self.owed += f64::from(pulses.count) * factor;
                pulses.count = self.owed as u32;
                self.owed -= f64::from(pulses.count);
            }
            Some(Effect::Noise { per_s }) if faults.chance(one_in_scan(per_s)) => {
                pulses.count += 1;
                pulses.edge_at = pulses.sampled_at;
            }
            _ => {}
        }
        if pulses.count == 0 {
            pulses.edge_at = self.last.edge_at;
        }
        self.last = pulses;
        pulses
    }
}
