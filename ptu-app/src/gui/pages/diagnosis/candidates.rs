//! The ranked parts and fault modes, with the reasons.

use diagnosis::{Candidate, Finding};
use eframe::egui::{CollapsingHeader, RichText, Ui};

use super::NamedAnswer;
use crate::gui::parts::share_bar;
use crate::gui::{Destination, PageContext, Palette};
use ptu_bench::run_diagnosis::Answer;
use ptu_report::words::fill;

/// Parts of less than this share of the likeliest are not named in the headline.
const WORTH_NAMING: f64 = 0.1;

/// The parts the headline names.
pub fn parts(answer: &Answer) -> String {
    let parts = &answer.diagnosis.lrus;
    if answer.diagnosis.finding == Finding::TwoFound {
        let both = parts.iter().take(2).map(|part| part.lru.to_string());
        return both.collect::<Vec<_>>().join(", ");
    }
    let most = parts.first().map_or(0.0, |part| part.probability);
    let named = parts
        .iter()
        .filter(|part| part.probability > 0.0 && part.probability >= WORTH_NAMING * most)
        .map(|part| format!("{} ({:.1} %)", part.lru, 100.0 * part.probability));
    named.collect::<Vec<_>>().join(", ")
}

/// Candidates, two faults at once, and the rest.
pub fn ranked(ui: &mut Ui, context: &mut PageContext<'_>, named: &NamedAnswer) {
    let words = &context.words.diagnosis;
    let diagnosis = &named.answer.diagnosis;
    for (place, candidate) in diagnosis.candidates.iter().enumerate() {
        show(ui, context, named, candidate, place == 0);
    }
    for two in &diagnosis.two_faults {
        let said = fill(words.both, &[("faults", &two.faults.join(" + "))]);
        likely(ui, two.probability, &said);
    }
    likely(ui, diagnosis.no_fault, words.no_fault);
    likely(ui, diagnosis.unknown_fault, words.unknown_fault);
}

fn likely(ui: &mut Ui, probability: f64, text: &str) {
    ui.horizontal(|ui| {
        share_bar(ui, probability, Palette::of(ui).quiet);
        ui.label(text);
    });
}

fn show(
    ui: &mut Ui,
    context: &mut PageContext<'_>,
    named: &NamedAnswer,
    candidate: &Candidate,
    open: bool,
) {
    let words = &context.words.diagnosis;
    ui.horizontal(|ui| {
        share_bar(ui, candidate.probability, Palette::of(ui).accent);
        ui.label(RichText::new(candidate.lru.as_str()).strong().size(17.0));
        ui.label(RichText::new(named.part(candidate.lru.as_str(), context.words)).strong());
        ui.label(format!("{}: {}", candidate.fault, candidate.text));
    });
    CollapsingHeader::new(words.reasons)
        .id_salt(&candidate.fault)
        .default_open(open)
        .show(ui, |ui| {
            reasons(
                ui,
                "+",
                words.speaks_for,
                &candidate.for_it,
                Palette::of(ui).good,
            );
            reasons(
                ui,
                "−",
                words.speaks_against,
                &candidate.against,
                Palette::of(ui).warn,
            );
            let traces = named
                .answer
                .traces
                .get(candidate.lru.as_str())
                .into_iter()
                .flatten();
            let traces: Vec<_> = traces.collect();
            if !traces.is_empty() {
                ui.horizontal_wrapped(|ui| {
                    ui.label(words.traces);
                    for trace in traces {
                        if ui.button(trace.short()).clicked() {
                            context.go_to.push(Destination::Trace(*trace));
                        }
                    }
                });
            }
        });
}

fn reasons(ui: &mut Ui, sign: &str, what: &str, texts: &[String], colour: eframe::egui::Color32) {
    if texts.is_empty() {
        return;
    }
    ui.label(RichText::new(what).small().color(colour));
    for text in texts {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(sign).strong().color(colour));
            ui.label(text);
        });
    }
}
