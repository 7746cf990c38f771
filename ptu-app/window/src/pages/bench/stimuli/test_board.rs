//! The unit's TEST board: stimuli that a PTU on the maintenance port can give to an armed unit.

use crate::pages::bench::stimuli::markers::MARKERS;
use btu_rig::stimulus::Stimulus;
use eframe::egui::Ui;
use protocol::config::UnitConfig;
use protocol::line::Line;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, check, named_number, number, one_of, row};
use super::{atp, self_test, speed, twc};
use crate::pages::bench::forms::{Forms, MotionForm, StimulusPath};
use crate::pages::bench::text;
use ptu_report::words::Bench;

/// Greatest acceleration that the message to the unit can carry, km/h/s.
const MAX_KMHPS: f64 = 235.0;

pub fn show(
    ui: &mut Ui,
    forms: &mut Forms,
    config: &UnitConfig,
    line: &Line,
    hand: &mut StimulusPanel<'_>,
) {
    let words = &hand.words.bench;
    row(ui, words.maintenance, |ui, _| {
        hand.button(ui, words.arm, Stimulus::PtuArm);
        hand.button(ui, words.disarm, Stimulus::PtuDisarm);
    });
    row(ui, "", |ui, _| {
        for (on, text) in [(true, words.silent), (false, words.speaks)] {
            let stimulus = Stimulus::PtuSilent { on };
            hand.choice(ui, words.maintenance, text, false, stimulus);
        }
    });
    atp::codes(ui, &forms.test_code, config, StimulusPath::TestBoard, hand);
    atp::free(ui, &mut forms.test_code, words);
    row(ui, "", |ui, _| {
        let stimulus = forms.test_code.free(StimulusPath::TestBoard);
        hand.choice(ui, words.test_code, words.give_signal, false, stimulus);
    });
    motion(ui, &mut forms.test_motion, hand, words);
    row(ui, words.read_back, |ui, _| {
        let made = [
            Signal::TestCarrier,
            Signal::TestCodeRate,
            Signal::TestLevel,
            Signal::TestSpeed,
        ];
        ui.label(
            made.map(|signal| text::value(words, signal, hand.seen))
                .join(", "),
        );
    });
    let pulses = (1..)
        .zip(MARKERS)
        .map(|(psm, name)| (name, false, Stimulus::PtuMarker { psm }));
    hand.choices(ui, words.test_marker, pulses);
    ui.separator();
    twc::fields(ui, &mut forms.test_station, line, words);
    row(ui, words.test_twc, |ui, _| {
        let stimulus = forms.test_station.send(StimulusPath::TestBoard);
        hand.choice(ui, words.test_twc, words.send_frame, false, stimulus);
    });
    ui.separator();
    self_test::show(ui, hand);
    row(ui, "", |ui, _| {
        hand.button(ui, words.release_all, Stimulus::PtuRelease);
        hand.button(ui, words.clear_log, Stimulus::PtuClearLog);
    });
}

fn motion(ui: &mut Ui, form: &mut MotionForm, hand: &mut StimulusPanel<'_>, words: &Bench) {
    row(ui, words.test_speed, |ui, label| {
        number(ui, label, &mut form.to_kmh, 0.0..=speed::MAX_KMH, "km/h");
        let accel = &mut form.accel_kmhps;
        named_number(ui, words.acceleration, accel, 0.0..=MAX_KMHPS, "km/h/s");
    });
    row(ui, words.inputs, |ui, label| {
        let all = [(0b11, "1 + 2"), (0b01, "1"), (0b10, "2")];
        let all = all.map(|(channels, text)| (channels, text.to_owned()));
        one_of(ui, label, &mut form.channels, all);
        check(ui, words.backward, &mut form.backward);
    });
    row(ui, "", |ui, _| {
        hand.choice(ui, words.test_speed, words.go_to, false, form.test_go());
        hand.choice(ui, words.test_speed, words.stand, false, form.test_stand());
    });
}
