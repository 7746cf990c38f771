//! The names every script knows: verbs, signals, configuration, and Starlark's own.

use std::collections::{BTreeMap, HashSet};

use protocol::signal::Signal;
use starlark::environment::{Globals, GlobalsBuilder, LibraryExtension};

use super::context::Context;
use super::handle::alloc_frozen;
use super::item::Item;
use super::verb;

/// The predeclared names of this program, without Starlark's own.
pub(super) fn predeclared(context: &Context) -> BTreeMap<&'static str, Item> {
    let mut names: BTreeMap<&'static str, Item> = context.globals().into_iter().collect();
    for &signal in Signal::ALL {
        names.insert(signal.name(), Item::Signal(signal));
    }
    for verb in verb::all() {
        match verb.name.split_once('.') {
            Some((space, _)) => names.insert(space, Item::Namespace(space)),
            None => names.insert(verb.name, Item::Verb(verb)),
        };
    }
    names
}

/// All names, for Starlark.
pub(super) fn build(predeclared: &BTreeMap<&'static str, Item>) -> Globals {
    let mut builder = GlobalsBuilder::extended_by(&[LibraryExtension::Print]);
    for (name, item) in predeclared {
        let value = alloc_frozen(item.clone(), builder.frozen_heap());
        builder.set(name, value);
    }
    builder.build()
}

/// All names, for "did you mean".
pub(super) fn names(globals: &Globals) -> HashSet<String> {
    globals
        .names()
        .map(|name| name.as_str().to_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_verb_hides_a_signal() {
        for verb in verb::all() {
            let word = verb.name.split('.').next().unwrap_or_default();
            assert!(Signal::from_name(word).is_none(), "{word}");
        }
    }

    #[test]
    fn verb_names_are_unique() {
        let mut names: Vec<_> = verb::all().map(|verb| verb.name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn the_technicians_reference_has_every_verb() {
        let reference = include_str!("../../../../scripts/README.md");
        for verb in verb::all() {
            let shown = [format!("`{}(", verb.name), format!("`{}`", verb.name)];
            let found = shown.iter().any(|word| reference.contains(word));
            assert!(found, "scripts/README.md does not explain {}", verb.name);
        }
    }
}
