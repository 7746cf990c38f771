//! Marker coils and markers along the way.

use btu_rig::stimulus::Stimulus;
use eframe::egui::Ui;
use protocol::line::Line;

use super::buttons::{StimulusPanel, named_number, one_of, row};
use crate::pages::bench::forms::MarkerForm;

/// The markers along a section, by their numbers from 1.
pub const MARKERS: [&str; 4] = ["PSM1", "PSM2", "PSM3", "PSM4"];
/// Greatest distance by which a marker can be moved, m.
const MAX_MOVE_M: f64 = 100.0;

pub fn show(ui: &mut Ui, form: &mut MarkerForm, line: &Line, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    let pulses = (1..)
        .zip(MARKERS)
        .map(|(psm, name)| (name, false, Stimulus::Marker { psm }));
    hand.choices(ui, words.marker_pulse, pulses);
    row(ui, words.section, |ui, label| {
        one_of(ui, label, &mut form.section, sections(line));
        let laid = hand.given.laid == Some(form.section);
        hand.choice(ui, words.section, words.lay, laid, form.lay());
        let none = Stimulus::MarkersAlong { section: None };
        hand.choice(ui, words.section, words.take_up, false, none);
    });
    row(ui, words.marker, |ui, label| {
        let all = (1..).zip(MARKERS.map(str::to_owned));
        one_of(ui, label, &mut form.psm, all);
        let range = -MAX_MOVE_M..=MAX_MOVE_M;
        named_number(ui, words.move_by, &mut form.by_m, range, "m");
    });
    row(ui, "", |ui, _| {
        hand.choice(ui, words.marker, words.move_marker, false, form.moved());
        hand.choice(ui, words.marker, words.missing, false, form.missing());
    });
}

/// Sections of a line by number, with their stations.
pub fn sections(line: &Line) -> impl Iterator<Item = (u16, String)> + '_ {
    line.sections.iter().map(|section| {
        let (number, from, to) = (section.section, section.from_station, section.to_station);
        (number, format!("{number}: {from} → {to}"))
    })
}
