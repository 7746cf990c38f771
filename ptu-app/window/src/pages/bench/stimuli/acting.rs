//! Stimuli in force, each with a button that takes it away.

use btu_rig::stimulus::{DoorState, Stimulus, TachoCondition, WaysideCondition};
use eframe::egui::{Align, Layout, RichText, Ui};
use egui_material_icons::icons::ICON_CLOSE;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, row};
use crate::Palette;
use crate::pages::bench::forms::Forms;
use crate::pages::bench::text;
use crate::parts::{Face, Look, ground};
use ptu_report::naming::DOT;
use ptu_report::words::fill;

/// A stimulus in force: its name, its state as text, and the stimulus that takes it away.
type Given = (String, String, Stimulus);

pub fn acting(ui: &mut Ui, forms: &Forms, hand: &mut StimulusPanel<'_>) {
    let all = given(forms, hand);
    if all.is_empty() {
        return;
    }
    let (words, palette) = (hand.words, Palette::of(ui));
    let mut taken = Vec::new();
    ground(&palette).inner_margin(8).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(
                RichText::new(words.bench.acting)
                    .small()
                    .color(palette.quiet),
            );
            let ends = Layout::right_to_left(Align::Center);
            ui.with_layout(ends, |ui| {
                let face = Face::new(Look::Quiet, words.bench.take_all);
                if face.ink(palette.accent).show(ui).clicked() {
                    taken.extend(all.iter().map(|(.., away)| *away));
                }
            });
        });
        for (name, value, away) in &all {
            row(ui, name, |ui, _| {
                ui.label(value);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let called = [words.frame.take_out, name].join(" ");
                    let close = Face::new(Look::Quiet, "").icon(ICON_CLOSE).named(called);
                    if close.because(hand.may(away).err()).show(ui).clicked() {
                        taken.push(*away);
                    }
                });
            });
        }
    });
    for away in taken {
        hand.give(away);
    }
}

#[rustfmt::skip]
fn given(forms: &Forms, hand: &StimulusPanel<'_>) -> Vec<Given> {
    use Stimulus as S;
    let (words, seen) = (&hand.words.bench, hand.seen);
    let value = |signal| text::value(words, signal, seen);
    let is_not = |signal, rest: f64| seen.value(signal).is_some_and(|now| now != rest);
    let tacho = |channel| fill(words.tacho, &[("channel", &channel)]);
    let good = |channel| S::Tacho { channel, condition: TachoCondition::Good };
    let locked = |left| S::SideDoors { left, state: DoorState::Locked };
    let code = [Signal::CodeRateHz, Signal::LevelMv].map(value).join(DOT);
    let mut all = Vec::new();
    if is_not(Signal::LevelMv, 0.0) {
        all.push((words.speed_code.to_owned(), code, S::CodeOff));
    }
    if let Some(section) = hand.given.laid {
        all.push((words.section.to_owned(), section.to_string(), S::MarkersAlong { section: None }));
    }
    let at_rest = [
        (Signal::TrainSpeed, 0.0, words.group_speed.to_owned(), forms.motion.stand()),
        (Signal::Tacho1, 0.0, tacho(1), good(1)),
        (Signal::Tacho2, 0.0, tacho(2), good(2)),
        (Signal::Doors, 1.0, words.doors.to_owned(), S::Doors { closed: true }),
        (Signal::DoorsLeft, 2.0, words.doors_left.to_owned(), locked(true)),
        (Signal::DoorsRight, 2.0, words.doors_right.to_owned(), locked(false)),
        (Signal::Wayside, 1.0, words.wayside.to_owned(), S::Wayside(WaysideCondition::Good)),
        (Signal::WaysideOrder, 0.0, words.wayside_order.to_owned(), S::Orders(None)),
    ];
    let others = at_rest.into_iter().filter(|(signal, rest, ..)| is_not(*signal, *rest));
    all.extend(others.map(|(signal, _, name, away)| (name, value(signal), away)));
    all
}
