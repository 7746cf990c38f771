//! Types of a verb's parameters, and the message when an argument does not fit.

use super::context::Context;
use super::item::Item;
use super::quantity::Dimension;
use super::suggest::near;

/// Longest text of a script that people read, in characters.
const LONGEST_TEXT: usize = 2_000;
/// Longest name of a step, a measurement or a procedure, in characters.
const LONGEST_NAME: usize = 200;

#[derive(Clone, Copy, Debug)]
pub(super) enum ParamType {
    Amount(Dimension),
    Number,
    /// A whole number from .. to.
    Int(i64, i64),
    Bool,
    Text,
    /// A text that names something.
    Name,
    Choice(&'static [&'static str]),
    Signal,
    /// A signal that is compared, or a whole condition.
    Subject,
    Condition,
    /// Text, number, quantity, True, False or a measured value.
    Value,
    /// A code of the table or its name.
    Code,
    /// A section of the line or its number.
    Section,
    /// An action or a list of them, nested as deep as helper functions make it.
    Actions,
    Expectations,
    Measures,
    /// An event's name or a list of them.
    Events,
    /// A condition, "start" or "actions".
    TimeFrom,
    /// A whole number or a list of them.
    Ints,
    Conditions,
    /// Where numbers come from: a text or a list of them.
    Sources,
}

impl ParamType {
    pub(super) fn wanted(self) -> String {
        match self {
            Self::Amount(dimension) => dimension.wanted().into(),
            Self::Number => "a number".into(),
            Self::Int(low, high) => format!("a whole number {low} to {high}"),
            Self::Bool => "True or False".into(),
            Self::Text => format!("a text in quotes, at most {LONGEST_TEXT} characters"),
            Self::Name => format!("a name in quotes, at most {LONGEST_NAME} characters"),
            Self::Choice(words) => format!("one of \"{}\"", words.join("\", \"")),
            Self::Signal | Self::Subject => "a signal such as eb or speed".into(),
            Self::Condition => "a condition such as is_(eb, \"applied\")".into(),
            Self::Value => "a value to compare with".into(),
            Self::Code => "a speed code such as code(\"55\")".into(),
            Self::Section => "a section of the line or its number".into(),
            Self::Actions => "actions such as tacho.speed(kmh(40))".into(),
            Self::Expectations => {
                "expectations such as becomes(eb, \"applied\", within = s(1))".into()
            }
            Self::Measures => "measurements such as value(\"limit\", limit)".into(),
            Self::Events => "names of events such as \"overspeed_eb\"".into(),
            Self::TimeFrom => "\"start\", \"actions\" or a condition".into(),
            Self::Ints => "a list of whole numbers".into(),
            Self::Conditions => "conditions such as is_(eb, \"applied\")".into(),
            Self::Sources => "where numbers come from, such as \"S3 eq. 4\", \"configuration doors.aligned_m\" or \"default: two scans\"".into(),
        }
    }

    /// Whether the item fits the type; `Err` says what was found instead.
    pub(super) fn check(self, item: &Item, context: &Context) -> Result<(), String> {
        if matches!(item, Item::Unknown) {
            return Ok(());
        }
        let fits = match self {
            Self::Amount(dimension) => {
                matches!(item, Item::Quantity(q) if q.dimension == dimension && q.value.is_finite())
            }
            Self::Number => item.number().is_some_and(f64::is_finite),
            Self::Int(low, high) => matches!(item, Item::Int(n) if (low..=high).contains(n)),
            Self::Bool => matches!(item, Item::Bool(_)),
            Self::Text => return text(item, LONGEST_TEXT),
            Self::Name => return text(item, LONGEST_NAME),
            Self::Choice(words) => match item {
                Item::Text(word) if words.contains(&word.as_str()) => true,
                Item::Text(word) => {
                    return Err(format!(
                        "{}{}",
                        item.found(),
                        near(word, words.iter().copied())
                    ));
                }
                _ => false,
            },
            Self::Signal => matches!(item, Item::Signal(_)),
            Self::Subject => matches!(item, Item::Signal(_) | Item::Condition(..)),
            Self::Condition => matches!(item, Item::Condition(..)),
            Self::Value => matches!(
                item,
                Item::Quantity(_)
                    | Item::Text(_)
                    | Item::Bool(_)
                    | Item::Int(_)
                    | Item::Float(_)
                    | Item::Measured(..)
            ),
            Self::Code => match item {
                Item::Text(name) => return context.code(name).map(|_| ()),
                item => matches!(item, Item::Record(r) if r.kind == "speed code"),
            },
            Self::Section => match item {
                Item::Int(n) => u16::try_from(*n).is_ok_and(|n| context.line.section(n).is_some()),
                Item::Record(record) => record.kind == "section" && record.get("section").is_some(),
                _ => false,
            },
            Self::TimeFrom => match item {
                Item::Text(word) => ["start", "actions"].contains(&word.as_str()),
                other => matches!(other, Item::Condition(..)),
            },
            Self::Actions => {
                return every(item, |i| matches!(i, Item::Actions(_) | Item::None));
            }
            Self::Expectations => {
                return every(item, |i| matches!(i, Item::Expectation(..) | Item::None));
            }
            Self::Measures => return every(item, |i| matches!(i, Item::Measure(_) | Item::None)),
            Self::Sources => return sources(item, context),
            Self::Events => return every(item, |i| matches!(i, Item::Text(_))),
            Self::Ints => return every(item, |i| matches!(i, Item::Int(_))),
            Self::Conditions => return every(item, |i| matches!(i, Item::Condition(..))),
        };
        if fits { Ok(()) } else { Err(item.found()) }
    }
}

/// Whether all texts in the item are sources that exist; `Err` says which text is none.
fn sources(item: &Item, context: &Context) -> Result<(), String> {
    match item {
        Item::List(items) => items.iter().try_for_each(|item| sources(item, context)),
        Item::Unknown => Ok(()),
        Item::Text(source) => {
            text(item, LONGEST_NAME)?;
            context.source(source)
        }
        other => Err(other.found()),
    }
}

/// `Err` says what was found instead of a text of at most `longest` characters.
fn text(item: &Item, longest: usize) -> Result<(), String> {
    match item {
        Item::Text(text) if text.chars().count() <= longest => Ok(()),
        Item::Text(text) => Err(format!("one of {}", text.chars().count())),
        other => Err(other.found()),
    }
}

/// Whether all items of a nested list fit; `Err` says what the first misfit is.
fn every(item: &Item, fits: fn(&Item) -> bool) -> Result<(), String> {
    match item {
        Item::List(items) => items.iter().try_for_each(|item| every(item, fits)),
        Item::Unknown => Ok(()),
        item if fits(item) => Ok(()),
        item => Err(item.found()),
    }
}
