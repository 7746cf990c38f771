//! What scripts may read besides signals: unit configuration, code table and line.

use std::sync::Arc;

use protocol::config::UnitConfig;
use protocol::line::Line;

use crate::tcms::{EbSources, Lamps, PowerCuts};
use crate::train::TrainData;

use super::item::{Item, Record};
use super::quantity::{Dimension, Quantity};
use super::suggest::hint;

/// Configuration that verbs take defaults from.
#[derive(Debug)]
pub(super) struct Context {
    pub unit: UnitConfig,
    pub line: Line,
    train: TrainData,
    codes: Vec<Item>,
}

impl Context {
    pub(super) fn new(unit: UnitConfig, line: Line, train: TrainData) -> Self {
        let codes = (unit.codes.iter().enumerate())
            .map(|(index, code)| {
                let limit = Quantity::new(Dimension::Speed, code.limit_kmh);
                record(
                    "speed code",
                    vec![
                        ("name", Item::Text(code.name.clone())),
                        ("limit", Item::Quantity(limit)),
                        ("limit_kmh", Item::Float(code.limit_kmh)),
                        ("carrier_hz", Item::Float(code.carrier_hz)),
                        ("rate_hz", Item::Float(code.rate_hz)),
                        ("index", Item::Int(index as i64)),
                    ],
                )
            })
            .collect();
        Self {
            unit,
            line,
            train,
            codes,
        }
    }

    /// The predeclared names that are neither verbs nor signals.
    pub(super) fn globals(&self) -> Vec<(&'static str, Item)> {
        vec![
            ("codes", Item::List(self.codes.clone())),
            ("unit", tree("unit configuration", &self.unit)),
            ("line", tree("line", &self.line)),
            ("consist", self.consist()),
            (
                "cuts",
                bits(
                    "cuts",
                    PowerCuts::ALL.iter().map(|(one, name)| (*name, one.bits())),
                ),
            ),
            (
                "eb_by",
                bits(
                    "eb_by",
                    EbSources::ALL.iter().map(|(one, name)| (*name, one.bits())),
                ),
            ),
            (
                "lamp",
                bits(
                    "lamp",
                    Lamps::ALL.iter().map(|(one, name)| (*name, one.bits())),
                ),
            ),
        ]
    }

    /// The train's file.
    fn consist(&self) -> Item {
        match &self.train {
            TrainData::Ideal(data) => tree("train", data),
            TrainData::Cars(data) => tree("train", data),
        }
    }

    pub(super) fn code(&self, name: &str) -> Result<Item, String> {
        let names = || self.unit.codes.iter().map(|code| code.name.as_str());
        match names().position(|n| n == name) {
            Some(at) => Ok(self.codes[at].clone()),
            None => Err(format!("no speed code \"{name}\"{}", hint(name, names()))),
        }
    }
}

fn record(kind: &'static str, fields: Vec<(&str, Item)>) -> Item {
    let fields = fields.into_iter().map(|(n, v)| (n.to_owned(), v)).collect();
    Item::Record(Arc::new(Record { kind, fields }))
}

/// Bits of a signal by their names.
fn bits<'a>(kind: &'static str, named: impl Iterator<Item = (&'a str, u16)>) -> Item {
    record(
        kind,
        named
            .map(|(name, bit)| (name, Item::Int(i64::from(bit))))
            .collect(),
    )
}

/// Configuration data as nested records, by way of their names in configuration files.
fn tree(kind: &'static str, data: &impl serde::Serialize) -> Item {
    match serde_json::to_value(data) {
        Ok(value) => item(kind, &value),
        Err(_) => Item::None,
    }
}

fn item(kind: &'static str, value: &serde_json::Value) -> Item {
    use serde_json::Value;
    match value {
        Value::Null => Item::None,
        Value::Bool(on) => Item::Bool(*on),
        Value::Number(n) => match n.as_i64() {
            Some(whole) => Item::Int(whole),
            None => Item::Float(n.as_f64().unwrap_or(f64::NAN)),
        },
        Value::String(text) => Item::Text(text.clone()),
        Value::Array(values) => {
            let inner = if kind == "line" { "section" } else { kind };
            Item::List(values.iter().map(|value| item(inner, value)).collect())
        }
        Value::Object(fields) => Item::Record(Arc::new(Record {
            kind,
            fields: fields
                .iter()
                .map(|(name, value)| (name.clone(), item(kind, value)))
                .collect(),
        })),
    }
}
