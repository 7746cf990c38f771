//! Little-endian base-128 integers, and the zigzag mapping that makes small negative numbers short.

/// Appends `value`, seven bits a byte, lowest first.
#[inline]
pub(super) fn put(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Takes a value off the front of `input`; `None` if it is cut off or has more than 64 bits.
#[inline]
pub(super) fn take(input: &mut &[u8]) -> Option<u64> {
    let (&first, rest) = input.split_first()?;
    if first < 0x80 {
        *input = rest;
        return Some(u64::from(first));
    }
    let mut value = 0u64;
    for (place, &byte) in input.iter().enumerate().take(10) {
        if place == 9 && byte > 1 {
            return None;
        }
        value |= u64::from(byte & 0x7F) << (7 * place);
        if byte < 0x80 {
            *input = &input[place + 1..];
            return Some(value);
        }
    }
    None
}

/// Maps 0, -1, 1, -2 … to 0, 1, 2, 3 …
#[inline]
pub(super) fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// Maps 0, 1, 2, 3 … to 0, -1, 1, -2 …
#[inline]
pub(super) fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 300 = 0b10_0101100: low seven bits 0101100 with the more-bit is AC, then 02.
    #[test]
    fn bytes_are_as_worked_by_hand() {
        let mut out = Vec::new();
        put(&mut out, 300);
        assert_eq!(out, [0xAC, 0x02]);
        assert_eq!([0, -1, 1, -2].map(zigzag), [0, 1, 2, 3]);
    }

    #[test]
    fn extremes_return_and_nonsense_does_not() {
        for value in [0, 127, 128, u64::from(u32::MAX), u64::MAX] {
            let mut out = Vec::new();
            put(&mut out, value);
            assert_eq!(take(&mut out.as_slice()), Some(value));
            assert_eq!(take(&mut &out[..out.len() - 1]), None, "{value} cut off");
        }
        for value in [i64::MIN, -1, 0, 1, i64::MAX] {
            assert_eq!(unzigzag(zigzag(value)), value);
        }
        let too_wide = [0xFF; 9].iter().chain(&[0x02]).copied().collect::<Vec<_>>();
        assert_eq!(take(&mut too_wide.as_slice()), None);
    }
}
