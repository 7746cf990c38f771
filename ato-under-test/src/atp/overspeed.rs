//! Overspeed supervision in stages: alarm, full service brake, emergency brake.
//!
//! The service brake brings the train back under the limit by itself and releases there; when it
//! does not slow the train, or the speed passes the emergency margin, the emergency brake follows.

use protocol::config::{OverspeedConfig, UnitConfig};
use protocol::event::Event;
use protocol::{Duration, Instant, Speed};

use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Scans over which the deceleration is measured (0.5 s).
const DECEL_SCANS: usize = 50;

/// Result of the supervision in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overspeed {
    /// Sound the alarm.
    pub alarm: bool,
    /// Request the full service brake.
    pub service_brake: bool,
    /// Speed is beyond the emergency margin.
    pub emergency: bool,
    /// The service brake has shown no effect.
    pub ineffective: bool,
    /// Speed above the limit, cm/s.
    pub excess_cms: i32,
    /// Deceleration, negative while the train gains speed, mm/s².
    pub decel_mms2: i32,
}

/// Compares the speed with the limit in force, scan by scan.
#[derive(Clone, Debug)]
pub struct OverspeedSupervision {
    limit: Speed,
    above_alarm: OnDelay,
    above_service: OnDelay,
    above_emergency: OnDelay,
    effect_changes: OnDelay,
    effective: bool,
    alarm: bool,
    service: bool,
    service_since: Instant,
    stepped_down: bool,
    grace_until: Instant,
    alarmed: Edge,
    braked: Edge,
    history: [f64; DECEL_SCANS],
    at: usize,
}

impl OverspeedSupervision {
    /// Limit zero, nothing exceeded.
    pub fn new() -> Self {
        Self {
            limit: Speed::ZERO,
            above_alarm: OnDelay::default(),
            above_service: OnDelay::default(),
            above_emergency: OnDelay::default(),
            effect_changes: OnDelay::default(),
            effective: false,
            alarm: false,
            service: false,
            service_since: Instant::ZERO,
            stepped_down: false,
            grace_until: Instant::ZERO,
            alarmed: Edge::default(),
            braked: Edge::default(),
            history: [0.0; DECEL_SCANS],
            at: 0,
        }
    }

    pub fn step(
        &mut self,
        now: Instant,
        speed: Speed,
        limit: Speed,
        config: &UnitConfig,
        log: &mut EventLog,
    ) -> Overspeed {
        let margins = &config.overspeed;
        let decel_mps2 = self.deceleration(speed);
        self.watch_step_down(now, speed, limit, margins);
        self.stage(now, speed, limit, margins);
        let excess_cms = i32::from((speed - limit).to_cms());
        if self.alarmed.rises(self.alarm) {
            log.push(now, Event::Overspeed, excess_cms);
        }
        if self.braked.rises(self.service) {
            self.service_since = now;
            log.push(now, Event::OverspeedFsb, excess_cms);
        }
        let proof = Duration::from_ms(u64::from(margins.brake_proof_ms));
        let proved = decel_mps2 >= margins.brake_proof_mps2;
        let delay = Duration::from_ms(u64::from(margins.eb_delay_ms));
        // A pulse too many in a tachometer hides a deceleration, or feigns one, for as long as its speed window.
        let differs = proved != self.effective;
        if self.effect_changes.update(now, differs, delay) {
            self.effective = proved;
        }
        // Close to the limit, and to standstill, a deceleration is no longer to be measured.
        let well_over = speed.kmh() > limit.kmh() + margins.alarm_margin_kmh;
        let ineffective =
            self.service && !self.effective && now.since(self.service_since) >= proof && well_over;
        let in_grace = self.stepped_down && !ineffective && (proved || now < self.grace_until);
        let beyond = speed.kmh() > limit.kmh() + margins.eb_margin_kmh && !in_grace;
        let emergency = self.above_emergency.update(now, beyond, delay);
        Overspeed {
            alarm: self.alarm,
            service_brake: self.service,
            emergency,
            ineffective,
            excess_cms,
            decel_mms2: libm::round(decel_mps2 * 1000.0) as i32,
        }
    }

    fn deceleration(&mut self, speed: Speed) -> f64 {
        let before = core::mem::replace(&mut self.history[self.at], speed.mps());
        self.at = (self.at + 1) % DECEL_SCANS;
        (before - speed.mps()) / (DECEL_SCANS as f64 * protocol::SCAN.as_secs())
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
            self.grace_until = now + Duration::from_ms(u64::from(margins.step_down_grace_ms));
        } else if speed <= limit {
            self.stepped_down = false;
        }
        self.limit = limit;
    }

    fn stage(&mut self, now: Instant, speed: Speed, limit: Speed, margins: &OverspeedConfig) {
        let over = |margin_kmh: f64| speed.kmh() > limit.kmh() + margin_kmh;
        let alarm_delay = Duration::from_ms(u64::from(margins.alarm_delay_ms));
        let service_delay = Duration::from_ms(u64::from(margins.fsb_delay_ms));
        self.alarm |= self
            .above_alarm
            .update(now, over(margins.alarm_margin_kmh), alarm_delay);
        self.service |= self
            .above_service
            .update(now, over(margins.fsb_margin_kmh), service_delay);
        if speed <= limit {
            self.alarm = false;
            self.service = false;
        }
    }
}

impl Default for OverspeedSupervision {
    fn default() -> Self {
        Self::new()
    }
}
