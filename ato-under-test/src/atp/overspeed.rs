//! Overspeed supervision in stages: alarm, full service brake, emergency brake.
//!
//! The service brake brings the train back under the limit by itself and releases there; when it
//! does not slow the train (`brake_proof`), or the speed passes the emergency margin, the emergency brake follows.
//!
//! Margins apply to limits above zero. Under a stop (code 0, absolute stop, no code, or mode off) alarm and service
//! brake come as soon as the train does what no standing train does, and the service brake is held until a limit above
//! zero lets the train run.

use protocol::config::{OverspeedConfig, UnitConfig};
use protocol::event::Event;
use protocol::{Instant, Speed};

use super::BrakeState;
use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay, ms};

/// Motion of the train in one scan, and its limits.
#[derive(Clone, Copy, Debug)]
pub struct SupervisedMotion {
    pub speed: Speed,
    pub limit: Speed,
    /// The limit is zero by the code, without a code, or because the mode is off.
    pub stop: bool,
    pub standstill: bool,
    /// The train does what no standing train does
    /// ([`Tachometers::moves`](super::Tachometers::moves)).
    pub moves: bool,
}

/// Result of the supervision in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overspeed {
    /// Sound the alarm.
    pub alarm: bool,
    /// Request the full service brake.
    pub service_brake: bool,
    /// Speed above the limit, cm/s.
    pub excess_cms: i32,
}

/// Compares the speed with the limit in force, scan by scan.
#[derive(Clone, Debug, Default)]
pub struct OverspeedSupervision {
    limit: Speed,
    above_alarm: OnDelay,
    above_service: OnDelay,
    above_emergency: OnDelay,
    alarm: bool,
    service: bool,
    /// The train has stood under the present stop.
    stood: bool,
    stepped_down: bool,
    grace_until: Instant,
    alarmed: Edge,
    braked: Edge,
}

impl OverspeedSupervision {
    /// Alarm and service brake.
    pub fn step(
        &mut self,
        now: Instant,
        motion: SupervisedMotion,
        config: &UnitConfig,
        log: &mut EventLog,
    ) -> Overspeed {
        let margins = &config.overspeed;
        self.watch_step_down(now, motion.speed, motion.limit, margins);
        self.stage(now, motion, margins);
        let excess_cms = i32::from((motion.speed - motion.limit).to_cms());
        if self.alarmed.rises(self.alarm) {
            log.push(now, Event::Overspeed, excess_cms);
        }
        if self.braked.rises(self.service) {
            let event = if self.stood {
                Event::MovedAtStop
            } else {
                Event::OverspeedFsb
            };
            log.push(now, event, excess_cms);
        }
        // What has set off braking is logged before a train that is stopped counts as standing under a stop.
        self.stood = motion.stop && (self.stood || motion.standstill);
        Overspeed {
            alarm: self.alarm,
            service_brake: self.service,
            excess_cms,
        }
    }

    /// The speed is beyond the emergency margin.
    pub fn emergency(
        &mut self,
        now: Instant,
        motion: SupervisedMotion,
        proof: BrakeState,
        margins: &OverspeedConfig,
    ) -> bool {
        let in_grace =
            self.stepped_down && !proof.ineffective && (proof.proved || now < self.grace_until);
        let most_kmh = (margins.eb_margin_kmh).map(|margin| motion.limit.kmh() + margin);
        let beyond = most_kmh.is_some_and(|most_kmh| motion.speed.kmh() > most_kmh) && !in_grace;
        (self.above_emergency).update(now, beyond, ms(margins.eb_delay_ms))
    }

    /// At a step down the train may be over the new limit at once: the service brake gets its
    /// chance before the emergency brake, for the grace time and then as long as it is proved to
    /// slow the train [S2 §3.3].
    fn watch_step_down(
        &mut self,
        now: Instant,
        speed: Speed,
        limit: Speed,
        margins: &OverspeedConfig,
    ) {
        if limit < self.limit && speed > limit {
            self.stepped_down = true;
            self.grace_until = now + ms(margins.step_down_grace_ms);
        } else if speed <= limit {
            self.stepped_down = false;
        }
        self.limit = limit;
    }

    fn stage(&mut self, now: Instant, motion: SupervisedMotion, margins: &OverspeedConfig) {
        let over = |margin_kmh: f64| {
            if motion.stop {
                motion.moves
            } else {
                motion.speed.kmh() > motion.limit.kmh() + margin_kmh
            }
        };
        let (alarm, service) = (over(margins.alarm_margin_kmh), over(margins.fsb_margin_kmh));
        self.alarm |= (self.above_alarm).update(now, alarm, ms(margins.alarm_delay_ms));
        self.service |= (self.above_service).update(now, service, ms(margins.fsb_delay_ms));
        if motion.speed <= motion.limit {
            self.alarm = false;
            // A train that moved under a stop, or was stopped by it, would roll away again.
            self.service &= motion.stop;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::seoul34;

    /// The rule of `seoul34`: as soon as the train is faster than the limit the service brake comes, and the emergency
    /// brake never by an excess alone, however great and long.
    #[test]
    fn without_delay_and_margin_the_service_brake_comes_at_once_and_alone() {
        let config = seoul34();
        let (mut one, mut log) = (OverspeedSupervision::default(), EventLog::default());
        let mut now = Instant::from_ms(1000);
        let mut scan = |kmh: f64, limit_kmh: f64| {
            now += protocol::SCAN;
            let motion = SupervisedMotion {
                speed: Speed::from_kmh(kmh),
                limit: Speed::from_kmh(limit_kmh),
                stop: false,
                standstill: false,
                moves: true,
            };
            let found = one.step(now, motion, &config, &mut log);
            let beyond = one.emergency(now, motion, BrakeState::default(), &config.overspeed);
            (found.service_brake, beyond)
        };
        assert_eq!(scan(40.0, 40.0), (false, false));
        assert_eq!(scan(40.1, 40.0), (true, false));
        for _ in 0..2000 {
            assert_eq!(scan(100.0, 25.0), (true, false));
        }
        assert_eq!(scan(25.0, 25.0), (false, false));
    }
}
