//! What a run on the bench does and measures.

use fault_db::{FreezeSample, MeasurementRecord, StepRecord, Verdict};

use crate::catalogue::Season;
use crate::chance::Chance;

/// A step with what it measures.
pub struct Check {
    pub procedure: &'static str,
    pub step: &'static str,
    pub name: &'static str,
    pub unit: &'static str,
    /// As good as new, and how much it scatters.
    pub value: f64,
    pub scatter: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// The part that is too old when it is out of limits.
    pub lru: &'static str,
    /// Change in a year; a few units have ten times as much.
    pub yearly: f64,
    pub season: Season,
}

macro_rules! checks {
    ($($procedure:literal $step:literal $name:literal $unit:literal $value:literal +- $scatter:literal
        $low:expr, $high:expr, $lru:literal $yearly:literal $season:ident;)*) => {
        pub const CHECKS: &[Check] = &[$(Check {
            procedure: $procedure, step: $step, name: $name, unit: $unit, value: $value,
            scatter: $scatter, low: $low, high: $high, lru: $lru, yearly: $yearly,
            season: Season::$season,
        }),*];
    };
}

checks! {
    "atp/power_up" "emergency brake released in a manned cab" "release_time" "s" 1.08 +- 0.03 None, Some(1.7), "brake_cylinder" 0.03 Winter;
    "atp/power_up" "without a cab the brake is applied" "apply_time" "s" 0.31 +- 0.008 None, Some(0.5), "eb_relay" 0.01 Any;
    "atp/limit_speed" "code 75 gives 80 km/h" "decoding_time" "s" 0.72 +- 0.05 None, Some(1.3), "atp_receiver" 0.03 Summer;
    "atp/limit_speed" "weak signal just above the threshold is decoded" "code_level" "mV" 118.0 +- 2.5 Some(70.0), None, "atp_antenna" -3.0 Winter;
    "atp/limit_speed" "a lost code holds" "hold_time" "s" 2.0 +- 0.02 Some(1.8), Some(2.2), "atp_receiver" 0.0 Any;
    "atp/overspeed" "code 55: FSB" "fsb_reaction" "s" 0.61 +- 0.02 None, Some(0.9), "fsb_output" 0.02 Any;
    "atp/overspeed" "code 55: alarm, FSB, EB" "eb_reaction" "s" 0.42 +- 0.008 None, Some(0.58), "eb_relay" 0.016 Any;
    "door/interlocks" "open doors inhibit departure" "inhibit_reaction" "s" 0.21 +- 0.015 None, Some(0.5), "door_contact" 0.02 Winter;
    "door/interlocks" "closed doors free departure" "door_closing_time" "s" 2.9 +- 0.08 None, Some(3.6), "door_contact" 0.06 Winter;
    "ato/markers" "PSM2 is detected" "detection_time" "s" 0.08 +- 0.01 None, Some(0.2), "marker_antenna" 0.006 Winter;
    "twc/exchange" "the unit answers" "answer_time" "s" 0.18 +- 0.02 None, Some(0.5), "fsk_board" 0.015 Summer;
    "tcms/link" "silence is noticed at both ends" "loss_time" "s" 1.02 +- 0.03 None, Some(1.5), "rs485_link" 0.02 Any;
}

/// How far a unit has gone from new.
pub struct Wear {
    drift: f64,
    daily: f64,
}

impl Wear {
    pub fn new(check: &Check, chance: &mut Chance) -> Self {
        let mut daily = check.yearly / 365.0 * chance.factor(0.4);
        if chance.happens(0.05) {
            daily *= 10.0;
        }
        Self {
            drift: daily * chance.between(0.0, 200.0),
            daily,
        }
    }

    /// Some days later.
    pub fn age(&mut self, days: f64) {
        self.drift += self.daily * days;
    }

    /// The part is new.
    pub fn renew(&mut self) {
        self.drift = 0.0;
    }
}

/// The step at this place, and whether what it measured is within limits.
pub fn measured(
    check: &Check,
    wear: &Wear,
    index: u32,
    of_year: f64,
    chance: &mut Chance,
) -> StepRecord {
    let season = check.season.factor(of_year) - 1.0;
    let value = check.value + wear.drift + check.scatter * (chance.normal() + 1.5 * season);
    // As a bench counts: milliseconds, tenths of a millivolt.
    let value = (value * 1000.0).round() / 1000.0;
    let good =
        check.low.is_none_or(|low| value >= low) && check.high.is_none_or(|high| value <= high);
    let verdict = if good {
        Verdict::Passed
    } else {
        Verdict::Failed
    };
    let message = if good {
        String::new()
    } else {
        format!("{} was {value} {}", check.name, check.unit)
    };
    StepRecord {
        verdict,
        started_bench_us: i64::from(index) * 9_000_000,
        bench_time_us: 4_000_000 + chance.below(5_000_000) as i64,
        message,
        script_line: Some(12 + index),
        measurements: vec![MeasurementRecord {
            name: check.name.to_owned(),
            value: Some(value),
            unit: check.unit.to_owned(),
            low: check.low,
            high: check.high,
            limit_source: None,
            verdict,
        }],
        ..StepRecord::passed(index, check.procedure, check.step)
    }
}

/// Signals at the moment of a fault: those a unit's own log has, or more when the bench was there.
pub fn freeze(on_bench: bool, chance: &mut Chance) -> Vec<FreezeSample> {
    let speed = (chance.between(0.0, 80.0) * 10.0).round() / 10.0;
    let number = |name: &str, value: f64, unit: &str| FreezeSample {
        name: name.to_owned(),
        value: Some(value),
        unit: unit.to_owned(),
        label: None,
    };
    let word = |name: &str, value: f64, label: &str| FreezeSample {
        name: name.to_owned(),
        value: Some(value),
        unit: String::new(),
        label: Some(label.to_owned()),
    };
    let mut samples = vec![
        number("speed", speed, "km/h"),
        number("limit", (speed / 5.0).ceil() * 5.0 + 5.0, "km/h"),
        number(
            "position",
            (chance.between(0.0, 1200.0) * 100.0).round() / 100.0,
            "m",
        ),
        word("mode", 3.0, chance.one_of(&["manual", "automatic", "yard"])),
        word("eb_cause", 0.0, "none"),
        number("boot", chance.below(900) as f64, "1"),
        number("entry", chance.below(65_000) as f64, "1"),
    ];
    if on_bench {
        samples.extend([
            number("speed_2", speed, "km/h"),
            number("target", speed + 3.0, "km/h"),
            number("effort", chance.between(-1024.0, 1023.0).round(), "1"),
            number("code_rate", 12.5, "Hz"),
            number(
                "level",
                (chance.between(60.0, 130.0) * 10.0).round() / 10.0,
                "mV",
            ),
            number(
                "supply",
                (chance.between(98.0, 112.0) * 10.0).round() / 10.0,
                "V",
            ),
            word("eb", 1.0, chance.one_of(&["applied", "released"])),
            word("fsb", 0.0, "released"),
            word("doors", 1.0, "closed"),
            word("cab", 1.0, "on"),
        ]);
    }
    samples
}
