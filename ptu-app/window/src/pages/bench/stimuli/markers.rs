//! Marker coils and markers along the way.

use btu_rig::stimulus::Stimulus;
use eframe::egui::Ui;
use protocol::line::Line;

use super::buttons::{StimulusPanel, named_number, one_of, row};
use crate::pages::bench::forms::MarkerForm;

/// Farthest a marker can be moved, m.
const MAX_MOVE_M: f64 = 100.0;

pub fn show(ui: &mut Ui, form: &mut MarkerForm, line: &Line, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words().bench;
    row(ui, words.marker_pulse, |ui, _| {
        for psm in 1..=4 {
            let name = format!("PSM{psm}");
            hand.choice(
                ui,
                words.marker_pulse,
                &name,
                false,
                Stimulus::Marker { psm },
            );
        }
    });
    row(ui, words.section, |ui, label| {
        one_of(ui, label, &mut form.section, sections(line));
        let laid = hand.given.laid == Some(form.section);
        hand.choice(ui, words.section, words.lay, laid, form.lay());
        let none = Stimulus::MarkersAlong { section: None };
        hand.choice(ui, words.section, words.take_up, false, none);
    });
    row(ui, words.marker, |ui, label| {
        let all = (1..=4).map(|psm| (psm, format!("PSM{psm}")));
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
