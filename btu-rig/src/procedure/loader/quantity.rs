//! Quantities of scripts: a number with its dimension.

use std::cmp::Ordering;

use crate::procedure::origin::Origin;

protocol::labelled! {
    /// Dimension of a quantity, with the unit in which it is kept.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum Dimension: unit {
        /// km/h.
        Speed = "km/h",
        /// m/s².
        Acceleration = "m/s²",
        /// ms.
        Time = "ms",
        /// m.
        Distance = "m",
        /// Hz.
        Frequency = "Hz",
        /// mV.
        Level = "mV",
        /// kg.
        Mass = "kg",
    }
}

/// Units by their name, as scripts call them and as keys of configuration files end; with the factor to the unit of the
/// dimension. Where a key ends in the names of two units, the first in this table counts.
pub(super) const UNITS: [(&str, Dimension, f64); 11] = [
    ("kmh_per_s", Dimension::Acceleration, 1.0 / 3.6),
    ("mps2", Dimension::Acceleration, 1.0),
    ("kmh", Dimension::Speed, 1.0),
    ("mps", Dimension::Speed, 3.6),
    ("ms", Dimension::Time, 1.0),
    ("mm", Dimension::Distance, 0.001),
    ("hz", Dimension::Frequency, 1.0),
    ("mv", Dimension::Level, 1.0),
    ("kg", Dimension::Mass, 1.0),
    ("s", Dimension::Time, 1000.0),
    ("m", Dimension::Distance, 1.0),
];

impl Dimension {
    /// The dimension of signals and measurements in `unit`; `None` for plain numbers.
    pub(super) fn of_unit(unit: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.unit() == unit)
    }

    /// Name with article and example, for messages.
    pub(super) const fn wanted(self) -> &'static str {
        match self {
            Self::Speed => "a speed such as kmh(55)",
            Self::Acceleration => "an acceleration such as kmh_per_s(1)",
            Self::Time => "a time such as s(2)",
            Self::Distance => "a distance such as m(10)",
            Self::Frequency => "a frequency such as hz(15)",
            Self::Level => "a level such as mv(500)",
            Self::Mass => "a mass such as kg(20000)",
        }
    }

    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Acceleration => "acceleration",
            Self::Time => "time",
            Self::Distance => "distance",
            Self::Frequency => "frequency",
            Self::Level => "level",
            Self::Mass => "mass",
        }
    }

    /// Name with article.
    pub(super) fn found(self) -> String {
        let article = match self {
            Self::Acceleration => "an",
            _ => "a",
        };
        format!("{article} {}", self.word())
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Quantity {
    pub dimension: Dimension,
    /// Value in the dimension's unit.
    pub value: f64,
    /// Where the value comes from.
    pub origin: Origin,
}

impl Quantity {
    /// `value` is rounded to a thousand-millionth, so that 1.1 s are 1100 ms and not a hair more.
    pub(super) fn new(dimension: Dimension, value: f64, origin: Origin) -> Self {
        let rounded = (value * 1e9).round() / 1e9;
        // Huge numbers would overflow on the way.
        let value = if rounded.is_finite() { rounded } else { value };
        Self {
            dimension,
            value,
            origin,
        }
    }

    /// Sum or difference.
    pub(super) fn plus(&self, other: &Self, sign: f64) -> Result<Self, String> {
        self.same(other, if sign < 0.0 { "subtract" } else { "add" })?;
        let mut origin = self.origin.clone();
        origin.join(&other.origin);
        let sum = self.value + sign * other.value;
        Ok(Self::new(self.dimension, sum, origin))
    }

    /// Multiple.
    pub(super) fn times(&self, factor: f64) -> Self {
        Self::new(self.dimension, self.value * factor, self.origin.clone())
    }

    pub(super) fn compare(&self, other: &Self) -> Result<Ordering, String> {
        self.same(other, "compare")?;
        Ok(self.value.total_cmp(&other.value))
    }

    fn same(&self, other: &Self, verb: &str) -> Result<(), String> {
        if self.dimension == other.dimension {
            return Ok(());
        }
        let (a, b) = (self.dimension.found(), other.dimension.found());
        Err(format!("cannot {verb} {a} ({self}) and {b} ({other})"))
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let number = crate::stimulus::text::number(self.value);
        write!(f, "{number} {}", self.dimension.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_like_quantities_mix() {
        let of = |dimension, value| Quantity::new(dimension, value, Origin::lacking());
        let speed = of(Dimension::Speed, 55.0);
        let time = of(Dimension::Time, 1100.0);
        assert_eq!(speed.plus(&speed, -1.0).unwrap().value, 0.0);
        assert_eq!(
            speed.plus(&time, 1.0).unwrap_err(),
            "cannot add a speed (55 km/h) and a time (1100 ms)"
        );
        assert!(speed.compare(&time).is_err());
        assert_eq!(of(Dimension::Time, 1.1 * 1000.0).value, 1100.0);
    }
}
