//! TCMS, and the train and the track around the unit.

use btu_rig::stimulus::{CutOut, MAX_GRADIENT_PERMILLE, Stimulus, TcmsCondition};
use btu_rig::train::TrainData;
use eframe::egui::Ui;

use super::buttons::{StimulusPanel, number, row};
use crate::pages::bench::forms::TrainForm;

/// Adhesion beyond this is glue.
const MAX_ADHESION: f64 = 1.0;

pub fn show(ui: &mut Ui, form: &mut TrainForm, train: &TrainData, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words().bench;
    row(ui, words.tcms_link, |ui, _| {
        for (condition, text) in [
            (TcmsCondition::Good, words.good),
            (TcmsCondition::Silent, words.silent),
            (TcmsCondition::Stale, words.tcms_stale),
        ] {
            let stimulus = Stimulus::Tcms(condition);
            hand.choice(ui, words.tcms_link, text, false, stimulus);
        }
    });
    row(ui, words.ato_enable, |ui, _| {
        hand.switch(ui, words.ato_enable, None, |on| Stimulus::AtoEnable { on });
    });
    row(ui, words.load, |ui, label| {
        let full_t = train.full_load_kg() / 1000.0;
        number(ui, label, &mut form.load_t, 0.0..=full_t, "t");
        hand.choice(ui, words.load, words.set, false, form.load());
    });
    row(ui, words.gradient, |ui, label| {
        let range = -MAX_GRADIENT_PERMILLE..=MAX_GRADIENT_PERMILLE;
        number(ui, label, &mut form.gradient_permille, range, "‰");
        hand.choice(ui, words.gradient, words.set, false, form.gradient());
        let usual = Stimulus::Gradient { permille: None };
        hand.choice(ui, words.gradient, words.as_always, false, usual);
    });
    row(ui, words.adhesion, |ui, label| {
        number(ui, label, &mut form.adhesion, 0.01..=MAX_ADHESION, "");
        hand.choice(ui, words.adhesion, words.set, false, form.adhesion());
        let usual = Stimulus::Adhesion { coefficient: None };
        hand.choice(ui, words.adhesion, words.as_always, false, usual);
    });
    let TrainData::Cars(cars) = train else {
        return;
    };
    row(ui, words.cut_out, |ui, label| {
        let last = u8::try_from(cars.cars.len()).unwrap_or(u8::MAX);
        number(ui, label, &mut form.car, 1..=last, "");
    });
    let motor = cars
        .motor_cars()
        .contains(usize::from(form.car.saturating_sub(1)));
    for (name, what) in [
        (words.cut_brake, CutOut::Brake),
        (words.cut_inverter, CutOut::Inverter),
    ] {
        // A trailer has no inverter.
        if what == CutOut::Inverter && !motor {
            continue;
        }
        row(ui, name, |ui, _| {
            for (on, text) in [(true, words.cut_off), (false, words.cut_in)] {
                let car = form.car;
                let stimulus = Stimulus::CutOut { what, car, on };
                hand.choice(ui, name, text, false, stimulus);
            }
        });
    }
}
