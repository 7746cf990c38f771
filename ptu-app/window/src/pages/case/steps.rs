//! The seven steps of a case beside the page, each a way to its stage, and the strip that names unit, run and operator.

use eframe::egui::{Align, Layout, RichText, ScrollArea, Ui};
use egui_material_icons::icons::{ICON_ADD_CIRCLE, ICON_DESCRIPTION, ICON_LOCK};

use super::verdict::{Next, Told};
use super::{CasePage, Stage, name_field};
use crate::parts::{ActionPlace, Face, Look, Step, fact, running_text};
use crate::{Destination, PageContext, Palette, Sizes, Wanted};
use ptu_report::count_text;
use ptu_runs::bench_worker::{Phase, Progress};
use ptu_runs::clock;

/// Height of a step, and of one in a low window, points.
const HIGH: [f32; 2] = [64.0, 48.0];

/// Width of the list of steps for a window of width `screen`, points; a narrow window shows numbers alone.
pub fn wide(screen: f32) -> f32 {
    match screen {
        narrow if narrow < 1000.0 => 64.0,
        usual if usual < 1600.0 => 208.0,
        _ => 240.0,
    }
}

impl CasePage {
    pub(super) fn steps(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let narrow = ui.available_width() < 100.0;
        let foot = 2.0 * (Sizes::of(ui).target + ui.spacing().item_spacing.y);
        let room = ui.available_height() - foot;
        let high =
            (room / 7.0 - ui.spacing().item_spacing.y).clamp(28.0, HIGH[usize::from(narrow)]);
        let mut to = None;
        let area = ScrollArea::vertical()
            .max_height(room)
            .auto_shrink([false, true]);
        area.show(ui, |ui| {
            for (number, stage) in (1..).zip(Stage::ALL) {
                let blocked = self.blocked(stage, context);
                let below = match blocked {
                    Some(why) if stage != Stage::Start => why.to_owned(),
                    _ => self.came_to(stage, context),
                };
                let step = Step {
                    number,
                    name: stage.name(words),
                    below: &below,
                    is_here: stage == self.stage,
                    is_done: stage < self.stage,
                    can_go: blocked.is_none(),
                };
                if step.show(ui, high).clicked() {
                    to = Some(stage);
                }
            }
        });
        self.go(to);
        ui.with_layout(Layout::bottom_up(Align::Min), |ui| {
            let text = |text: &'static str| if narrow { "" } else { text };
            let lock = Face::new(Look::Quiet, text(words.frame.lock)).icon(ICON_LOCK);
            let lock = lock.named(words.frame.lock).hint(words.frame.lock_hint);
            if lock.show(ui).clicked() {
                context.settings.lock();
            }
            let place = ActionPlace::new(ui, "new case", self.stage);
            let begun = !matches!(self.stage, Stage::Start | Stage::Unit);
            let unit = context.units.chosen();
            let may = begun && unit.phase() != Phase::Running;
            let new = Face::new(Look::Quiet, text(words.case.new_case)).icon(ICON_ADD_CIRCLE);
            let new = new.named(words.case.new_case).hint(words.case.new_case);
            let why_not = match begun {
                true => words.case.under_way,
                false => words.case.after_symptom,
            };
            if place.clicked(&new.because((!may).then_some(why_not)).show(ui)) {
                self.begin(unit);
            }
        });
    }

    fn go(&mut self, to: Option<Stage>) {
        match (to, &self.found) {
            (Some(Stage::Repair), Some(found)) => {
                self.repair.prepare(found, &self.known);
                self.stage = Stage::Repair;
            }
            (Some(to), _) => self.stage = to,
            (None, _) => {}
        }
    }

    /// Does the action that was chosen below a result.
    pub(super) fn next(&mut self, way: Next, context: &mut PageContext<'_>) {
        let Some(found) = &self.found else {
            return;
        };
        match way {
            Next::Repair => self.go(Some(Stage::Repair)),
            Next::Sheet => self.stage = Stage::Sheet,
            Next::ShowFailed => context.go_to.push(Destination::Report(found.run)),
            Next::Check => {
                let check = found.next_check().map(|next| next.check.clone());
                let step = check.zip(self.unit.clone());
                let step = step.map(|(check, unit)| Wanted::Step {
                    procedure: check.procedure,
                    step: check.step,
                    unit,
                });
                context.go_to.extend(step.map(Destination::Run));
            }
            Next::WholeSuite | Next::RunAgain => {
                let wanted = Wanted::Part {
                    symptom: self.tiles.symptom(),
                    adaptive: way == Next::RunAgain,
                };
                context.go_to.push(Destination::Run(wanted));
                (self.found, self.stage) = (None, Stage::Find);
            }
        }
    }

    /// Reason for which a click cannot lead to this stage; none = it can.
    fn blocked(&self, stage: Stage, context: &PageContext<'_>) -> Option<&'static str> {
        let words = &context.words.case;
        let unit = context.units.chosen();
        let failed = self
            .found
            .as_ref()
            .is_some_and(|found| found.told.is_failed());
        // During a run only its own stage is shown. A run that has ended counts as under way until its result is taken,
        // which happens in the stages Find and Prove alone.
        let takes = matches!(self.stage, Stage::Find | Stage::Prove);
        let runs =
            unit.run_of_case().is_some_and(Progress::is_running) || takes && self.is_over(context);
        let (can, why) = match stage {
            _ if runs => (stage == self.stage, words.under_way),
            Stage::Start => (!unit.is_connected(), words.disconnect_first),
            Stage::Unit => (unit.is_connected(), words.connect_first),
            Stage::Find => (self.found.is_some(), words.after_symptom),
            Stage::Result => (self.found.is_some(), words.after_test),
            Stage::Repair => (failed, words.after_result),
            Stage::Prove => (self.repair.is_written(), words.after_repair),
            Stage::Sheet => (
                self.found.is_some() && !self.repair.is_written() || self.proof.has_run(),
                words.after_proof,
            ),
        };
        (!can && stage != self.stage).then_some(why)
    }

    /// Outcome of a stage, in few words.
    fn came_to(&self, stage: Stage, context: &PageContext<'_>) -> String {
        let words = context.words;
        let run = context.units.chosen().run_of_case();
        match stage {
            Stage::Start => self.unit.clone().unwrap_or_default(),
            Stage::Unit => self.tiles.said(words),
            Stage::Find => match (run, stage == self.stage) {
                (Some(run), true) => running_text(run, words),
                _ => self
                    .found
                    .as_ref()
                    .map_or_else(String::new, |found| count_text(&found.counts, words)),
            },
            Stage::Result => self.found.as_ref().map_or_else(String::new, |found| {
                let part = found
                    .parts
                    .first()
                    .filter(|_| matches!(found.told, Told::Part | Told::Few));
                let word = || found.told.word(&words.case);
                part.map_or_else(word, |part| self.known.part_name(part, words))
                    .to_owned()
            }),
            Stage::Repair if self.repair.is_written() => self.repair.serial_new().to_owned(),
            Stage::Repair | Stage::Prove | Stage::Sheet => String::new(),
        }
    }

    pub(super) fn back(&self, context: &PageContext<'_>) -> Option<Stage> {
        let before = Stage::ALL
            .into_iter()
            .rev()
            .filter(|stage| *stage < self.stage);
        let mut before = before.filter(|stage| self.blocked(*stage, context).is_none());
        before.next()
    }

    /// Why Back is disabled: what blocks the step before; empty if there is no such step.
    pub(super) fn why_not_back(&self, context: &PageContext<'_>) -> Option<&'static str> {
        let mut before = (Stage::ALL.into_iter().rev()).filter(|stage| *stage < self.stage);
        let why = before.next().and_then(|stage| self.blocked(stage, context));
        Some(why.unwrap_or_default())
    }

    /// Draws unit, run, operator and open faults of the case at the right of its page.
    pub(super) fn strip(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let none = "–";
        let unit = context.units.chosen();
        let name = self.unit.as_deref().unwrap_or(none);
        fact(ui, words.common.unit, name);
        let found = self.found.as_ref();
        let run = match self.stage {
            // The run that the sheet shows.
            Stage::Sheet => self.seen,
            _ => {
                (found.map(|found| found.run)).or_else(|| unit.run_of_case().and_then(Progress::id))
            }
        };
        let short = run.map_or_else(|| none.to_owned(), |run| run.short());
        fact(ui, words.case.run, &short);
        if let Some(found) = found.filter(|found| Some(found.run) == run) {
            let ended = RichText::new(clock::local(found.ended_us)).small();
            ui.label(ended.color(Palette::of(ui).quiet));
        }
        name_field(ui, context);
        ui.separator();
        self.known.facts(ui, words);
        if self.stage == Stage::Result
            && let Some(found) = &self.found
        {
            ui.with_layout(Layout::bottom_up(Align::Min), |ui| {
                let sheet =
                    Face::new(Look::Secondary, words.case.test_sheet).icon(ICON_DESCRIPTION);
                if sheet.show(ui).clicked() {
                    context.go_to.push(Destination::Report(found.run));
                }
            });
        }
    }
}
