//! The bridge to Starlark: one value type that carries an [`Item`].
// Starlark's macros implement an unsafe marker trait for value types; nothing else here is unsafe.
#![allow(unsafe_code)]

use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt;

use allocative::Allocative;
use starlark::codemap::FileSpan;
use starlark::eval::{Arguments, Evaluator};
use starlark::starlark_simple_value;
use starlark::values::float::UnpackFloat;
use starlark::values::list::{AllocList, ListRef};
use starlark::values::none::NoneType;
use starlark::values::tuple::TupleRef;
use starlark::values::{
    FrozenHeap, FrozenValue, Heap, NoSerialize, ProvidesStaticType, StarlarkPagablePanic,
    StarlarkValue, Value, ValueLike, starlark_value,
};
use thiserror::Error;

use super::context::Context;
use super::draft::Declaration;
use super::item::Item;

/// Lists nested deeper than this are refused; a list may contain itself.
const DEEPEST_LIST: usize = 16;
/// Most steps that a script may declare, so that a loop cannot fill the memory.
const MOST_STEPS: usize = 10_000;

/// Data that a script's verbs need, and declarations that they leave; reached through the
/// evaluator.
#[derive(Debug, ProvidesStaticType)]
pub(super) struct Session<'a> {
    pub context: &'a Context,
    /// Libraries may not declare anything.
    pub is_library: bool,
    pub declared: RefCell<Vec<(Declaration, Vec<FileSpan>)>>,
}

/// Something wrong with a script, said by a verb.
#[derive(Debug, Error)]
#[error("{0}")]
pub(super) struct ScriptError(pub String);

/// An [`Item`] as a value inside Starlark.
#[derive(Clone, Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(super) struct Handle(#[allocative(skip)] pub Item);
starlark_simple_value!(Handle);

impl fmt::Display for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.found())
    }
}

#[starlark_value(type = "value")]
impl<'v> StarlarkValue<'v> for Handle {
    fn invoke(
        &self,
        _me: Value<'v>,
        args: &Arguments<'v, '_>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let Item::Verb(verb) = &self.0 else {
            return Err(error(format!("{} cannot be called", self.0.found())));
        };
        let heap = eval.heap();
        let positional = args.positions(heap)?.map(item).collect();
        let named = args.names_map()?;
        let named = named
            .iter()
            .map(|(name, value)| (name.as_str().to_owned(), item(*value)));
        let session = eval
            .extra
            .and_then(|extra| extra.downcast_ref::<Session>())
            .ok_or_else(|| error("verbs work in check procedures only".into()))?;
        let made = verb
            .call(session.context, positional, named.collect())
            .map_err(|e| error(e.message))?;
        let Item::Declaration(declaration) = made else {
            return Ok(alloc(made, heap));
        };
        declare(session, *declaration, eval).map_err(error)?;
        Ok(Value::new_none())
    }

    fn get_attr(&self, attribute: &str, heap: Heap<'v>) -> Option<Value<'v>> {
        self.0.attribute(attribute).map(|item| alloc(item, heap))
    }

    fn dir_attr(&self) -> Vec<String> {
        self.0.attributes()
    }

    fn equals(&self, other: Value<'v>) -> starlark::Result<bool> {
        match (&self.0, item(other)) {
            (Item::Signal(signal), _) => Err(error(no_value(signal.name()))),
            (Item::Quantity(a), Item::Quantity(b)) => {
                Ok(a.compare(&b).map_err(error)? == Ordering::Equal)
            }
            _ => Ok(false),
        }
    }

    fn compare(&self, other: Value<'v>) -> starlark::Result<Ordering> {
        match (&self.0, item(other)) {
            (Item::Signal(signal), _) => Err(error(no_value(signal.name()))),
            (Item::Quantity(a), Item::Quantity(b)) => a.compare(&b).map_err(error),
            (a, b) => Err(error(format!(
                "cannot compare {} and {}",
                a.found(),
                b.found()
            ))),
        }
    }

    fn add(&self, other: Value<'v>, heap: Heap<'v>) -> Option<starlark::Result<Value<'v>>> {
        give(self.0.plus(&item(other), 1.0), heap)
    }

    fn radd(&self, other: Value<'v>, heap: Heap<'v>) -> Option<starlark::Result<Value<'v>>> {
        give(item(other).plus(&self.0, 1.0), heap)
    }

    fn sub(&self, other: Value<'v>, heap: Heap<'v>) -> starlark::Result<Value<'v>> {
        must(self.0.plus(&item(other), -1.0), heap)
    }

    fn mul(&self, other: Value<'v>, heap: Heap<'v>) -> Option<starlark::Result<Value<'v>>> {
        give(self.0.times(&item(other)), heap)
    }

    fn rmul(&self, other: Value<'v>, heap: Heap<'v>) -> Option<starlark::Result<Value<'v>>> {
        give(item(other).times(&self.0), heap)
    }

    fn div(&self, other: Value<'v>, heap: Heap<'v>) -> starlark::Result<Value<'v>> {
        must(self.0.over(&item(other)), heap)
    }

    fn minus(&self, heap: Heap<'v>) -> starlark::Result<Value<'v>> {
        must(self.0.times(&Item::Int(-1)), heap)
    }
}

/// Message for a signal used as a value: signals have none while a script is loaded, and would quietly choose a branch.
pub(super) fn no_value(name: &str) -> String {
    format!("{name} has no value while a script is loaded; use is_({name}, …) in a step")
}

pub(super) fn error(message: String) -> starlark::Error {
    starlark::Error::new_other(ScriptError(message))
}

fn declare(
    session: &Session<'_>,
    declaration: Declaration,
    eval: &Evaluator<'_, '_, '_>,
) -> Result<(), String> {
    if session.is_library {
        return Err(
            "a library (its name starts with _) cannot declare steps or a procedure".into(),
        );
    }
    let mut declared = session.declared.borrow_mut();
    if declared.len() >= MOST_STEPS {
        return Err(format!("more than {MOST_STEPS} steps"));
    }
    let depth = eval.call_stack_count();
    let places = (0..depth)
        .filter_map(|n| eval.call_stack_nth_location(n))
        .collect();
    declared.push((declaration, places));
    Ok(())
}

fn give<'v>(
    result: Option<Result<Item, String>>,
    heap: Heap<'v>,
) -> Option<starlark::Result<Value<'v>>> {
    result.map(|result| result.map(|item| alloc(item, heap)).map_err(error))
}

fn must<'v>(result: Option<Result<Item, String>>, heap: Heap<'v>) -> starlark::Result<Value<'v>> {
    give(result, heap).unwrap_or_else(|| Err(error("these cannot be combined".into())))
}

/// The item a Starlark value stands for.
fn item(value: Value<'_>) -> Item {
    nested_item(value, 0)
}

fn nested_item(value: Value<'_>, depth: usize) -> Item {
    let list = |values: &[Value<'_>]| {
        if depth >= DEEPEST_LIST {
            return Item::Foreign("list nested too deeply".into());
        }
        Item::List(values.iter().map(|v| nested_item(*v, depth + 1)).collect())
    };
    if let Some(handle) = value.downcast_ref::<Handle>() {
        handle.0.clone()
    } else if value.is_none() {
        Item::None
    } else if let Some(on) = value.unpack_bool() {
        Item::Bool(on)
    } else if let Some(text) = value.unpack_str() {
        Item::Text(text.to_owned())
    } else if let Some(n) = value.unpack_i32() {
        Item::Int(n.into())
    } else if let Some(n) = starlark::values::UnpackValue::unpack_value_opt(value) {
        let UnpackFloat(n) = n;
        Item::Float(n)
    } else if let Some(values) = ListRef::from_value(value) {
        list(values.content())
    } else if let Some(values) = TupleRef::from_value(value) {
        list(values.content())
    } else {
        Item::Foreign(value.get_type().to_owned())
    }
}

fn alloc(item: Item, heap: Heap<'_>) -> Value<'_> {
    match item {
        Item::None => Value::new_none(),
        Item::Bool(on) => Value::new_bool(on),
        Item::Int(n) => heap.alloc(n),
        Item::Float(n) => heap.alloc(n),
        Item::Text(text) => heap.alloc(text),
        Item::List(items) => {
            let values: Vec<_> = items.into_iter().map(|item| alloc(item, heap)).collect();
            heap.alloc(AllocList(values))
        }
        item => heap.alloc(Handle(item)),
    }
}

/// Value of a predeclared name on a frozen heap.
pub(super) fn alloc_frozen(item: Item, heap: &FrozenHeap) -> FrozenValue {
    match item {
        Item::None => heap.alloc(NoneType),
        Item::Bool(on) => heap.alloc(on),
        Item::Int(n) => heap.alloc(n),
        Item::Float(n) => heap.alloc(n),
        Item::Text(text) => heap.alloc(text.as_str()),
        Item::List(items) => {
            let values: Vec<_> = items
                .into_iter()
                .map(|item| alloc_frozen(item, heap))
                .collect();
            heap.alloc(AllocList(values))
        }
        item => heap.alloc_simple(Handle(item)),
    }
}
