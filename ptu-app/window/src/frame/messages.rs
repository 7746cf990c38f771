//! Shows messages: trouble until a person acknowledges it, the latest message for a while, all under the bell.
//! A message about a written step has a button that undoes the step.

use std::time::Duration;

use eframe::egui::{
    Align2, Area, Frame, Id, Key, Modifiers, Popup, Response, RichText, ScrollArea, Ui, Vec2,
};
use egui_material_icons::icons::{ICON_CLOSE, ICON_UNDO};
use fault_db::ToWithdraw;

use crate::messages::{Message, Written};
use crate::parts::{ActionPlace, Face, Look};
use crate::request::Request;
use crate::{Page, PageContext, Palette};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

/// Width of messages, points.
const WIDE: f32 = 560.0;

/// A step that is being undone.
#[derive(Default)]
pub struct Undo {
    under_way: Request<Written>,
    /// Text of the message about the step.
    what: String,
}

impl Undo {
    /// Adds a message once the step is undone.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        let frame = &context.words.frame;
        if let Some(written) = self.under_way.take(frame.not_undone, context.messages) {
            let said = fill(frame.undone, &[("what", &self.what)]);
            context.messages.tell_taken_back(said, written);
        }
    }

    fn begin(&mut self, written: Written, what: String, context: &mut PageContext<'_>) {
        context.messages.take_offer(written);
        self.what = what;
        let (who, why) = (
            context.settings.operator.trim().to_owned(),
            context.words.frame.undo_reason,
        );
        self.under_way = Request::Pending(context.queries.run(move |paths| {
            let what = ToWithdraw {
                written_at_us: Some(written.at_us),
                only: false,
            };
            let store = paths.open()?;
            store.withdraw(written.fault, what, &who, why, clock::now_us())?;
            Ok(written)
        }));
    }
}

/// Shows the latest messages over the bottom left of the page: trouble until it is acknowledged, others for a while.
pub fn toasts(ui: &Ui, at: Vec2, context: &mut PageContext<'_>, undo: &mut Undo) {
    let (ended, now_s) = (context.units.runs_ended(), ui.input(|input| input.time));
    let undoable = context.messages.undoable(now_s, ended);
    // An undo is recorded with the name of the person who does it.
    let named = !context.settings.operator.trim().is_empty();
    let undoable = undoable.filter(|_| named && !context.settings.is_locked());
    let place = undoable.map(|(place, ..)| place);
    let words = context.words;
    let (mut noted, mut seen, mut taken_back) = (false, false, None);
    let all = &context.messages.all;
    let trouble = context.messages.unread_trouble();
    let last = context.messages.latest_note(place, now_s);
    // The page Case itself shows the result of its run.
    let last = last.filter(|last| context.settings.page != Page::Case || !last.is_of_run());
    let told =
        undoable.and_then(|(place, written, left_s)| Some((all.get(place)?, written, left_s)));
    if trouble.is_none() && last.is_none() && told.is_none() {
        return;
    }
    let palette = Palette::of(ui);
    let area = Area::new(Id::unique("toasts")).anchor(Align2::LEFT_BOTTOM, at);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::popup(ui.style())
            .fill(palette.raised)
            .inner_margin(8);
        frame.show(ui, |ui| {
            ui.set_max_width((ui.ctx().content_rect().width() - at.x - 40.0).min(WIDE));
            if let Some(trouble) = trouble {
                ui.horizontal_wrapped(|ui| {
                    let place = ActionPlace::new(ui, "dismiss", trouble.at_us);
                    let dismiss = Face::new(Look::Secondary, words.frame.dismiss).show(ui);
                    noted = place.clicked(&dismiss);
                    said(ui, trouble, words);
                });
            }
            if let Some(last) = last {
                ui.horizontal_wrapped(|ui| {
                    // The message may have appeared under the pointer during a double click.
                    let place = ActionPlace::new(ui, "seen", last.at_us);
                    let close = Face::new(Look::Quiet, "").icon(ICON_CLOSE);
                    seen = place.clicked(&close.named(words.frame.seen).show(ui));
                    said(ui, last, words);
                });
            }
            if let Some((told, written, left_s)) = told {
                ui.horizontal_wrapped(|ui| {
                    let place = ActionPlace::new(ui, "undo", written.at_us);
                    let left = format!("{left_s:.0} s");
                    let button = Face::new(Look::Secondary, words.frame.undo).icon(ICON_UNDO);
                    let button = button.small(left).show(ui);
                    // In a text field the key undoes typing.
                    let typing = ui.ctx().egui_wants_keyboard_input();
                    let by_key = !typing
                        && ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Z));
                    let wanted = place.clicked(&button) || by_key;
                    taken_back = wanted.then(|| (written, told.text.clone()));
                    said(ui, told, words);
                });
            }
        });
    });
    ui.ctx().request_repaint_after(Duration::from_secs(1));
    if let Some((written, what)) = taken_back {
        undo.begin(written, what, context);
    }
    if noted {
        context.messages.acknowledge();
    }
    if seen {
        context.messages.note_seen();
    }
}

/// List of all messages, under the bell.
pub fn bell(response: &Response, context: &mut PageContext<'_>) {
    let words = context.words;
    Popup::menu(response).show(|ui| {
        ui.set_min_width(WIDE);
        let all = &context.messages.all;
        if all.is_empty() {
            ui.label(words.common.nothing);
            return;
        }
        ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for message in all.iter().rev() {
                ui.horizontal_wrapped(|ui| {
                    ui.label(RichText::new(clock::local(message.at_us)).small());
                    said(ui, message, words);
                });
            }
        });
        if Face::new(Look::Secondary, words.frame.clear)
            .show(ui)
            .clicked()
        {
            context.messages.clear();
        }
    });
}

fn said(ui: &mut Ui, message: &Message, words: &Words) {
    let palette = Palette::of(ui);
    let (mark, colour) = match message.bad {
        true => ("⚠ ", palette.bad),
        false => ("", palette.ink),
    };
    let text = format!("{mark}{}", message.text);
    ui.label(RichText::new(text).color(colour));
    let detail = words.trouble(&message.detail);
    if !detail.is_empty() {
        ui.label(&*detail);
    }
}
