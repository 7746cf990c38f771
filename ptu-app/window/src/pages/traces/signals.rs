//! Selects the shown signals, their order and their heights.

use eframe::egui::{Label, RichText, Role, ScrollArea, Ui, WidgetInfo};

use crate::parts::{SavedSaid, find_edit, saved_questions};
use crate::{PageContext, Palette};
use ptu_report::trace_view::{Summary, TracePlot, bare, toggled};
use ptu_report::words::fill;

/// Factor by which one press makes a lane taller.
const TALLER: f32 = 1.25;

/// Action on a lane.
enum LaneAction {
    Up(usize),
    Down(usize),
    Stretch(usize, f32),
    Hide(usize),
    Join(usize),
}

pub fn choose(
    ui: &mut Ui,
    scene: &mut TracePlot,
    (find, name): (&mut String, &mut String),
    context: &mut PageContext<'_>,
) {
    let words = &context.words.traces;
    ui.horizontal(|ui| {
        ui.label(RichText::new(words.signals).strong());
        if ui.button(words.usual_signals).clicked() {
            context.settings.lanes.clear();
            scene.set_signals(&[]);
        }
    });
    ui.horizontal_wrapped(|ui| {
        let saved = (&mut context.settings.layouts, name);
        let said = SavedSaid::layouts(context.words);
        if let Some(signals) = saved_questions(ui, &said, saved, &scene.signals()) {
            scene.set_signals(&signals);
            context.settings.lanes = signals;
        }
    });
    find_edit(ui, find, words.find_signal, f32::INFINITY);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let before = scene.signals();
        let mut signals = before.clone();
        if find.trim().is_empty() {
            ui.label(RichText::new(words.shown_signals).color(Palette::of(ui).quiet));
            if let Some(pressed) = shown(ui, scene, context) {
                act(pressed, &mut signals, scene);
            }
            ui.separator();
        }
        ui.label(RichText::new(words.all_signals).color(Palette::of(ui).quiet));
        let wanted = find.trim().to_lowercase();
        let view = scene.view();
        for (place, channel) in view.data().channels.iter().enumerate() {
            if !channel.name.contains(&wanted) {
                continue;
            }
            let mut on = signals.iter().any(|entry| bare(entry) == channel.name);
            let mut text = RichText::new(&channel.name);
            if matches!(view.summary(place), Summary::Unknown) {
                text = text.weak();
            }
            if ui.checkbox(&mut on, text).changed() {
                signals.retain(|entry| bare(entry) != channel.name);
                if on {
                    signals.push(channel.name.clone());
                }
            }
        }
        if signals != before {
            scene.set_signals(&signals);
            context.settings.lanes = signals;
        }
    });
}

fn shown(ui: &mut Ui, scene: &TracePlot, context: &PageContext<'_>) -> Option<LaneAction> {
    let words = &context.words.traces;
    let mut pressed = None;
    for (i, lane) in scene.lanes.iter().enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            ui.spacing_mut().button_padding.x = 4.0;
            for (sign, name, what) in [
                ("▲", words.up, LaneAction::Up(i)),
                ("▼", words.down, LaneAction::Down(i)),
                ("+", words.higher, LaneAction::Stretch(i, TALLER)),
                ("−", words.lower, LaneAction::Stretch(i, 1.0 / TALLER)),
                ("×", words.hide, LaneAction::Hide(i)),
            ] {
                let name = fill(name, &[("signal", &lane.signal)]);
                let button = ui.button(sign);
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
                if button.on_hover_text(&name).clicked() {
                    pressed = Some(what);
                }
            }
            if scene.can_join(i) {
                let name = fill(words.join, &[("signal", &lane.signal)]);
                let join = ui.selectable_label(lane.joined, "&");
                let (enabled, on) = (join.enabled(), lane.joined);
                join.widget_info(|| WidgetInfo::selected(Role::Button, enabled, on, &name));
                if join.on_hover_text(&name).clicked() {
                    pressed = Some(LaneAction::Join(i));
                }
            }
            ui.add(Label::new(&lane.signal).truncate());
        });
    }
    pressed
}

fn act(pressed: LaneAction, signals: &mut Vec<String>, scene: &mut TracePlot) {
    match pressed {
        LaneAction::Up(i) if i > 0 => signals.swap(i, i - 1),
        LaneAction::Down(i) if i + 1 < signals.len() => signals.swap(i, i + 1),
        LaneAction::Up(_) | LaneAction::Down(_) => {}
        LaneAction::Stretch(i, times) => scene.stretch(i, times),
        // The last lane cannot be hidden: without lanes the usual ones would come back.
        LaneAction::Hide(i) if signals.len() > 1 => {
            signals.remove(i);
        }
        LaneAction::Hide(_) => {}
        LaneAction::Join(i) => {
            if let Some(entry) = signals.get_mut(i) {
                *entry = toggled(entry);
            }
        }
    }
}
