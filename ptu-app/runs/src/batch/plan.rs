//! Description of a file's runs: their maker, their plan, and the part of the plan.

use serde::{Deserialize, Serialize};

use super::Shard;
use crate::data::sha256;

/// Head of a file of runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the program.
    pub app_version: String,
    /// SHA-256 of program, scripts and data: of all that decides a run beside its name.
    pub made_by: String,
    pub plan: Plan,
    /// The part of the plan that the file is for; none = all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
}

/// All runs by their names, in order. A name decides its run, whichever process makes it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Description of the plan, for people.
    pub what: String,
    /// A name for each run or, with seeds, for as many runs as there are seeds.
    pub names: Vec<String>,
    /// The first seed, and how many.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seeds: Option<(u64, u64)>,
}

impl Head {
    /// Head of all runs of the plan, made by this version of the program; `made_by` = all that decides a run beside
    /// its name.
    pub fn new(made_by: &str, plan: Plan) -> Self {
        Self {
            app_version: env!("CARGO_PKG_VERSION").into(),
            made_by: sha256(made_by),
            plan,
            shard: None,
        }
    }

    /// This head for all runs of the plan instead of one shard.
    pub fn of_all(&self) -> Self {
        Self {
            shard: None,
            ..self.clone()
        }
    }

    /// Why runs under the other head do not fit this one; none if they fit.
    pub fn other_maker(&self, other: &Self) -> Option<String> {
        if self.app_version != other.app_version {
            return Some(format!(
                "its runs were made by version {}, not {}",
                other.app_version, self.app_version
            ));
        }
        (self.made_by != other.made_by)
            .then(|| "its runs were made by another program or with other scripts".into())
    }
}

impl Plan {
    pub fn len(&self) -> usize {
        let seeds = self.seeds.map_or(1, |(_, count)| count);
        (self.names.len()).saturating_mul(usize::try_from(seeds).unwrap_or(usize::MAX))
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Place of a run's name in the list, and its seed, if the plan has seeds.
    pub fn place(&self, number: usize) -> (usize, Option<u64>) {
        match self.seeds {
            None => (number, None),
            Some((first, count)) => {
                let count = usize::try_from(count).unwrap_or(usize::MAX).max(1);
                let seed = first.wrapping_add((number % count) as u64);
                (number / count, Some(seed))
            }
        }
    }

    pub fn name(&self, number: usize) -> String {
        let (place, seed) = self.place(number);
        let name = self.names.get(place).map_or("", String::as_str);
        match seed {
            None => name.to_owned(),
            Some(seed) => format!("{name} seed {seed}"),
        }
    }
}
