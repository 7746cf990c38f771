//! The menu of a unit: connect or disconnect, set-up, and identity.

use eframe::egui::{Button, RichText, Ui};
use protocol::message::Identity;

use super::keys::CONNECT;
use crate::parts::{ActionPlace, Face, Look};
use crate::{Destination, PageContext, Palette};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::Phase;

/// Least width of the menu, points.
const WIDE: f32 = 260.0;

pub fn unit_menu(ui: &mut Ui, context: &mut PageContext<'_>) {
    let (words, frame) = (context.words, &context.words.frame);
    ui.set_min_width(WIDE);
    for place in 0..context.units.count() {
        let unit = context.units.iter().nth(place);
        let name = unit.map(|unit| format!("{}: {}", place + 1, unit.name()));
        let is_other = place != context.units.chosen_place();
        if is_other && ui.button(name.unwrap_or_default()).clicked() {
            context.units.choose(place);
        }
    }
    let only_reads = context.only_reads();
    let unit = context.units.chosen_mut();
    let phase = unit.phase();
    let place = ActionPlace::new(ui, "unit menu", (unit.id, phase == Phase::Offline));
    let key = CONNECT.name();
    if phase == Phase::Offline {
        let connect = Face::new(Look::Secondary, frame.connect).small(key);
        if place.clicked(&connect.off(only_reads).show(ui)) {
            unit.connect(context.queries);
        }
    } else {
        let disconnect = Face::new(Look::Secondary, frame.disconnect).small(key);
        if place.clicked(&disconnect.show(ui)) {
            unit.disconnect();
        }
    }
    let free = phase == Phase::Offline;
    if ui.add_enabled(free, Button::new(frame.setup)).clicked() {
        context.go_to.push(Destination::Setup);
    }
    if !free {
        ui.label(RichText::new(frame.setup_hint).small());
    }
    if context.units.count() > 1 {
        let remove = ui.add_enabled(free, Button::new(frame.remove_unit));
        if remove.clicked() {
            context.units.remove_chosen();
        }
    }
    if let Some(identity) = context.units.chosen().identity() {
        ui.separator();
        let quiet = Palette::of(ui).quiet;
        ui.label(
            RichText::new(versions(&identity, words))
                .small()
                .color(quiet),
        );
    }
}

/// Text: software version of the unit, and checksums of its configuration and line.
fn versions(identity: &Identity, words: &Words) -> String {
    let software = identity.software.map(|number| number.to_string()).join(".");
    let config = ptu_runs::run::unit_text::config_name(identity);
    let config = format!("{config} {:08x}", identity.config_crc);
    let line = format!("{:08x}", identity.tdb_crc);
    let said: [(&str, &dyn std::fmt::Display); 3] = [
        ("software", &software),
        ("config", &config),
        ("line", &line),
    ];
    fill(words.frame.versions, &said)
}
