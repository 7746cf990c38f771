//! Measurements.

use protocol::Duration;

use super::conditions::{SOURCE, amount, operand};
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::procedure::origin::Origin;
use crate::procedure::plan::{Measure, Operand, TimeFrom, What};

/// Time for which a measurement waits for its condition if neither `within` nor `high` gives a time.
const MEASURE_WITHIN: Duration = Duration::from_ms(10_000);
/// Time beyond its upper limit for which a measured time is waited for, so that a late one has a
/// value.
const BEYOND_LIMIT_MS: f64 = 1000.0;

const TIME: ParamType = ParamType::Amount(Dimension::Time);

/// A verb that measures one signal in the step, without a condition.
macro_rules! of_signal {
    ($name:literal, $what:ident) => {
        Verb {
            name: $name,
            params: &[
                needs("name", ParamType::Name),
                needs("signal", ParamType::Signal),
                takes("low", ParamType::Value),
                takes("high", ParamType::Value),
                SOURCE,
            ],
            make: |args| measure(args, What::$what(args.signal("signal")?)),
        }
    };
}

pub(super) static VERBS: &[Verb] = &[
    Verb {
        name: "time",
        params: &[
            needs("name", ParamType::Name),
            needs("to", ParamType::Condition),
            takes("from_", ParamType::TimeFrom),
            takes("low", ParamType::Value),
            takes("high", ParamType::Value),
            takes("within", TIME),
            SOURCE,
        ],
        make: |args| {
            let from = match args.get("from_") {
                Some(Item::Condition(condition, _)) => TimeFrom::Condition(condition.clone()),
                Some(Item::Text(word)) if word == "start" => TimeFrom::StepStart,
                _ => TimeFrom::ActionsEnd,
            };
            let to = args.condition("to")?;
            measure(args, What::Time { from, to })
        },
    },
    of_signal!("value", Value),
    of_signal!("maximum", Maximum),
    of_signal!("minimum", Minimum),
    of_signal!("change", Change),
    Verb {
        name: "at",
        params: &[
            needs("name", ParamType::Name),
            needs("signal", ParamType::Signal),
            needs("when", ParamType::Condition),
            takes("low", ParamType::Value),
            takes("high", ParamType::Value),
            takes("within", TIME),
            SOURCE,
        ],
        make: |args| {
            let (signal, when) = (args.signal("signal")?, args.condition("when")?);
            measure(args, What::At { signal, when })
        },
    },
];

fn measure(args: &Args<'_>, what: What) -> Result<Item, String> {
    let mut measure = Measure {
        name: args.text("name").unwrap_or_default().to_owned(),
        slot: usize::MAX,
        what,
        low: None,
        high: None,
        within: MEASURE_WITHIN,
        origin: Origin::default(),
    };
    if measure.name.trim().is_empty() {
        return Err("a measurement needs a name".into());
    }
    measure.low = limit(args, "low", &measure)?;
    measure.high = limit(args, "high", &measure)?;
    if let (Some(Operand::Literal(low)), Some(Operand::Literal(high))) =
        (&measure.low, &measure.high)
        && low > high
    {
        return Err("`low` is above `high`: nothing could pass".into());
    }
    if let (What::Time { .. }, Some(Operand::Literal(high))) = (&measure.what, &measure.high) {
        measure.within = Duration::from_secs((high + BEYOND_LIMIT_MS) / 1000.0);
    }
    measure.within = args.time_or("within", measure.within)?;
    measure.origin = args.stated(origin(args));
    Ok(Item::Measure(Box::new(measure)))
}

/// Where the limits come from; a plain number has no source.
fn origin(args: &Args<'_>) -> Origin {
    let mut origin = Origin::default();
    for item in ["low", "high"].iter().filter_map(|limit| args.get(limit)) {
        origin.join(&item.origin());
        if item.number().is_some() {
            origin.join(&Origin::lacking());
        }
    }
    origin
}

fn limit(args: &Args<'_>, name: &str, measure: &Measure) -> Result<Option<Operand>, String> {
    let Some(item) = args.get(name) else {
        return Ok(None);
    };
    let limit = match (measure.what.signal(), &measure.what) {
        (Some(signal), _) => operand(signal, item).map_err(|error| format!("`{name}`: {error}"))?,
        (None, What::Time { .. }) => amount("ms", item).map_err(|()| {
            let (wanted, found) = (Dimension::Time.wanted(), item.found());
            format!("`{name}` wants {wanted}, found {found}")
        })?,
        (None, _) => return Ok(None),
    };
    Ok(Some(limit))
}
