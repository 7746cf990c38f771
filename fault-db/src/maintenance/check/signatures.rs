//! Counts the entries that each key has signed.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::signature::Statement;

/// Uses of one key.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct KeyUse {
    /// The public key.
    pub key: String,
    /// Name of the owner, as the key's signatures give it.
    pub who: String,
    /// Kind of the key's owner: technician or bench.
    pub kind: String,
    /// Number of runs that the key signed.
    pub runs: u32,
    /// Number of fault events, notes and instruments that the key signed.
    pub others: u32,
    /// Time of the first thing signed, µs since 1970.
    pub first_at_us: i64,
    /// Time of the last thing signed, µs since 1970.
    pub last_at_us: i64,
}

/// Uses by public key, name and kind: a key that signs under two names is listed twice.
#[derive(Default)]
pub(super) struct KeyUses(BTreeMap<[String; 3], KeyUse>);

impl KeyUses {
    pub fn add(&mut self, statement: &Statement) {
        let Statement { key, who, kind, .. } = statement;
        let at_us = statement.at_us;
        let name = [key, who, kind].map(String::clone);
        let uses = self.0.entry(name).or_insert_with(|| KeyUse {
            key: key.clone(),
            who: who.clone(),
            kind: kind.clone(),
            runs: 0,
            others: 0,
            first_at_us: at_us,
            last_at_us: at_us,
        });
        match statement.what == "run" {
            true => uses.runs += 1,
            false => uses.others += 1,
        }
        uses.first_at_us = uses.first_at_us.min(at_us);
        uses.last_at_us = uses.last_at_us.max(at_us);
    }

    pub fn into_list(self) -> Vec<KeyUse> {
        self.0.into_values().collect()
    }
}
