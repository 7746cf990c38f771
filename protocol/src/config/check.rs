//! Rules that the values of a unit configuration keep: ranges, and what must fit together.

use super::*;

/// Highest frequency that is sampled well with 48 000 samples a second, Hz.
const HIGHEST_HZ: f64 = 22_000.0;
/// Tones that are nearer to each other are not told apart, Hz.
const TONES_APART_HZ: f64 = 500.0;

impl UnitConfig {
    /// Checks ranges and that values fit together.
    ///
    /// # Errors
    /// The first thing wrong.
    pub fn check(&self) -> Result<(), ConfigError> {
        self.check_ranges()?;
        if self.name.is_empty() || self.name.len() > 16 || !self.name.is_ascii() {
            return Err(conflict("name must be 1 to 16 ASCII characters"));
        }
        let margins = &self.overspeed;
        let [alarm, fsb] = [margins.alarm_margin_kmh, margins.fsb_margin_kmh];
        // Where the emergency brake has no margin, alarm and service brake may have the same one.
        let rise = match margins.eb_margin_kmh {
            Some(eb) => alarm < fsb && fsb < eb,
            None => alarm <= fsb,
        };
        if !rise {
            return Err(conflict("overspeed margins must rise: alarm < fsb < eb"));
        }
        if let Some(eb) = margins.eb_margin_kmh {
            within("overspeed.eb_margin_kmh", eb, 0.0, 30.0)?;
        }
        if let Some(proceeds) = &self.stop_and_proceed {
            check_ranges! { proceeds, "stop_and_proceed.";
                limit_kmh: 5.0, 25.0;
                warning_ms: 1000.0, 60_000.0;
                sounds_ms: 100.0, 5000.0;
            }
            if proceeds.sounds_ms >= proceeds.warning_ms {
                return Err(conflict(
                    "stop_and_proceed.sounds_ms must be below warning_ms",
                ));
            }
        }
        if self.receiver.level_min_mv >= self.receiver.level_max_mv {
            return Err(conflict("receiver.level_min_mv must be below level_max_mv"));
        }
        if self.receiver.shift_hz != 0.0 {
            within("receiver.shift_hz", self.receiver.shift_hz, 5.0, 100.0)?;
        }
        for carrier_hz in &self.receiver.other_carriers_hz {
            within("receiver.other_carriers_hz", *carrier_hz, 100.0, 20000.0)?;
        }
        if self.start.self_test_ms <= self.receiver.detect_ms {
            return Err(conflict(
                "start.self_test_ms must be above receiver.detect_ms",
            ));
        }
        // A wheel may spin faster than adhesion lets it roll, never the other way round.
        let rolls_mps2 = self.tacho.adhesion * 9.81;
        within(
            "tacho.plausible_accel_mps2",
            self.tacho.plausible_accel_mps2,
            rolls_mps2,
            30.0,
        )?;
        if self.marker.debounce_ms > self.marker.bounce_ms {
            return Err(conflict("marker.debounce_ms must not be above bounce_ms"));
        }
        if self.twc.apart_hz >= self.twc.middle_hz
            || self.twc.middle_hz + self.twc.apart_hz > HIGHEST_HZ
        {
            return Err(conflict(
                "twc: middle_hz - apart_hz must be above 0, middle_hz + apart_hz at most 22 000 Hz",
            ));
        }
        for (place, tone_hz) in self.marker.tones_hz.iter().enumerate() {
            within("marker.tones_hz", *tone_hz, 500.0, HIGHEST_HZ)?;
            let is_near = |other: &f64| libm::fabs(other - tone_hz) < TONES_APART_HZ;
            if self.marker.tones_hz[..place].iter().any(is_near) {
                return Err(conflict("marker.tones_hz must be at least 500 Hz apart"));
            }
        }
        self.ato.check()?;
        self.check_codes()
    }

    fn check_ranges(&self) -> Result<(), ConfigError> {
        check_ranges! { self, "";
            receiver.carrier_tolerance_hz: 1.0, 1000.0;
            receiver.rate_tolerance_hz: 0.05, 5.0;
            receiver.level_min_mv: 1.0, 5000.0;
            receiver.level_max_mv: 1.0, 10000.0;
            receiver.apart_db: 0.5, 20.0;
            receiver.detect_ms: 50.0, 5000.0;
            receiver.hold_ms: 0.0, 5000.0;
            tacho.pulses_per_turn: 10.0, 1000.0;
            tacho.wheel_diameter_mm: 500.0, 1200.0;
            tacho.worn_mm: 0.0, 200.0;
            tacho.over_mm: 0.0, 50.0;
            tacho.window_ms: 20.0, 1000.0;
            tacho.difference_kmh: 1.0, 20.0;
            tacho.standstill_kmh: 0.1, 3.0;
            tacho.rollback_m: 0.05, 5.0;
            tacho.creep_m: 0.05, 5.0;
            tacho.adhesion: 0.05, 0.6;
            tacho.share: 0.005, 0.2;
            tacho.fall_kmh: 0.5, 20.0;
            tacho.fall_ms: 20.0, 5000.0;
            tacho.least_brake_mps2: 0.1, 1.5;
            tacho.no_pulses_ms: 500.0, 60000.0;
            tacho.tcms_moves_kmh: 0.5, 20.0;
            tacho.tcms_difference_kmh: 2.0, 50.0;
            tacho.clock_share: 0.05, 0.5;
            overspeed.alarm_margin_kmh: 0.0, 20.0;
            overspeed.fsb_margin_kmh: 0.0, 20.0;
            overspeed.yard_kmh: 5.0, 45.0;
            overspeed.emergency_kmh: 5.0, 45.0;
            overspeed.jog_kmh: 2.0, 5.0;
            doors.aligned_m: 0.05, 2.0;
            marker.window_m: 0.1, 50.0;
            marker.start_window_m: 0.1, 50.0;
            marker.window_share: 0.0, 0.2;
            marker.scatter_m: 0.001, 2.0;
            marker.wheel_spread: 0.0001, 0.1;
            marker.debounce_ms: 0.0, 1000.0;
            marker.bounce_ms: 0.0, 2000.0;
            marker.level_mv: 1.0, 2000.0;
            marker.reach_m: 0.01, 1.0;
            twc.middle_hz: 500.0, 20_000.0;
            twc.apart_hz: 10.0, 5_000.0;
            twc.bits_per_s: 50.0, 10_000.0;
            twc.level_mv: 1.0, 2000.0;
            test_board.carrier_tolerance_hz: 1.0, 100.0;
            test_board.rate_tolerance_hz: 0.01, 5.0;
            test_board.level_tolerance: 0.001, 0.5;
            test_board.speed_tolerance: 0.001, 0.2;
            driverless.dwell_min_ms: 0.0, 600000.0;
            driverless.open_ms: 500.0, 60000.0;
            driverless.close_ms: 500.0, 60000.0;
            driverless.reopen_ms: 100.0, 60000.0;
            driverless.close_tries: 1.0, 20.0;
            orders.length_tolerance_m: 0.1, 50.0;
            orders.cab_change_ms: 500.0, 60000.0;
            orders.entry_frames: 1.0, 20.0;
            link.io_timeout_ms: 50.0, 900.0;
            link.tester_timeout_ms: 200.0, 1000.0;
        }
        Ok(())
    }

    fn check_codes(&self) -> Result<(), ConfigError> {
        if self.codes.is_empty() || self.codes.len() > 32 {
            return Err(conflict("the code table needs 1 to 32 codes"));
        }
        for (i, code) in self.codes.iter().enumerate() {
            for other in &code.stands_for {
                let others = (self.codes.iter())
                    .filter(|one| one.name == *other || one.stands_for.contains(other));
                if others.count() != 1 {
                    return Err(ConfigError::Conflict(alloc::format!(
                        "codes.stands_for: \"{other}\" is the name of a code, or two codes stand for it"
                    )));
                }
                // A line that permits less must not be run faster.
                let most_kmh = other.parse().unwrap_or(f64::INFINITY);
                if code.limit_kmh > most_kmh {
                    return Err(ConfigError::Conflict(alloc::format!(
                        "codes.stands_for: code {} permits more than \"{other}\"",
                        code.name
                    )));
                }
            }
            if code.meaning == CodeMeaning::Yard && code.limit_kmh != self.overspeed.yard_kmh {
                return Err(conflict("a yard code has the limit of overspeed.yard_kmh"));
            }
            if code.meaning == CodeMeaning::YardCancel && code.limit_kmh > 0.0 {
                return Err(conflict(
                    "a code that ends yard mode has no limit: limit_kmh = 0",
                ));
            }
            within("codes.limit_kmh", code.limit_kmh, 0.0, 130.0)?;
            within("codes.carrier_hz", code.carrier_hz, 100.0, 20000.0)?;
            within("codes.rate_hz", code.rate_hz, 1.0, 100.0)?;
            for other in &self.codes[..i] {
                let same_carrier = libm::fabs(code.carrier_hz - other.carrier_hz)
                    <= 2.0 * self.receiver.carrier_tolerance_hz;
                let same_rate = libm::fabs(code.rate_hz - other.rate_hz)
                    <= 2.0 * self.receiver.rate_tolerance_hz;
                if code.name == other.name || (same_carrier && same_rate) {
                    return Err(ConfigError::Conflict(alloc::format!(
                        "codes {} and {} cannot be told apart with these tolerances",
                        other.name,
                        code.name
                    )));
                }
            }
        }
        Ok(())
    }
}
