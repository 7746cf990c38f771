//! Cab desks and train lines: inputs of TCMS and the unit from drivers, doors and the brake loop.

use protocol::message::{CabEntries, Message, ModeSwitch, TrainLines, WheelEntry};
use protocol::{Duration, Instant};

use crate::lever::Lever;
use crate::stimulus::{CutOut, DoorLine, DoorState, TrainSwitch};
use crate::tcms::{CabInputs, ControllerInputs, TcmsData};
use crate::train::CarSet;

use super::train_faults::CabDeskFaults;

/// Time for which a button stays pressed.
const PRESSED: Duration = Duration::from_ms(500);
/// Period and number of the frames of an entry: few enough that a unit which does not know them logs nothing.
const ENTRY_PERIOD: Duration = Duration::from_ms(50);
const ENTRY_FRAMES: u8 = 6;

/// Contacts and levers of both cabs and of the train; the unit is in the first cab.
#[derive(Debug)]
pub struct CabDesk {
    /// Doors on the left and on the right.
    pub doors: [DoorState; 2],
    /// State that each door line shows the unit whatever the doors do; `None` = the state of the doors.
    pub line_said: [Option<bool>; DoorLine::ALL.len()],
    pub hcr: bool,
    pub maintenance_key: bool,
    pub mode_switch: ModeSwitch,
    pub lever: Lever,
    /// Voltage of the lever's potentiometer, whatever its position.
    pub volts: Option<f64>,
    /// P and B contacts, whatever the lever's position.
    pub contacts: Option<(bool, bool)>,
    /// Reverser: 1, 0 or −1.
    pub reverser: i8,
    /// Faults of desk and train lines.
    pub faults: CabDeskFaults,
    pub brakes_cut_out: CarSet,
    pub inverters_cut_out: CarSet,
    pub switches: Switches,
    acknowledge_until: Instant,
    start_until: Instant,
    eb_loop: bool,
    eb_loop_fed: bool,
    pub number: Entry,
    pub wheel: Entry,
}

/// Value keyed in last, 0 = as the unit is configured, and the number of frames with this value still to be sent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Entry {
    value: u16,
    frames: u8,
    due: Instant,
}

impl Entry {
    pub fn key_in(&mut self, now: Instant, value: u16) {
        *self = Self {
            value,
            frames: ENTRY_FRAMES,
            due: now,
        };
    }

    /// The value, when it is due to be sent.
    fn due(&mut self, now: Instant) -> Option<u16> {
        if self.frames == 0 || now < self.due {
            return None;
        }
        self.frames -= 1;
        self.due = now + ENTRY_PERIOD;
        Some(self.value)
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Switches(u16);

impl Default for Switches {
    /// The dead man is held, and the contact line takes regenerated power.
    fn default() -> Self {
        let mut switches = Self(0);
        switches.set(TrainSwitch::DeadMan, true);
        switches.set(TrainSwitch::Regeneration, true);
        switches
    }
}

impl Switches {
    pub fn set(&mut self, switch: TrainSwitch, on: bool) {
        let bit = 1 << switch as u16;
        self.0 = if on { self.0 | bit } else { self.0 & !bit };
    }

    pub fn on(self, switch: TrainSwitch) -> bool {
        self.0 & (1 << switch as u16) != 0
    }
}

impl Default for CabDesk {
    /// A manned cab, ready to drive by hand.
    fn default() -> Self {
        Self {
            doors: [DoorState::Locked; 2],
            line_said: [None; DoorLine::ALL.len()],
            hcr: true,
            maintenance_key: false,
            mode_switch: ModeSwitch::Manual,
            lever: Lever::Neutral,
            volts: None,
            contacts: None,
            reverser: 1,
            faults: CabDeskFaults::default(),
            brakes_cut_out: CarSet::NONE,
            inverters_cut_out: CarSet::NONE,
            switches: Switches::default(),
            acknowledge_until: Instant::ZERO,
            start_until: Instant::ZERO,
            eb_loop: false,
            eb_loop_fed: false,
            number: Entry::default(),
            wheel: Entry::default(),
        }
    }
}

impl CabDesk {
    /// Restores [`Self::default`]; loop and faults belong to the train and stay. A train number that was keyed in is
    /// taken back.
    pub fn reset(&mut self, now: Instant) {
        for entry in [&mut self.number, &mut self.wheel] {
            if entry.value != 0 {
                entry.key_in(now, 0);
            }
        }
        *self = Self {
            eb_loop: self.eb_loop,
            eb_loop_fed: self.eb_loop_fed,
            faults: self.faults,
            number: self.number,
            wheel: self.wheel,
            ..Self::default()
        };
    }

    pub fn press_acknowledge(&mut self, now: Instant) {
        self.acknowledge_until = now + PRESSED;
    }

    pub fn press_start(&mut self, now: Instant) {
        self.start_until = now + PRESSED;
    }

    /// Entries that are due to be sent.
    pub fn entries_due(&mut self, now: Instant) -> [Option<Message>; 2] {
        let number = self.number.due(now);
        let wheel = self.wheel.due(now);
        [
            number.map(|train_number| CabEntries { train_number }.into()),
            wheel.map(|diameter_01mm| WheelEntry { diameter_01mm }.into()),
        ]
    }

    /// Cuts equipment of a car, by its place from 0, out or in.
    pub fn cut_out(&mut self, what: CutOut, car: usize, on: bool) {
        match what {
            CutOut::Brake => self.brakes_cut_out.set(car, on),
            CutOut::Inverter => self.inverters_cut_out.set(car, on),
        }
    }

    /// Sets the brake loop as TCMS's relays have it.
    pub fn set_loop(&mut self, energised: bool, fed: bool) {
        self.eb_loop = energised;
        self.eb_loop_fed = fed;
    }

    /// Closes and locks all doors, or opens them.
    pub fn set_doors(&mut self, closed: bool) {
        self.doors = match closed {
            true => [DoorState::Locked; 2],
            false => [DoorState::Open; 2],
        };
    }

    /// Lines of the doors of each side: closed, and locked, as far as their contacts say.
    fn side_lines(&self) -> [(bool, bool); 2] {
        let faults = &self.faults;
        let of = |side: usize| {
            let closed = faults.side_doors[side].unwrap_or(self.doors[side] != DoorState::Open);
            // The line that proves the locks runs through the contact that proves the doors closed.
            let locked = closed && self.doors[side] == DoorState::Locked;
            faults.doors.map_or((closed, locked), |said| (said, said))
        };
        [of(0), of(1)]
    }

    /// All doors proved closed and locked, as far as their contacts say.
    pub fn doors_proved(&self) -> bool {
        self.side_lines()
            .iter()
            .all(|(closed, locked)| *closed && *locked)
    }

    /// Door train lines: one through the closed contacts of all doors, and two for each side.
    fn door_lines(&self) -> TrainLines {
        let [left, right] = self.side_lines();
        let mut lines = TrainLines::empty();
        // In the order of `DoorLine`.
        let by_doors = [
            (TrainLines::DOORS_CLOSED, left.0 && right.0),
            (TrainLines::LEFT_CLOSED, left.0),
            (TrainLines::LEFT_LOCKED, left.1),
            (TrainLines::RIGHT_CLOSED, right.0),
            (TrainLines::RIGHT_LOCKED, right.1),
            (TrainLines::DOORS_BY_SIDE, true),
        ];
        for ((line, on), said) in by_doors.into_iter().zip(self.line_said) {
            lines.set(line, said.unwrap_or(on));
        }
        lines
    }

    /// The main reservoir's pressure switch says that pressure is low.
    pub fn main_reservoir_low(&self) -> bool {
        let said = self.faults.main_reservoir_low;
        said.unwrap_or_else(|| self.switches.on(TrainSwitch::MainReservoirLow))
    }

    /// The head control relay of the first cab.
    pub fn hcr_energised(&self) -> bool {
        self.faults.hcr.unwrap_or(self.hcr)
    }

    /// Both cabs as TCMS sees them.
    pub fn cabs(&self, tcms: &TcmsData) -> [CabInputs; 2] {
        let mut controller = tcms.at(self.lever);
        if let Some((power, brake)) = self.contacts {
            controller = ControllerInputs {
                power,
                brake,
                neutral: !power && !brake,
                ..controller
            };
        }
        controller.volts = self.volts.unwrap_or(controller.volts);
        controller.volts += self.faults.volts_offset;
        controller.volts = self.faults.volts.unwrap_or(controller.volts);
        let first = CabInputs {
            hcr: self.hcr_energised(),
            reverser: self.reverser,
            mode_switch: self.mode_switch,
            controller,
            dead_man: self.switches.on(TrainSwitch::DeadMan),
            emergency_button: self.switches.on(TrainSwitch::Button1),
            forced_release: self.switches.on(TrainSwitch::ForcedRelease),
        };
        // Nobody drives from the other cab: its desk is as it was left.
        let other = CabInputs {
            hcr: self.switches.on(TrainSwitch::OtherCab),
            controller: tcms.at(Lever::Neutral),
            emergency_button: self.switches.on(TrainSwitch::Button2),
            ..CabInputs::default()
        };
        [first, other]
    }

    pub fn lines(&self, now: Instant) -> TrainLines {
        let mut lines = self.door_lines();
        lines.set(TrainLines::HCR, self.hcr_energised());
        lines.set(TrainLines::MAINTENANCE_KEY, self.maintenance_key);
        lines.set(TrainLines::ACKNOWLEDGE, now < self.acknowledge_until);
        lines.set(TrainLines::START, now < self.start_until);
        lines.set(TrainLines::EB_LOOP, self.eb_loop);
        lines.set(TrainLines::EB_LOOP_FED, self.eb_loop_fed);
        lines.set(TrainLines::FORWARD, self.reverser > 0);
        lines.set(TrainLines::BACKWARD, self.reverser < 0);
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buttons_spring_back() {
        let mut desk = CabDesk::default();
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

    /// A broken contact stays as it is, whatever the doors do, and making safe does not repair it.
    #[test]
    fn a_broken_contact_outlives_a_reset() {
        let mut desk = CabDesk::default();
        desk.faults.doors = Some(false);
        desk.reset(Instant::ZERO);
        assert!(!desk.doors_proved());
        assert!(!desk.lines(Instant::ZERO).contains(TrainLines::DOORS_CLOSED));
    }

    /// A bridged contact of one side says closed, also to the line of all doors; the lock line still says unlocked.
    #[test]
    fn each_side_has_lines_of_its_own() {
        let sides = TrainLines::LEFT_CLOSED
            | TrainLines::LEFT_LOCKED
            | TrainLines::RIGHT_CLOSED
            | TrainLines::RIGHT_LOCKED;
        let mut desk = CabDesk::default();
        let doors = |desk: &CabDesk| desk.door_lines() & (sides | TrainLines::DOORS_CLOSED);
        assert_eq!(doors(&desk), sides | TrainLines::DOORS_CLOSED);
        desk.doors[1] = DoorState::Open;
        let left = TrainLines::LEFT_CLOSED | TrainLines::LEFT_LOCKED;
        assert_eq!(doors(&desk), left);
        desk.doors[1] = DoorState::Unlocked;
        let right = TrainLines::RIGHT_CLOSED | TrainLines::DOORS_CLOSED;
        assert_eq!(doors(&desk), left | right);
        desk.doors[1] = DoorState::Open;
        desk.faults.side_doors[1] = Some(true);
        assert_eq!(doors(&desk), left | right);
        assert!(!desk.doors_proved());
    }

    /// A line can show the unit another state than the doors have and TCMS reads.
    #[test]
    fn a_line_may_say_what_the_doors_do_not() {
        let mut desk = CabDesk::default();
        desk.line_said[DoorLine::All as usize] = Some(false);
        assert!(desk.doors_proved());
        let locked = TrainLines::LEFT_LOCKED;
        assert!(desk.door_lines().contains(locked));
        assert!(!desk.door_lines().contains(TrainLines::DOORS_CLOSED));
        desk.doors[0] = DoorState::Open;
        desk.line_said[DoorLine::LeftLocked as usize] = Some(true);
        assert!(desk.door_lines().contains(locked));
        desk.reset(Instant::ZERO);
        assert!(desk.door_lines().contains(TrainLines::DOORS_CLOSED));
    }
}
