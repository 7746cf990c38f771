//! The steps to run, in order and with their repetitions.

use crate::procedure::PromptPolicy;
use crate::procedure::plan::Procedure;

#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Places of the chosen steps; `None` = all.
    pub chosen: Option<Vec<usize>>,
    /// How often the procedure is run, each time with set-up and clean-up.
    pub repeat: u32,
    /// Skip the rest after the first step that did not pass.
    pub stop_on_fail: bool,
    pub prompts: PromptPolicy,
    /// A step begins one scan after the step before ended, not in the same scan, so that
    /// [`Runner::leave`](super::Runner::leave) can come between.
    pub one_by_one: bool,
    /// Places of steps whose trace is kept even if they pass.
    pub traced: Vec<usize>,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            chosen: None,
            repeat: 1,
            stop_on_fail: false,
            prompts: PromptPolicy::Refuse,
            one_by_one: false,
            traced: Vec::new(),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ScheduledStep {
    pub index: usize,
    pub turn: u32,
    pub turns: u32,
}

/// The chosen steps, each with its own repetitions, for the procedure's repetition `round`, counted from 0.
pub(super) fn schedule(
    procedure: &Procedure,
    options: &RunOptions,
    round: u32,
) -> Vec<ScheduledStep> {
    let all: Vec<usize> = (0..procedure.steps.len()).collect();
    let chosen = options.chosen.as_ref().unwrap_or(&all);
    let mut turns = Vec::new();
    for &index in chosen.iter().filter(|&&i| i < procedure.steps.len()) {
        let repeat = procedure.steps[index].repeat;
        turns.extend((1..=repeat).map(|k| ScheduledStep {
            index,
            turn: round * repeat + k,
            turns: options.repeat * repeat,
        }));
    }
    turns
}

/// Place at which a repetition of the step at `place` begins: this step, or the first of those it continues from.
pub(super) fn group_start(
    procedure: &Procedure,
    schedule: &[ScheduledStep],
    place: usize,
) -> usize {
    let continues = |place: &usize| procedure.steps[schedule[*place].index].continues;
    (1..=place)
        .rev()
        .find(|place| !continues(place))
        .unwrap_or_default()
}
