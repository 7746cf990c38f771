//! Tachometers and the train model that can drive them.

use btu_rig::stimulus::Stimulus;
use eframe::egui::Ui;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, named_number, number, row};
use crate::pages::bench::forms::{MotionForm, TachoKind};
use ptu_report::words::fill;

/// Fastest the generators turn, km/h.
pub const MAX_KMH: f64 = 200.0;
/// No train accelerates like this, km/h/s.
pub const MAX_KMHPS: f64 = 360.0;
const MAX_TRAVEL_M: f64 = 100_000.0;
const MAX_NOISE_PER_S: f64 = 5_000.0;
const MAX_FACTOR: f64 = 10.0;

pub fn show(ui: &mut Ui, form: &mut MotionForm, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words().bench;
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
    row(ui, words.direction, |ui, _| {
        for (text, backward) in [(words.forward, false), (words.backward, true)] {
            let stimulus = Stimulus::Direction { backward };
            hand.choice(ui, words.direction, text, false, stimulus);
        }
    });
    for (channel, signal) in [(1, Signal::Tacho1), (2, Signal::Tacho2)] {
        let name = fill(words.tacho, &[("channel", &channel)]);
        let states = words.states(signal);
        row(ui, &name, |ui, _| {
            for (place, (kind, text)) in TachoKind::ALL.into_iter().zip(&states).enumerate() {
                let in_force = hand.seen.is(signal, place as f64);
                hand.choice(ui, &name, text, in_force, form.tacho(channel, kind));
            }
        });
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
    row(ui, words.train_model, |ui, _| {
        hand.switch(ui, words.train_model, None, |on| Stimulus::TrainDriven {
            on,
        });
    });
}
