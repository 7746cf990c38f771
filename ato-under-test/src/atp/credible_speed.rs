//! Plausibility of the speed of both tachometers: a speed that no train can have is not believed.
//!
//! A train slows by its adhesion at most. Where both inputs fall faster, pulses are missing: a connector, the supply
//! of both sensors, wheels that are locked. Then the train counts as moving until pulses are back, or until its brake
//! has had the time for a stop from the last believed speed at the least rate, and TCMS, where it tells a speed, tells
//! of axles that stand. The train also counts as moving while TCMS tells of axles that turn and no tachometer does, or
//! that turn much faster than both tachometers. Power that moves nothing from rest is cut.
//!
//! A clock that is fast makes all speeds too low: where TCMS's counter contradicts the clock, speeds are raised by
//! the same share.

use protocol::config::TachoConfig;
use protocol::event::Event;
use protocol::{Duration, Instant, SCAN, Speed};

use crate::kernel::{EventLog, hundredths, hundredths_of_percent};
use crate::timer::{Edge, OnDelay, ms};

const GRAVITY_MPS2: f64 = 9.81;
/// A lower speed comes from one pulse or none.
const NO_PULSES: Speed = Speed::from_kmh(1.0);
/// Time for which TCMS must tell of a speed that no tachometer sees: frames, its own lag, and the tachometers' window.
const CONTRADICTS: Duration = Duration::from_ms(800);
/// Time for which pulses must be back.
const BACK: Duration = Duration::from_ms(1_000);

/// Evidence against which the speed is held in a scan.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpeedEvidence {
    /// Speed of the axles that TCMS measures; `None` = it does not tell.
    pub tcms_speed: Option<Speed>,
    /// Share by which the unit's clock is faster than TCMS's; 0 if it is not.
    pub clock_ahead: f64,
    /// Power is asked for, and nothing that ATP knows of holds the train.
    pub powers: bool,
    /// A person acknowledges: the start of the train is awaited again.
    pub acknowledge: bool,
    /// The speeds come from test signals, which change as a tester likes.
    pub tested: bool,
    /// An injected fault has put this check out of action.
    pub unguarded: bool,
}

impl SpeedEvidence {
    /// TCMS tells of a train that moves.
    pub fn tcms_moves(&self, config: &TachoConfig) -> bool {
        self.tcms_speed
            .is_some_and(|told| told.kmh() > config.tcms_moves_kmh)
    }

    /// The speed that TCMS tells of, where both tachometers are much slower.
    fn contradicts(&self, speed: Speed, config: &TachoConfig) -> Option<Speed> {
        let faster_kmh = match speed < NO_PULSES {
            true => config.tcms_moves_kmh,
            false => speed.kmh() + config.tcms_difference_kmh,
        };
        self.tcms_speed.filter(|told| told.kmh() > faster_kmh)
    }
}

/// Compares the speeds from scan to scan.
#[derive(Clone, Debug, Default)]
pub struct CredibleSpeed {
    /// Speed that follows the measured one as fast as adhesion lets a train, m/s.
    reference_mps: f64,
    /// The reference of each tachometer, m/s.
    each_mps: [f64; 2],
    /// Last reference that was near the measured speed, m/s.
    last_mps: f64,
    falls: OnDelay,
    vanishes: OnDelay,
    contradicts: OnDelay,
    back: OnDelay,
    /// Speed that the train may still have, m/s; `None` = the measured speed is believed.
    doubted_mps: Option<f64>,
    /// The speed by which TCMS contradicts, m/s; 0 = it does not.
    told_mps: f64,
    powerless: OnDelay,
    cut: bool,
    told: Edge,
    clock_told: Edge,
    /// Share by which speeds are too low, because the clock is fast.
    pub clock_fast: f64,
}

impl CredibleSpeed {
    /// One scan with the speeds of both tachometers.
    pub fn step(
        &mut self,
        now: Instant,
        speeds: [Speed; 2],
        pulses: bool,
        evidence: SpeedEvidence,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        let speed = speeds[0].max(speeds[1]);
        self.hold_clock(now, evidence, config, log);
        if evidence.unguarded || evidence.tested {
            *self = Self {
                reference_mps: speed.mps(),
                last_mps: speed.mps(),
                each_mps: speeds.map(Speed::mps),
                clock_fast: self.clock_fast,
                clock_told: self.clock_told,
                ..Self::default()
            };
            return;
        }
        if self.one_rolls_on(speeds, config) && self.doubted_mps.is_none() {
            self.reference_mps = speed.mps();
        }
        self.follow(now, speed, config, log);
        let told = evidence.contradicts(speed, config);
        self.told_mps = told.map_or(0.0, Speed::mps);
        let lasts = self.contradicts.update(now, told.is_some(), CONTRADICTS);
        if let Some(told) = told.filter(|_| lasts && self.doubted_mps.is_none()) {
            self.doubted_mps = Some(0.0);
            log.push(now, Event::SpeedContradicted, i32::from(told.to_cms()));
        }
        self.settle(now, speed, evidence, config);
        self.await_start(now, pulses, evidence, config, log);
    }

    /// Compares the clock with TCMS's; a share that late frames can cause does not count.
    fn hold_clock(
        &mut self,
        now: Instant,
        evidence: SpeedEvidence,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        let ahead = evidence.clock_ahead;
        let off = ahead > config.clock_share && !evidence.unguarded;
        self.clock_fast = if off { ahead } else { 0.0 };
        if self.clock_told.rises(off) {
            log.push(now, Event::ClockContradicted, hundredths_of_percent(ahead));
        }
    }

    /// Whether one tachometer turns and falls no faster than adhesion allows: then the other one is at fault.
    fn one_rolls_on(&mut self, speeds: [Speed; 2], config: &TachoConfig) -> bool {
        let most_mps = config.adhesion * GRAVITY_MPS2 * SCAN.as_secs();
        let mut rolls = false;
        for (each_mps, speed) in self.each_mps.iter_mut().zip(speeds) {
            *each_mps = speed
                .mps()
                .clamp(*each_mps - most_mps, *each_mps + most_mps);
            let fallen_kmh = (*each_mps - speed.mps()) * 3.6;
            rolls |= speed >= NO_PULSES && fallen_kmh <= config.fall_kmh;
        }
        rolls
    }

    /// Notices a speed that falls faster than adhesion lets it.
    fn follow(&mut self, now: Instant, speed: Speed, config: &TachoConfig, log: &mut EventLog) {
        let most_mps = config.adhesion * GRAVITY_MPS2 * SCAN.as_secs();
        let low_mps = self.reference_mps - most_mps;
        self.reference_mps = speed.mps().clamp(low_mps, self.reference_mps + most_mps);
        let fallen_kmh = (self.reference_mps - speed.mps()) * 3.6;
        if fallen_kmh <= config.fall_kmh {
            self.last_mps = self.reference_mps;
        }
        let silent = speed < NO_PULSES && fallen_kmh > config.fall_kmh;
        let vanishes = self.vanishes.update(now, silent, ms(config.fall_ms));
        let falls = fallen_kmh > config.difference_kmh;
        let falls = (self.falls).update(now, falls, ms(config.difference_ms));
        if (vanishes || falls) && self.doubted_mps.is_none() {
            self.doubted_mps = Some(self.last_mps);
            log.push(now, Event::SpeedVanished, hundredths(self.last_mps));
        }
    }

    /// Ends the doubt: the train must have stopped by now, or pulses are back.
    fn settle(
        &mut self,
        now: Instant,
        speed: Speed,
        evidence: SpeedEvidence,
        config: &TachoConfig,
    ) {
        let Some(doubted_mps) = &mut self.doubted_mps else {
            return;
        };
        // The emergency brake is applied meanwhile.
        *doubted_mps = (*doubted_mps - config.least_brake_mps2 * SCAN.as_secs()).max(0.0);
        let stopped = *doubted_mps == 0.0 && !evidence.tcms_moves(config);
        let turns = speed.kmh() > config.standstill_kmh
            && self.reference_mps <= speed.mps()
            && self.told_mps == 0.0;
        if stopped || self.back.update(now, turns, BACK) {
            self.doubted_mps = None;
            self.back.clear();
            self.reference_mps = speed.mps();
        }
    }

    /// Cuts power that moves nothing, until it does or somebody acknowledges.
    fn await_start(
        &mut self,
        now: Instant,
        pulses: bool,
        evidence: SpeedEvidence,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        if pulses {
            self.powerless.clear();
            self.cut = false;
        }
        let waits = evidence.powers && !pulses && !self.cut;
        self.cut |= (self.powerless).update(now, waits, ms(config.no_pulses_ms));
        self.cut &= !evidence.acknowledge;
        if self.told.rises(self.cut) {
            log.push(now, Event::NoPulses, config.no_pulses_ms as i32);
        }
    }

    /// Speed that the train may still have beside what is measured.
    pub fn doubted(&self) -> Option<Speed> {
        let doubted_mps = self.doubted_mps?;
        Some(Speed::from_mps(doubted_mps.max(self.told_mps)))
    }

    /// Power is cut: it moves nothing.
    pub fn cuts_power(&self) -> bool {
        self.cut
    }
}

#[cfg(test)]
mod tests;
