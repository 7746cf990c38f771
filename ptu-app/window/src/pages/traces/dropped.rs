//! A file that is dropped on the page: a readable trace is shown behind the open one.

use std::path::PathBuf;

use eframe::egui::{Align2, FontId, Ui};

use crate::messages::told;
use crate::{PageContext, Palette};
use ptu_report::trace_io::is_importable;

/// Font size of the text that is shown while a file is over the page, points.
const TEXT: f32 = 22.0;

/// The dropped file, if it can be read; a message tells about others.
pub fn file(ui: &Ui, context: &mut PageContext<'_>) -> Option<PathBuf> {
    let words = &context.words.traces;
    let (over, mut dropped) = ui.input(|input| {
        let dropped = input.raw.dropped_files.iter();
        let paths: Vec<_> = dropped.map(|file| file.path().to_owned()).collect();
        (!input.raw.hovered_files.is_empty(), paths)
    });
    if over {
        let palette = Palette::of(ui);
        let whole = ui.ctx().content_rect();
        let painter = ui.painter();
        painter.rect_filled(whole, 0.0, palette.accent.gamma_multiply(0.2));
        painter.text(
            whole.center(),
            Align2::CENTER_CENTER,
            words.drop_here,
            FontId::proportional(TEXT),
            palette.ink,
        );
    }
    let file = dropped.pop()?;
    if !is_importable(&file) {
        let name = file.display().to_string();
        context.messages.trouble(words.not_importable, told(name));
        return None;
    }
    Some(file)
}
