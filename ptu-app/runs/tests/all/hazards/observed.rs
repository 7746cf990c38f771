//! State that the monitor of hazards sees in a scan: the rig's truth, and the unit's contacts.

use protocol::Instant;
use protocol::signal::{Sample, Signal};

/// Overrun after which a train may be jogged back, m, with what its position may be off.
const JOGS_FROM_M: f64 = 5.3 + 0.9;

/// True state of train, track and unit in one scan.
#[derive(Clone, Copy)]
pub struct Observed<'a> {
    pub now: Instant,
    pub sample: &'a Sample,
    /// True speed of the train, m/s, forward positive.
    pub speed_mps: f64,
    /// Forward positive, m/s².
    pub accel_mps2: f64,
    /// Distance to the stop point, m, where a section is laid.
    pub to_stop_m: Option<f64>,
    /// Traction at the wheels, N; 0 while the bench turns them.
    pub traction_n: f64,
    /// A car slips or slides.
    pub sliding: bool,
    /// The wheels follow the train; else the bench turns them, whatever brakes do.
    pub driven: bool,
    /// Doors of the left and of the right.
    pub doors_open: [bool; 2],
    /// Reverser: 1, 0, -1.
    pub reverser: i8,
    /// Contacts of the mode switch or the reverser change all the time.
    pub chatters: bool,
    /// Section that the train is on.
    pub section: u16,
    /// Section whose data the wayside gives.
    pub told: u16,
    /// The start button is pressed, or was a moment ago.
    pub start: bool,
    /// No tachometer gives pulses.
    pub blind: bool,
    /// The unit has its supply.
    pub powered: bool,
    /// Carrier and code rate of a neighbouring track's code, Hz; its level is a signal.
    pub crosstalk: [f64; 2],
    /// Wheel diameter that is being keyed in, mm; 0 = as configured.
    pub wheel_mm: Option<f64>,
    /// Pulses of markers that lie nowhere, so far.
    pub pulsed: usize,
    /// Distance of the markers beyond their places, m.
    pub displaced: [f64; 4],
}

impl<'a> Observed<'a> {
    /// A train at rest on the bench, forward, with its unit supplied.
    pub(super) fn at_rest(now: Instant, sample: &'a Sample) -> Self {
        Self {
            now,
            sample,
            speed_mps: 0.0,
            accel_mps2: 0.0,
            to_stop_m: None,
            traction_n: 0.0,
            sliding: false,
            driven: true,
            doors_open: [false; 2],
            reverser: 1,
            chatters: false,
            section: 0,
            told: 0,
            start: false,
            blind: false,
            powered: true,
            crosstalk: [0.0; 2],
            wheel_mm: None,
            pulsed: 0,
            displaced: [0.0; 4],
        }
    }
}

impl Observed<'_> {
    pub(super) fn on(&self, signal: Signal) -> bool {
        self.value(signal) > 0.5
    }

    pub(super) fn value(&self, signal: Signal) -> f64 {
        self.sample.get(signal).unwrap_or(0.0)
    }

    pub(super) fn kmh(&self) -> f64 {
        self.speed_mps.abs() * 3.6
    }

    pub(super) fn switch(&self) -> u8 {
        self.value(Signal::ModeSwitch) as u8
    }

    /// ATO drives the train, as TCMS has it.
    pub(super) fn by_ato(&self) -> bool {
        matches!(self.value(Signal::TcmsMode) as u8, 4 | 5)
    }

    /// The train may be jogging back: by ATO, past the stop point, doors closed.
    pub(super) fn jogs_back(&self) -> bool {
        let past = |to_stop_m: f64| (-JOGS_FROM_M..1.2).contains(&to_stop_m);
        let backward = self.reverser == 1 && self.speed_mps < 0.0;
        self.by_ato() && backward && self.to_stop_m.is_some_and(past)
    }

    /// The train runs in a direction that neither reverser nor code allows.
    pub(super) fn wrong_way(&self) -> bool {
        let by_code = matches!(self.switch(), 2..=4);
        let against = self.speed_mps * f64::from(self.reverser) <= 0.0;
        (against || by_code && self.speed_mps < 0.0) && !self.jogs_back()
    }
}
