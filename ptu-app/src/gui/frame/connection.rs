//! The connection bar: which unit, how it is reached, who it is, and whether it is armed.

use btu_rig::stimulus::Stimulus;
use eframe::egui::{Align, Button, Color32, Frame, Layout, Margin, RichText, Ui};
use protocol::link::Counters;
use protocol::message::{Channel, Identity};
use protocol::signal::Signal;

use super::keys::{STOP_ALL, stop_all};
use super::setup::Setup;
use crate::gui::parts::chip;
use crate::gui::{Desk, Palette};
use crate::station::Phase;
use crate::words::{Words, fill};

/// The bar.
pub fn bar(ui: &mut Ui, desk: &mut Desk<'_>, setup: &mut Setup) {
    ui.horizontal(|ui| {
        units(ui, desk);
        setup.endpoint(ui, desk);
        connect(ui, desk);
        identity(ui, desk);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            stop_button(ui, desk);
            arming(ui, desk);
        });
    });
}

/// Units side by side; the pages show the chosen one.
fn units(ui: &mut Ui, desk: &mut Desk<'_>) {
    if desk.units.count() > 1 {
        for place in 0..desk.units.count() {
            let Some(unit) = desk.units.iter().nth(place) else {
                continue;
            };
            let label = format!("{}: {}", place + 1, unit.name());
            if ui
                .selectable_label(place == desk.units.chosen_place(), label)
                .clicked()
            {
                desk.units.choose(place);
            }
        }
        let free = desk.units.chosen().phase() == Phase::Offline;
        let remove = ui.add_enabled(free, Button::new(desk.words.frame.remove_unit));
        if remove.clicked() {
            desk.units.remove(desk.units.chosen_place());
        }
    }
    if ui
        .button("+")
        .on_hover_text(desk.words.frame.add_unit)
        .clicked()
    {
        let choice = desk.units.chosen().choice.clone();
        if let Err(failure) = desk.units.add(choice) {
            desk.messages
                .trouble(desk.words.frame.cannot_connect, failure.message);
        }
    }
}

fn connect(ui: &mut Ui, desk: &mut Desk<'_>) {
    let frame = &desk.words.frame;
    let unit = desk.units.chosen_mut();
    match unit.phase() {
        Phase::Offline => {
            if ui.button(RichText::new(frame.connect).strong()).clicked() {
                unit.connect(desk.library);
            }
        }
        Phase::Connecting => {
            ui.spinner();
            ui.label(frame.connecting);
            if ui.button(desk.words.common.cancel).clicked() {
                unit.station.disconnect();
            }
        }
        Phase::Idle | Phase::Running | Phase::MakingSafe => {
            if ui.button(frame.disconnect).clicked() {
                unit.station.disconnect();
            }
        }
    }
}

fn identity(ui: &mut Ui, desk: &Desk<'_>) {
    let words = desk.words;
    let frame = &words.frame;
    let palette = Palette::of(ui);
    let unit = desk.units.chosen();
    let (phase, identity, counters) = {
        let live = unit.station.live();
        (live.phase, live.identity, live.counters)
    };
    if phase == Phase::Offline {
        ui.label(RichText::new(frame.not_connected).color(palette.quiet));
        return;
    }
    if let Some(setup) = unit.setup.value().filter(|setup| !setup.faults.is_empty()) {
        let names = setup.injected().unwrap_or_default();
        chip(
            ui,
            &fill(frame.injected, &[("faults", &names)]),
            palette.warn,
        );
    }
    if let Some(identity) = identity {
        let serial = crate::run::text(&identity.serial);
        let label = ui.label(RichText::new(serial).strong());
        label.on_hover_text(versions(&identity, words));
        let share = link_quality(&counters);
        let colour = if share >= 99.9 {
            palette.good
        } else {
            palette.warn
        };
        chip(
            ui,
            &fill(frame.link_good, &[("share", &format!("{share:.1}"))]),
            colour,
        );
    }
}

/// Software and data of the unit.
fn versions(identity: &Identity, words: &Words) -> String {
    let software = identity.software.map(|number| number.to_string()).join(".");
    fill(
        words.frame.versions,
        &[
            ("software", &software),
            (
                "config",
                &format!(
                    "{} {:08x}",
                    crate::run::text(&identity.config),
                    identity.config_crc
                ),
            ),
            ("line", &format!("{:08x}", identity.tdb_crc)),
        ],
    )
}

/// Frames taken of all that came, %.
fn link_quality(counters: &Counters) -> f64 {
    let taken: u64 = Channel::ALL
        .iter()
        .map(|channel| counters.accepted(*channel))
        .sum();
    let lost: u64 = Channel::ALL
        .iter()
        .map(|channel| counters.gaps(*channel) + counters.rejected_on(*channel))
        .sum();
    match taken + lost {
        0 => 100.0,
        all => 100.0 * taken as f64 / all as f64,
    }
}

fn arming(ui: &mut Ui, desk: &mut Desk<'_>) {
    let frame = &desk.words.frame;
    let unit = desk.units.chosen();
    if !unit.is_connected() {
        return;
    }
    let armed = unit.station.live().sample.get(Signal::Armed) == Some(1.0);
    if armed {
        let may = unit.station.permits(&Stimulus::PtuDisarm).is_ok();
        if ui.add_enabled(may, Button::new(frame.disarm)).clicked() {
            // Refused only while a run has the bench, when the button is not enabled.
            let _ = unit.station.apply(Stimulus::PtuDisarm);
        }
        Frame::new()
            .fill(Palette::of(ui).armed)
            .inner_margin(Margin::symmetric(10, 4))
            .corner_radius(4)
            .show(ui, |ui| {
                ui.label(
                    RichText::new(frame.armed)
                        .color(Color32::WHITE)
                        .strong()
                        .size(17.0),
                );
            });
    } else {
        let may = unit.phase() == Phase::Idle;
        if ui.add_enabled(may, Button::new(frame.arm)).clicked() {
            unit.station.arm();
        }
        ui.label(RichText::new(frame.disarmed).color(Palette::of(ui).quiet));
    }
}

fn stop_button(ui: &mut Ui, desk: &mut Desk<'_>) {
    let palette = Palette::of(ui);
    let text = RichText::new(desk.words.frame.stop_all)
        .color(Color32::WHITE)
        .strong()
        .size(16.0);
    let button = Button::new(text)
        .fill(palette.armed)
        .shortcut_text(RichText::new(STOP_ALL.name()).color(Color32::WHITE));
    if ui.add(button).clicked() {
        stop_all(desk);
    }
}
