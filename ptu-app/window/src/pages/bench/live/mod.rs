//! The live view: the indications in the cab, and those for the technician only.

mod cab;
mod card;
mod dial;
mod effort;
mod lamps;
mod log;
mod strip;
mod twc;

use std::collections::VecDeque;

use btu_rig::procedure::UnitEvent;
use btu_rig::stimulus::StationData;
use eframe::egui::{Ui, vec2};

pub use card::{framed, heading, put_centred};
pub use log::log;

use super::live_copy::BenchSnapshot;
use super::scale::Dial;
use super::track::{Strip, WaysideFrame};
use crate::Palette;
use card::card;
use ptu_report::words::Words;
use ptu_runs::run::BenchSetup;

pub struct View<'a> {
    pub words: &'static Words,
    pub seen: &'a BenchSnapshot,
    pub setup: &'a BenchSetup,
    /// Section laid along the way by hand.
    pub laid: Option<u16>,
    /// Station data last given by hand.
    pub given: Option<&'a StationData>,
    /// The unit's log and TCMS's log, together.
    pub events: &'a VecDeque<UnitEvent>,
}

/// Width from which on cards stand beside each other, points.
pub const WIDE: f32 = 640.0;
/// Height of dial and lamps, points.
const TOP_HEIGHT: f32 = 198.0;
/// Height of effort and TWC beside each other, points.
const MIDDLE_HEIGHT: f32 = 174.0;
/// Share of the width that the dial takes.
const DIAL_SHARE: f32 = 0.46;

/// Draws the live view, without log and plot.
pub fn view(ui: &mut Ui, view: &View<'_>) {
    let palette = Palette::of(ui);
    let words = &view.words.bench;
    let highest = view.setup.config.content.codes.iter();
    let highest_kmh = highest.map(|code| code.limit_kmh).fold(0.0, f64::max);
    let scale = Dial::up_to(highest_kmh);
    let width = ui.available_width();
    if width >= WIDE {
        ui.horizontal(|ui| {
            dial::dial(
                ui,
                vec2(width * DIAL_SHARE, TOP_HEIGHT),
                scale,
                view,
                &palette,
            );
            lamps::lamps(
                ui,
                vec2(ui.available_width(), TOP_HEIGHT),
                view.seen,
                words,
                &palette,
            );
        });
    } else {
        dial::dial(ui, vec2(width, TOP_HEIGHT), scale, view, &palette);
        lamps::lamps(ui, vec2(width, TOP_HEIGHT), view.seen, words, &palette);
    }
    cab::cab(ui, view, &palette);
    let strip = Strip::of(&view.setup.line.content, view.laid, view.seen);
    strip::strip(ui, strip.as_ref(), view, &palette);
    let sent = WaysideFrame::of(&view.setup.line.content, view.given, view.seen);
    if width >= WIDE {
        ui.columns(2, |columns| {
            card(&mut columns[0], words.effort, |ui| {
                ui.set_min_height(MIDDLE_HEIGHT);
                effort::effort(ui, view, &palette)
            });
            card(&mut columns[1], words.twc, |ui| {
                ui.set_min_height(MIDDLE_HEIGHT);
                twc::twc(ui, view, &sent, &palette)
            });
        });
    } else {
        card(ui, words.effort, |ui| effort::effort(ui, view, &palette));
        card(ui, words.twc, |ui| twc::twc(ui, view, &sent, &palette));
    }
}
