//! Tachometers and the train model that can drive them.

use btu_rig::stimulus::Stimulus;
use eframe::egui::Ui;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, named_number, number, row};
use crate::pages::bench::forms::MotionForm;
use ptu_report::words::fill;

/// Greatest speed of the tachometer generators, km/h.
pub const MAX_KMH: f64 = 200.0;
/// Greatest acceleration that can be entered, more than any train reaches, km/h/s.
pub const MAX_KMHPS: f64 = 360.0;
const MAX_TRAVEL_M: f64 = 100_000.0;
const MAX_NOISE_PER_S: f64 = 5_000.0;
const MAX_FACTOR: f64 = 10.0;

pub fn show(ui: &mut Ui, form: &mut MotionForm, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    row(ui, words.to_speed, |ui, label| {
        number(ui, label, &mut form.to_kmh, 0.0..=MAX_KMH, "km/h");
        let accel = &mut form.accel_kmhps;
        named_number(ui, words.acceleration, accel, 0.01..=MAX_KMHPS, "km/h/s");
    });
    row(ui, "", |ui, _| {
        hand.button(ui, words.go_to, form.go_to());
        hand.button(ui, words.stand, form.stand());
    });
    row(ui, words.distance, |ui, label| {
        number(ui, label, &mut form.distance_m, 0.1..=MAX_TRAVEL_M, "m");
        hand.button(ui, words.travel, form.travel());
    });
    let directions = [(words.forward, false), (words.backward, true)];
    let directions =
        directions.map(|(text, backward)| (text, false, Stimulus::Direction { backward }));
    hand.choices(ui, words.direction, directions);
    for (channel, signal) in [(1, Signal::Tacho1), (2, Signal::Tacho2)] {
        let name = fill(words.tacho, &[("channel", &channel)]);
        let all = form.tacho_conditions().into_iter();
        let all = all.map(|condition| Stimulus::Tacho { channel, condition });
        hand.states(ui, &name, signal, all);
    }
    row(ui, words.noise, |ui, label| {
        number(
            ui,
            label,
            &mut form.noise_per_s,
            0.0..=MAX_NOISE_PER_S,
            "1/s",
        );
        named_number(ui, words.factor, &mut form.factor, 0.0..=MAX_FACTOR, "×");
    });
    let driven = |on| Stimulus::TrainDriven { on };
    hand.switch(ui, words.train_model, None, driven);
}
