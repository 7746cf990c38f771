//! Evidence behind a run's results besides its scripts: kept with the run, sealed and signed with
//! it.

use fault_db::Instrument;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::bench_contents::BenchContents;
use super::plan::MeasuringRules;
use crate::clock::{ClockState, NOT_KNOWN_MS, local_day, now_us};

/// Content of the bench, and accuracy of the computer's clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Unit configuration, line, train and settings, by their content.
    pub bench: BenchContents,
    /// The computer's clock.
    pub clock: ClockEvidence,
    /// The instruments of the bench, as they were registered then.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instruments: Vec<InstrumentEvidence>,
    /// Limits were narrowed by the uncertainty of what was measured.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub guard_banded: bool,
    /// Different steps that were due.
    #[serde(default)]
    pub planned: u32,
    /// Some steps of its procedures were chosen, not all.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_part: bool,
}

/// An instrument that a run used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "serde_json::Value")]
pub struct InstrumentEvidence {
    /// Instrument as registered.
    #[serde(flatten)]
    pub of: Instrument,
    /// The calibration was valid.
    pub is_calibrated: bool,
}

/// Written by hand: flattening by serde loses the numbers that serde_json keeps with all their
/// digits.
impl TryFrom<Value> for InstrumentEvidence {
    type Error = serde_json::Error;

    fn try_from(mut kept: Value) -> Result<Self, Self::Error> {
        let mut is_calibrated = || kept.as_object_mut()?.remove("is_calibrated");
        let is_calibrated = is_calibrated().unwrap_or_default();
        Ok(Self {
            is_calibrated: serde_json::from_value(is_calibrated)?,
            of: serde_json::from_value(kept)?,
        })
    }
}

/// The computer's clock at the beginning of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClockEvidence {
    /// The network has set the clock since the computer was started; none: the system does not say.
    pub synchronised: Option<bool>,
    /// Greatest error of the clock's times, ms; none = unknown.
    pub uncertainty_ms: Option<u16>,
}

impl Evidence {
    /// Evidence of a run that begins now, with the state of the clock.
    pub fn now(
        bench: BenchContents,
        used: Vec<Instrument>,
        rules: MeasuringRules,
        planned: usize,
    ) -> Self {
        let today = local_day(now_us());
        let used = used.into_iter().map(|of| InstrumentEvidence {
            is_calibrated: of.is_calibrated_on(&today),
            of,
        });
        let state = ClockState::now();
        let uncertainty = state.uncertainty_ms();
        Self {
            bench,
            clock: ClockEvidence {
                synchronised: match state {
                    ClockState::Synchronised => Some(true),
                    ClockState::NotSynchronised => Some(false),
                    ClockState::Unknown => None,
                },
                uncertainty_ms: (uncertainty != NOT_KNOWN_MS).then_some(uncertainty),
            },
            instruments: used.collect(),
            guard_banded: rules.guard_band,
            planned: planned as u32,
            is_part: false,
        }
    }

    /// The instrument that values in this unit of measurement are measured with, if one is registered for it.
    pub fn instrument_for(&self, unit: &str) -> Option<&InstrumentEvidence> {
        let measures = |used: &&InstrumentEvidence| used.of.uncertainty.contains_key(unit);
        self.instruments.iter().find(measures)
    }

    /// Evidence as JSON, as a run stores it.
    pub fn text(&self) -> String {
        // Structures of text and numbers: this cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Evidence from the JSON of a run.
    pub fn of(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instrument_with_an_uncertainty_is_read_as_it_was_kept() {
        let kept = r#"{"kind":"bench","serial_no":"B-0031","uncertainty":{"ms":2.5},"at_us":1,"who":"","is_calibrated":true}"#;
        let read: InstrumentEvidence = serde_json::from_str(kept).expect("an instrument");
        assert_eq!(read.of.uncertainty["ms"], 2.5);
        assert!(read.is_calibrated);
        assert_eq!(serde_json::to_string(&read).expect("text"), kept);
        let without = kept.replace(r#","is_calibrated":true"#, "");
        assert!(serde_json::from_str::<InstrumentEvidence>(&without).is_err());
    }
}
