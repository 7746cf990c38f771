//! Data that scripts may read besides signals: unit configuration, code table and line.

use std::sync::Arc;

use protocol::config::{UnitConfig, find_code};
use protocol::line::Line;

use crate::tcms::{EbSources, Lamps, PowerCuts};
use crate::train::TrainData;

use super::amounts;
use super::item::{Item, Record};
use super::suggest::hint;
use crate::procedure::origin::SourceKind;

/// Configuration that verbs take defaults from.
#[derive(Debug)]
pub(super) struct Context {
    pub unit: UnitConfig,
    pub line: Line,
    codes: Vec<Item>,
    /// The unit configuration, the track database and the train's file, as scripts read them.
    trees: [Item; 3],
}

impl Context {
    pub(super) fn new(unit: UnitConfig, mut line: Line, train: TrainData) -> Self {
        line.name_codes(&unit.codes);
        let codes = (unit.codes.iter().enumerate())
            .map(|(index, code)| {
                let fields = vec![
                    ("name", Item::Text(code.name.clone())),
                    ("limit_kmh", Item::Float(code.limit_kmh)),
                    ("carrier_hz", Item::Float(code.carrier_hz)),
                    ("rate_hz", Item::Float(code.rate_hz)),
                    ("meaning", Item::Text(code.meaning.label().into())),
                    ("index", Item::Int(index as i64)),
                ];
                record("speed code", fields, "configuration codes.")
            })
            .collect();
        let train = match &train {
            TrainData::Ideal(data) => tree("train", data, "train "),
            TrainData::Cars(data) => tree("train", data, "train "),
        };
        let trees = [
            tree("unit configuration", &unit, "configuration "),
            tree("line", &line, "track database "),
            train,
        ];
        Self {
            unit,
            line,
            codes,
            trees,
        }
    }

    /// The predeclared names that are neither verbs nor signals.
    pub(super) fn globals(&self) -> Vec<(&'static str, Item)> {
        let [configuration, track, train] = &self.trees;
        vec![
            ("codes", Item::List(self.codes.clone())),
            ("unit", configuration.clone()),
            ("line", track.clone()),
            ("consist", train.clone()),
            ("cuts", bits::<PowerCuts>("cuts")),
            ("eb_by", bits::<EbSources>("eb_by")),
            ("lamp", bits::<Lamps>("lamp")),
        ]
    }

    /// Whether `source` names a place from which a number can come, and the place exists; `Err` says what `source` is.
    pub(super) fn source(&self, source: &str) -> Result<(), String> {
        let [configuration, track, train] = &self.trees;
        let Some((kind, key)) = SourceKind::split(source) else {
            return Err(format!("the text \"{source}\""));
        };
        let tree = match kind {
            SourceKind::Configuration => configuration,
            SourceKind::Track => track,
            SourceKind::Train => train,
            SourceKind::Measurement => {
                return Err(format!("\"{source}\", which measured() says by itself"));
            }
            SourceKind::Paper | SourceKind::Standard | SourceKind::Unit | SourceKind::Default => {
                return Ok(());
            }
        };
        let found = key.split('.').try_fold(tree.clone(), |at, name| match at {
            Item::List(items) => items.first()?.attribute(name),
            at => at.attribute(name),
        });
        match found {
            Some(_) => Ok(()),
            None => Err(format!("\"{source}\", and no such key")),
        }
    }

    pub(super) fn code(&self, name: &str) -> Result<Item, String> {
        let names = || self.unit.codes.iter().map(|code| code.name.as_str());
        match find_code(&self.unit.codes, name) {
            Some(at) => Ok(self.codes[at].clone()),
            None => Err(format!("no speed code \"{name}\"{}", hint(name, names()))),
        }
    }
}

/// A record of named values and of their quantities; `source` stands before the names in the quantities' origins.
fn record(
    kind: &'static str,
    fields: impl IntoIterator<Item = (impl Into<String>, Item)>,
    source: &str,
) -> Item {
    let fields = fields.into_iter().map(|(n, v)| (n.into(), v));
    let mut fields: Vec<_> = fields.collect();
    fields.extend(amounts::of(&fields, source));
    Item::Record(Arc::new(Record { kind, fields }))
}

/// Bits of a signal by their names.
fn bits<Set: bitflags::Flags<Bits = u16>>(kind: &'static str) -> Item {
    let named = Set::all().iter_names();
    let fields = named.map(|(name, bit)| (name.to_lowercase(), Item::Int(bit.bits().into())));
    record(kind, fields, "")
}

/// Configuration data as nested records, with the names that configuration files use.
fn tree(kind: &'static str, data: &impl serde::Serialize, source: &str) -> Item {
    match serde_json::to_value(data) {
        Ok(value) => item(kind, &value, source),
        Err(_) => Item::None,
    }
}

fn item(kind: &'static str, value: &serde_json::Value, source: &str) -> Item {
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
            Item::List(
                values
                    .iter()
                    .map(|value| item(inner, value, source))
                    .collect(),
            )
        }
        Value::Object(fields) => {
            let fields = fields.iter().map(|(name, value)| {
                let inner = item(kind, value, &format!("{source}{name}."));
                (name.as_str(), inner)
            });
            record(kind, fields, source)
        }
    }
}
