//! The holding brake: 70 % of full service at standstill, so that no train rolls back (S4).

use protocol::{Duration, Instant};

use super::data::TcmsData;
use super::timer::OnDelay;

/// Inputs of the holding brake in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoldingInputs {
    /// Automatic or driverless mode.
    pub by_ato: bool,
    /// Driverless mode, which orders the holding brake when the mode begins at standstill.
    pub driverless: bool,
    /// ATO asks for the holding brake, by contact or by message.
    pub requested: bool,
    /// The train brakes by the driver's or ATO's order (DRYINB).
    pub braking: bool,
    /// Speed, m/s, never negative.
    pub speed_mps: f64,
    /// Greatest traction of any motor car, share of the greatest it can give; stands for motor
    /// current.
    pub traction: f64,
    /// Driverless initialisation or turn-back.
    pub turn_back: bool,
}

/// Conditions of the holding brake from scan to scan (S4).
#[derive(Clone, Debug)]
pub struct HoldingBrake {
    below_mps: f64,
    after: Duration,
    release: f64,
    lasts: OnDelay,
    driverless: bool,
    applied: bool,
}

impl HoldingBrake {
    /// A released holding brake.
    pub fn new(data: &TcmsData) -> Self {
        Self {
            below_mps: data.holding_below_kmh / 3.6,
            after: Duration::from_secs(data.holding_after_s),
            release: data.holding_release / 100.0,
            lasts: OnDelay::default(),
            driverless: false,
            applied: false,
        }
    }

    /// Releases the holding brake; whatever asks for it has to ask again.
    pub fn reset(&mut self) {
        self.lasts = OnDelay::default();
        self.driverless = false;
        self.applied = false;
    }

    /// One scan; returns whether the holding brake is ordered.
    ///
    /// On by ATO's request, when driverless mode begins at standstill, at a driverless turn-back, and by
    /// hand when a brake has lasted at low speed. Off when nothing asks for it and one motor car at
    /// least pulls. Request and turn-back are wired and count in any mode: they brake.
    pub fn step(&mut self, now: Instant, inputs: &HoldingInputs) -> bool {
        let slow = inputs.speed_mps <= self.below_mps;
        let by_hand = !inputs.by_ato && inputs.braking && slow;
        let lasts = self.lasts.update(now, by_hand, self.after);
        let begins = inputs.driverless && !self.driverless && slow;
        self.driverless = inputs.driverless;
        if inputs.requested || inputs.turn_back || lasts || begins {
            self.applied = true;
        } else if inputs.traction >= self.release {
            self.applied = false;
        }
        self.applied
    }
}
