//! The ranked parts and fault modes, with the reasons.

use std::collections::BTreeSet;

use diagnosis::{Candidate, Reason};
use eframe::egui::{CollapsingHeader, Color32, RichText, Ui};

use super::NamedAnswer;
use crate::parts::{link, share_bar};
use crate::{Destination, PageContext, Palette};
use ptu_report::diagnosis::{MOST_PARTS, MOST_REASONS, Possible, probability_of};
use ptu_report::words::{Diagnosis, fill};

/// List of the possible causes, the likeliest first; the other faults are shown on demand.
pub fn ranked(ui: &mut Ui, context: &mut PageContext<'_>, named: &NamedAnswer) {
    let words = &context.words.diagnosis;
    let diagnosis = &named.answer.diagnosis;
    let possible = ptu_report::diagnosis::ranked(diagnosis, MOST_PARTS);
    let (mut shown, mut parts) = (Vec::new(), BTreeSet::new());
    for (probability, possible) in possible {
        match possible {
            Possible::Part(candidate) => {
                show(
                    ui,
                    context,
                    named,
                    (candidate, Some(probability)),
                    shown.is_empty(),
                );
                shown.push(candidate);
                parts.insert(&candidate.lru);
            }
            Possible::NoFault => likely(ui, probability, words.no_fault),
        }
    }
    let more = diagnosis.candidates.iter();
    let more: Vec<_> = more.filter(|one| !shown.contains(one)).collect();
    behind_more(ui, words, "candidates", more.len(), |ui| {
        for candidate in more {
            let is_first = parts.insert(&candidate.lru);
            let of_part = is_first.then(|| probability_of(diagnosis, candidate));
            show(ui, context, named, (candidate, of_part), false);
        }
    });
}

fn at_once<T>(all: &[T]) -> (&[T], &[T]) {
    all.split_at(all.len().min(MOST_REASONS))
}

/// A part of the page that is shown on demand.
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

/// A part by its likeliest fault mode; `of_part` = probability of the part, none for one of the other fault modes.
fn show(
    ui: &mut Ui,
    context: &mut PageContext<'_>,
    named: &NamedAnswer,
    (candidate, of_part): (&Candidate, Option<f64>),
    open: bool,
) {
    let words = &context.words.diagnosis;
    ui.horizontal_wrapped(|ui| {
        let probability = of_part.unwrap_or(candidate.probability);
        share_bar(ui, probability, Palette::of(ui).accent);
        // The part's name stands only beside its own probability, not beside that of a single fault mode.
        if of_part.is_some() {
            let (part, language) = (candidate.lru.as_str(), context.words.language);
            let name = RichText::new(named.parts.name(part, language));
            ui.label(name.strong().size(17.0));
        }
        ui.label(context.words.fault_text(&candidate.text));
        // The fault mode's name as typed on the command line.
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
