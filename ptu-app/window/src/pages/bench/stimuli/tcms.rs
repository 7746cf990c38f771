//! TCMS, and the train and the track around the unit.

use btu_rig::stimulus::{CutOut, MAX_GRADIENT_PERMILLE, Stimulus, TcmsCondition};
use btu_rig::train::TrainData;
use eframe::egui::Ui;

use super::buttons::{StimulusPanel, number, row};
use crate::pages::bench::forms::TrainForm;

/// Greatest coefficient of adhesion that can be entered.
const MAX_ADHESION: f64 = 1.0;

pub fn show(ui: &mut Ui, form: &mut TrainForm, train: &TrainData, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    let link = [
        (TcmsCondition::Good, words.good),
        (TcmsCondition::Silent, words.silent),
        (TcmsCondition::Stale, words.tcms_stale),
    ];
    let link = link.map(|(condition, text)| (text, false, Stimulus::Tcms(condition)));
    hand.choices(ui, words.tcms_link, link);
    hand.switch(ui, words.ato_enable, None, |on| Stimulus::AtoEnable { on });
    row(ui, words.load, |ui, label| {
        let full_t = train.full_load_kg() / 1000.0;
        number(ui, label, &mut form.load_t, 0.0..=full_t, "t");
        hand.choice(ui, words.load, words.set, false, form.load());
    });
    row(ui, words.gradient, |ui, label| {
        let range = -MAX_GRADIENT_PERMILLE..=MAX_GRADIENT_PERMILLE;
        number(ui, label, &mut form.gradient_permille, range, "‰");
        let given = Some(form.gradient_permille);
        for (text, permille) in [(words.set, given), (words.as_always, None)] {
            let stimulus = Stimulus::Gradient { permille };
            hand.choice(ui, words.gradient, text, false, stimulus);
        }
    });
    row(ui, words.adhesion, |ui, label| {
        number(ui, label, &mut form.adhesion, 0.01..=MAX_ADHESION, "");
        let given = Some(form.adhesion);
        for (text, coefficient) in [(words.set, given), (words.as_always, None)] {
            let stimulus = Stimulus::Adhesion { coefficient };
            hand.choice(ui, words.adhesion, text, false, stimulus);
        }
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
        // A trailer has no inverter to cut out.
        if what == CutOut::Inverter && !motor {
            continue;
        }
        let car = form.car;
        let both = [(true, words.cut_off), (false, words.cut_in)];
        let both = both.map(|(on, text)| (text, false, Stimulus::CutOut { what, car, on }));
        hand.choices(ui, name, both);
    }
}
