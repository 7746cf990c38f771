//! One case in ten clicks: connect, symptom, test, result, repair, proof, sheet.

mod chain;
mod evidence;
mod known;
mod prove;
mod repair;
mod result;
mod running;
mod seen;
mod stage;
mod symptom;
mod verdict;

use eframe::egui::{Button, Color32, Response, RichText, ScrollArea, Ui, vec2};
use fault_db::Id;

use super::procedures::Concluded;
use super::report::SheetOf;
use crate::parts::{ActionPlace, name_edit};
use crate::request::Request;
use crate::units::Unit;
use crate::{PageContext, Palette, Sizes};
use known::KnownUnit;
use prove::Proof;
use ptu_report::words::fill;
use ptu_runs::bench_worker::{Phase, Progress};
use repair::Repair;
use result::Found;
use seen::SeenUnits;
use stage::Stage;
use symptom::SymptomTiles;

#[derive(Default)]
pub struct CasePage {
    stage: Stage,
    /// Serial number of the unit the case is about.
    unit: Option<String>,
    known: KnownUnit,
    units: SeenUnits,
    tiles: SymptomTiles,
    /// Its last run that was looked at.
    seen: Option<Id>,
    found: Option<Found>,
    repair: Repair,
    proof: Proof,
}

impl CasePage {
    /// Takes what has come, whatever page is in front; `concluded` is what is said of the chosen unit's last run.
    pub fn poll(
        &mut self,
        concluded: Option<(Id, &Request<Concluded>)>,
        context: &mut PageContext<'_>,
    ) {
        self.follow_unit(context);
        self.known.poll();
        self.units.poll();
        self.tiles.poll(context);
        self.proof.poll(context);
        if let Some(found) = &mut self.found {
            found.poll(context);
        }
        if self.repair.poll(&self.known, context) {
            self.stage = Stage::Prove;
        }
        if self.repair.is_undone(context) && self.stage == Stage::Prove {
            self.stage = Stage::Repair;
        }
        // A run that goes on blanks the result it had.
        let run = context.units.chosen().run_of_case();
        if self.stage == Stage::Result && run.is_some_and(Progress::is_running) {
            (self.found, self.stage) = (None, Stage::Find);
        }
        if matches!(self.stage, Stage::Find | Stage::Prove) {
            self.take_run(concluded, context);
        }
    }

    /// The case is about the connected unit; another unit is another case.
    fn follow_unit(&mut self, context: &PageContext<'_>) {
        let unit = context.units.chosen();
        let Some(serial) = unit.serial().filter(|_| unit.is_connected()) else {
            return;
        };
        if self.unit.as_ref() != Some(&serial) {
            self.begin(unit);
            self.unit = Some(serial);
            self.stage = Stage::Unit;
        } else if self.stage == Stage::Start {
            self.stage = Stage::Unit;
        }
    }

    /// A case about nothing yet; the last run of the unit belongs to no case.
    fn begin(&mut self, unit: &Unit) {
        *self = Self {
            seen: unit.run.as_ref().and_then(Progress::id),
            ..Self::default()
        };
    }

    /// Goes on when the run of this stage is over and it is known what it says.
    fn take_run(
        &mut self,
        concluded: Option<(Id, &Request<Concluded>)>,
        context: &PageContext<'_>,
    ) {
        let unit = context.units.chosen();
        let Some(run) = unit.run_of_case() else {
            return;
        };
        let Some(Some(outcome)) = &run.ended else {
            return;
        };
        if self.seen == Some(outcome.id) {
            return;
        }
        let said = concluded.filter(|(of, _)| *of == outcome.id);
        let said = match said {
            Some((_, Request::Pending(_))) | None => return,
            Some((_, said)) => said.value(),
        };
        self.seen = Some(outcome.id);
        let proofs = said.map(|said| said.proofs.as_slice()).unwrap_or_default();
        let proven = !proofs.is_empty() && proofs.iter().all(|proof| proof.says.is_proven());
        let next = self.stage.after_run(outcome.exit, proven);
        if next == Stage::Result {
            self.found = Some(Found::of(outcome, run, said, context));
            // Another repair is to be fitted and proved.
            self.proof = Proof::default();
        } else {
            self.proof.ran(said, run, outcome, context.words);
        }
        self.stage = next;
    }

    /// Draws it; the sheet that is to be drawn below.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        has_orders: bool,
        context: &mut PageContext<'_>,
    ) -> Option<SheetOf> {
        self.way(ui, context);
        ui.separator();
        if self.stage == Stage::Sheet {
            let run = self.seen?;
            self.proof.sign(ui, run, context);
            return Some(match self.repair.fault() {
                Some(fault) => SheetOf::Case { fault, run },
                None => SheetOf::Run(run),
            });
        }
        ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| match self.stage {
                Stage::Start => self.start(ui, context),
                Stage::Unit if !context.units.chosen().is_connected() => self.start(ui, context),
                Stage::Unit => self.unit(ui, context),
                Stage::Find => self.running(ui, has_orders, Stage::Unit, context),
                Stage::Result => self.result(ui, context),
                Stage::Repair => self.repair(ui, context),
                Stage::Prove => self.prove(ui, has_orders, context),
                Stage::Sheet => {}
            });
        None
    }

    /// The stages with the present one marked, the way to a new case, and the lock of the window.
    fn way(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let palette = Palette::of(ui);
        ui.horizontal_wrapped(|ui| {
            for (place, stage) in (1..).zip(Stage::ALL) {
                let text = format!("{place} {}", stage.name(context.words));
                let text = RichText::new(text).size(Sizes::of(ui).lead);
                ui.label(match stage == self.stage {
                    true => text.strong().color(palette.accent),
                    false => text.color(palette.quiet),
                });
            }
            let place = ActionPlace::new(ui, "new case", self.stage);
            let begun = !matches!(self.stage, Stage::Start | Stage::Unit);
            let unit = context.units.chosen();
            let new = ui.add_enabled(
                begun && unit.phase() != Phase::Running,
                Button::new(context.words.case.new_case),
            );
            if place.clicked(&new) {
                self.begin(unit);
            }
            let lock = ui.button(context.words.frame.lock);
            if place.clicked(&lock.on_hover_text(context.words.frame.lock_hint)) {
                context.settings.lock();
            }
        });
    }

    fn start(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        if let Some(why) = context.only_reads() {
            ui.label(RichText::new(why).size(Sizes::of(ui).lead));
            return;
        }
        self.name(ui, context);
        let unit = context.units.chosen_mut();
        let place = fill(words.reached_at, &[("place", &unit.choice.endpoint)]);
        ui.label(RichText::new(place).size(Sizes::of(ui).lead));
        let offline = unit.phase() == Phase::Offline;
        let action = ActionPlace::new(ui, "case connect", offline);
        let connect = large(ui, context.words.frame.connect, offline);
        if action.clicked(&connect) {
            unit.connect(context.queries);
        }
        if !offline {
            ui.spinner();
            return;
        }
        self.units.show(ui, context);
    }

    /// Who works on the case.
    fn name(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        ui.horizontal(|ui| {
            let label =
                ui.label(RichText::new(context.words.case.your_name).size(Sizes::of(ui).lead));
            ui.add(name_edit(&mut context.settings.operator, 220.0))
                .labelled_by(label.id);
        });
    }
}

/// The button of a page that is pressed first.
fn primary(ui: &mut Ui, text: &str, enabled: bool) -> Response {
    let fill = Palette::of(ui).fill;
    ui.scope(|ui| {
        if !(enabled && ui.is_enabled()) {
            return large(ui, text, enabled);
        }
        let widgets = &mut ui.visuals_mut().widgets;
        for widget in [&mut widgets.inactive, &mut widgets.hovered] {
            widget.weak_bg_fill = fill;
            widget.fg_stroke.color = Color32::WHITE;
        }
        large(ui, text, true)
    })
    .inner
}

/// A button that is found and hit at arm's length.
fn large(ui: &mut Ui, text: &str, enabled: bool) -> Response {
    let button = Button::new(RichText::new(text).size(Sizes::of(ui).lead));
    let button = button.min_size(vec2(180.0, Sizes::of(ui).target));
    if ui.layout().is_horizontal() {
        return ui.add_enabled(enabled, button);
    }
    // A row has its text in the middle of a button.
    ui.horizontal(|ui| ui.add_enabled(enabled, button)).inner
}
