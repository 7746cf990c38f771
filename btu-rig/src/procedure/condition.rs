//! Conditions over signals: three-valued, so that missing data is never taken for an answer.

use protocol::signal::{Kind, Sample, Signal};
use serde::{Deserialize, Serialize};

use super::Driver;
use super::names::{Name, Part};

/// Number with which a signal is compared, or limit of a measurement, in the unit of the signal or measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Operand {
    /// Written in the script.
    Literal(f64),
    /// Measured by an earlier step.
    Measured {
        /// Place of the measurement in the procedure.
        slot: usize,
        /// Name of the measurement, for people.
        name: String,
        /// Amount added to the measured value, in the unit of the measurement.
        offset: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Comparison {
    Equal,
    /// The values differ, rounded to the signal's recorded step.
    NotEqual,
    /// Less.
    Below,
    /// Less or equal.
    AtMost,
    /// Greater.
    Above,
    /// Greater or equal.
    AtLeast,
    /// The signal is no further from the operand than `tolerance`.
    Near {
        /// Greatest distance, in the signal's unit.
        tolerance: f64,
    },
    /// All these bits are set.
    Has,
    /// None of these bits is set.
    Lacks,
}

impl Comparison {
    /// The comparison is about bits, not about a number's size.
    pub fn is_bits(self) -> bool {
        matches!(self, Self::Has | Self::Lacks)
    }
}

/// A statement about signals that is true, false or unknown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Condition {
    /// One signal against one operand.
    Compare {
        /// Signal of the present sample.
        signal: Signal,
        /// Comparison by value, or by bits ([`Comparison::is_bits`]).
        comparison: Comparison,
        /// Right-hand side, in the signal's unit.
        operand: Operand,
    },
    /// Every part holds.
    All(Vec<Condition>),
    /// At least one part holds.
    Any(Vec<Condition>),
}

/// Values captured by the procedure's measures so far, by slot.
pub(super) type Captured = [Option<f64>];

/// The data that a condition or limit needs and that are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MissingData {
    /// A signal is not known.
    Signal(Signal),
    /// An earlier measurement has no value.
    Measurement,
}

impl std::fmt::Display for MissingData {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Signal(signal) => write!(
                f,
                "no data for {}",
                Part(Name(signal.name()), f.alternate())
            ),
            Self::Measurement => f.write_str("an earlier measurement it refers to has no value"),
        }
    }
}

/// Answer to a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    Yes,
    No,
    NoData(MissingData),
}

impl Operand {
    pub(super) fn value(&self, captured: &Captured) -> Result<f64, MissingData> {
        let value = match self {
            Self::Literal(value) => Some(*value),
            Self::Measured { slot, offset, .. } => {
                captured.get(*slot).copied().flatten().map(|v| v + offset)
            }
        };
        value
            .filter(|v| v.is_finite())
            .ok_or(MissingData::Measurement)
    }
}

impl Condition {
    /// Whether the condition holds in `sample`.
    pub(super) fn truth(&self, sample: &Sample, captured: &Captured) -> Answer {
        match self {
            Self::Compare {
                signal,
                comparison,
                operand,
            } => compare(*signal, *comparison, operand, sample, captured),
            Self::All(parts) => fold(parts, sample, captured, Answer::Yes, Answer::No),
            Self::Any(parts) => fold(parts, sample, captured, Answer::No, Answer::Yes),
        }
    }

    /// Detail that the driver gives for the first of the condition's signals that has a detail.
    pub(super) fn said<'a>(&self, driver: &'a dyn Driver) -> Option<&'a str> {
        let mut said = None;
        self.for_each_signal(&mut |signal| said = said.or_else(|| driver.said(signal)));
        said
    }

    /// Calls `f` with each signal that the condition looks at.
    pub fn for_each_signal(&self, f: &mut impl FnMut(Signal)) {
        match self {
            Self::Compare { signal, .. } => f(*signal),
            Self::All(parts) | Self::Any(parts) => {
                parts.iter().for_each(|part| part.for_each_signal(f));
            }
        }
    }

    /// Calls `f` with each operand and the signal that is compared with the operand.
    pub(super) fn try_for_each_operand<E>(
        &mut self,
        f: &mut impl FnMut(Signal, &mut Operand) -> Result<(), E>,
    ) -> Result<(), E> {
        match self {
            Self::Compare {
                signal, operand, ..
            } => f(*signal, operand),
            Self::All(parts) | Self::Any(parts) => parts
                .iter_mut()
                .try_for_each(|part| part.try_for_each_operand(f)),
        }
    }
}

/// `decisive` if any part gives this answer; else `NoData` if any part lacks data; else `otherwise`.
fn fold(
    parts: &[Condition],
    sample: &Sample,
    captured: &Captured,
    otherwise: Answer,
    decisive: Answer,
) -> Answer {
    let mut result = otherwise;
    for part in parts {
        match part.truth(sample, captured) {
            truth if truth == decisive => return decisive,
            missing_data @ Answer::NoData(_) => result = missing_data,
            _ => {}
        }
    }
    result
}

/// Both sides are rounded to the signal's recorded step first: a limit of 55 km/h is 1528 cm/s on
/// the wire, 55.008 km/h in a sample, and still *is* 55 km/h.
fn compare(
    signal: Signal,
    comparison: Comparison,
    operand: &Operand,
    sample: &Sample,
    captured: &Captured,
) -> Answer {
    let Some(found) = sample.get(signal).filter(|v| v.is_finite()) else {
        return Answer::NoData(MissingData::Signal(signal));
    };
    let wanted = match operand.value(captured) {
        Ok(wanted) => wanted,
        Err(missing_data) => return Answer::NoData(missing_data),
    };
    let lsb = match signal.definition().kind {
        Kind::Number { lsb } => lsb,
        Kind::Enum(_) | Kind::Bit => 1.0,
    };
    let (left, right) = ((found / lsb).round(), (wanted / lsb).round());
    let holds = match comparison {
        Comparison::Equal => left == right,
        Comparison::NotEqual => left != right,
        Comparison::Below => left < right,
        Comparison::AtMost => left <= right,
        Comparison::Above => left > right,
        Comparison::AtLeast => left >= right,
        // Half a recorded step of grace: the tolerance is meant for the true value, not for the rounded one.
        Comparison::Near { tolerance } => (found - wanted).abs() <= tolerance + lsb / 2.0,
        Comparison::Has => bits(found) & bits(wanted) == bits(wanted),
        Comparison::Lacks => bits(found) & bits(wanted) == 0,
    };
    if holds { Answer::Yes } else { Answer::No }
}

/// A value as the set of bits it stands for.
fn bits(value: f64) -> u32 {
    value as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is(signal: Signal, comparison: Comparison, value: f64) -> Condition {
        Condition::Compare {
            signal,
            comparison,
            operand: Operand::Literal(value),
        }
    }

    fn sample(limit: f64) -> Sample {
        let mut sample = Sample::default();
        sample.set(Signal::Limit, limit);
        sample
    }

    #[test]
    fn each_comparison_below_at_and_above() {
        let wire_55 = 15.28 * 3.6;
        let table = [
            (Comparison::Equal, [false, true, false]),
            (Comparison::NotEqual, [true, false, true]),
            (Comparison::Below, [true, false, false]),
            (Comparison::AtMost, [true, true, false]),
            (Comparison::Above, [false, false, true]),
            (Comparison::AtLeast, [false, true, true]),
            (Comparison::Near { tolerance: 0.5 }, [false, true, false]),
        ];
        for (comparison, expected) in table {
            for (value, expected) in [54.0, wire_55, 56.0].into_iter().zip(expected) {
                let truth = is(Signal::Limit, comparison, 55.0).truth(&sample(value), &[]);
                assert_eq!(truth == Answer::Yes, expected, "{comparison:?} {value}");
            }
            for value in [f64::NAN, f64::INFINITY] {
                let truth = is(Signal::Limit, comparison, 55.0).truth(&sample(value), &[]);
                assert_eq!(truth, Answer::NoData(MissingData::Signal(Signal::Limit)));
            }
        }
    }

    #[test]
    fn bits_are_all_there_or_all_away() {
        // Found, wanted, has, lacks.
        for (found, wanted, has, lacks) in [
            (0b0000, 0b0001, false, true),
            (0b0101, 0b0001, true, false),
            (0b0101, 0b0101, true, false),
            (0b0100, 0b0101, false, false),
            (0b1010, 0b0101, false, true),
        ] {
            let mut sample = Sample::default();
            sample.set(Signal::Lamps, f64::from(found));
            for (comparison, expected) in [(Comparison::Has, has), (Comparison::Lacks, lacks)] {
                let condition = is(Signal::Lamps, comparison, f64::from(wanted));
                let truth = condition.truth(&sample, &[]);
                assert_eq!(truth == Answer::Yes, expected, "{found:b} {condition:?}");
                let missing_data = Answer::NoData(MissingData::Signal(Signal::Lamps));
                assert_eq!(condition.truth(&Sample::default(), &[]), missing_data);
            }
        }
    }

    #[test]
    fn missing_data_never_makes_a_group_true() {
        let known = is(Signal::Limit, Comparison::Above, 50.0);
        let known_false = is(Signal::Limit, Comparison::Below, 50.0);
        let missing = is(Signal::Eb, Comparison::Equal, 1.0);
        let missing_data = Answer::NoData(MissingData::Signal(Signal::Eb));
        let cases = [
            (
                Condition::All(vec![known.clone(), missing.clone()]),
                missing_data,
            ),
            (
                Condition::All(vec![missing.clone(), known_false.clone()]),
                Answer::No,
            ),
            (Condition::Any(vec![missing.clone(), known]), Answer::Yes),
            (Condition::Any(vec![known_false, missing]), missing_data),
        ];
        for (condition, expected) in cases {
            assert_eq!(
                condition.truth(&sample(55.0), &[]),
                expected,
                "{condition:?}"
            );
        }
    }

    #[test]
    fn a_measured_operand_needs_its_measurement() {
        let condition = Condition::Compare {
            signal: Signal::Limit,
            comparison: Comparison::Above,
            operand: Operand::Measured {
                slot: 0,
                name: "v".into(),
                offset: 1.0,
            },
        };
        assert_eq!(condition.truth(&sample(55.0), &[Some(53.0)]), Answer::Yes);
        assert_eq!(condition.truth(&sample(55.0), &[Some(54.5)]), Answer::No);
        for captured in [&[None][..], &[Some(f64::NAN)], &[]] {
            assert_eq!(
                condition.truth(&sample(55.0), captured),
                Answer::NoData(MissingData::Measurement)
            );
        }
    }
}
