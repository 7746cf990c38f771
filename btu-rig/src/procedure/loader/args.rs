//! Arguments of a call, bound and checked, as verbs read them.

use protocol::Duration;
use protocol::event::Event;
use protocol::signal::Signal;

use super::context::Context;
use super::item::Item;
use super::suggest::hint;
use super::verb::Verb;
use crate::procedure::origin::Origin;
use crate::procedure::plan::{Action, Condition};

/// Arguments of a call, bound to the parameters of its verb.
pub(super) struct Args<'a> {
    pub verb: &'static Verb,
    pub values: Vec<Option<Item>>,
    pub context: &'a Context,
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

    /// A number that may be left out.
    pub(super) fn optional_number(&self, name: &str) -> Result<Option<f64>, String> {
        self.get(name).map(|_| self.number(name)).transpose()
    }

    /// A whole number, which the parameter keeps within the range of `T`.
    pub(super) fn int<T: TryFrom<i64>>(&self, name: &str) -> Result<T, String> {
        match self.must(name)? {
            Item::Int(n) => T::try_from(*n).map_err(|_| format!("`{name}` cannot be {n}")),
            other => Err(format!("`{name}` cannot be {}", other.found())),
        }
    }

    /// A whole number that may be left out.
    pub(super) fn given_int<T: TryFrom<i64>>(&self, name: &str) -> Result<Option<T>, String> {
        let given = self.get(name).is_some();
        given.then(|| self.int(name)).transpose()
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
            Item::Condition(condition, _) => Ok(condition.clone()),
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

    /// The sources that the call states.
    pub(super) fn sources(&self) -> Vec<String> {
        let texts = self
            .flat("source")
            .into_iter()
            .filter_map(|item| match item {
                Item::Text(text) => Some(text.clone()),
                _ => None,
            });
        texts.collect()
    }

    /// Origin of the numbers in the call: the origin of each quantity, and the sources that the call states.
    pub(super) fn origin(&self) -> Origin {
        let mut origin = Origin::default();
        (self.values.iter().flatten()).for_each(|item| origin.join(&item.origin()));
        self.stated(origin)
    }

    /// The origin together with the sources that the call states.
    pub(super) fn stated(&self, mut origin: Origin) -> Origin {
        let sources = self.sources();
        if !sources.is_empty() {
            origin.give(&sources);
        }
        origin
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

    /// Number of the section that the argument gives, by number or as a section of the line.
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
