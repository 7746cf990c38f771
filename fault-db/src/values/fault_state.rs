//! The life of a fault: open, acknowledged, repaired, verified, closed.
//!
//! A repair is only a claim until a passing run verifies it. A new occurrence before the fault is closed opens the
//! fault again; one after that begins a new fault.

use crate::values::text_enum::text_enum;

text_enum! {
    /// The state of a fault.
    FaultState {
        /// The fault was seen; nobody works on it yet.
        Open = "open",
        /// Somebody works on it.
        Acknowledged = "acknowledged",
        /// A part was replaced or adjusted; not verified yet.
        Repaired = "repaired",
        /// A run after the repair passed.
        Verified = "verified",
        /// Closed; the next occurrence begins a new fault.
        Closed = "closed",
    }
}

/// Changes of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultAction {
    /// The fault occurred again.
    Occur,
    /// Somebody begins to work on it.
    Acknowledge,
    /// A repair was made.
    Repair,
    /// A run after the repair passed.
    Verify,
    /// The fault is closed.
    Close,
    /// The repair did not hold, or was a mistake.
    Reopen,
}

impl FaultAction {
    /// Changes that a person can make to a fault, in the order in which they are offered.
    pub const BY_A_PERSON: [Self; 5] = [
        Self::Acknowledge,
        Self::Repair,
        Self::Verify,
        Self::Close,
        Self::Reopen,
    ];

    /// The action of a person that leads to `state`.
    pub fn towards(state: FaultState) -> Self {
        match state {
            FaultState::Open => Self::Reopen,
            FaultState::Acknowledged => Self::Acknowledge,
            FaultState::Repaired => Self::Repair,
            FaultState::Verified => Self::Verify,
            FaultState::Closed => Self::Close,
        }
    }

    /// Kind of the action in the event log.
    pub fn event_kind(self) -> &'static str {
        match self {
            Self::Occur => "recurred",
            Self::Acknowledge => "acknowledged",
            Self::Repair => "repaired",
            Self::Verify => "verified",
            Self::Close => "closed",
            Self::Reopen => "reopened",
        }
    }
}

/// An action that the fault's state does not allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it is {from}, and from there it cannot be {}; it can be {}", .action.event_kind(), choices(*.from))]
pub struct TransitionError {
    /// The fault's state.
    pub from: FaultState,
    /// The action.
    pub action: FaultAction,
}

impl FaultState {
    /// The state after an action.
    pub fn next(self, action: FaultAction) -> Result<Self, TransitionError> {
        use FaultAction as A;
        use FaultState as S;
        match (self, action) {
            (S::Open, A::Occur) => Ok(S::Open),
            (S::Acknowledged, A::Occur) => Ok(S::Acknowledged),
            (S::Repaired | S::Verified, A::Occur) => Ok(S::Open),
            (S::Open, A::Acknowledge) => Ok(S::Acknowledged),
            // A fault may be repaired again, for instance by replacing a second part.
            (S::Open | S::Acknowledged | S::Repaired, A::Repair) => Ok(S::Repaired),
            (S::Repaired, A::Verify) => Ok(S::Verified),
            // Without a repair a fault may be closed (no fault found); after a repair only once that is verified.
            (S::Open | S::Acknowledged | S::Verified, A::Close) => Ok(S::Closed),
            (S::Acknowledged | S::Repaired | S::Verified, A::Reopen) => Ok(S::Open),
            (from, action) => Err(TransitionError { from, action }),
        }
    }
}

fn choices(from: FaultState) -> String {
    let words: Vec<_> = FaultAction::BY_A_PERSON
        .into_iter()
        .filter(|action| from.next(*action).is_ok())
        .map(FaultAction::event_kind)
        .collect();
    if words.is_empty() {
        "nothing more".to_owned()
    } else {
        words.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every state against every action; `-` is a refusal.
    #[test]
    fn transitions_match_the_table() {
        let table = "
            from          occur         acknowledge   repair    verify    close   reopen
            open          open          acknowledged  repaired  -         closed  -
            acknowledged  acknowledged  -             repaired  -         closed  open
            repaired      open          -             repaired  verified  -       open
            verified      open          -             -         -         closed  open
            closed        -             -             -         -         -       -
        ";
        let actions = [
            FaultAction::Occur,
            FaultAction::Acknowledge,
            FaultAction::Repair,
            FaultAction::Verify,
            FaultAction::Close,
            FaultAction::Reopen,
        ];
        for line in table
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .skip(1)
        {
            let mut words = line.split_whitespace();
            let from: FaultState = words.next().expect("a state").parse().expect("known");
            for (action, expected) in actions.into_iter().zip(words) {
                let found = from
                    .next(action)
                    .map_or("-".to_owned(), |state| state.to_string());
                assert_eq!(found, expected, "{from} {action:?}");
            }
        }
    }

    #[test]
    fn an_unknown_word_is_refused_with_the_possible_ones() {
        let error = FaultState::Repaired
            .next(FaultAction::Close)
            .expect_err("not verified");
        assert_eq!(
            error.to_string(),
            "it is repaired, and from there it cannot be closed; it can be repaired, verified, reopened"
        );
    }
}
