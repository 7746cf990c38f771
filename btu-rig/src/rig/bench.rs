//! The rig and a unit on a wire, moved on together one scan at a time.

use protocol::{Duration, Instant, SCAN};

use super::{LinkTrouble, Rig};

/// A unit at the other end of a byte stream: embedded, or on a port.
pub trait UnitLink {
    /// Hands over what the rig sent in this scan and appends what has come from the unit.
    ///
    /// # Errors
    /// When nothing can be sent or received any more.
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble>;

    /// Time for which unit and bench both stood still since the last call, as two programs do on a computer that is
    /// held up. This time counts for neither.
    fn take_pause(&mut self) -> Duration {
        Duration::ZERO
    }

    /// How late an instrument of the bench was since the last call: what the unit did then is not judged.
    fn take_late(&mut self) -> Duration {
        Duration::ZERO
    }

    /// Moves the bench's clock by `later_us` of the wall clock; negative = earlier.
    fn shift_clock(&mut self, _later_us: i64) {}
}

/// A rig with its unit. Time is virtual; over a port the caller paces the ticks.
#[derive(Debug)]
pub struct Bench<L> {
    /// The rig, to be looked at (sample, events, tester session) and driven.
    pub rig: Rig,
    /// The unit's side.
    pub link: L,
    now: Instant,
    to_unit: Vec<u8>,
    from_unit: Vec<u8>,
}

impl<L: UnitLink> Bench<L> {
    /// Time of the last tick.
    pub fn now(&self) -> Instant {
        self.now
    }

    /// A bench at the beginning of time.
    pub fn new(rig: Rig, link: L) -> Self {
        Self {
            rig,
            link,
            now: Instant::ZERO,
            to_unit: Vec::new(),
            from_unit: Vec::new(),
        }
    }

    /// Moves on by one scan.
    ///
    /// # Errors
    /// When the connection to the unit broke.
    pub fn tick(&mut self) -> Result<(), LinkTrouble> {
        self.now += SCAN;
        self.to_unit.clear();
        self.rig.step(self.now, &mut self.to_unit);
        self.from_unit.clear();
        let exchanged = self
            .link
            .exchange(self.now, &self.to_unit, &mut self.from_unit);
        self.rig.receive(self.now, &self.from_unit);
        // A tester that is turned away gets the reason, and then the connection is closed.
        exchanged.map_err(|broken| self.rig.turned_away().unwrap_or(broken))
    }
}
