//! Values that scripts pass around, independent of Starlark; verbs take and return them.

use std::sync::Arc;

use protocol::signal::Signal;

use super::draft::Declaration;
use super::quantity::Quantity;
use super::verb::Verb;
use crate::procedure::origin::Origin;
use crate::procedure::plan::{Action, Condition, Expectation, Measure};

#[derive(Clone, Debug)]
pub(super) enum Item {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<Item>),
    Quantity(Quantity),
    Signal(Signal),
    /// A speed code, a section, or a part of the configuration.
    Record(Arc<Record>),
    Actions(Vec<Action>),
    /// A condition, with the source of the numbers it compares with.
    Condition(Condition, Origin),
    /// An expectation, with the source of its numbers.
    Expectation(Expectation, Origin),
    Measure(Box<Measure>),
    /// Name of a value measured by an earlier step, and the quantity added to the value.
    Measured(String, Option<Quantity>),
    /// `step()` or `procedure()`: takes effect when a script is evaluated, not when it is checked.
    Declaration(Box<Declaration>),
    Verb(&'static Verb),
    Namespace(&'static str),
    /// A Starlark value that no verb takes; holds its type's name.
    Foreign(String),
    /// A value that is not known while a script is only checked, without being run.
    Unknown,
}

/// Named values read with a dot.
#[derive(Debug)]
pub(super) struct Record {
    pub kind: &'static str,
    pub fields: Vec<(String, Item)>,
}

impl Record {
    pub(super) fn get(&self, name: &str) -> Option<&Item> {
        self.fields.iter().find(|(n, _)| n == name).map(|(_, v)| v)
    }
}

impl Item {
    /// Name of the item's type, with article, for messages.
    pub(super) fn found(&self) -> String {
        match self {
            Self::None => "None".into(),
            Self::Bool(true) => "True".into(),
            Self::Bool(false) => "False".into(),
            Self::Int(n) => format!("the number {n}"),
            Self::Float(n) => format!("the number {n}"),
            Self::Text(text) => format!("the text \"{text}\""),
            Self::List(_) => "a list".into(),
            Self::Quantity(q) => format!("{} ({q})", q.dimension.found()),
            Self::Signal(signal) => format!("the signal {}", signal.name()),
            Self::Record(record) => format!("a {}", record.kind),
            Self::Actions(_) => "an action".into(),
            Self::Condition(..) => "a condition".into(),
            Self::Expectation(..) => "an expectation".into(),
            Self::Measure(_) => "a measurement".into(),
            Self::Measured(name, _) => format!("measured(\"{name}\")"),
            Self::Declaration(_) => "a step or procedure".into(),
            Self::Verb(verb) => format!("{} without brackets", verb.name),
            Self::Namespace(name) => format!("{name} without a verb"),
            Self::Foreign(kind) => format!("a {kind}"),
            Self::Unknown => "something".into(),
        }
    }

    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Int(n) => Some(*n as f64),
            Self::Float(n) => Some(*n),
            _ => None,
        }
    }

    /// Origin of the quantities in this item. A plain number in an item is a state or a count, and no limit.
    pub(super) fn origin(&self) -> Origin {
        let mut origin = Origin::default();
        match self {
            Self::Quantity(quantity) => origin.join(&quantity.origin),
            Self::Condition(_, own) | Self::Expectation(_, own) => origin.join(own),
            Self::Measured(name, offset) => {
                origin.join(&Origin::of(format!("measurement {name}")));
                offset.iter().for_each(|more| origin.join(&more.origin));
            }
            Self::List(items) => items.iter().for_each(|item| origin.join(&item.origin())),
            _ => {}
        }
        origin
    }

    /// Whether the item and everything in it is known while a script is only checked.
    pub(super) fn is_known(&self) -> bool {
        match self {
            Self::Unknown => false,
            Self::List(items) => items.iter().all(Self::is_known),
            _ => true,
        }
    }

    /// What `name` behind a dot stands for: a verb of a namespace, or a field of a record.
    pub(super) fn attribute(&self, name: &str) -> Option<Item> {
        match self {
            Self::Record(record) => record.get(name).cloned(),
            Self::Namespace(space) => super::verb::find(&format!("{space}.{name}")).map(Item::Verb),
            _ => None,
        }
    }

    /// All names that may stand behind a dot.
    pub(super) fn attributes(&self) -> Vec<String> {
        match self {
            Self::Record(record) => record.fields.iter().map(|(n, _)| n.clone()).collect(),
            Self::Namespace(space) => super::verb::members(space),
            _ => Vec::new(),
        }
    }

    /// `self + other` or, with `sign` -1, `self - other`; `None` if Starlark itself is to decide.
    pub(super) fn plus(&self, other: &Self, sign: f64) -> Option<Result<Self, String>> {
        let sum = match (self, other) {
            (Self::Quantity(a), Self::Quantity(b)) => a.plus(b, sign).map(Self::Quantity),
            (Self::Measured(name, offset), Self::Quantity(b)) => {
                let offset = match offset {
                    Some(offset) => offset.plus(b, sign),
                    None => Ok(b.times(sign)),
                };
                offset.map(|offset| Self::Measured(name.clone(), Some(offset)))
            }
            (Self::Unknown, _) | (_, Self::Unknown) => Ok(Self::Unknown),
            (a, b) if a.is_ours() || b.is_ours() => {
                let verb = if sign < 0.0 { "subtract" } else { "add" };
                Err(format!("cannot {verb} {} and {}", a.found(), b.found()))
            }
            _ => return None,
        };
        Some(sum)
    }

    pub(super) fn times(&self, other: &Self) -> Option<Result<Self, String>> {
        match (self, other) {
            (Self::Quantity(q), n) | (n, Self::Quantity(q)) if n.number().is_some() => {
                Some(Ok(Self::Quantity(q.times(n.number().unwrap_or(1.0)))))
            }
            (Self::Unknown, _) | (_, Self::Unknown) => Some(Ok(Self::Unknown)),
            (a, b) if a.is_ours() || b.is_ours() => Some(Err(format!(
                "cannot multiply {} by {}",
                a.found(),
                b.found()
            ))),
            _ => None,
        }
    }

    /// `self / other`.
    pub(super) fn over(&self, other: &Self) -> Option<Result<Self, String>> {
        let by_zero = || Err("division by zero".to_owned());
        let ratio = match (self, other) {
            (Self::Quantity(a), Self::Quantity(b)) if a.dimension == b.dimension => match b.value {
                0.0 => by_zero(),
                value => Ok(Self::Float(a.value / value)),
            },
            (Self::Quantity(q), n) if n.number().is_some() => match n.number() {
                Some(0.0) | None => by_zero(),
                Some(n) => Ok(Self::Quantity(q.times(1.0 / n))),
            },
            (Self::Unknown, _) | (_, Self::Unknown) => Ok(Self::Unknown),
            (a, b) if a.is_ours() || b.is_ours() => {
                Err(format!("cannot divide {} by {}", a.found(), b.found()))
            }
            _ => return None,
        };
        Some(ratio)
    }

    fn is_ours(&self) -> bool {
        !matches!(
            self,
            Self::None
                | Self::Bool(_)
                | Self::Int(_)
                | Self::Float(_)
                | Self::Text(_)
                | Self::List(_)
                | Self::Foreign(_)
        )
    }
}
