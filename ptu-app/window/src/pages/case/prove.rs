//! Proof of a repair: the part is fitted, the unit connected again, a run shows no fault, the sheet is signed.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

use btu_rig::procedure::Verdict;
use eframe::egui::{Grid, RichText, Ui};
use egui_material_icons::icons::ICON_DRAW;
use fault_db::Id;

use super::repair::Repair;
use super::result::{Found, headline};
use super::verdict::Told;
use crate::pages::procedures::{Concluded, why_not};
use crate::parts::{ActionPlace, Face, Look, dialog, field, last_row, name_edit, pick};
use crate::request::Request;
use crate::{Destination, Page, PageContext, Palette, Sizes, Wanted};
use ptu_report::naming::DOT;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Phase, Progress};
use ptu_runs::clock::now_us;
use ptu_runs::keys;
use ptu_runs::run::Outcome;

#[derive(Default)]
pub struct RepairProof {
    /// The part was fitted; the unit is connected again as soon as it is disconnected.
    reconnects: bool,
    fitted: bool,
    /// What the last run says about the repair; if nothing, the outcome of the run.
    said: Option<String>,
    verdict: Option<Verdict>,
    /// The verdict in the window's words.
    word: Option<&'static str>,
    /// Response: the run that was signed, the signer, and whether a key signed.
    signing: Request<(Id, String, bool)>,
    sign: Option<Sign>,
}

/// Width of a field of the dialog, points.
const FIELD: f32 = 300.0;

impl RepairProof {
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        let locked = context.settings.is_locked();
        if locked || context.settings.page != Page::Case {
            // A typed PIN must not remain for the next person.
            self.sign = None;
        }
        let unit = context.units.chosen_mut();
        if self.reconnects && !locked && unit.phase() == Phase::Offline {
            self.reconnects = false;
            unit.connect(context.queries);
        }
        if !self.signing.poll() {
            return;
        }
        match (&self.signing, &mut self.sign) {
            // The chosen key stays; the PIN is typed again.
            (Request::Failed(_), Some(sign)) => sign.pin.clear(),
            (Request::Failed(why), None) => {
                let said = context.words.case.not_signed;
                context.messages.trouble(said, why.clone());
            }
            _ => self.sign = None,
        }
    }

    /// Takes the outcome of a proof run; `proven` = the run proved the repair.
    pub fn ran(
        &mut self,
        said: Option<&Concluded>,
        (run, outcome, proven): (&Progress, &Outcome, bool),
        words: &Words,
    ) {
        let told = Told::of(outcome.verdict, None);
        self.word = Some(match proven {
            true => words.report.proved,
            false => told.word(&words.case),
        });
        let of_repair = said.map(|said| said.text.clone());
        let of_repair = of_repair.filter(|text| !text.is_empty());
        self.said = Some(of_repair.unwrap_or_else(|| {
            let headline = headline(told, run, outcome, None, words);
            [told.word(&words.case), &headline].join(DOT)
        }));
        self.verdict = Some(outcome.verdict);
    }

    pub fn has_run(&self) -> bool {
        self.verdict.is_some()
    }

    /// Shows the runs' statement on the repair.
    pub fn told(&self, ui: &mut Ui) {
        if let Some(said) = &self.said {
            ui.label(RichText::new(said).size(Sizes::of(ui).lead).strong());
        }
    }

    /// Buttons: the part is fitted, prove the repair, to the sheet; true when the last was clicked.
    pub fn foot(
        &mut self,
        ui: &mut Ui,
        (found, repair): (Option<&Found>, &Repair),
        context: &mut PageContext<'_>,
    ) -> bool {
        let words = &context.words.case;
        let unit = context.units.chosen();
        let phase = unit.phase();
        let place = ActionPlace::new(ui, "case prove", (phase == Phase::Idle, self.fitted));
        let fitted = self.fitted && !self.reconnects;
        let may = fitted && unit.may_run();
        let look = |first| match first {
            true => Look::Primary,
            false => Look::Secondary,
        };
        let why_not = why_not(unit, context.words);
        // Before the part is fitted, the reason is the other button's text.
        let first = if fitted { why_not } else { words.fitted };
        let prove = Face::new(look(fitted), words.prove);
        let prove = prove.because((!may).then_some(first)).show(ui);
        if let (true, Some(found)) = (place.clicked(&prove), found) {
            context.go_to.push(Destination::Run(Wanted::Prove {
                procedures: found.procedures.clone(),
                part: repair.part.clone(),
            }));
        }
        let at_rest = matches!(phase, Phase::Idle | Phase::Offline);
        let face = Face::new(look(!fitted), words.fitted);
        let face = face.because((!at_rest).then_some(why_not));
        if place.clicked(&face.show(ui)) {
            let part = &repair.part;
            let unit = context.units.chosen_mut();
            // In practice the new part has no injected faults; faults of other parts stay.
            let choice = &mut unit.choice;
            choice
                .faults
                .retain(|fault| fault.split('.').next() != Some(part.as_str()));
            unit.disconnect();
            (self.fitted, self.reconnects) = (true, true);
        }
        // The sheet of a run that did not pass says that the repair is not proved.
        let passed = self.verdict == Some(Verdict::Passed);
        passed && place.clicked(&Face::new(Look::Secondary, words.to_sheet).show(ui))
    }

    /// Foot of the sheet: who signed the sheet, or the button that opens the dialog to sign.
    pub fn sign_foot(&mut self, ui: &mut Ui, run: Option<Id>, context: &mut PageContext<'_>) {
        let words = &context.words.case;
        if let Some((_, who, with_key)) = self.signing.value().filter(|(of, ..)| Some(*of) == run) {
            let said = match with_key {
                true => words.signed_with_key,
                false => words.signed_by,
            };
            let said = fill(said, &[("who", who)]);
            let good = Palette::of(ui).good;
            ui.label(RichText::new(said).size(Sizes::of(ui).lead).color(good));
            return;
        }
        let place = ActionPlace::new(ui, "case sign", run);
        let may = run.is_some() && !matches!(self.signing, Request::Pending(_));
        let sign = Face::new(Look::Primary, words.sign).icon(ICON_DRAW);
        let why_not = match run {
            Some(_) => context.words.common.loading,
            None => words.after_test,
        };
        if place.clicked(&sign.because((!may).then_some(why_not)).show(ui)) {
            (self.sign, self.signing) = (Some(Sign::default()), Request::Idle);
        }
    }

    /// The dialog of a signature, while it is open: what is signed, by whom, with which key.
    pub fn sign(
        &mut self,
        ui: &Ui,
        (run, verdict): (Id, &'static str),
        (unit, repair): (&Option<String>, &Repair),
        context: &mut PageContext<'_>,
    ) {
        let Some(sign) = &mut self.sign else { return };
        let words = context.words;
        let facts = [
            (
                words.common.verdict,
                self.word.unwrap_or(verdict).to_owned(),
            ),
            (words.common.unit, unit.clone().unwrap_or_default()),
            (words.case.part, repair.said()),
            (words.case.run, run.short()),
        ];
        let mut chosen = None;
        let signing = &self.signing;
        let open = dialog(ui, "sign", words.case.sign_title, |ui| {
            chosen = sign.show(ui, &facts, signing, context);
        });
        match chosen {
            Some(true) => {
                let who = context.settings.operator.trim().to_owned();
                let (text, key) = (words.case.signed, sign.key());
                self.signing = Request::Pending(context.queries.run(move |paths| {
                    let store = paths.open()?;
                    let signer = key.map(|(key, pin)| keys::signer(&key, &pin)).transpose()?;
                    // A key signs in its owner's name.
                    let (who, with_key) = match &signer {
                        Some(signer) => (signer.who().to_owned(), true),
                        None => (who, false),
                    };
                    store.sign_with(signer.map(Arc::new));
                    store.add_run_note(run, &who, text, now_us())?;
                    Ok((run, who, with_key))
                }));
            }
            Some(false) => self.sign = None,
            None if !open => self.sign = None,
            None => {}
        }
    }
}

/// Choices before a sheet is signed.
#[derive(Default)]
struct Sign {
    /// Key files of this computer, once they were looked for.
    keys: Option<Vec<(PathBuf, String)>>,
    /// The key file that signs, and its owner.
    chosen: Option<(PathBuf, String)>,
    pin: String,
}

impl Sign {
    fn key(&self) -> Option<(PathBuf, String)> {
        let (key, _) = self.chosen.clone()?;
        Some((key, self.pin.clone()))
    }

    /// True = sign, false = do not.
    fn show(
        &mut self,
        ui: &mut Ui,
        facts: &[(&str, String)],
        signing: &Request<(Id, String, bool)>,
        context: &mut PageContext<'_>,
    ) -> Option<bool> {
        let words = context.words;
        let quiet = Palette::of(ui).quiet;
        Grid::new("signed").num_columns(2).show(ui, |ui| {
            for (name, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
                ui.label(RichText::new(*name).color(quiet));
                ui.label(value);
                ui.end_row();
            }
            ui.label(words.case.key);
            let folder = &context.queries.paths.keys;
            let keys = self.keys.get_or_insert_with(|| keys::all_in(folder));
            let stem = |(key, _): &(PathBuf, String)| key.file_stem().map(OsStr::to_os_string);
            let name = |key: &Option<(PathBuf, String)>| match key.as_ref().and_then(stem) {
                Some(name) => name.to_string_lossy().into_owned(),
                None => words.case.no_key.to_owned(),
            };
            let all = std::iter::once(None).chain(keys.iter().cloned().map(Some));
            let all = all.map(|key| (key.clone(), name(&key)));
            pick(ui, (words.case.key, FIELD), &mut self.chosen, all);
            ui.end_row();
            let (named, edit) = match self.chosen {
                Some(_) => (
                    words.case.pin,
                    name_edit(&mut self.pin, FIELD).password(true),
                ),
                None => {
                    let operator = &mut context.settings.operator;
                    (words.case.your_name, name_edit(operator, FIELD))
                }
            };
            field(ui, named, edit);
        });
        ui.label(RichText::new(words.case.sign_hint).color(quiet));
        if let Request::Failed(why) = signing {
            let said = [words.case.not_signed, &*words.trouble(why)].join(DOT);
            ui.label(RichText::new(said).color(Palette::of(ui).bad));
        }
        let operator = context.settings.operator.trim();
        let (who, missing) = match &self.chosen {
            Some((_, who)) => (
                who.as_str(),
                self.pin.is_empty().then_some(words.case.pin_first),
            ),
            None => (
                operator,
                operator.is_empty().then_some(words.case.name_first),
            ),
        };
        let place = ActionPlace::new(ui, "sign", ());
        let mut chosen = None;
        last_row(ui, |ui| {
            let sign = fill(words.case.sign_as, &[("who", &who)]);
            let missing = match signing {
                Request::Pending(_) => Some(words.common.loading),
                _ => missing,
            };
            let sign = Face::new(Look::Primary, sign).icon(ICON_DRAW).off(missing);
            if place.clicked(&sign.show(ui)) {
                chosen = Some(true);
            }
            if Face::new(Look::Quiet, words.common.cancel)
                .show(ui)
                .clicked()
            {
                chosen = Some(false);
            }
        });
        chosen
    }
}
