//! Verbs that make a quantity of a number: `kmh(40)`, `s(1)`.

use super::conditions::SOURCE;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::{Dimension, Quantity};
use crate::procedure::loader::verb::{Param, Verb, needs};
use crate::procedure::origin::Origin;

const NUMBER: &[Param] = &[needs("value", ParamType::Number), SOURCE];

macro_rules! unit {
    ($name:literal, $dimension:ident, $factor:expr) => {
        verb!($name, NUMBER, |args| quantity(
            args,
            Dimension::$dimension,
            $factor
        ))
    };
}

pub(super) static VERBS: &[Verb] = &[
    unit!("kmh", Speed, 1.0),
    unit!("mps", Speed, 3.6),
    unit!("kmh_per_s", Acceleration, 1.0 / 3.6),
    unit!("mps2", Acceleration, 1.0),
    unit!("s", Time, 1000.0),
    unit!("ms", Time, 1.0),
    unit!("m", Distance, 1.0),
    unit!("mm", Distance, 0.001),
    unit!("hz", Frequency, 1.0),
    unit!("mv", Level, 1.0),
    unit!("kg", Mass, 1.0),
];

fn quantity(args: &Args<'_>, dimension: Dimension, factor: f64) -> Result<Item, String> {
    let value = args.number("value")? * factor;
    let origin = args.stated(Origin::lacking());
    Ok(Item::Quantity(Quantity::new(dimension, value, origin)))
}
