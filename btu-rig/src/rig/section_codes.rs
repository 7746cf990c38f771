//! The antenna signal follows the speed codes of the section that lies along the way.

use protocol::config::{SpeedCode, find_code};
use protocol::line::Section;

use crate::procedure::Refusal;
use crate::stimulus::CodeSignal;

use super::Rig;

impl Rig {
    /// Lets the antenna follow the section's codes, or keep what it has.
    pub(super) fn set_codes_along(&mut self, on: bool) -> Result<(), Refusal> {
        if let Some(track) = self.track.as_ref().filter(|_| on) {
            self.check_codes(&track.section)?;
        }
        self.codes_along = on;
        self.code_put_in = None;
        Ok(())
    }

    /// The section has codes, and the unit knows all of them.
    pub(super) fn check_codes(&self, section: &Section) -> Result<(), Refusal> {
        let number = section.section;
        if section.speed_codes.is_empty() {
            return Err(Refusal(format!("section {number} has no speed codes")));
        }
        let name = |code: &SpeedCode| code.name.clone();
        for from in &section.speed_codes {
            if find_code(&self.codes, &from.code).is_none() {
                let known: Vec<_> = self.codes.iter().map(name).collect();
                return Err(Refusal(format!(
                    "section {number} sends code {} at {} m, which the unit does not have; it has {}",
                    from.code,
                    from.at_m,
                    known.join(", ")
                )));
            }
        }
        Ok(())
    }

    /// Puts the code at the head of the train into the antenna when the code changes.
    pub(super) fn follow_codes(&mut self) {
        let Some(track) = self.track.as_ref().filter(|_| self.codes_along) else {
            return;
        };
        let Some(name) = track.speed_code(self.wheel.motion.position_m) else {
            return;
        };
        let place = find_code(&self.codes, name);
        if place != self.code_put_in
            && let Some(code) = place.map(|at| &self.codes[at])
        {
            let signal = CodeSignal::new(code.carrier_hz, code.rate_hz, self.level_mv);
            self.antenna.set(signal);
            self.code_put_in = place;
        }
    }
}
