//! Runs that another page asks for: a step, the search for a part, the proof of a repair.

use super::prepare::RunSettings;
use super::selection::Selection;
use super::{ProceduresPage, controls};
use crate::messages::told;
use crate::{PageContext, Wanted};
use ptu_report::words::fill;

impl ProceduresPage {
    /// Whether the scripts are still those of the run that broke off.
    pub fn goes_on(&self, context: &PageContext<'_>) -> bool {
        let suite = self.suite.value();
        let waiting = context.units.chosen().waiting_run();
        let same = suite
            .zip(waiting)
            .map(|(suite, (run, _))| suite.sha256 == run.scripts_sha256);
        same.unwrap_or_default()
    }

    /// Orders this run on the chosen unit; a step only if it is meant for that unit.
    pub fn want(&mut self, wanted: Wanted, context: &mut PageContext<'_>) {
        let chosen = context.units.chosen();
        if let Wanted::Step { unit, .. } = &wanted {
            let why_not = match chosen.may_run() {
                true => fill(context.words.procedures.other_unit, &[("unit", unit)]),
                false => controls::why_not(chosen, context.words).to_owned(),
            };
            if !chosen.may_run() || chosen.name() != *unit {
                context.messages.trouble(why_not, told(""));
                return;
            }
        }
        self.wanted = Some((wanted, chosen.id));
        self.keep_loaded(context);
    }

    /// Orders the run that another page asked for, once the suite is loaded; the selection on this page stays.
    pub(super) fn run_wanted(&mut self, context: &mut PageContext<'_>) {
        let Some(suite) = self.suite.value() else {
            return;
        };
        let Some((wanted, unit)) = self.wanted.take() else {
            return;
        };
        let Some(of) = context.units.of_id(unit) else {
            return;
        };
        let connection = of.connection();
        let same = of.waiting_run().filter(|_| !of.is_other());
        let rest = same.map(|(run, _)| (Selection::rest(run), run.id()));
        if let Wanted::Rest = wanted
            && rest.is_some()
            && !of.may_run()
        {
            self.wanted = Some((wanted, unit));
            return;
        }
        let was_of_case = of.is_run_of_case;
        let mut how = RunSettings::default();
        let all = &suite.procedures;
        let of_case = match &wanted {
            Wanted::Step { .. } => false,
            Wanted::Rest => was_of_case,
            Wanted::Part { .. } | Wanted::Prove { .. } => true,
        };
        let (selection, what) = match wanted {
            Wanted::Step {
                procedure, step, ..
            } => {
                let found = all.iter().find(|known| known.id == procedure);
                let only = found.map(|found| Selection::only(found, &step));
                (only.unwrap_or_default(), format!("{procedure} {step}"))
            }
            Wanted::Part { symptom, adaptive } => {
                (how.adaptive, how.symptom) = (adaptive, symptom);
                (Selection::usual(all, connection), String::new())
            }
            Wanted::Rest => {
                // The rest is not run on another unit.
                let Some((rest, continued)) = rest else {
                    return;
                };
                how.continues = continued;
                (rest, String::new())
            }
            Wanted::Prove { procedures, part } => {
                let selection = Selection::proof(all, connection, &procedures, &part);
                (selection, part)
            }
        };
        if selection.extent(all).0 == 0 {
            let said = context.words.procedures.no_such_step;
            context.messages.trouble(said, told(what));
            return;
        }
        self.order_of((unit, of_case), selection, how, context);
    }
}
