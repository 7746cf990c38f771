//! Meaning of the values in a Parquet column: its logical type, or the older converted one.

use parquet::basic::{ConvertedType, LogicalType, TimeUnit as Parquet, Type as Physical};
use parquet::schema::types::ColumnDescriptor;

use super::times::TimeUnit;

/// Longest number of a decimal column, bytes.
const LONGEST: usize = 16;

/// Conversion of stored values to numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Values {
    /// Numbers as they are.
    Plain,
    Unsigned,
    /// Whole numbers, of which this many digits stand behind the point.
    Decimal(i32),
    /// IEEE 754 of 16 bits.
    Half,
    /// Texts, which may be numbers or words of a signal.
    Words,
    /// Whole numbers of this unit: from the trigger, or from 1970 on.
    Times {
        unit: TimeUnit,
        is_utc: bool,
    },
}

impl Values {
    /// Conversion of the values of a column.
    ///
    /// # Errors
    /// The reason for which they are no samples.
    pub fn of(column: &ColumnDescriptor) -> Result<Self, String> {
        if column.max_rep_level() > 0 || column.max_def_level() > 1 {
            return Err("it has lists or parts, not one value a row".to_owned());
        }
        let times = |unit, is_utc| Ok(Self::Times { unit, is_utc });
        let of = |unit: &Parquet| match unit {
            Parquet::MILLIS => TimeUnit::Milliseconds,
            Parquet::MICROS => TimeUnit::Microseconds,
            Parquet::NANOS => TimeUnit::Nanoseconds,
        };
        match column.logical_type_ref() {
            Some(LogicalType::Timestamp(time)) => return times(of(&time.unit), true),
            Some(LogicalType::Time(time)) => return times(of(&time.unit), false),
            Some(LogicalType::Decimal(decimal)) => {
                return Ok(Self::Decimal(decimal.scale));
            }
            Some(LogicalType::Integer(int)) if !int.is_signed => {
                return Ok(Self::Unsigned);
            }
            Some(LogicalType::Float16) => return Ok(Self::Half),
            Some(LogicalType::Integer(_) | LogicalType::String | LogicalType::Enum) | None => {}
            Some(other) => return Err(format!("values of the type {other:?} are no samples")),
        }
        match (column.converted_type(), column.physical_type()) {
            (ConvertedType::TIMESTAMP_MILLIS, _) => times(TimeUnit::Milliseconds, true),
            (ConvertedType::TIMESTAMP_MICROS, _) => times(TimeUnit::Microseconds, true),
            (ConvertedType::TIME_MILLIS, _) => times(TimeUnit::Milliseconds, false),
            (ConvertedType::TIME_MICROS, _) => times(TimeUnit::Microseconds, false),
            (ConvertedType::DECIMAL, _) => Ok(Self::Decimal(column.type_scale())),
            (
                ConvertedType::UINT_8
                | ConvertedType::UINT_16
                | ConvertedType::UINT_32
                | ConvertedType::UINT_64,
                _,
            ) => Ok(Self::Unsigned),
            (_, Physical::BYTE_ARRAY) => Ok(Self::Words),
            (_, Physical::INT96 | Physical::FIXED_LEN_BYTE_ARRAY) => Err(format!(
                "values of the type {} are no samples",
                column.physical_type()
            )),
            _ => Ok(Self::Plain),
        }
    }

    pub fn of_32(self, number: i32) -> f64 {
        match self {
            Self::Unsigned => number.cast_unsigned().into(),
            _ => self.scaled(number.into()),
        }
    }

    pub fn of_64(self, number: i64) -> f64 {
        match self {
            Self::Unsigned => number.cast_unsigned() as f64,
            _ => self.scaled(number as f64),
        }
    }

    /// A number of several bytes, the highest first, or a half float.
    ///
    /// # Errors
    /// The bytes are longer than any number here, or no number.
    pub fn of_bytes(self, bytes: &[u8]) -> Result<f64, String> {
        match (self, bytes) {
            (Self::Half, [low, high]) => Ok(half(u16::from_le_bytes([*low, *high]))),
            (Self::Decimal(_), [first, ..]) if bytes.len() <= LONGEST => {
                let sign = if *first < 0x80 { 0 } else { 0xff };
                let mut all = [sign; LONGEST];
                all[LONGEST - bytes.len()..].copy_from_slice(bytes);
                Ok(self.scaled(i128::from_be_bytes(all) as f64))
            }
            _ => Err(format!("{} bytes are no number", bytes.len())),
        }
    }

    fn scaled(self, number: f64) -> f64 {
        match self {
            // The power of ten is exact, its inverse is not.
            Self::Decimal(digits) => number / 10f64.powi(digits),
            _ => number,
        }
    }
}

/// IEEE 754 of 16 bits: a sign, five bits of exponent, ten of fraction.
fn half(bits: u16) -> f64 {
    let fraction = f64::from(bits & 0x3ff);
    let size = match bits >> 10 & 0x1f {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1024.0 + fraction) * 2f64.powi(i32::from(exponent) - 25),
    };
    if bits & 0x8000 == 0 { size } else { -size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_form_are_what_they_say() {
        assert_eq!(Values::Unsigned.of_32(-1_294_967_296), 3e9);
        assert_eq!(Values::Unsigned.of_64(-1), u64::MAX as f64);
        assert_eq!(Values::Decimal(2).of_32(3_294), 32.94);
        assert_eq!(Values::Decimal(2).of_bytes(&[0xff, 0x38]), Ok(-2.0));
        assert_eq!(Values::Half.of_bytes(&[0x00, 0xc5]), Ok(-5.0));
        assert_eq!(Values::Half.of_bytes(&[0x01, 0x00]), Ok(2f64.powi(-24)));
        assert!(Values::Decimal(0).of_bytes(&[1; 17]).is_err());
        assert_eq!(Values::Plain.of_32(-7), -7.0);
    }
}
