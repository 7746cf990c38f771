//! The ATP signal in the antenna.

use btu_rig::stimulus::Stimulus;
use eframe::egui::Ui;
use protocol::config::UnitConfig;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, named_number, number, row};
use crate::pages::bench::forms::{CodeForm, NO_DRIFT, StimulusPath};
use ptu_report::words::Bench;

/// Greatest values: carrier and level have 16 bits, Hz and mV; the code rate has 16 bits, 0.01 Hz.
const MAX_HZ: f64 = 65_535.0;
const MAX_RATE_HZ: f64 = 655.0;
const MAX_MV: f64 = 65_535.0;
/// Greatest drifts; steeper ones would be steps.
const MAX_DRIFT_HZ_PER_S: f64 = 100.0;
const MAX_DRIFT_MV_PER_S: f64 = 10_000.0;

pub fn show(ui: &mut Ui, form: &mut CodeForm, config: &UnitConfig, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    codes(ui, form, config, StimulusPath::Harness, hand);
    let along = |on| Stimulus::CodesAlong { on };
    hand.switch(ui, words.codes_along, None, along);
    free(ui, form, words);
    row(ui, "", |ui, _| {
        hand.button(ui, words.give_signal, form.free(StimulusPath::Harness));
    });
    row(ui, words.rate_drift, |ui, label| {
        let range = -MAX_DRIFT_HZ_PER_S..=MAX_DRIFT_HZ_PER_S;
        number(ui, label, &mut form.rate_drift_hz_per_s, range, "Hz/s");
        let range = -MAX_DRIFT_MV_PER_S..=MAX_DRIFT_MV_PER_S;
        named_number(
            ui,
            words.level_drift,
            &mut form.level_drift_mv_per_s,
            range,
            "mV/s",
        );
    });
    row(ui, "", |ui, _| {
        hand.button(ui, words.start_drift, form.drift());
        hand.button(ui, words.stop_drift, NO_DRIFT);
    });
}

/// A button for each code of the table.
pub fn codes(
    ui: &mut Ui,
    form: &CodeForm,
    config: &UnitConfig,
    way: StimulusPath,
    hand: &mut StimulusPanel<'_>,
) {
    let words = &hand.words.bench;
    let name = match way {
        StimulusPath::Harness => words.speed_code,
        StimulusPath::TestBoard => words.test_code,
    };
    row(ui, name, |ui, _| {
        for code in &config.codes {
            let in_force = way == StimulusPath::Harness
                && hand.seen.is(Signal::CarrierHz, code.carrier_hz)
                && hand.seen.is(Signal::CodeRateHz, code.rate_hz)
                && hand
                    .seen
                    .value(Signal::LevelMv)
                    .is_some_and(|level| level > 0.0);
            hand.choice(ui, name, &code.name, in_force, form.of_table(code, way));
        }
        if way == StimulusPath::Harness {
            hand.button(ui, words.code_off, Stimulus::CodeOff);
        }
    });
}

pub fn free(ui: &mut Ui, form: &mut CodeForm, words: &Bench) {
    row(ui, words.carrier, |ui, label| {
        number(ui, label, &mut form.carrier_hz, 0.0..=MAX_HZ, "Hz");
        named_number(ui, words.rate, &mut form.rate_hz, 0.0..=MAX_RATE_HZ, "Hz");
    });
    row(ui, words.level, |ui, label| {
        number(ui, label, &mut form.level_mv, 0.0..=MAX_MV, "mV");
    });
}
