//! Verbs that make a quantity of a number: `kmh(40)`, `s(1)`.

use super::conditions::SOURCE;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::{Quantity, UNITS};
use crate::procedure::loader::verb::{Param, Verb, needs};
use crate::procedure::origin::Origin;

const NUMBER: &[Param] = &[needs("value", ParamType::Number), SOURCE];

const fn unit(name: &'static str) -> Verb {
    Verb {
        name,
        params: NUMBER,
        make: quantity,
    }
}

pub(super) static VERBS: &[Verb] = &[
    unit("kmh"),
    unit("mps"),
    unit("kmh_per_s"),
    unit("mps2"),
    unit("s"),
    unit("ms"),
    unit("m"),
    unit("mm"),
    unit("hz"),
    unit("mv"),
    unit("kg"),
];

fn quantity(args: &Args<'_>) -> Result<Item, String> {
    let mut units = UNITS.into_iter();
    let unit = units.find(|(name, ..)| *name == args.verb.name);
    let (_, dimension, factor) = unit.ok_or("no such unit")?;
    let value = args.number("value")? * factor;
    let origin = args.stated(Origin::lacking());
    Ok(Item::Quantity(Quantity::new(dimension, value, origin)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_verb_is_a_unit_and_each_unit_has_a_verb() {
        let mut verbs: Vec<_> = VERBS.iter().map(|verb| verb.name).collect();
        let mut units = UNITS.map(|(name, ..)| name);
        verbs.sort_unstable();
        units.sort_unstable();
        assert_eq!(verbs, units);
    }
}
