//! The page Case leads through one case in ten clicks: connect, symptom, test, result, repair, proof, sheet.

mod chain;
mod evidence;
mod known;
mod prove;
mod repair;
mod result;
mod running;
mod seen;
mod stage;
mod steps;
mod symptom;
mod verdict;

use eframe::egui::{Align, Frame, Layout, Margin, Panel, RichText, ScrollArea, Ui};
use egui_material_icons::icons::{ICON_ARROW_BACK, ICON_ARROW_FORWARD, ICON_LINK, ICON_TUNE};
use fault_db::Id;

use super::procedures::Concluded;
use super::report::SheetOf;
use crate::parts::{ActionPlace, Face, Look, choice as choice_card, name_edit, title};
use crate::request::Request;
use crate::units::Unit;
use crate::{Destination, PageContext, Palette, Sizes};
use known::KnownUnit;
use prove::RepairProof;
use ptu_runs::bench_worker::{Phase, Progress};
use repair::Repair;
use result::Found;
use seen::SeenUnits;
use stage::Stage;
pub use steps::wide as case_steps;
use symptom::SymptomTiles;
pub use verdict::{Told, named};

/// Least width of a window with the strip beside the page, and width of the strip, points.
const STRIP: [f32; 2] = [1200.0, 232.0];

#[derive(Default)]
pub struct CasePage {
    stage: Stage,
    /// Serial number of the unit the case is about.
    unit: Option<String>,
    known: KnownUnit,
    units: SeenUnits,
    tiles: SymptomTiles,
    /// Last run whose result was taken.
    seen: Option<Id>,
    found: Option<Found>,
    repair: Repair,
    proof: RepairProof,
}

impl CasePage {
    /// Takes results that have arrived, whichever page is shown; `concluded`: conclusion of the chosen unit's last run.
    pub fn poll(
        &mut self,
        concluded: Option<(Id, &Request<Concluded>)>,
        context: &mut PageContext<'_>,
    ) {
        self.follow_unit(context);
        if let Some(serial) = &self.unit {
            self.known.keep_up(serial, context);
        }
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
        // While the case's run goes on, an earlier result is not shown.
        let run = context.units.chosen().run_of_case();
        if self.stage == Stage::Result && run.is_some_and(Progress::is_running) {
            (self.found, self.stage) = (None, Stage::Find);
        }
        if matches!(self.stage, Stage::Find | Stage::Prove) {
            self.take_run(concluded, context);
        }
    }

    /// Begins a new case when another unit is connected.
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

    /// Begins an empty case; an earlier run of the unit does not belong to it.
    fn begin(&mut self, unit: &Unit) {
        *self = Self {
            seen: unit.run.as_ref().and_then(Progress::id),
            ..Self::default()
        };
    }

    /// Goes to the next stage when the run of this stage has ended and its conclusion is known.
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
            // The next repair has to be fitted and proved anew.
            self.proof = RepairProof::default();
        } else {
            self.proof.ran(said, (run, outcome, proven), context.words);
        }
        self.stage = next;
    }

    /// Draws the page; returns the sheet that is to be drawn on it.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        has_orders: bool,
        context: &mut PageContext<'_>,
    ) -> Option<SheetOf> {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let screen = ui.ctx().content_rect().size();
        let ground = Frame::new()
            .fill(palette.panel)
            .inner_margin(Margin::same(8));
        let panel = Panel::left("steps of a case")
            .resizable(false)
            .frame(ground);
        panel
            .exact_size(steps::wide(screen.x))
            .show(ui, |ui| self.steps(ui, context));
        if screen.x >= STRIP[0] {
            let panel = Panel::right("strip of a case")
                .resizable(false)
                .frame(ground);
            panel
                .exact_size(STRIP[1])
                .show(ui, |ui| self.strip(ui, context));
        }
        let ground = ground.inner_margin(Margin::symmetric(16, 0));
        let panel = Panel::bottom("foot of a case")
            .resizable(false)
            .frame(ground);
        panel.exact_size(sizes.footer).show(ui, |ui| {
            let whole = Layout::left_to_right(Align::Center);
            ui.with_layout(whole, |ui| self.foot(ui, has_orders, context));
        });
        if self.stage == Stage::Sheet {
            let run = self.seen?;
            self.proof.told(ui);
            let found = self.found.as_ref();
            let verdict = found.map_or("", |found| found.told.word(&context.words.case));
            let of = (&self.unit, &self.repair);
            self.proof.sign(ui, (run, verdict), of, context);
            return Some(match self.repair.fault() {
                Some(fault) => SheetOf::Case { fault, run },
                None => SheetOf::Run(run),
            });
        }
        let margin = Frame::new().inner_margin(Margin::symmetric(
            if screen.x < STRIP[0] { 8 } else { 16 },
            8,
        ));
        margin.show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt(self.stage)
                .auto_shrink(false)
                .show(ui, |ui| match self.stage {
                    Stage::Start => self.start(ui, context),
                    Stage::Unit if !context.units.chosen().is_connected() => {
                        self.start(ui, context)
                    }
                    Stage::Unit => {
                        self.name(ui, context);
                        title(ui, context.words.case.what_is_wrong);
                        self.tiles.show(ui, context);
                        ui.add_space(8.0);
                        self.known.show(ui, context.words, context.go_to);
                    }
                    Stage::Find => self.running(ui, has_orders, context),
                    Stage::Result => {
                        if let Some(found) = &mut self.found {
                            found.show(ui, screen.x < STRIP[0], context.words);
                        }
                    }
                    Stage::Repair => {
                        self.repair.show(ui, &self.known, context);
                        self.name(ui, context);
                    }
                    Stage::Prove => self.prove(ui, has_orders, context),
                    Stage::Sheet => {}
                });
        });
        None
    }

    /// Foot of the page: Back or Stop, and the accent button with the reason if it is disabled.
    fn foot(&mut self, ui: &mut Ui, has_orders: bool, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        let place = ActionPlace::new(ui, "case back", self.stage);
        if self.is_running(has_orders, context) {
            let unit = context.units.chosen();
            let place = ActionPlace::new(ui, "case stop", unit.bench.stop().presses());
            let stop = Face::new(Look::Danger, context.words.procedures.stop).show(ui);
            if place.clicked(&stop) {
                unit.bench.stop().press();
            }
        } else {
            let back = self.back(context);
            let face = Face::new(Look::Quiet, words.back).icon(ICON_ARROW_BACK);
            let why_not = self.why_not_back(context).filter(|_| back.is_none());
            let button = face.because(why_not).show(ui);
            if let (true, Some(back)) = (place.clicked(&button), back) {
                self.stage = back;
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            match self.stage {
                Stage::Start => self.start_foot(ui, context),
                Stage::Unit if !context.units.chosen().is_connected() => {
                    self.start_foot(ui, context)
                }
                Stage::Unit => {
                    if self.tiles.foot(ui, context) {
                        (self.found, self.stage) = (None, Stage::Find);
                    }
                }
                Stage::Find => {
                    let goes_on = has_orders
                        || self.is_over(context)
                        || context.units.chosen().phase() == Phase::Running;
                    let why = self.found.is_none().then_some(match goes_on {
                        true => words.under_way,
                        false => words.not_begun,
                    });
                    let next = Face::new(Look::Primary, words.stage_result).off(why);
                    if next.end(ICON_ARROW_FORWARD).show(ui).clicked() {
                        self.stage = Stage::Result;
                    }
                }
                Stage::Result => {
                    let unit = context.units.chosen();
                    let found = self.found.as_ref();
                    let chosen = found.and_then(|found| found.foot(ui, unit, context.words));
                    if let Some(way) = chosen {
                        self.next(way, context);
                    }
                }
                Stage::Repair => self.repair.foot(ui, context),
                Stage::Prove if self.is_running(has_orders, context) => {
                    let next = Face::new(Look::Primary, words.stage_sheet);
                    next.off(Some(words.under_way)).show(ui);
                }
                Stage::Prove => {
                    let of = (self.found.as_ref(), &self.repair);
                    if self.proof.foot(ui, of, context) {
                        self.stage = Stage::Sheet;
                    }
                }
                Stage::Sheet => self.proof.sign_foot(ui, self.seen, context),
            }
        });
    }

    fn start(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        self.name(ui, context);
        title(ui, words.where_is);
        let unit = context.units.chosen_mut();
        let choice = &mut unit.choice;
        let simulated = choice.is_simulated();
        let below = match simulated {
            true => words.practice_hint,
            false => "",
        };
        let name = match simulated {
            true => context.words.frame.simulated,
            false => &choice.endpoint,
        };
        let size = [ui.available_width(), 56.0];
        choice_card(ui, (name, below), true, size);
        ui.add_space(8.0);
        ui.horizontal_wrapped(|ui| {
            let frame = &context.words.frame;
            for (name, value) in [
                (frame.line, &choice.line),
                (frame.unit_config, &choice.unit_config),
                (frame.train, &choice.train),
            ] {
                let quiet = Palette::of(ui).quiet;
                ui.label(RichText::new(name).color(quiet));
                ui.label(RichText::new(value).strong());
            }
            let setup = Face::new(Look::Quiet, frame.setup).icon(ICON_TUNE);
            if setup.show(ui).clicked() {
                context.go_to.push(Destination::Setup);
            }
        });
        if unit.phase() == Phase::Offline {
            self.units.show(ui, context);
        } else {
            ui.spinner();
        }
    }

    fn start_foot(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let why = context.only_reads();
        let unit = context.units.chosen_mut();
        let offline = unit.phase() == Phase::Offline;
        let place = ActionPlace::new(ui, "case connect", offline);
        let connecting = match unit.phase() {
            Phase::Offline => None,
            Phase::MakingSafe => Some(context.words.frame.stopping),
            _ => Some(context.words.frame.connecting),
        };
        let face = Face::new(Look::Primary, context.words.frame.connect).icon(ICON_LINK);
        let connect = face.small("F9").off(why.or(connecting)).show(ui);
        if place.clicked(&connect) {
            unit.connect(context.queries);
        }
    }

    /// Field for the operator's name, in a window without the strip.
    fn name(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        if ui.ctx().content_rect().width() < STRIP[0] {
            ui.horizontal(|ui| name_field(ui, context));
        }
    }
}

fn name_field(ui: &mut Ui, context: &mut PageContext<'_>) {
    let quiet = Palette::of(ui).quiet;
    let label = ui.label(RichText::new(context.words.case.your_name).color(quiet));
    let wide = ui.available_width().min(220.0);
    ui.add(name_edit(&mut context.settings.operator, wide))
        .labelled_by(label.id);
}
