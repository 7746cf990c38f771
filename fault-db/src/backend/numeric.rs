//! Decodes PostgreSQL's binary `numeric`, the type of sums of integers and of quotients.

use super::value::Field;

const NEGATIVE: u16 = 0x4000;

/// Decodes the binary format: number of base-10000 digits, weight of the first digit, sign, scale, digits. Gives an
/// integer for a whole number, else the nearest double; `None` if the bytes are cut off.
pub(super) fn field(raw: &[u8]) -> Option<Field<'static>> {
    let mut words = raw
        .chunks_exact(2)
        .map(|two| u16::from_be_bytes([two[0], two[1]]));
    let (count, weight) = (words.next()?, words.next()?.cast_signed());
    let (sign, decimals) = (words.next()?, words.next()?);
    if sign & !NEGATIVE != 0 {
        // NaN or infinite.
        return Some(Field::Real(f64::NAN));
    }
    let groups: Vec<i64> = words.map(i64::from).collect();
    if groups.len() != usize::from(count) {
        return None;
    }
    let sign = if sign == NEGATIVE { -1 } else { 1 };
    if decimals == 0 {
        let whole = (0..=weight.max(-1)).try_fold(0i64, |whole, place| {
            let group = groups.get(place as usize).copied().unwrap_or(0);
            whole.checked_mul(10_000)?.checked_add(group)
        });
        if let Some(whole) = whole {
            return Some(Field::Integer(sign * whole));
        }
    }
    // By way of text, which gives the nearest double, as in a file.
    let text: String = groups.iter().map(|group| format!("{group:04}")).collect();
    let exponent = 4 * (i32::from(weight) + 1 - groups.len() as i32);
    let value: f64 = format!("0{text}e{exponent}").parse().ok()?;
    Some(Field::Real(sign as f64 * value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(words: &[i32]) -> Option<Field<'static>> {
        let bytes = |word: &i32| (*word as u16).to_be_bytes();
        field(&words.iter().flat_map(bytes).collect::<Vec<_>>())
    }

    /// 1 2345, -5 0000, 12 0000 0000, -0.05, 3.25, 1e36, 0, not a number, truncated: worked by hand from the
    /// layout in PostgreSQL's numeric.c.
    #[test]
    fn decimal_numbers_are_read() {
        assert_eq!(of(&[2, 1, 0, 0, 1, 2345]), Some(Field::Integer(12_345)));
        assert_eq!(of(&[1, 1, 0x4000, 0, 5]), Some(Field::Integer(-50_000)));
        let large = Field::Integer(1_200_000_000);
        assert_eq!(of(&[1, 2, 0, 0, 12]), Some(large));
        assert_eq!(of(&[1, -1, 0x4000, 2, 500]), Some(Field::Real(-0.05)));
        assert_eq!(of(&[2, 0, 0, 2, 3, 2500]), Some(Field::Real(3.25)));
        assert_eq!(of(&[1, 9, 0, 0, 1]), Some(Field::Real(1e36)));
        assert_eq!(of(&[0, 0, 0, 0]), Some(Field::Integer(0)));
        let nothing = of(&[0, 0, 0xC000, 0]);
        assert!(matches!(nothing, Some(Field::Real(nan)) if nan.is_nan()));
        assert_eq!(of(&[2, 0, 0, 0, 1]), None);
        assert_eq!(of(&[0, 1]), None);
    }
}
