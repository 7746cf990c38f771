//! Verbs: each is one entry of a table with its parameters and what it makes of them.
//!
//! The same table binds and checks calls when a script is evaluated and when it is only checked,
//! so a call in a branch that is never taken gets the same message as any other.

use super::args::Args;
use super::context::Context;
use super::item::Item;
use super::param_type::ParamType;
use super::suggest::hint;
use super::verbs;

#[derive(Debug)]
pub(super) struct Param {
    pub name: &'static str,
    pub want: ParamType,
    pub required: bool,
}

/// A parameter that must be given.
pub(super) const fn needs(name: &'static str, want: ParamType) -> Param {
    Param {
        name,
        want,
        required: true,
    }
}

/// A parameter that may be given.
pub(super) const fn takes(name: &'static str, want: ParamType) -> Param {
    Param {
        name,
        want,
        required: false,
    }
}

/// A word of the script language.
#[derive(Debug)]
pub(super) struct Verb {
    /// Name as written, namespace included.
    pub name: &'static str,
    pub params: &'static [Param],
    pub make: fn(&Args<'_>) -> Result<Item, String>,
}

pub(super) fn find(name: &str) -> Option<&'static Verb> {
    all().find(|verb| verb.name == name)
}

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

#[derive(Debug)]
pub(super) struct CallError {
    pub message: String,
    /// Place of the wrong argument, if an argument is wrong: in the order given, positional first.
    pub argument: Option<usize>,
}

impl Verb {
    /// Binds arguments, checks them, and makes the verb's value.
    ///
    /// While a script is only checked, arguments may be unknown; then the known arguments are checked, and
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
                want: ParamType::Conditions,
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
