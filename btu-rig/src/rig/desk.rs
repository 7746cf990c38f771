//! Cab desk and train lines: what a driver, the doors and the brake loop give the unit.

use protocol::message::{ModeSwitch, Outputs, TrainLines};
use protocol::{Duration, Instant};

/// How long a button stays pressed.
const PRESSED: Duration = Duration::from_ms(500);
/// Master controller position that opens the emergency brake loop.
const EMERGENCY_NOTCH: i8 = -8;

/// Contacts and levers of one cab.
#[derive(Debug)]
pub struct Desk {
    /// Doors proved closed.
    pub doors_closed: bool,
    /// Head control relay.
    pub hcr: bool,
    /// Maintenance key.
    pub maintenance_key: bool,
    /// Mode switch.
    pub mode_switch: ModeSwitch,
    /// Master controller notch, −8..=4.
    pub controller: i8,
    /// Reverser: 1, 0 or −1.
    pub reverser: i8,
    acknowledge_until: Instant,
    start_until: Instant,
    eb_loop: bool,
}

impl Default for Desk {
    /// A manned cab, ready to drive by hand.
    fn default() -> Self {
        Self {
            doors_closed: true,
            hcr: true,
            maintenance_key: false,
            mode_switch: ModeSwitch::Manual,
            controller: 0,
            reverser: 1,
            acknowledge_until: Instant::ZERO,
            start_until: Instant::ZERO,
            eb_loop: false,
        }
    }
}

impl Desk {
    /// Everything back to where [`Self::default`] has it; the loop is the train's and stays.
    pub fn reset(&mut self) {
        *self = Self {
            eb_loop: self.eb_loop,
            ..Self::default()
        };
    }

    /// Presses the acknowledge button.
    pub fn press_acknowledge(&mut self, now: Instant) {
        self.acknowledge_until = now + PRESSED;
    }

    /// Presses the ATO start button.
    pub fn press_start(&mut self, now: Instant) {
        self.start_until = now + PRESSED;
    }

    /// One scan: the loop follows the relay as last heard, which is one scan old, as a train's
    /// relays would be. A unit that is not heard holds no relay.
    pub fn step(&mut self, outputs: Option<Outputs>) {
        let relay = outputs.is_some_and(|o| o.contains(Outputs::EB_RELAY));
        self.eb_loop = relay && self.controller != EMERGENCY_NOTCH;
    }

    /// The emergency brake loop is energised: brake released.
    pub fn eb_loop(&self) -> bool {
        self.eb_loop
    }

    /// Train lines at this scan.
    pub fn lines(&self, now: Instant) -> TrainLines {
        let mut lines = TrainLines::empty();
        lines.set(TrainLines::DOORS_CLOSED, self.doors_closed);
        lines.set(TrainLines::HCR, self.hcr);
        lines.set(TrainLines::MAINTENANCE_KEY, self.maintenance_key);
        lines.set(TrainLines::ACKNOWLEDGE, now < self.acknowledge_until);
        lines.set(TrainLines::START, now < self.start_until);
        lines.set(TrainLines::EB_LOOP, self.eb_loop);
        lines.set(TrainLines::FORWARD, self.reverser > 0);
        lines.set(TrainLines::BACKWARD, self.reverser < 0);
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loop_needs_relay_and_lever() {
        let mut desk = Desk::default();
        for (outputs, controller, energised) in [
            (None, 0, false),
            (Some(Outputs::empty()), 0, false),
            (Some(Outputs::EB_RELAY), 0, true),
            (Some(Outputs::EB_RELAY), -7, true),
            (Some(Outputs::EB_RELAY), -8, false),
        ] {
            desk.controller = controller;
            desk.step(outputs);
            assert_eq!(desk.eb_loop(), energised, "{outputs:?} {controller}");
        }
    }

    #[test]
    fn buttons_spring_back() {
        let mut desk = Desk::default();
        desk.press_start(Instant::from_ms(100));
        assert!(
            desk.lines(Instant::from_ms(590))
                .contains(TrainLines::START)
        );
        assert!(
            !desk
                .lines(Instant::from_ms(600))
                .contains(TrainLines::START)
        );
        assert!(
            !desk
                .lines(Instant::from_ms(590))
                .contains(TrainLines::ACKNOWLEDGE)
        );
    }
}
