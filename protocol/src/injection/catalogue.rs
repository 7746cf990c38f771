//! Catalogue of parts (LRUs) and their fault modes.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::FaultMode;
use super::check::check;
use crate::LruId;
use crate::config::{ConfigError, conflict};

/// A part that can be replaced.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lru {
    /// Name used in faults.
    pub id: LruId,
    /// Name people use, English.
    pub name: String,
    /// Name people use, Korean.
    pub name_ko: String,
    /// The part belongs to the bench, not to the unit or its train: it is examined, not replaced.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub of_bench: bool,
}

/// The catalogue of parts and fault modes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultCatalogue {
    /// Parts.
    pub lrus: Vec<Lru>,
    /// Fault modes.
    pub faults: Vec<FaultMode>,
}

impl FaultCatalogue {
    /// Reads and checks a catalogue file.
    ///
    /// # Errors
    /// Syntax with line and column, a name used twice, a part that is not listed, or a mode that
    /// cannot be carried out as it is written.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let catalogue: Self =
            toml::from_str(text).map_err(|e| ConfigError::Syntax(e.to_string()))?;
        let lrus = &catalogue.lrus;
        for (i, lru) in lrus.iter().enumerate() {
            if lrus[..i].iter().any(|l| l.id == lru.id) {
                return Err(conflict(&format!("part {} is listed twice", lru.id)));
            }
        }
        for (i, fault) in catalogue.faults.iter().enumerate() {
            if catalogue.faults[..i].iter().any(|f| f.id == fault.id) {
                return Err(conflict(&format!("fault {} is listed twice", fault.id)));
            }
            let Some(part) = lrus.iter().find(|l| l.id == fault.lru) else {
                return Err(conflict(&format!(
                    "fault {} names the part {}, which is not listed under lrus",
                    fault.id, fault.lru
                )));
            };
            if part.of_bench != fault.place.on_bench() {
                return Err(conflict(&format!(
                    "fault {}: its part and its place are both of the bench, or neither is",
                    fault.id
                )));
            }
            check(fault)?;
        }
        Ok(catalogue)
    }

    /// The fault mode called `id`.
    pub fn fault(&self, id: &str) -> Option<&FaultMode> {
        self.faults.iter().find(|f| f.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::injection::{Effect, FaultKind};

    const PARTS: &str = "lrus = [{ id = \"a\", name = \"A\", name_ko = \"A\" }]\n";
    const FAULT: &str = r#"
[[faults]]
id = "a.b"
lru = "a"
mode = "m"
severity = "major"
weight = 1.0
unsafe = false
place = "brake_cylinder"
effect = { kind = "gain", factor = 0.5 }
car = 5
"#;

    /// What is wrong with the catalogue when `from` in its fault is `to`; empty = nothing.
    fn wrong(from: &str, to: &str) -> String {
        assert!(FAULT.contains(from), "{from}");
        let text = format!("{PARTS}{}", FAULT.replace(from, to));
        let read = FaultCatalogue::from_toml(&text);
        read.err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    }

    #[test]
    fn the_shipped_catalogue_is_sound_and_names_cars_where_the_train_has_the_part() {
        let text = include_str!("../../../scripts/units/faults.toml");
        let catalogue = FaultCatalogue::from_toml(text).unwrap();
        let weak = catalogue.fault("brake_cylinder.weak").unwrap();
        assert_eq!(weak.car, Some(5));
        assert!(
            catalogue
                .faults
                .iter()
                .any(|f| f.place.on_train() && !f.place.on_car())
        );
    }

    /// A laptop reaches the TEST board, what its signals go through, and what the self-test tests: such a mode is out
    /// of its reach only while it acts on wheels that turn.
    #[test]
    fn what_test_signals_go_through_is_out_of_reach_only_while_the_wheels_turn() {
        use crate::injection::{Occurrence, OutOfReach, Place};
        let text = include_str!("../../../scripts/units/faults.toml");
        let catalogue = FaultCatalogue::from_toml(text).unwrap();
        for mode in &catalogue.faults {
            let tested = matches!(
                mode.place,
                Place::AtpAntenna
                    | Place::AtpReceiver
                    | Place::EbRelay
                    | Place::MarkerAntenna
                    | Place::Tra
                    | Place::TwcAntenna
                    | Place::FskReceiver
                    | Place::FskTransmitter
                    | Place::TwcCpu
                    | Place::TcmsReceiver
                    | Place::TcmsTransmitter
                    | Place::TestBoard
                    | Place::TestCode
                    | Place::TestCarrier
                    | Place::TestRate
                    | Place::TestSpeed
                    | Place::TestMarker
                    | Place::Memory
                    | Place::Clock
                    | Place::TrackDatabase
            );
            let turning = matches!(mode.occurs, Occurrence::AboveSpeed { .. });
            let expected = turning.then_some(OutOfReach::Motion);
            if tested || turning {
                assert_eq!(mode.out_of_reach, expected, "{}", mode.id);
            }
        }
    }

    #[test]
    fn a_fault_mode_that_cannot_be_injected_is_refused_with_the_reason() {
        let rows = include_str!("wrong_faults.txt").lines().skip(1);
        for row in rows.map(|row| row.replace("\\n", "\n")) {
            let [from, to, expected] = row.split(" | ").collect::<Vec<_>>()[..] else {
                panic!("{row}")
            };
            let said = wrong(from, to);
            assert!(said.starts_with(expected), "{to}: {said}");
        }
        assert_eq!(wrong("a.b", "a.b"), "");
        let twice = FaultCatalogue::from_toml(&format!("{PARTS}{FAULT}{FAULT}"));
        assert_eq!(twice.unwrap_err().to_string(), "fault a.b is listed twice");
        let parts = PARTS.replace("]", ", { id = \"a\", name = \"A\", name_ko = \"A\" }]");
        let twice = FaultCatalogue::from_toml(&format!("faults = []\n{parts}"));
        assert_eq!(twice.unwrap_err().to_string(), "part a is listed twice");
    }

    /// What the unit's memory holds is there from power-up on.
    #[test]
    fn a_fault_of_stored_data_has_no_onset_and_is_not_intermittent() {
        for (key, line) in [
            ("onset_s", "onset_s = 3.0"),
            ("occurs", "occurs = { when = \"above_speed\", kmh = 30.0 }"),
        ] {
            let text = FAULT.replace("brake_cylinder", "wheel_parameter");
            let text = text.replace("car = 5", line);
            let said = FaultCatalogue::from_toml(&format!("{PARTS}{text}")).unwrap_err();
            assert_eq!(
                said.to_string(),
                format!(
                    "fault a.b: wheel_parameter is stored data, wrong from power-up on: leave {key} out"
                )
            );
        }
    }

    /// What is wrong when these lines are added to the fault.
    fn wrong_with(lines: &str) -> String {
        wrong("car = 5", &format!("car = 5\n{lines}"))
    }

    #[test]
    fn occurrences_and_levels_that_make_no_sense_are_refused_with_the_reason() {
        let occurs = |rest: &str| wrong_with(&format!("occurs = {{ when = {rest} }}"));
        assert!(occurs("\"sometimes\"").contains("unknown variant `sometimes`"));
        let warm = "onset_s = 2.0\noccurs = { when = \"when_warm\", after_s = 1.0, full_s = 1.0 }";
        assert_eq!(
            wrong_with(warm),
            "fault a.b: what comes with warmth begins at occurs.after_s: leave onset_s out"
        );
        assert!(
            wrong_with("levels = [0.6, 1.5]")
                .starts_with("fault a.b: levels = 1.5 is outside 0 .. 1")
        );
        for twice in ["levels = [0.6, 0.6]", "levels = [0.5]"] {
            assert!(wrong_with(twice).contains("twice, or effect.factor has it already"));
        }
        let stuck = wrong(
            "effect = { kind = \"gain\", factor = 0.5 }",
            "effect = { kind = \"stuck_on\" }\nlevels = [0.5]",
        );
        assert_eq!(stuck, "fault a.b: stuck_on has no levels: leave them out");
    }

    #[test]
    fn a_mode_has_a_kind_and_is_had_at_its_levels() {
        let read = |lines: &str| {
            let text = format!("{PARTS}{FAULT}{lines}");
            FaultCatalogue::from_toml(&text).unwrap().faults.remove(0)
        };
        let mode = read("levels = [0.6, 0.7]");
        assert_eq!(mode.kind(), FaultKind::Degraded);
        let factors: Vec<_> = (0..4).map(|i| mode.at_level(i).map(|m| m.effect)).collect();
        let gain = |factor| Some(Effect::Gain { factor });
        assert_eq!(factors, [gain(0.5), gain(0.6), gain(0.7), None]);
        let comes = read("occurs = { when = \"at_times\", on_s = 1.0, off_s = 5.0 }");
        assert_eq!(comes.kind(), FaultKind::Intermittent);
        assert_eq!(comes.at_level(0), Some(comes.clone()));
        let dead = FaultMode {
            effect: Effect::Dead,
            ..mode
        };
        assert_eq!(dead.kind(), FaultKind::Permanent);
    }

    /// Neighbouring levels lie on one side of the value of a good part: a good part lies between the sides.
    #[test]
    fn next_levels_are_on_one_side_of_a_good_part() {
        let next = |effect: &str, levels: &str| {
            let gain = "effect = { kind = \"gain\", factor = 0.5 }";
            let fault = FAULT
                .replace("brake_cylinder", "speed_sensor1")
                .replace("car = 5\n", "");
            let text = format!("{PARTS}{}levels = {levels}", fault.replace(gain, effect));
            FaultCatalogue::from_toml(&text).unwrap().faults[0].next_levels()
        };
        let gain = "effect = { kind = \"gain\", factor = 1.04 }";
        assert_eq!(next(gain, "[0.96, 1.02, 1.08]"), [[2, 0], [0, 3]]);
        assert_eq!(
            next("effect = { kind = \"noise\", per_s = 80.0 }", "[40.0]"),
            [[1, 0]]
        );
        assert!(next(gain, "[]").is_empty());
    }
}
