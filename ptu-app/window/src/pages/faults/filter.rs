//! Which faults are shown.

use fault_db::{FaultState, FaultSummary};

use crate::page_context::FaultsOf;
use crate::settings::FaultsQuestion;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    pub unit: Option<String>,
    pub lru: Option<String>,
    pub state: Option<FaultState>,
    /// Days to look back.
    pub days: Option<i64>,
    /// Something its code, name, part, unit or severity contains.
    pub text: String,
    /// What a bar of the statistics stands for, until it is cleared.
    pub of_bar: FaultsOf,
}

impl Filter {
    /// As it is saved; what a bar of the statistics stands for is not.
    pub fn question(&self) -> FaultsQuestion {
        FaultsQuestion {
            unit: self.unit.clone(),
            part: self.lru.clone(),
            state: self.state.map(|state| state.to_string()),
            days: self.days,
            text: self.text.clone(),
        }
    }

    /// As it was saved.
    pub fn asked(question: FaultsQuestion) -> Self {
        Self {
            unit: question.unit,
            lru: question.part,
            state: question.state.and_then(|state| state.parse().ok()),
            days: question.days,
            text: question.text,
            of_bar: FaultsOf::default(),
        }
    }

    /// Whether a fault is shown.
    pub fn takes(&self, fault: &FaultSummary) -> bool {
        let text = self.text.trim().to_lowercase();
        let has = |what: &str| what.to_lowercase().contains(&text);
        self.unit
            .as_ref()
            .is_none_or(|unit| *unit == fault.unit_serial)
            && self.lru.as_ref().is_none_or(|lru| *lru == fault.lru)
            && self.state.is_none_or(|state| state == fault.state)
            && (self.of_bar.cause.as_deref()).is_none_or(|cause| cause == fault.cause())
            && (self.of_bar.first_seen_us.as_ref())
                .is_none_or(|span| span.contains(&fault.first_at_us))
            && (has(&fault.code_name)
                || has(&fault.code.to_string())
                || has(&fault.lru)
                || has(&fault.unit_serial)
                || has(&fault.severity))
    }
}

/// Names in order, each once.
pub fn names<'a>(all: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: std::collections::BTreeSet<_> = all.collect();
    names.into_iter().map(str::to_owned).collect()
}
