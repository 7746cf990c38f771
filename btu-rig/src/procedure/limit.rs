//! Judging a measured value against its limits.

use super::Verdict;
use super::condition::{Captured, Operand};

/// A limit as it stands when the value is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    Open,
    /// This number.
    At(f64),
    /// Given, but it refers to a measurement without a value.
    Unknown,
}

impl Bound {
    /// The bound that `limit` stands for now.
    pub(super) fn resolve(limit: Option<&Operand>, captured: &Captured) -> Self {
        match limit.map(|limit| limit.value(captured)) {
            None => Self::Open,
            Some(Ok(value)) => Self::At(value),
            Some(Err(_)) => Self::Unknown,
        }
    }

    pub(super) fn number(self) -> Option<f64> {
        match self {
            Self::At(value) => Some(value),
            Self::Open | Self::Unknown => None,
        }
    }
}

/// Passed if `low <= value <= high`, and while the value is outside by no more than its uncertainty: only what is
/// proved fails. A value or limit that is missing or not a finite number is an error: nothing but a comparison that
/// came out right may pass.
pub(super) fn judge(
    value: Option<f64>,
    uncertainty: Option<f64>,
    low: Bound,
    high: Bound,
) -> Verdict {
    let Some(value) = value.filter(|v| v.is_finite()) else {
        return Verdict::Error;
    };
    let unusable = |bound| match bound {
        Bound::Open => false,
        Bound::At(limit) => !f64::is_finite(limit),
        Bound::Unknown => true,
    };
    if unusable(low) || unusable(high) {
        return Verdict::Error;
    }
    let off = uncertainty.unwrap_or(0.0);
    let low_holds = low.number().is_none_or(|low| value + off >= low);
    let high_holds = high.number().is_none_or(|high| value - off <= high);
    if low_holds && high_holds {
        Verdict::Passed
    } else {
        Verdict::Failed
    }
}

#[cfg(test)]
mod tests {
    use super::Verdict::{Error, Failed, Passed};
    use super::*;

    #[test]
    fn each_kind_of_limit_against_each_kind_of_value() {
        use Bound::{At, Open, Unknown};
        let values = [
            Some(9.0),
            Some(10.0),
            Some(15.0),
            Some(20.0),
            Some(21.0),
            Some(f64::NAN),
            Some(f64::INFINITY),
            None,
        ];
        let (p, f, e) = (Passed, Failed, Error);
        let table = [
            ("none", Open, Open, [p, p, p, p, p, e, e, e]),
            ("low", At(10.0), Open, [f, p, p, p, p, e, e, e]),
            ("high", Open, At(20.0), [p, p, p, p, f, e, e, e]),
            ("both", At(10.0), At(20.0), [f, p, p, p, f, e, e, e]),
            ("crossed", At(20.0), At(10.0), [f, f, f, f, f, e, e, e]),
            ("low NaN", At(f64::NAN), Open, [e; 8]),
            ("high NaN", Open, At(f64::NAN), [e; 8]),
            ("low missing", Unknown, At(20.0), [e; 8]),
            ("high missing", At(10.0), Unknown, [e; 8]),
        ];
        for (name, low, high, expected) in table {
            for (value, expected) in values.into_iter().zip(expected) {
                assert_eq!(judge(value, None, low, high), expected, "{name} {value:?}");
            }
        }
    }

    #[test]
    fn a_value_fails_only_outside_its_uncertainty() {
        let (low, high) = (Bound::At(10.0), Bound::At(20.0));
        for (value, expected) in [
            (7.9, Failed),
            (8.0, Passed),
            (15.0, Passed),
            (22.0, Passed),
            (22.1, Failed),
        ] {
            assert_eq!(
                judge(Some(value), Some(2.0), low, high),
                expected,
                "{value}"
            );
        }
        assert_eq!(judge(None, Some(2.0), low, high), Error);
    }

    #[test]
    fn a_limit_may_be_an_earlier_measurement() {
        let limit = Operand::Measured {
            slot: 1,
            name: "v".into(),
            offset: -2.0,
        };
        let resolved = Bound::resolve(Some(&limit), &[None, Some(12.0)]);
        assert_eq!(resolved, Bound::At(10.0));
        assert_eq!(Bound::resolve(Some(&limit), &[None, None]), Bound::Unknown);
        assert_eq!(Bound::resolve(None, &[]), Bound::Open);
    }
}
