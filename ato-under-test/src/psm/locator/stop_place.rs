//! Where the train is known to stand: at the stop point of a section, until it is moved at yard or emergency, or
//! its cab is left.

use protocol::line::{Line, Section};
use protocol::message::TwcWayside;

use super::Locator;

impl Locator {
    /// The section at whose stop point the train stands, as far as that is known.
    pub(super) fn anchor(&self) -> Option<&Section> {
        let here = self.section.as_ref().filter(|_| self.placed)?;
        let run_m = self.position_m() - here.start_m;
        let begins = self.fix.marker == 0 && libm::fabs(run_m) <= self.config.start_window_m;
        match self.at_end() {
            true => Some(here),
            false => self.came_from.as_ref().filter(|_| begins),
        }
    }

    /// The train stands where a section ends, and these data are neither of its end nor of the section that begins there.
    pub fn contradicts(&self, data: &TwcWayside, section: &Section, line: &Line) -> bool {
        let next = self
            .anchor()
            .and_then(|here| Some((here, line.after(here)?)));
        next.is_some_and(|(here, next)| {
            let of_end = section.section == here.section && data.loop_id != section.from_loop;
            section.section != next.section && !(of_end && self.at_end())
        })
    }

    /// Near the section's end, aligned or not: another section begins here, whatever its last marker was worth.
    fn at_end(&self) -> bool {
        let near = |to_stop_m: f64| libm::fabs(to_stop_m) <= self.config.start_window_m;
        self.fix.marker != 0 && self.to_stop_m().is_some_and(near)
    }

    /// Sets whether the place counts: not in a train that moves at yard or emergency, or whose cab was
    /// left.
    pub fn keep_place(&mut self, keeps: bool) {
        self.placed = keeps && (self.placed || !self.at_end());
        if !keeps {
            self.came_from = None;
        }
    }
}
