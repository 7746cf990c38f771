//! Verbs: each is one entry of a table with its parameters and what it makes of them.
//!
//! The same table binds and checks calls when a script is evaluated and when it is only checked,
//! so a call in a branch that is never taken gets the same message as any other.

use protocol::Duration;
use protocol::event::Event;
use protocol::signal::Signal;

use super::context::Context;
use super::item::Item;
use super::quantity::{Dimension, Quantity};
use super::suggest::hint;
use super::verbs;
use crate::procedure::plan::{Action, Condition};

/// What a parameter takes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Want {
    Amount(Dimension),
    Number,
    /// A whole number from .. to.
    Int(i64, i64),
    Bool,
    Text,
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
    /// One or a list of whole numbers.
    Ints,
    /// Any number of conditions.
    Conditions,
}

/// One parameter of a verb.
#[derive(Debug)]
pub(super) struct Param {
    pub name: &'static str,
    pub want: Want,
    pub required: bool,
}

/// A parameter that must be given.
pub(super) const fn needs(name: &'static str, want: Want) -> Param {
    Param {
        name,
        want,
        required: true,
    }
}

/// A parameter that may be given.
pub(super) const fn takes(name: &'static str, want: Want) -> Param {
    Param {
        name,
        want,
        required: false,
    }
}

/// A word of the script language.
#[derive(Debug)]
pub(super) struct Verb {
    /// As written, namespace included.
    pub name: &'static str,
    pub params: &'static [Param],
    pub make: fn(&Args<'_>) -> Result<Item, String>,
}

/// The verb called `name`.
pub(super) fn find(name: &str) -> Option<&'static Verb> {
    all().find(|verb| verb.name == name)
}

/// All verbs.
pub(super) fn all() -> impl Iterator<Item = &'static Verb> {
    verbs::TABLES.iter().flat_map(|table| table.iter())
}

/// Names of the verbs of a namespace.
pub(super) fn members(space: &str) -> Vec<String> {
    all()
        .filter_map(|verb| verb.name.split_once('.'))
        .filter(|(prefix, _)| *prefix == space)
        .map(|(_, name)| name.to_owned())
        .collect()
}

/// Something wrong with a call.
#[derive(Debug)]
pub(super) struct CallError {
    pub message: String,
    /// Which argument, if it is one: in the order given, positional first.
    pub argument: Option<usize>,
}

/// Arguments of a call, bound to the parameters of its verb.
pub(super) struct Args<'a> {
    verb: &'static Verb,
    values: Vec<Option<Item>>,
    pub context: &'a Context,
}

impl Verb {
    /// Binds arguments, checks them, and makes the verb's value.
    ///
    /// While a script is only checked, arguments may be unknown; then what can be checked is, and
    /// the value is unknown, too.
    pub(super) fn call(
        &'static self,
        context: &Context,
        positional: Vec<Item>,
        named: Vec<(String, Item)>,
    ) -> Result<Item, CallError> {
        let args = self.bind(context, positional, named)?;
        if !args.values.iter().flatten().all(Item::is_known) {
            return Ok(Item::Unknown);
        }
        (self.make)(&args).map_err(|message| CallError {
            message: format!("{}: {message}", self.name),
            argument: None,
        })
    }

    /// Takes any number of values, such as `all_of`.
    fn is_variadic(&self) -> bool {
        matches!(
            self.params,
            [Param {
                want: Want::Conditions,
                ..
            }]
        )
    }

    fn bind<'a>(
        &'static self,
        context: &'a Context,
        mut positional: Vec<Item>,
        named: Vec<(String, Item)>,
    ) -> Result<Args<'a>, CallError> {
        let fail = |message, argument| {
            Err(CallError {
                message: format!("{} {message}", self.name),
                argument,
            })
        };
        if self.is_variadic() {
            positional = vec![Item::List(positional)];
        }
        let given = positional.len();
        if given > self.params.len() {
            let most = self.params.len();
            return fail(format!("takes at most {most} values"), Some(most));
        }
        let mut values: Vec<Option<Item>> = positional.into_iter().map(Some).collect();
        values.resize_with(self.params.len(), || None);
        let mut places: Vec<Option<usize>> = (0..self.params.len())
            .map(|i| (i < given).then_some(i))
            .collect();
        for (i, (name, item)) in named.into_iter().enumerate() {
            let place = Some(given + i);
            let Some(at) = self.params.iter().position(|p| p.name == name) else {
                let hint = hint(&name, self.params.iter().map(|p| p.name));
                return fail(format!("has no parameter `{name}`{hint}"), place);
            };
            if values[at].replace(item).is_some() {
                return fail(format!("gets `{name}` twice"), place);
            }
            places[at] = place;
        }
        for ((param, value), place) in self.params.iter().zip(&mut values).zip(places) {
            match value {
                // None stands for "not given", so that helper functions can pass it on.
                Some(Item::None) if !param.required => *value = None,
                Some(item) => {
                    if let Err(misfit) = param.want.check(item, context) {
                        let (name, wanted) = (param.name, param.want.wanted());
                        let message = format!(": `{name}` wants {wanted}, found {misfit}");
                        return Err(CallError {
                            message: format!("{}{message}", self.name),
                            argument: place,
                        });
                    }
                }
                None if param.required => {
                    let wanted = param.want.wanted();
                    return fail(format!("needs `{}`, {wanted}", param.name), None);
                }
                None => {}
            }
        }
        Ok(Args {
            verb: self,
            values,
            context,
        })
    }
}

impl Want {
    fn wanted(self) -> String {
        match self {
            Self::Amount(dimension) => dimension.wanted().into(),
            Self::Number => "a number".into(),
            Self::Int(low, high) => format!("a whole number {low} to {high}"),
            Self::Bool => "True or False".into(),
            Self::Text => "a text in quotes".into(),
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
        }
    }

    /// `Err` says what was found instead.
    fn check(self, item: &Item, context: &Context) -> Result<(), String> {
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
            Self::Text => matches!(item, Item::Text(_)),
            Self::Choice(words) => match item {
                Item::Text(word) if words.contains(&word.as_str()) => true,
                Item::Text(word) => {
                    return Err(format!("{}{}", item.found(), near(word, words)));
                }
                _ => false,
            },
            Self::Signal => matches!(item, Item::Signal(_)),
            Self::Subject => matches!(item, Item::Signal(_) | Item::Condition(_)),
            Self::Condition => matches!(item, Item::Condition(_)),
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
                other => matches!(other, Item::Condition(_)),
            },
            Self::Actions => {
                return every(item, |i| matches!(i, Item::Actions(_) | Item::None));
            }
            Self::Expectations => {
                return every(item, |i| matches!(i, Item::Expectation(_) | Item::None));
            }
            Self::Measures => return every(item, |i| matches!(i, Item::Measure(_) | Item::None)),
            Self::Events => return every(item, |i| matches!(i, Item::Text(_))),
            Self::Ints => return every(item, |i| matches!(i, Item::Int(_))),
            Self::Conditions => return every(item, |i| matches!(i, Item::Condition(_))),
        };
        if fits { Ok(()) } else { Err(item.found()) }
    }
}

/// Near misses only: the choice itself is listed anyway.
fn near(word: &str, words: &[&'static str]) -> String {
    let hint = hint(word, words.iter().copied());
    if hint.contains("did you mean") {
        hint
    } else {
        String::new()
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

/// Access to bound and checked arguments; a value of another kind than its parameter wants cannot
/// be there.
impl Args<'_> {
    pub(super) fn get(&self, name: &str) -> Option<&Item> {
        let at = self.verb.params.iter().position(|p| p.name == name)?;
        self.values[at].as_ref()
    }

    fn must(&self, name: &str) -> Result<&Item, String> {
        self.get(name).ok_or_else(|| format!("needs `{name}`"))
    }

    /// A quantity in its dimension's unit.
    pub(super) fn amount(&self, name: &str) -> Result<f64, String> {
        match self.must(name)? {
            Item::Quantity(q) => Ok(q.value),
            other => Err(format!("`{name}` cannot be {}", other.found())),
        }
    }

    pub(super) fn amount_or(&self, name: &str, default: f64) -> f64 {
        self.amount(name).unwrap_or(default)
    }

    pub(super) fn positive(&self, name: &str) -> Result<f64, String> {
        let value = self.amount(name)?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(format!("`{name}` must be above 0"))
        }
    }

    pub(super) fn time(&self, name: &str) -> Result<Option<Duration>, String> {
        if self.get(name).is_none() {
            return Ok(None);
        }
        let ms = self.amount(name)?;
        if (0.0..=86_400_000.0).contains(&ms) {
            Ok(Some(Duration::from_secs(ms / 1000.0)))
        } else {
            Err(format!("`{name}` must be from 0 to 24 hours"))
        }
    }

    pub(super) fn time_or(&self, name: &str, default: Duration) -> Result<Duration, String> {
        Ok(self.time(name)?.unwrap_or(default))
    }

    pub(super) fn number(&self, name: &str) -> Result<f64, String> {
        self.must(name)?
            .number()
            .ok_or_else(|| format!("`{name}` must be a number"))
    }

    pub(super) fn int(&self, name: &str) -> Result<i64, String> {
        match self.must(name)? {
            Item::Int(n) => Ok(*n),
            other => Err(format!("`{name}` cannot be {}", other.found())),
        }
    }

    pub(super) fn flag(&self, name: &str, default: bool) -> bool {
        match self.get(name) {
            Some(Item::Bool(on)) => *on,
            _ => default,
        }
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        match self.get(name) {
            Some(Item::Text(text)) => Some(text),
            _ => None,
        }
    }

    pub(super) fn signal(&self, name: &str) -> Result<Signal, String> {
        match self.must(name)? {
            Item::Signal(signal) => Ok(*signal),
            other => Err(format!("`{name}` cannot be {}", other.found())),
        }
    }

    pub(super) fn condition(&self, name: &str) -> Result<Condition, String> {
        match self.must(name)? {
            Item::Condition(condition) => Ok(condition.clone()),
            other => Err(format!("`{name}` cannot be {}", other.found())),
        }
    }

    /// All items of a possibly nested list, in order.
    pub(super) fn flat(&self, name: &str) -> Vec<&Item> {
        let mut items = Vec::new();
        if let Some(item) = self.get(name) {
            flatten(item, &mut items);
        }
        items
    }

    pub(super) fn actions(&self, name: &str) -> Vec<Action> {
        let lists = self.flat(name).into_iter().filter_map(|item| match item {
            Item::Actions(actions) => Some(actions.clone()),
            _ => None,
        });
        lists.flatten().collect()
    }

    pub(super) fn events(&self, name: &str) -> Result<Vec<Event>, String> {
        let texts = self.flat(name).into_iter().filter_map(|item| match item {
            Item::Text(text) => Some(event(text)),
            _ => None,
        });
        texts.collect()
    }

    /// Number of a section given by number or as itself.
    pub(super) fn section(&self, name: &str) -> Option<u16> {
        let number = match self.get(name)? {
            Item::Record(record) => match record.get("section")? {
                Item::Int(n) => *n,
                _ => return None,
            },
            Item::Int(n) => *n,
            _ => return None,
        };
        u16::try_from(number).ok()
    }

    /// A quantity, number or measured value as given.
    pub(super) fn quantity(&self, name: &str) -> Option<Quantity> {
        match self.get(name) {
            Some(Item::Quantity(q)) => Some(*q),
            _ => None,
        }
    }
}

/// The event called `name`.
pub(super) fn event(name: &str) -> Result<Event, String> {
    Event::from_name(name).ok_or_else(|| {
        let hint = hint(name, Event::ALL.iter().map(|e| e.definition().name));
        format!("no event \"{name}\"{hint}")
    })
}

fn flatten<'a>(item: &'a Item, out: &mut Vec<&'a Item>) {
    match item {
        Item::List(items) => items.iter().for_each(|item| flatten(item, out)),
        item => out.push(item),
    }
}
