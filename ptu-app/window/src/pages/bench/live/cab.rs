//! The controls in the cab, and how the unit reads them.

use eframe::egui::Ui;
use protocol::signal::Signal;

use super::View;
use super::card::{Fact, card, facts};
use crate::Palette;
use crate::pages::bench::live_copy::BenchSnapshot;
use crate::pages::bench::text::{self, UNKNOWN};
use ptu_report::words::Bench;

/// Width of a name with its value, points.
const COLUMN: f32 = 240.0;
/// Value of [`Signal::CodeIndex`] while no code is received.
const NO_CODE: usize = 255;

/// Draws the controls of the cab desk, and how the unit reads them.
pub fn cab(ui: &mut Ui, view: &View<'_>, palette: &Palette) {
    let (words, seen) = (&view.words.bench, view.seen);
    let fact = |name, signal| Fact::new(name, text::value(words, signal, seen));
    let bad = |wrong: bool| wrong.then_some(palette.bad);
    let cause = |name, signal| {
        let holds = seen.value(signal).is_some_and(|cause| cause != 0.0);
        fact(name, signal).coloured(bad(holds))
    };
    let unhealthy = seen.on(Signal::Healthy) == Some(false);
    let list = [
        fact(words.mode, Signal::Mode),
        fact(words.mode_switch, Signal::ModeSwitch),
        Fact::new(words.controller, text::controller(seen)),
        fact(words.hcr, Signal::Hcr),
        fact(words.key, Signal::MaintenanceKey),
        Fact::new(words.speed_code, code(view, words)),
        fact(words.standstill, Signal::Standstill),
        Fact::new(words.ato, ato(words, seen)),
        cause(words.eb_cause, Signal::EbCause),
        cause(words.fsb_cause, Signal::FsbCause),
        Fact::new(words.refused, text::bits(words, Signal::Refusals, seen)),
        fact(words.healthy, Signal::Healthy).coloured(bad(unhealthy)),
    ];
    card(ui, words.cab, |ui| {
        let columns = (ui.available_width() / COLUMN).floor().max(1.0);
        facts(ui, columns as usize, &list);
    });
}

/// Name of the received speed code in the unit's code table.
fn code(view: &View<'_>, words: &Bench) -> String {
    let Some(index) = view.seen.value(Signal::CodeIndex) else {
        return UNKNOWN.to_owned();
    };
    let codes = &view.setup.config.content.codes;
    match codes.get(index as usize) {
        Some(code) => code.name.clone(),
        None if index as usize == NO_CODE => words.no_code.to_owned(),
        None => format!("{index}"),
    }
}

fn ato(words: &Bench, seen: &BenchSnapshot) -> String {
    let state = text::value(words, Signal::AtoState, seen);
    match seen.on(Signal::AtoReady) {
        None => state,
        Some(true) => format!("{state}, {}", words.ready),
        Some(false) => format!("{state}, {}", words.not_ready),
    }
}
