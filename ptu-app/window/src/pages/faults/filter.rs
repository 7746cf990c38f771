//! The filter of the page Faults.

use fault_db::{FaultState, FaultSummary};

use crate::page_context::FaultsOf;
use crate::settings::FaultsQuestion;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    pub lru: Option<String>,
    pub state: Option<FaultState>,
    /// Days to look back; none = all there is.
    pub days: Option<i64>,
    /// Text that a fault's code, name, part, unit or severity contains.
    pub text: String,
    /// Faults of a bar of the statistics that was clicked, until the choice is cleared.
    pub of_bar: FaultsOf,
}

impl Filter {
    /// Choices of the filter and the unit, to be saved; the choice of a bar of the statistics is not saved.
    pub fn question(&self, unit: Option<&str>) -> FaultsQuestion {
        FaultsQuestion {
            unit: unit.map(str::to_owned),
            part: self.lru.clone(),
            state: self.state.map(|state| state.to_string()),
            days: self.days,
            text: self.text.clone(),
        }
    }

    pub fn asked(question: FaultsQuestion) -> Self {
        Self {
            lru: question.part,
            state: question.state.and_then(|state| state.parse().ok()),
            days: question.days,
            text: question.text,
            of_bar: FaultsOf::default(),
        }
    }

    /// Whether the filter shows the fault.
    pub fn takes(&self, fault: &FaultSummary) -> bool {
        let text = self.text.trim().to_lowercase();
        let has = |what: &str| what.to_lowercase().contains(&text);
        self.lru.as_ref().is_none_or(|lru| *lru == fault.lru)
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
