//! Faults of stored data: there from power-up on, and sound in themselves, so that no check of the
//! unit's own sees them.

use protocol::injection::{Effect, Place};

use crate::unit::Setup;

/// What the unit's memory really holds.
pub fn spoil_stored_data(mut setup: Setup) -> Setup {
    for fault in &setup.faults {
        match (fault.place, fault.effect) {
            (Place::TrackDatabase, Effect::Offset { by }) => {
                for section in &mut setup.line.sections {
                    section.stop_m += by;
                    section.length_m += by;
                }
            }
            (Place::WheelParameter, Effect::Gain { factor }) => {
                setup.config.tacho.wheel_diameter_mm *= factor;
            }
            _ => {}
        }
    }
    setup
}
