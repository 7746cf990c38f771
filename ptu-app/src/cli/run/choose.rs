//! Choice of procedures and steps to run.

use std::sync::Arc;

use btu_rig::procedure::{Procedure, PromptPolicy, RunOptions};
use glob::Pattern;

use super::RunArguments;
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Asked, Failure, RunTrouble, Unknown, did_you_mean};
use ptu_runs::run::{Task, select};
use ptu_runs::stdio;

impl RunArguments {
    /// All procedures if some are named, else those that do not run on request only; in both cases without --exclude.
    pub(super) fn asked_for(
        &self,
        mut procedures: Vec<Arc<Procedure>>,
    ) -> Result<Vec<Arc<Procedure>>, Failure> {
        if self.procedures.is_empty() {
            let (left_out, run) = procedures.into_iter().partition(|p| p.on_request);
            procedures = run;
            let names: Vec<_> = left_out.iter().map(|p: &Arc<_>| p.id.as_str()).collect();
            if !names.is_empty() {
                let said = Words::shown().terminal.named_only;
                stdio::note(&fill(said, &[("names", &names.join(", "))]));
            }
        }
        for name in &self.exclude {
            exclude(name, &mut procedures)?;
        }
        Ok(procedures)
    }

    /// Tasks for the procedures, with the steps chosen by --step; a procedure without a chosen step is left out.
    pub(super) fn tasks(
        &self,
        procedures: Vec<Arc<Procedure>>,
        operator: bool,
    ) -> Result<Vec<Task>, Failure> {
        let pattern = select::step_pattern(self.step.as_deref())?;
        let task = |procedure: Arc<Procedure>| {
            let chosen = pattern.as_ref().map(|pattern| {
                let steps = procedure.steps.iter().enumerate();
                steps
                    .filter(|(_, step)| pattern.matches(&step.name))
                    .map(|(i, _)| i)
                    .collect()
            });
            let options = RunOptions {
                chosen,
                repeat: self.repeat,
                stop_on_fail: self.stop_on_fail,
                prompts: match operator {
                    true => PromptPolicy::Ask,
                    false => PromptPolicy::Refuse,
                },
                ..RunOptions::default()
            };
            Task { procedure, options }
        };
        let mut tasks: Vec<_> = procedures.into_iter().map(task).collect();
        if let Some(glob) = &self.step {
            tasks.retain(|task| task.options.chosen.as_ref().is_none_or(|c| !c.is_empty()));
            if tasks.is_empty() {
                return Err(Failure::usage(Unknown::Step(glob.clone())));
            }
        }
        if self.shuffle {
            select::shuffle(&mut tasks, self.seed());
        }
        Ok(tasks)
    }
}

/// Removes the procedures with this name, in this folder, or that match this glob.
///
/// # Errors
/// It would remove no procedure, or all that are left.
fn exclude(name: &str, procedures: &mut Vec<Arc<Procedure>>) -> Result<(), Failure> {
    let wanted = name.strip_suffix(".star").unwrap_or(name);
    let wanted = wanted.trim_start_matches("scripts/").trim_end_matches('/');
    let pattern = Pattern::new(wanted)
        .map_err(|error| Failure::usage(RunTrouble::Glob(name.to_owned(), error.to_string())))?;
    let is_excluded = |id: &str| {
        pattern.matches(id)
            || id
                .split_once('/')
                .is_some_and(|(folder, _)| folder == wanted)
    };
    let (left_out, left): (Vec<_>, Vec<_>) = std::mem::take(procedures)
        .into_iter()
        .partition(|procedure| is_excluded(&procedure.id));
    if left_out.is_empty() {
        let hint = did_you_mean(wanted, left.iter().map(|procedure| procedure.id.as_str()));
        return Err(Failure::usage(Asked::ExcludesNone(name.to_string(), hint)));
    }
    if left.is_empty() {
        return Err(Failure::usage(Asked::ExcludesAll(name.to_string())));
    }
    *procedures = left;
    Ok(())
}
