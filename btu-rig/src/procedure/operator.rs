//! The person at the bench, whom a procedure may ask.

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PromptPolicy {
    /// No operator is present: a step with a prompt is skipped; one in set-up or clean-up is an error.
    #[default]
    Refuse,
    /// A [`RunEvent::Prompt`](crate::procedure::RunEvent::Prompt) is sent and [`Runner::answer`](crate::procedure::Runner::answer) awaited.
    Ask,
}

/// Operator's side of a prompt.
#[derive(Debug)]
pub(super) struct Operator {
    pub policy: PromptPolicy,
    /// Answer given since the last scan.
    pub answer: Option<bool>,
}
