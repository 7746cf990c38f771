//! Shows the latest trouble until it is acknowledged, the latest message, and all messages on demand. A message that tells
//! what was written has a button that takes it back.

use std::time::Duration;

use eframe::egui::{RichText, ScrollArea, TextWrapMode, Ui};
use fault_db::ToWithdraw;

use crate::messages::{Message, Written};
use crate::parts::ActionPlace;
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

/// A step that is being taken back.
#[derive(Default)]
pub struct Undo {
    under_way: Request<Written>,
    /// The step as its message told it.
    what: String,
}

impl Undo {
    /// Tells when it is done.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if !self.under_way.poll() {
            return;
        }
        let frame = &context.words.frame;
        match std::mem::take(&mut self.under_way) {
            Request::Failed(why) => context.messages.trouble(frame.not_undone, why.clone()),
            Request::Ready(written) => {
                let said = fill(frame.undone, &[("what", &self.what)]);
                context.messages.tell_taken_back(said, written);
            }
            Request::Idle | Request::Pending(_) => {}
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

pub fn bar(ui: &mut Ui, context: &mut PageContext<'_>, undo: &mut Undo) {
    let ended = context.units.runs_ended();
    let undoable = context
        .messages
        .undoable(ui.input(|input| input.time), ended);
    // Who takes it back is written down with it.
    let named = !context.settings.operator.trim().is_empty();
    let undoable = undoable.filter(|_| named && !context.settings.locked);
    let all = context.messages.all();
    if all.is_empty() {
        let quiet = Palette::of(ui).quiet;
        ui.label(RichText::new(context.words.frame.title).color(quiet));
        return;
    }
    let mut clear = false;
    let mut noted = false;
    let mut taken_back = None;
    ui.horizontal(|ui| {
        let button = format!("{} ({})", context.words.frame.messages, all.len());
        ui.menu_button(button, |ui| {
            ui.set_min_width(560.0);
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for message in all.iter().rev() {
                    ui.horizontal_wrapped(|ui| {
                        ui.label(RichText::new(clock::local(message.at_us)).small());
                        said(ui, message, context.words);
                    });
                }
            });
            clear = ui.button(context.words.frame.clear).clicked();
        });
        // There is one line; what is cut is told when it is pointed at, and in the menu.
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        let trouble = context.messages.unread_trouble();
        noted = trouble.is_some() && ui.button(context.words.frame.dismiss).clicked();
        if let Some(trouble) = trouble {
            said(ui, trouble, context.words);
        }
        // Trouble is shown until it was taken note of, and not again as the latest message.
        let undone = undoable.map(|(place, ..)| place);
        if let Some(last) = context.messages.latest_note(undone) {
            said(ui, last, context.words);
        }
        if let Some((place, written, left_s)) = undoable
            && let Some(told) = all.get(place)
        {
            let place = ActionPlace::new(ui, "undo", written.at_us);
            let button = ui
                .button(context.words.frame.undo)
                .on_hover_text(&told.text);
            taken_back = place.clicked(&button).then(|| (written, told.text.clone()));
            ui.ctx()
                .request_repaint_after(Duration::from_secs_f64(left_s));
            said(ui, told, context.words);
        }
    });
    if let Some((written, what)) = taken_back {
        undo.begin(written, what, context);
    }
    if noted {
        context.messages.acknowledge();
    }
    if clear {
        context.messages.clear();
    }
}

fn said(ui: &mut Ui, message: &Message, words: &Words) {
    let palette = Palette::of(ui);
    let (mark, colour) = match message.bad {
        true => ("⚠ ", palette.bad),
        false => ("", ui.visuals().text_color()),
    };
    let text = format!("{mark}{}", message.text);
    ui.label(RichText::new(text).color(colour).strong());
    let detail = words.trouble(&message.detail);
    if !detail.is_empty() {
        ui.label(&*detail);
    }
}
