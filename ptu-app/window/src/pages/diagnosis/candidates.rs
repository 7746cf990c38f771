//! The ranked parts and fault modes, with the reasons.

use diagnosis::{Candidate, Reason};
use eframe::egui::{CollapsingHeader, Color32, RichText, Ui};

use super::NamedAnswer;
use crate::parts::{link, share_bar};
use crate::{Destination, PageContext, Palette};
use ptu_report::diagnosis::{MOST_PARTS, MOST_REASONS, first_of_parts};
use ptu_report::words::{Diagnosis, fill};

/// Candidates, two faults at once, and the rest.
pub fn ranked(ui: &mut Ui, context: &mut PageContext<'_>, named: &NamedAnswer) {
    let words = &context.words.diagnosis;
    let diagnosis = &named.answer.diagnosis;
    let first: Vec<_> = first_of_parts(&diagnosis.candidates).collect();
    let more = diagnosis.candidates.iter();
    let more: Vec<_> = more.filter(|one| !first.contains(one)).collect();
    for (place, candidate) in first.into_iter().enumerate() {
        show(ui, context, named, candidate, place == 0);
    }
    behind_more(ui, words, "candidates", more.len(), |ui| {
        for candidate in more {
            show(ui, context, named, candidate, false);
        }
    });
    for two in diagnosis.two_faults.iter().take(MOST_PARTS) {
        let said = fill(words.both, &[("faults", &two.faults.join(" + "))]);
        likely(ui, two.probability, &said);
    }
    likely(ui, diagnosis.no_fault, words.no_fault);
}

fn at_once<T>(all: &[T]) -> (&[T], &[T]) {
    all.split_at(all.len().min(MOST_REASONS))
}

/// What is shown when it is asked for.
fn behind_more(
    ui: &mut Ui,
    words: &Diagnosis,
    of: &str,
    count: usize,
    content: impl FnOnce(&mut Ui),
) {
    if count > 0 {
        CollapsingHeader::new(fill(words.more, &[("n", &count)]))
            .id_salt(("more", of))
            .show(ui, content);
    }
}

fn likely(ui: &mut Ui, probability: f64, text: &str) {
    ui.horizontal_wrapped(|ui| {
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
    ui.horizontal_wrapped(|ui| {
        share_bar(ui, candidate.probability, Palette::of(ui).accent);
        let (part, language) = (candidate.lru.as_str(), context.words.language);
        let name = RichText::new(named.parts.name(part, language));
        ui.label(name.strong().size(17.0));
        ui.label(context.words.fault_text(&candidate.text));
        // As it is typed.
        let typed = RichText::new(&candidate.fault).small();
        ui.label(typed.color(Palette::of(ui).quiet));
    });
    CollapsingHeader::new(words.reasons)
        .id_salt(&candidate.fault)
        .default_open(open)
        .show(ui, |ui| {
            let palette = Palette::of(ui);
            let (good, warn) = (palette.good, palette.warn);
            for (sign, what, texts, colour) in [
                ("+", words.speaks_for, &candidate.for_it, good),
                ("−", words.speaks_against, &candidate.against, warn),
            ] {
                reasons(ui, context, named, (sign, what), texts, colour);
            }
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
                        let shows = named.shown_by(*trace, context.words);
                        if link(ui, shows).clicked() {
                            context.go_to.push(Destination::Trace(*trace));
                        }
                    }
                });
            }
        });
}

fn reasons(
    ui: &mut Ui,
    context: &mut PageContext<'_>,
    named: &NamedAnswer,
    (sign, what): (&str, &str),
    texts: &[Reason],
    colour: Color32,
) {
    if texts.is_empty() {
        return;
    }
    ui.label(RichText::new(what).small().color(colour));
    let words = context.words;
    let mut list = |ui: &mut Ui, texts: &[Reason]| {
        for text in texts {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(sign).strong().color(colour));
                let said = ui.label(words.reason(text, &named.answer.run));
                if let Some(detail) = words.reason_detail(text) {
                    said.on_hover_text(detail);
                }
                if let Some(trace) = named.trace_of(text)
                    && link(ui, words.faults.to_trace).clicked()
                {
                    context.go_to.push(Destination::Trace(trace));
                }
            });
        }
    };
    let (first, more) = at_once(texts);
    list(ui, first);
    behind_more(ui, &words.diagnosis, sign, more.len(), |ui| list(ui, more));
}
