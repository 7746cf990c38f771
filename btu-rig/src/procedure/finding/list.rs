//! Findings in one place: each finding once, in the order in which it came first.

use serde::{Deserialize, Serialize};

use super::Finding;

/// Most findings of a step that are kept apart; the others are counted.
const MOST: usize = 64;

/// All findings of one place, each once with the number of times it came, in the order of their first appearance.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Findings(Vec<Found>);

/// A finding, and how often it came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    pub finding: Finding,
    /// Number of times the finding came; not in JSON if 1.
    #[serde(default = "once", skip_serializing_if = "is_once")]
    pub times: u32,
}

const fn once() -> u32 {
    1
}

fn is_once(times: &u32) -> bool {
    *times == 1
}

impl Findings {
    /// Each finding, in the order in which it came first.
    pub fn iter(&self) -> impl Iterator<Item = &Found> {
        self.0.iter()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Findings as JSON, as they are stored; `None` if there are none.
    pub fn to_json(&self) -> Option<String> {
        let stored = || serde_json::to_string(self).ok();
        (!self.is_empty()).then(stored)?
    }

    /// Findings from stored JSON; `None` for a form that this version does not know.
    pub fn from_json(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    /// One of the findings says that nothing could be run without the harness of a bench.
    pub fn need_harness(&self) -> bool {
        self.iter().any(|found| found.finding.needs_harness())
    }

    /// One of the findings is about the bench, and tells nothing of the unit.
    pub fn of_the_bench(&self) -> bool {
        self.iter().any(|found| found.finding.is_of_the_bench())
    }

    /// Adds a finding that came `times` times.
    pub fn add(&mut self, finding: Finding, times: u32) {
        if let Some(known) = self.0.iter_mut().find(|found| found.finding == finding) {
            known.times += times;
        } else if self.0.len() < MOST {
            self.0.push(Found { finding, times });
        } else if let Some(Found {
            finding: Finding::More { n },
            ..
        }) = self.0.last_mut()
        {
            *n += 1;
        } else {
            let finding = Finding::More { n: 1 };
            self.0.push(Found { finding, times: 1 });
        }
    }
}

impl From<Finding> for Findings {
    fn from(finding: Finding) -> Self {
        Self(vec![Found { finding, times: 1 }])
    }
}

impl Extend<Finding> for Findings {
    fn extend<T: IntoIterator<Item = Finding>>(&mut self, all: T) {
        all.into_iter().for_each(|one| self.add(one, 1));
    }
}
