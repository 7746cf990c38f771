//! TCMS's end of the RS-485 link to the unit: the frame of each cycle.

use protocol::message::{TcmsToAtc, TcmsToAtcBits};
use protocol::{CYCLE, Duration, Instant};

use crate::stimulus::TcmsCondition;
use crate::tcms::TcmsView;

/// Time since the alive counter last moved after which TCMS counts as not sending.
const SILENT: Duration = Duration::from_ms(500);

/// State of the train that TCMS reads.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrainSeen {
    /// The train brakes, by the service brake or any other.
    pub braking: bool,
    /// Doors are closed, by the contact of the door line.
    pub doors_closed: bool,
    /// Head control relay of the unit's cab.
    pub hcr: bool,
}

#[derive(Debug)]
pub struct TcmsPort {
    /// Condition of the link as the procedure wants it.
    pub condition: TcmsCondition,
    /// Condition of the port, if it is faulty.
    pub fault: Option<TcmsCondition>,
    pub ato_enable: bool,
    /// Passengers, kg.
    pub load_kg: f64,
    /// Passengers by default, kg.
    pub usual_load_kg: f64,
    alive: u8,
    next_due: Instant,
    moved: Option<Instant>,
}

impl Default for TcmsPort {
    /// A TCMS in order: ATO permitted, no passengers.
    fn default() -> Self {
        Self {
            condition: TcmsCondition::Good,
            fault: None,
            ato_enable: true,
            load_kg: 0.0,
            usual_load_kg: 0.0,
            alive: 0,
            next_due: Instant::ZERO,
            moved: None,
        }
    }
}

impl TcmsPort {
    /// Restores a good link, permission of ATO and the default load; the alive counter goes on.
    pub fn reset(&mut self) {
        self.condition = TcmsCondition::Good;
        self.ato_enable = true;
        self.load_kg = self.usual_load_kg;
    }

    /// Whether nothing comes through, either way.
    pub fn silent(&self) -> bool {
        self.condition() == TcmsCondition::Silent
    }

    /// Whether frames with a moving alive counter are sent.
    pub fn alive(&self, now: Instant) -> bool {
        self.moved.is_some_and(|at| now.since(at) < SILENT)
    }

    fn condition(&self) -> TcmsCondition {
        self.fault.unwrap_or(self.condition)
    }

    /// The message that is due this scan, if any.
    pub fn step(&mut self, now: Instant, view: &TcmsView, seen: TrainSeen) -> Option<TcmsToAtc> {
        if now < self.next_due {
            return None;
        }
        self.next_due = now + CYCLE;
        match self.condition() {
            TcmsCondition::Silent => return None,
            TcmsCondition::Stale => {}
            TcmsCondition::Good => {
                self.alive = self.alive.wrapping_add(1);
                self.moved = Some(now);
            }
        }
        let mut bits = TcmsToAtcBits::empty();
        for (bit, on) in [
            (TcmsToAtcBits::ATO_ENABLE, self.ato_enable),
            (
                TcmsToAtcBits::BRAKE_NOT_RELEASED,
                !view.found.not_released.is_empty(),
            ),
            (TcmsToAtcBits::SERVICE_BRAKE_APPLIED, seen.braking),
            (TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED, view.line.applied),
            (TcmsToAtcBits::HOLDING_BRAKE_APPLIED, view.holding),
            (TcmsToAtcBits::POWERING_CUT, !view.power_cuts.is_empty()),
            (TcmsToAtcBits::FULL_SERVICE_BRAKE, view.brake.bcymsb),
            (TcmsToAtcBits::TELLS_LINES, true),
            (TcmsToAtcBits::DOORS_CLOSED, seen.doors_closed),
            (TcmsToAtcBits::CAB_MANNED, seen.hcr),
            (TcmsToAtcBits::TELLS_SPEED, true),
        ] {
            bits.set(bit, on);
        }
        Some(TcmsToAtc {
            bits,
            load_100kg: (self.load_kg / 100.0).round() as u16,
            alive: self.alive,
            effort: view.given,
            speed_cms: (view.speed_mps * 100.0).round() as u16,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alive_counts_stands_or_is_not_sent() {
        let mut port = TcmsPort::default();
        let view = TcmsView::default();
        let sent = |port: &mut TcmsPort, from_ms: u64| -> Vec<u8> {
            (0..10)
                .filter_map(|i| {
                    port.step(
                        Instant::from_ms(from_ms + 10 * i),
                        &view,
                        TrainSeen::default(),
                    )
                })
                .map(|m| m.alive)
                .collect()
        };
        assert_eq!(sent(&mut port, 0), [1, 2]);
        port.condition = TcmsCondition::Stale;
        assert_eq!(sent(&mut port, 100), [2, 2]);
        port.condition = TcmsCondition::Silent;
        assert!(sent(&mut port, 200).is_empty());
        assert!(port.alive(Instant::from_ms(540)) && !port.alive(Instant::from_ms(560)));
        port.condition = TcmsCondition::Good;
        port.fault = Some(TcmsCondition::Stale);
        assert_eq!(sent(&mut port, 600), [2, 2], "a fault wins");
    }
}
