//! Sets of units as bit fields, indexed by the row numbers of units in a file.

/// A copy of the set with one unit added.
pub(crate) fn with(set: &[u8], unit: i64) -> Vec<u8> {
    let mut set = set.to_vec();
    insert(&mut set, unit);
    set
}

/// Adds one to a set.
pub(crate) fn insert(set: &mut Vec<u8>, unit: i64) {
    let Ok(unit) = usize::try_from(unit) else {
        return;
    };
    if set.len() <= unit / 8 {
        set.resize(unit / 8 + 1, 0);
    }
    set[unit / 8] |= 1 << (unit % 8);
}

/// Adds all of one set to another.
pub(crate) fn add(set: &mut Vec<u8>, more: &[u8]) {
    if set.len() < more.len() {
        set.resize(more.len(), 0);
    }
    for (byte, more) in set.iter_mut().zip(more) {
        *byte |= more;
    }
}

/// Number of units in the set.
pub(crate) fn count(set: &[u8]) -> u32 {
    set.iter().map(|byte| byte.count_ones()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_count_each_unit_once() {
        let mut set = [3, 900, 3]
            .iter()
            .fold(Vec::new(), |set, unit| with(&set, *unit));
        assert_eq!(count(&set), 2);
        add(&mut set, &with(&[], 4));
        add(&mut set, &with(&[], 900));
        assert_eq!(count(&set), 3);
    }
}
