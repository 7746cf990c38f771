//! Judging a measured value against its limits.

use super::Verdict;
use super::condition::{Captured, MissingData, Operand};

/// A limit as it stands when the value is judged: a number, none, or unknown, because it refers to a measurement without a
/// value.
pub(super) type Limit = Result<Option<f64>, MissingData>;

/// The limit that `operand` stands for now.
pub(super) fn resolve(operand: Option<&Operand>, captured: &Captured) -> Limit {
    operand.map(|operand| operand.value(captured)).transpose()
}

/// Passed if `low <= value <= high`, or if the value is outside by no more than its uncertainty: only what is
/// proved fails. A value or limit that is missing or not a finite number is an error: nothing but a comparison that
/// came out right may pass.
pub(super) fn judge(
    value: Option<f64>,
    uncertainty: Option<f64>,
    low: Limit,
    high: Limit,
) -> Verdict {
    let usable = |limit: Limit| limit.ok().filter(|limit| limit.is_none_or(f64::is_finite));
    let value = value.filter(|value| value.is_finite());
    let (Some(value), Some(low), Some(high)) = (value, usable(low), usable(high)) else {
        return Verdict::Error;
    };
    let off = uncertainty.unwrap_or(0.0);
    let low_holds = low.is_none_or(|low| value + off >= low);
    if low_holds && high.is_none_or(|high| value - off <= high) {
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
        let at = |limit| Ok(Some(limit));
        let (open, unknown) = (Ok(None), Err(MissingData::Measurement));
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
            ("none", open, open, [p, p, p, p, p, e, e, e]),
            ("low", at(10.0), open, [f, p, p, p, p, e, e, e]),
            ("high", open, at(20.0), [p, p, p, p, f, e, e, e]),
            ("both", at(10.0), at(20.0), [f, p, p, p, f, e, e, e]),
            ("crossed", at(20.0), at(10.0), [f, f, f, f, f, e, e, e]),
            ("low NaN", at(f64::NAN), open, [e; 8]),
            ("high NaN", open, at(f64::NAN), [e; 8]),
            ("low missing", unknown, at(20.0), [e; 8]),
            ("high missing", at(10.0), unknown, [e; 8]),
        ];
        for (name, low, high, expected) in table {
            for (value, expected) in values.into_iter().zip(expected) {
                assert_eq!(judge(value, None, low, high), expected, "{name} {value:?}");
            }
        }
    }

    #[test]
    fn a_value_fails_only_outside_its_uncertainty() {
        let (low, high) = (Ok(Some(10.0)), Ok(Some(20.0)));
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
        let captured = [None, Some(12.0)];
        assert_eq!(resolve(Some(&limit), &captured), Ok(Some(10.0)));
        let missing = Err(MissingData::Measurement);
        assert_eq!(resolve(Some(&limit), &[None, None]), missing);
        assert_eq!(resolve(None, &[]), Ok(None));
    }
}
