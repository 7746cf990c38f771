//! Keys that work on every page.

use eframe::egui::{Context, Key, Modifiers};

use crate::gui::{Desk, Page};
use crate::station::Phase;

/// Stops everything, whatever has the keyboard.
pub const STOP_ALL: Key = Key::F12;

/// Connects the chosen unit, or lets it go.
pub const CONNECT: Key = Key::F9;

/// Acts on them.
pub fn keys(context: &Context, desk: &mut Desk<'_>) {
    if context.input_mut(|input| input.consume_key(Modifiers::NONE, STOP_ALL)) {
        desk.units.stop_all();
    }
    if context.input_mut(|input| input.consume_key(Modifiers::NONE, CONNECT)) {
        let unit = desk.units.chosen_mut();
        if unit.phase() == Phase::Offline {
            unit.connect(desk.library);
        } else {
            unit.disconnect();
        }
    }
    for page in Page::ALL {
        if context.input_mut(|input| input.consume_key(Modifiers::NONE, page.key())) {
            desk.settings.page = page;
        }
    }
}
