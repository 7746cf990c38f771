//! Quantities of configuration files: `detect_ms = 400` is the time `detect`, and knows where it comes from.

use super::item::Item;
use super::quantity::{Dimension, Quantity, UNITS};
use crate::procedure::origin::Origin;

/// Quantities of the keys that end in a unit, each under its key without the unit. Where two keys would share a name,
/// the kind of quantity follows the name: `standstill_speed`. In origins `source` stands before the key.
pub(super) fn of(fields: &[(String, Item)], source: &str) -> Vec<(String, Item)> {
    let found = fields
        .iter()
        .filter_map(|(key, value)| of_key(key, value, source));
    let found: Vec<_> = found.collect();
    let times = |name: &String| found.iter().filter(|(other, ..)| other == name).count();
    let named = found.iter().map(|(name, dimension, amount)| {
        let name = match times(name) {
            1 => name.clone(),
            _ => format!("{name}_{}", dimension.word()),
        };
        (name, amount.clone())
    });
    named
        .filter(|(name, _)| fields.iter().all(|(key, _)| key != name))
        .collect()
}

fn of_key(key: &str, value: &Item, source: &str) -> Option<(String, Dimension, Item)> {
    let (name, dimension, factor) = UNITS.iter().find_map(|(unit, dimension, factor)| {
        let name = key.strip_suffix(unit)?.strip_suffix('_')?;
        Some((name, *dimension, *factor))
    })?;
    // `drag_per_s` is no time.
    if name.is_empty() || name.ends_with("_per") {
        return None;
    }
    let origin = Origin::of(format!("{source}{key}"));
    let amount = amount(value, &|number| {
        Quantity::new(dimension, number * factor, origin.clone())
    })?;
    Some((name.to_owned(), dimension, amount))
}

fn amount(value: &Item, make: &dyn Fn(f64) -> Quantity) -> Option<Item> {
    match value {
        Item::List(items) => {
            let all: Option<_> = items.iter().map(|item| amount(item, make)).collect();
            all.map(Item::List)
        }
        item => item.number().map(|number| Item::Quantity(make(number))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_with_a_unit_is_a_quantity_of_its_name() {
        for (key, name, shown) in [
            ("detect_ms", "detect", "2 ms"),
            ("dead_time_s", "dead_time", "2000 ms"),
            ("accel_kmh_per_s", "accel", "0.556 m/s²"),
            ("full_to_mps", "full_to", "7.2 km/h"),
            ("stop_m", "stop", "2 m"),
        ] {
            let (found, _, item) = of_key(key, &Item::Int(2), "configuration a.").expect(key);
            let Item::Quantity(quantity) = item else {
                panic!("{key} is {}", item.found());
            };
            assert_eq!(
                (found.as_str(), quantity.to_string().as_str()),
                (name, shown)
            );
            let source = quantity.origin.text();
            assert_eq!(source, Some(format!("configuration a.{key}")));
        }
        for key in [
            "drag_per_s",
            "s_curve_s_per_mps",
            "jerk_mps3",
            "number",
            "_m",
        ] {
            assert!(of_key(key, &Item::Int(2), "").is_none(), "{key}");
        }
    }

    #[test]
    fn keys_that_differ_in_their_unit_alone_are_told_apart() {
        let keys = [
            "standstill_kmh",
            "standstill_ms",
            "fall_ms",
            "creep_m",
            "creep",
        ];
        let fields = keys.map(|key| (key.to_owned(), Item::Int(1)));
        let names: Vec<_> = of(&fields, "").into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["standstill_speed", "standstill_time", "fall"]);
    }
}
