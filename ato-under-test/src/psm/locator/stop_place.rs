//! Where the train is known to stand: at the stop point of a section, until it is driven by hand at yard or emergency.

use protocol::line::{Line, Section};

use super::Locator;

impl Locator {
    /// The section at whose stop point the train stands, as far as that is known.
    pub(super) fn anchor(&self) -> Option<&Section> {
        let here = self.section.as_ref().filter(|_| self.placed)?;
        let run_m = self.position_m() - here.start_m;
        let begins = self.fix.marker == 0 && libm::fabs(run_m) <= self.config.start_window_m;
        match self.aligned() {
            true => Some(here),
            false => self.came_from.as_ref().filter(|_| begins),
        }
    }

    /// The train stands where a section ends, and these data are of one that does not begin there.
    pub fn contradicts(&self, section: &Section, line: &Line) -> bool {
        let next = self
            .anchor()
            .and_then(|here| Some((here, line.after(here)?)));
        next.is_some_and(|(here, next)| {
            section.section != here.section && section.section != next.section
        })
    }

    /// Whether the place counts: not in a train that is driven by hand at yard or emergency, or has no cab.
    pub fn keep_place(&mut self, keeps: bool) {
        self.placed = keeps && (self.placed || !self.aligned());
        if !keeps {
            self.came_from = None;
        }
    }
}
