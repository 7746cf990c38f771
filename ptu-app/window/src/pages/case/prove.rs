//! The part is fitted: the unit is connected again, a run shows that the fault is gone, and its sheet is signed.

use btu_rig::procedure::Verdict;
use eframe::egui::{RichText, Ui};
use fault_db::Id;

use super::result::headline;
use super::verdict::Told;
use super::{CasePage, Stage, large};
use crate::pages::procedures::Concluded;
use crate::parts::ActionPlace;
use crate::request::Request;
use crate::{Destination, PageContext, Palette, Sizes};
use ptu_report::naming::DOT;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Phase, Progress};
use ptu_runs::clock::now_us;
use ptu_runs::run::Outcome;

/// How far the proof is.
#[derive(Default)]
pub struct Proof {
    /// The part was fitted; the unit is connected again as soon as it is disconnected.
    reconnects: bool,
    fitted: bool,
    /// What the last run says of the repair, or what it came to itself.
    said: Option<String>,
    verdict: Option<Verdict>,
    /// Answers with the run that was signed, and by whom.
    signing: Request<(Id, String)>,
}

impl Proof {
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        let locked = context.settings.locked;
        let unit = context.units.chosen_mut();
        if self.reconnects && !locked && unit.phase() == Phase::Offline {
            self.reconnects = false;
            unit.connect(context.queries);
        }
        if self.signing.poll()
            && let Request::Failed(why) = &self.signing
        {
            let said = context.words.case.not_signed;
            context.messages.trouble(said, why.clone());
        }
    }

    /// A proof run has ended so.
    pub fn ran(
        &mut self,
        said: Option<&Concluded>,
        run: &Progress,
        outcome: &Outcome,
        words: &Words,
    ) {
        let of_repair = said.map(|said| said.text.clone());
        let of_repair = of_repair.filter(|text| !text.is_empty());
        self.said = Some(of_repair.unwrap_or_else(|| {
            let told = Told::of(outcome.verdict, None);
            let headline = headline(told, run, outcome, None, words);
            [told.word(&words.case), &headline].join(DOT)
        }));
        self.verdict = Some(outcome.verdict);
    }

    /// Who checked the sheet of this run.
    pub fn sign(&mut self, ui: &mut Ui, run: Id, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        if let Some(said) = &self.said {
            ui.label(RichText::new(said).size(Sizes::of(ui).lead).strong());
        }
        ui.horizontal_wrapped(|ui| {
            if let Some((_, who)) = self.signing.value().filter(|(of, _)| *of == run) {
                let said = fill(words.signed_by, &[("who", who)]);
                ui.label(
                    RichText::new(said)
                        .size(Sizes::of(ui).lead)
                        .color(Palette::of(ui).good),
                );
                return;
            }
            let who = context.settings.operator.trim().to_owned();
            let may = !who.is_empty() && !matches!(self.signing, Request::Pending(_));
            let place = ActionPlace::new(ui, "case sign", run);
            let sign = large(ui, words.sign, may).on_disabled_hover_text(words.name_first);
            if place.clicked(&sign) {
                let text = words.signed;
                self.signing = Request::Pending(context.queries.run(move |paths| {
                    paths.open()?.add_run_note(run, &who, text, now_us())?;
                    Ok((run, who))
                }));
            }
        });
    }
}

impl CasePage {
    pub(super) fn prove(&mut self, ui: &mut Ui, has_orders: bool, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        let unit = context.units.chosen();
        if has_orders || unit.run.as_ref().is_some_and(Progress::is_running) {
            self.running(ui, has_orders, Stage::Prove, context);
            return;
        }
        if let Some(said) = &self.proof.said {
            ui.label(RichText::new(said).size(Sizes::of(ui).lead).strong());
        }
        let quiet = Palette::of(ui).quiet;
        ui.label(RichText::new(words.fitted_hint).color(quiet));
        let phase = unit.phase();
        let place = ActionPlace::new(ui, "case prove", (phase == Phase::Idle, self.proof.fitted));
        let at_rest = matches!(phase, Phase::Idle | Phase::Offline);
        if place.clicked(&large(ui, words.fitted, at_rest)) {
            let part = &self.repair.part;
            let unit = context.units.chosen_mut();
            // In practice the part takes the faults with it that were injected into it; others stay.
            let choice = &mut unit.choice;
            choice
                .faults
                .retain(|fault| fault.split('.').next() != Some(part.as_str()));
            unit.disconnect();
            (self.proof.fitted, self.proof.reconnects) = (true, true);
        }
        let unit = context.units.chosen();
        let may = self.proof.fitted && !self.proof.reconnects && unit.may_run();
        let prove = large(ui, words.prove, may).on_hover_text(words.prove_hint);
        if let (true, Some(found)) = (place.clicked(&prove), &self.found) {
            context.go_to.push(Destination::Prove {
                procedures: found.procedures.clone(),
                part: self.repair.part.clone(),
            });
        }
        // Its sheet says that the repair is not proved.
        let passed = self.proof.verdict == Some(Verdict::Passed);
        if passed && place.clicked(&large(ui, words.to_sheet, true)) {
            self.stage = Stage::Sheet;
        }
    }
}
