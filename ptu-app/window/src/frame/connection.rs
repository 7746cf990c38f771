//! The connection bar: which unit, how it is reached, who it is, and whether it is armed.

use btu_rig::stimulus::Stimulus;
use eframe::egui::{Align, Button, Color32, Frame, Layout, Margin, RichText, Ui, vec2};
use protocol::message::Identity;
use protocol::signal::{Sample, Signal};

use super::keys::STOP_ALL;
use super::lock::only_look;
use super::setup::Setup;
use crate::parts::{ActionPlace, chip};
use crate::{Page, PageContext, Palette, Sizes};
use ptu_report::words::{self, Words, fill};
use ptu_runs::bench_worker::Phase;
use ptu_runs::table::cut;

/// Letters of a chip that names faults, at most.
const LINE: usize = 36;

pub fn bar(ui: &mut Ui, context: &mut PageContext<'_>, setup: &mut Setup) {
    both_ends(
        ui,
        context,
        |ui, context| {
            stop_button(ui, context);
            if context.settings.locked {
                only_look(ui);
            }
            arming(ui, context);
        },
        |ui, context| {
            units(ui, context);
            setup.endpoint(ui, context);
            connect(ui, context);
            identity(ui, context);
            running(ui, context);
            if context.only_reads().is_some() {
                let care = &context.words.care;
                let server = context.queries.paths().database.display().to_string();
                let said = fill(care.reads, &[("server", &server)]);
                let cut = cut(&said, LINE);
                chip(ui, &cut, Palette::of(ui).warn)
                    .on_hover_text(format!("{said}. {}", care.is_server));
            }
            if context.units.iter().any(|unit| unit.stopping) {
                chip(ui, context.words.frame.stopping, Palette::of(ui).warn);
            }
        },
    );
}

/// A bar with something at its right end, and the rest in the lines that it takes.
pub(super) fn both_ends(
    ui: &mut Ui,
    context: &mut PageContext<'_>,
    right: impl FnOnce(&mut Ui, &mut PageContext<'_>),
    left: impl FnOnce(&mut Ui, &mut PageContext<'_>),
) {
    // As high as one line at first: what is in a line is centred in it.
    let size = |ui: &Ui| vec2(ui.available_width(), ui.spacing().interact_size.y);
    let ends = Layout::right_to_left(Align::Center);
    ui.allocate_ui_with_layout(size(ui), ends, |ui| {
        right(ui, context);
        let lines = Layout::left_to_right(Align::Center).with_main_wrap(true);
        ui.allocate_ui_with_layout(size(ui), lines, |ui| left(ui, context));
    });
}

/// Units side by side; the pages show the chosen one.
fn units(ui: &mut Ui, context: &mut PageContext<'_>) {
    if context.units.count() > 1 {
        for place in 0..context.units.count() {
            let Some(unit) = context.units.iter().nth(place) else {
                continue;
            };
            let label = format!("{}: {}", place + 1, unit.name());
            if ui
                .selectable_label(place == context.units.chosen_place(), label)
                .clicked()
            {
                context.units.choose(place);
            }
        }
        let free = context.units.chosen().phase() == Phase::Offline;
        let remove = ui.add_enabled(free, Button::new(context.words.frame.remove_unit));
        if remove.clicked() {
            context.units.remove(context.units.chosen_place());
        }
    }
    if ui
        .button("+")
        .on_hover_text(context.words.frame.add_unit)
        .clicked()
    {
        let choice = context.units.chosen().choice.clone();
        if let Err(failure) = context.units.add(choice) {
            context
                .messages
                .trouble(context.words.frame.cannot_connect, failure.message);
        }
    }
}

fn connect(ui: &mut Ui, context: &mut PageContext<'_>) {
    let frame = &context.words.frame;
    let only_reads = context.only_reads();
    let unit = context.units.chosen_mut();
    let phase = unit.phase();
    let offline = (phase == Phase::Offline, phase == Phase::Connecting);
    let place = ActionPlace::new(ui, "connection", (unit.id, offline));
    match phase {
        Phase::Offline => {
            let button = Button::new(RichText::new(frame.connect).strong());
            let button = ui.add_enabled(only_reads.is_none(), button);
            let button = button.on_disabled_hover_text(only_reads.unwrap_or_default());
            if place.clicked(&button) {
                unit.connect(context.queries);
            }
        }
        Phase::Connecting => {
            ui.spinner();
            ui.label(frame.connecting);
            if place.clicked(&ui.button(context.words.common.cancel)) {
                unit.disconnect();
            }
        }
        Phase::Idle | Phase::Running | Phase::MakingSafe => {
            if place.clicked(&ui.button(frame.disconnect)) {
                unit.disconnect();
            }
        }
    }
}

fn identity(ui: &mut Ui, context: &PageContext<'_>) {
    let words = context.words;
    let frame = &words.frame;
    let palette = Palette::of(ui);
    let unit = context.units.chosen();
    let (phase, identity, share, differs) = {
        let live = unit.bench.live();
        let differs = differs_from_record(&live.sample, frame);
        (live.phase, live.identity, live.link.share(), differs)
    };
    if unit.is_lost() {
        chip(ui, frame.link_gone, palette.warn);
        return;
    }
    if phase == Phase::Offline {
        ui.label(RichText::new(frame.not_connected).color(palette.quiet));
        return;
    }
    if let Some(setup) = unit.setup.value().filter(|setup| !setup.faults.is_empty()) {
        let names = setup.injected().unwrap_or_default();
        let said = fill(frame.injected, &[("faults", &names)]);
        chip(ui, &cut(&said, LINE), palette.warn).on_hover_text(said);
    }
    if let Some(identity) = identity {
        let serial = ptu_runs::run::unit_text::serial(&identity);
        let label = ui.label(RichText::new(serial).strong());
        label.on_hover_text(versions(&identity, words));
        if let Some(differs) = differs {
            chip(ui, &differs, palette.bad);
        }
        let share = 100.0 * share.unwrap_or(1.0);
        let colour = if share >= 99.9 {
            palette.quiet
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

/// What of the unit is not as the record of its train says.
fn differs_from_record(sample: &Sample, frame: &words::Frame) -> Option<String> {
    let compared = [
        (Signal::IdentitySerial, frame.recorded_serial),
        (Signal::IdentitySoftware, frame.recorded_software),
        (Signal::IdentityConfig, frame.recorded_config),
        (Signal::IdentityLine, frame.recorded_line),
    ];
    let differs = |(signal, _): &(Signal, &str)| sample.get(*signal) == Some(0.0);
    let parts: Vec<_> = compared.into_iter().filter(differs).collect();
    let what: Vec<_> = parts.iter().map(|(_, name)| *name).collect();
    (!what.is_empty()).then(|| fill(frame.not_as_recorded, &[("what", &what.join(", "))]))
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
                    ptu_runs::run::unit_text::config_name(identity),
                    identity.config_crc
                ),
            ),
            ("line", &format!("{:08x}", identity.tdb_crc)),
        ],
    )
}

fn arming(ui: &mut Ui, context: &mut PageContext<'_>) {
    let frame = &context.words.frame;
    let chosen = context.units.chosen_place();
    for (_, other) in (0..)
        .zip(context.units.iter())
        .filter(|(place, _)| *place != chosen)
    {
        if other.is_armed() {
            armed_sign(ui, &fill(frame.armed_unit, &[("unit", &other.name())]));
        }
    }
    let unit = context.units.chosen();
    let phase = unit.phase();
    if matches!(phase, Phase::Offline | Phase::Connecting) {
        return;
    }
    let place = ActionPlace::new(ui, "arming", (unit.id, unit.is_armed()));
    if unit.is_armed() {
        let may = unit.bench.permits(&Stimulus::PtuDisarm).is_ok();
        if place.clicked(&ui.add_enabled(may, Button::new(frame.disarm))) {
            // Refused only while a run has the bench, when the button is not enabled.
            let _ = unit.bench.apply(Stimulus::PtuDisarm);
        }
        armed_sign(ui, frame.armed);
    } else {
        let idle = phase == Phase::Idle;
        if place.held(ui, Button::new(frame.arm), idle, frame.arm_hint) {
            unit.bench.arm();
        }
        ui.label(RichText::new(frame.disarmed).color(Palette::of(ui).quiet));
    }
}

/// Outranks everything else on the screen.
fn armed_sign(ui: &mut Ui, text: &str) {
    Frame::new()
        .fill(Palette::of(ui).armed)
        .inner_margin(Margin::symmetric(10, 4))
        .corner_radius(4)
        .show(ui, |ui| {
            ui.label(
                RichText::new(text)
                    .color(Color32::WHITE)
                    .strong()
                    .size(17.0),
            );
        });
}

/// What a run is at, whatever page is in front.
fn running(ui: &mut Ui, context: &mut PageContext<'_>) {
    let frame = &context.words.frame;
    let palette = Palette::of(ui);
    let Some(run) = context
        .units
        .chosen()
        .run
        .as_ref()
        .filter(|run| run.is_running())
    else {
        return;
    };
    let present = run.present.as_ref();
    if present.is_some_and(|present| present.prompt.is_some()) {
        if ui
            .button(RichText::new(frame.asks).color(palette.warn).strong())
            .clicked()
        {
            context.settings.page = Page::Procedures;
        }
    } else if present.is_some_and(|present| present.paused.is_some()) {
        chip(ui, frame.is_paused, palette.warn);
    } else {
        let share = format!("{:.0}", 100.0 * run.share());
        chip(
            ui,
            &fill(frame.running, &[("share", &share)]),
            palette.accent,
        );
    }
}

fn stop_button(ui: &mut Ui, context: &mut PageContext<'_>) {
    let palette = Palette::of(ui);
    let text = RichText::new(context.words.frame.stop_all)
        .color(Color32::WHITE)
        .strong()
        .size(Sizes::of(ui).body.max(16.0));
    let button = Button::new(text)
        .fill(palette.armed)
        .shortcut_text(RichText::new(STOP_ALL.name()).color(Color32::WHITE));
    if ui.add(button).clicked() {
        context.units.stop_all();
    }
}
