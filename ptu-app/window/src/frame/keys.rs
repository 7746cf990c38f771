//! Keys that work on every page.

use eframe::egui::{Context, Key, Modifiers};

use crate::parts::key_pressed;
use crate::{Page, PageContext};
use ptu_runs::bench_worker::Phase;

/// Key that stops all units, whichever widget has the keyboard focus.
pub const STOP_ALL: Key = Key::F12;

/// Name of the key that opens the search.
pub const FIND: &str = "Ctrl K";

/// Key of [`connect`].
pub const CONNECT: Key = Key::F9;

pub fn keys(egui_context: &Context, context: &mut PageContext<'_>) {
    if egui_context.input_mut(|input| input.consume_key(Modifiers::NONE, STOP_ALL)) {
        context.units.stop_all();
    }
    if key_pressed(egui_context, Modifiers::NONE, CONNECT) {
        connect(context);
    }
    for page in Page::ALL {
        let key = Key::from_name(page.key()).expect("a key of egui");
        if egui_context.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            context.settings.page = page;
        }
    }
}

/// Connects or disconnects the chosen unit; does nothing during a run, because the page keys are beside this key.
pub fn connect(context: &mut PageContext<'_>) {
    let only_reads = context.only_reads();
    let locked = context.settings.is_locked();
    let unit = context.units.chosen_mut();
    if locked || unit.phase() == Phase::Running {
        return;
    }
    if unit.phase() != Phase::Offline {
        unit.disconnect();
    } else if only_reads.is_none() {
        unit.connect(context.queries);
    }
}
