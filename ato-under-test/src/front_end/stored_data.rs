//! Faults of stored data (track database, wheel diameter), present from power-up. Numbers that are wrong are
//! plausible in themselves, so that no check of the unit itself detects them.

use protocol::injection::{Effect, Place};

use crate::setup::Setup;

/// The setup as the unit's memory holds it, with injected faults applied.
pub fn apply_stored_data_faults(mut setup: Setup) -> Setup {
    for fault in &setup.faults {
        match (fault.place, fault.effect) {
            (Place::TrackDatabase, Effect::Offset { by }) => {
                for section in &mut setup.line.sections {
                    section.stop_m += by;
                    section.length_m += by;
                }
            }
            (Place::TrackDatabase, Effect::Dead) => setup.line.sections.clear(),
            (Place::WheelParameter, Effect::Gain { factor }) => {
                setup.config.tacho.wheel_diameter_mm *= factor;
            }
            _ => {}
        }
    }
    setup
}
