//! Range checks of stimulus values: a number the bench cannot make is refused, not clipped.

use crate::procedure::Refusal;

/// Greatest value of a 16-bit field.
pub const U16_MAX: f64 = u16::MAX as f64;

/// `value`, if it lies within `low ..= high`.
///
/// # Errors
/// Names the quantity, the value and the range; not-a-number is outside every range.
pub fn in_range(what: &str, value: f64, low: f64, high: f64, unit: &str) -> Result<f64, Refusal> {
    if value >= low && value <= high {
        return Ok(value);
    }
    Err(Refusal(format!(
        "{what} {value} {unit} is outside {low} .. {high} {unit}"
    )))
}

/// `value`, if it is above 0 and at most `high`.
///
/// # Errors
/// As for [`in_range`].
pub fn positive(what: &str, value: f64, high: f64, unit: &str) -> Result<f64, Refusal> {
    if value > 0.0 && value <= high {
        return Ok(value);
    }
    Err(Refusal(format!(
        "{what} {value} {unit} must be above 0 and at most {high} {unit}"
    )))
}
