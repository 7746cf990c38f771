//! The doors at a station: opened, held open and closed by ATO. Departure waits for it.
//!
//! | from | to | when |
//! |---|---|---|
//! | closed | opening | the run has ended, ATP enables a side, and doors have not been open at this stop |
//! | closed | open | a door is open, whoever opened it |
//! | opening | open | a door is open |
//! | opening | closed | the enable is gone, or no door opens in time |
//! | open | closing | departure is given, and doors have been open long enough |
//! | closing, open, obstructed | closed | all doors are proved closed and locked |
//! | closing, reopening | open | departure is withdrawn: what holds the train is for passengers, too |
//! | closing | reopening | not proved closed in time, and not for the last time |
//! | closing | obstructed | not proved closed in time, for the last time |
//! | reopening | closing | after its time, or the enable is gone |
//! | obstructed | open | departure is withdrawn |
//! | obstructed | closing | a person acknowledges |
//!
//! Doors are ordered to open only on sides that ATP enables; without an enable, doors that have closed stay closed. ATP
//! passes the order on while all open doors are on enabled sides; a person closes doors that are open elsewhere.

use protocol::config::DriverlessConfig;
use protocol::event::Event;
use protocol::message::DoorSide;
use protocol::{Duration, Instant};

use crate::guards::Guards;
use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Time for which a train moves before it has left the station: a spurious pulse of a tachometer is no departure.
const LEAVES: Duration = Duration::from_ms(1000);

#[derive(Clone, Copy, Debug)]
pub struct StationInputs {
    /// The mode switch of the active cab is at driverless.
    pub driverless: bool,
    pub standstill: bool,
    /// ATP has set Automatic Run: a train that has not arrived is no place for doors.
    pub running: bool,
    /// Sides on which ATP enables doors.
    pub enabled: DoorSide,
    /// Sides on which a door is not proved closed and locked; `None` if the lines tell of no side.
    pub open: DoorSide,
    /// All doors are proved closed and locked.
    pub closed: bool,
    /// The wayside has given departure.
    pub departure: bool,
    pub acknowledge: bool,
    pub guards: Guards,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Closed,
    Opening,
    Open,
    Closing {
        tries: u8,
    },
    Reopening {
        tries: u8,
    },
    Obstructed,
}

/// The door sequence of a driverless train, stepped once a cycle.
#[derive(Clone, Debug, Default)]
pub struct Station {
    state: State,
    since: Instant,
    /// When doors were seen open first at this stop.
    opened: Option<Instant>,
    /// Doors have been open at this stop, or could not be opened.
    served: bool,
    /// Sides ordered to open.
    pub opens: DoorSide,
    /// Departure has to wait for the doors, and the train is held.
    pub waits: bool,
    leaves: OnDelay,
    acknowledge: Edge,
}

impl Station {
    pub fn step(
        &mut self,
        now: Instant,
        inputs: &StationInputs,
        config: &DriverlessConfig,
        log: &mut EventLog,
    ) {
        let acknowledged = self.acknowledge.rises(inputs.acknowledge);
        let left = self.leaves.update(now, !inputs.standstill, LEAVES);
        if left || !inputs.driverless {
            *self = Self {
                leaves: self.leaves,
                acknowledge: self.acknowledge,
                ..Self::default()
            };
            return;
        }
        if !inputs.standstill || inputs.running {
            self.opens = DoorSide::None;
            if inputs.closed {
                self.state = State::Closed;
                self.waits = false;
            }
            return;
        }
        let next = self.next(now, inputs, acknowledged, config);
        if next != self.state {
            self.report(now, next, inputs, log);
            self.state = next;
            self.since = now;
        }
        if next == State::Open {
            self.opened.get_or_insert(now);
            self.served = true;
        }
        let enabled = inputs.enabled != DoorSide::None;
        self.waits = next != State::Closed || enabled && !self.served;
        self.opens = match next {
            State::Closed | State::Closing { .. } => DoorSide::None,
            _ => inputs.enabled,
        };
    }

    fn next(
        &self,
        now: Instant,
        inputs: &StationInputs,
        acknowledged: bool,
        config: &DriverlessConfig,
    ) -> State {
        let since = |at: Instant, ms: u32| now.since(at) >= Duration::from_ms(u64::from(ms));
        let lasted = |ms| since(self.since, ms);
        let enabled = inputs.enabled != DoorSide::None;
        let stood_open = self.opened.is_some_and(|at| since(at, config.dwell_min_ms));
        match self.state {
            State::Closed if !inputs.closed => State::Open,
            State::Closed if enabled && !self.served => State::Opening,
            State::Opening if !inputs.closed => State::Open,
            State::Opening if !enabled || lasted(config.open_ms) => State::Closed,
            State::Closing { .. } | State::Open | State::Obstructed if inputs.closed => {
                State::Closed
            }
            State::Open if inputs.departure && stood_open && inputs.guards.door_closing => {
                State::Closing { tries: 1 }
            }
            State::Closing { .. } | State::Reopening { .. } if enabled && !inputs.departure => {
                State::Open
            }
            State::Closing { tries } if lasted(config.close_ms) => {
                if tries >= config.close_tries {
                    State::Obstructed
                } else if enabled && inputs.guards.door_reopening {
                    State::Reopening { tries }
                } else {
                    State::Closing { tries: tries + 1 }
                }
            }
            State::Reopening { tries } if !enabled || lasted(config.reopen_ms) => {
                State::Closing { tries: tries + 1 }
            }
            State::Obstructed if !inputs.departure => State::Open,
            State::Obstructed if acknowledged => State::Closing { tries: 1 },
            state => state,
        }
    }

    fn report(&mut self, now: Instant, next: State, inputs: &StationInputs, log: &mut EventLog) {
        let sides = |side: DoorSide| i32::from(side.code());
        match (self.state, next) {
            (State::Opening, State::Closed) if inputs.enabled != DoorSide::None => {
                self.served = true;
                log.push(now, Event::DoorsStayClosed, sides(inputs.enabled));
            }
            (_, State::Obstructed) => log.push(now, Event::DoorObstructed, sides(inputs.open)),
            _ => {}
        }
    }

    /// The station stop orders all doors to close.
    pub fn closes(&self) -> bool {
        matches!(self.state, State::Closing { .. })
    }
}

#[cfg(test)]
mod tests;
