//! Conditions over signals, and what is expected of them.

use protocol::Duration;
use protocol::signal::{Kind, Signal};

use crate::procedure::loader::args::{Args, event};
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::suggest::near;
use crate::procedure::loader::verb::{Param, Verb, needs, takes};
use crate::procedure::origin::Origin;
use crate::procedure::plan::{Action, Comparison, Condition, Expectation, Operand};

/// Time for something to become true if a script gives none.
const BECOMES_WITHIN: Duration = Duration::from_ms(2000);
/// Time that `until` waits if a script gives none.
const UNTIL_WITHIN: Duration = Duration::from_ms(10_000);

const TIME: ParamType = ParamType::Amount(Dimension::Time);
/// Where the numbers of the call come from.
pub(super) const SOURCE: Param = takes("source", ParamType::Sources);
const CONDITIONS: &[Param] = &[takes("conditions", ParamType::Conditions)];
/// A limit of an event's parameter.
const PARAMETER: ParamType = ParamType::Int(i32::MIN as i64, i32::MAX as i64);

/// Ways to compare, by parameter.
const COMPARISONS: [(&str, Comparison); 8] = [
    ("value", Comparison::Equal),
    ("not_", Comparison::NotEqual),
    ("above", Comparison::Above),
    ("at_least", Comparison::AtLeast),
    ("below", Comparison::Below),
    ("at_most", Comparison::AtMost),
    ("has", Comparison::Has),
    ("lacks", Comparison::Lacks),
];

/// A verb whose first parameters are a condition.
macro_rules! about {
    ($name:literal, [$($more:expr),*], $make:expr) => {
        Verb {
            name: $name,
            params: &[
                needs("signal", ParamType::Subject),
                takes("value", ParamType::Value),
                takes("not_", ParamType::Value),
                takes("above", ParamType::Value),
                takes("below", ParamType::Value),
                takes("at_least", ParamType::Value),
                takes("at_most", ParamType::Value),
                takes("near", ParamType::Value),
                takes("tol", ParamType::Value),
                takes("has", ParamType::Value),
                takes("lacks", ParamType::Value),
                $($more),*
            ],
            make: $make,
        }
    };
}

pub(super) static VERBS: &[Verb] = &[
    about!("is_", [], |args| given(args, condition(args)?)),
    about!("when", [], |args| given(args, condition(args)?)),
    verb!("all_of", CONDITIONS, |args| given(
        args,
        Condition::All(parts(args)?)
    )),
    verb!("any_of", CONDITIONS, |args| given(
        args,
        Condition::Any(parts(args)?)
    )),
    about!("until", [takes("within", TIME)], |args| {
        Ok(Item::Actions(vec![Action::Until {
            condition: condition(args)?,
            within: args.time_or("within", UNTIL_WITHIN)?,
        }]))
    }),
    about!("becomes", [takes("within", TIME), SOURCE], |args| {
        expected(
            args,
            Expectation::Becomes {
                condition: condition(args)?,
                within: args.time_or("within", BECOMES_WITHIN)?,
            },
        )
    }),
    about!("holds", [needs("for_", TIME), SOURCE], |args| {
        expected(
            args,
            Expectation::Holds {
                condition: condition(args)?,
                duration: args.time_or("for_", Duration::ZERO)?,
            },
        )
    }),
    about!("never", [SOURCE], |args| {
        expected(
            args,
            Expectation::Never {
                condition: condition(args)?,
            },
        )
    }),
    verb!(
        "logs",
        &[
            needs("event", ParamType::Name),
            takes("within", TIME),
            takes("low", PARAMETER),
            takes("high", PARAMETER),
            SOURCE,
        ],
        |args| {
            let limit = |name, none| match args.get(name) {
                None => Ok(none),
                Some(_) => args.int(name),
            };
            expected(
                args,
                Expectation::Logs {
                    event: event(args.text("event").unwrap_or_default())?,
                    parameter: [limit("low", i32::MIN)?, limit("high", i32::MAX)?],
                    within: args.time_or("within", BECOMES_WITHIN)?,
                },
            )
        }
    ),
    verb!("never_logs", &[needs("event", ParamType::Name)], |args| {
        expected(
            args,
            Expectation::NeverLogs {
                event: event(args.text("event").unwrap_or_default())?,
            },
        )
    }),
    verb!("measured", &[needs("name", ParamType::Name)], |args| {
        let name = args.text("name").unwrap_or_default();
        Ok(Item::Measured(name.to_owned(), None))
    }),
];

/// A condition with the source of its numbers.
fn given(args: &Args<'_>, condition: Condition) -> Result<Item, String> {
    Ok(Item::Condition(condition, args.origin()))
}

/// An expectation with the source of its numbers; limits of an event's parameter are plain numbers, without a source.
fn expected(args: &Args<'_>, expectation: Expectation) -> Result<Item, String> {
    let mut origin = args.origin();
    if ["low", "high"]
        .iter()
        .any(|limit| args.get(limit).is_some())
    {
        origin.join(&Origin::lacking());
    }
    Ok(Item::Expectation(expectation, args.stated(origin)))
}

/// The condition a verb's first parameters make.
fn condition(args: &Args<'_>) -> Result<Condition, String> {
    if let Some(Item::Condition(condition, _)) = args.get("signal") {
        let extra = COMPARISONS.iter().any(|(name, _)| args.get(name).is_some());
        if extra || args.get("near").is_some() || args.get("tol").is_some() {
            return Err("a condition is complete, nothing more to compare".into());
        }
        return Ok(condition.clone());
    }
    let signal = args.signal("signal")?;
    let mut all = Vec::new();
    for (name, comparison) in COMPARISONS {
        let Some(item) = args.get(name) else { continue };
        let ordered = !matches!(comparison, Comparison::Equal | Comparison::NotEqual);
        if ordered && !matches!(signal.definition().kind, Kind::Number { .. }) {
            return Err(format!(
                "{} is a state, it cannot be `{name}` something",
                signal.name()
            ));
        }
        let operand = match comparison.is_bits() {
            true => bits(signal, name, item)?,
            false => operand(signal, item)?,
        };
        all.push((comparison, operand));
    }
    if let Some(item) = args.get("near") {
        let tolerance = match args.get("tol").map(|tol| operand(signal, tol)) {
            Some(Ok(Operand::Literal(tolerance))) if tolerance >= 0.0 => tolerance,
            Some(Err(error)) => return Err(error),
            Some(Ok(_)) => return Err("`tol` must be a quantity that is not negative".into()),
            None => return Err("`near` needs `tol`".into()),
        };
        all.push((Comparison::Near { tolerance }, operand(signal, item)?));
    } else if args.get("tol").is_some() {
        return Err("`tol` goes with `near` only".into());
    }
    let mut compares: Vec<_> = all
        .into_iter()
        .map(|(comparison, operand)| Condition::Compare {
            signal,
            comparison,
            operand,
        })
        .collect();
    match compares.len() {
        0 => Err(format!(
            "what should {} be? {}",
            signal.name(),
            values_of(signal)
        )),
        1 => Ok(compares.remove(0)),
        _ => Ok(Condition::All(compares)),
    }
}

/// Bits with which a signal is compared, if the signal is a set of bits.
fn bits(signal: Signal, name: &str, item: &Item) -> Result<Operand, String> {
    let definition = signal.definition();
    if !definition.unit.is_empty() || !matches!(definition.kind, Kind::Number { lsb: 1.0 }) {
        return Err(format!(
            "{} is not made of bits, it cannot be `{name}` something",
            definition.name
        ));
    }
    match item {
        Item::Int(bits) if (1..=i64::from(u16::MAX)).contains(bits) => {
            Ok(Operand::Literal(*bits as f64))
        }
        other => Err(format!(
            "`{name}` is the bits to look at, as cuts.doors + cuts.hcr, found {}",
            other.found()
        )),
    }
}

fn parts(args: &Args<'_>) -> Result<Vec<Condition>, String> {
    let parts: Vec<_> = args
        .flat("conditions")
        .into_iter()
        .filter_map(|item| match item {
            Item::Condition(condition, _) => Some(condition.clone()),
            _ => None,
        })
        .collect();
    if parts.is_empty() {
        return Err("needs at least one condition".into());
    }
    Ok(parts)
}

/// Value that `signal` is compared with or limited by, checked against its kind and unit.
pub(super) fn operand(signal: Signal, item: &Item) -> Result<Operand, String> {
    let definition = signal.definition();
    let wrong = |end: String| {
        let (name, values, found) = (definition.name, values_of(signal), item.found());
        Err(format!("{name} {values}, found {found}{end}"))
    };
    match (definition.kind, item) {
        (Kind::Enum(labels), Item::Text(text)) => match labels.iter().position(|l| l == text) {
            Some(index) => Ok(Operand::Literal(index as f64)),
            None => wrong(near(text, labels.iter().copied())),
        },
        (Kind::Bit, Item::Bool(on)) => Ok(Operand::Literal(f64::from(*on))),
        (Kind::Enum(_) | Kind::Bit, Item::Measured(name, None)) => Ok(measured(name, 0.0)),
        (Kind::Number { .. }, item) => {
            amount(definition.unit, item).or_else(|()| wrong(String::new()))
        }
        _ => wrong(String::new()),
    }
}

/// A literal or measured amount in `unit`.
pub(super) fn amount(unit: &str, item: &Item) -> Result<Operand, ()> {
    let dimension = Dimension::of_unit(unit);
    match (item, dimension) {
        (Item::Quantity(q), Some(dimension)) if q.dimension == dimension => {
            Ok(Operand::Literal(q.value))
        }
        (Item::Measured(name, None), _) => Ok(measured(name, 0.0)),
        (Item::Measured(name, Some(offset)), Some(dimension)) if offset.dimension == dimension => {
            Ok(measured(name, offset.value))
        }
        (item, None) => item.number().map(Operand::Literal).ok_or(()),
        _ => Err(()),
    }
}

/// A measured value as operand; its slot is found when the whole script is known.
fn measured(name: &str, offset: f64) -> Operand {
    Operand::Measured {
        slot: usize::MAX,
        name: name.to_owned(),
        offset,
    }
}

fn values_of(signal: Signal) -> String {
    let definition = signal.definition();
    match definition.kind {
        Kind::Enum(labels) => format!("is one of \"{}\"", labels.join("\", \"")),
        Kind::Bit => "is True or False".into(),
        Kind::Number { .. } => match Dimension::of_unit(definition.unit) {
            Some(dimension) => format!("is {}", dimension.wanted()),
            None => "is a number".into(),
        },
    }
}
