//! Train lines, switches and push buttons of the cab.

use btu_rig::stimulus::{DoorState, Stimulus, TrainSwitch};
use eframe::egui::Ui;
use protocol::message::ModeSwitch;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, row};
use ptu_report::words::Bench;

fn switches(words: &Bench) -> [(TrainSwitch, &'static str); 11] {
    [
        (TrainSwitch::OtherCab, words.other_cab),
        (TrainSwitch::DeadMan, words.dead_man),
        (TrainSwitch::Button1, words.button_1),
        (TrainSwitch::Button2, words.button_2),
        (TrainSwitch::EbCutOut, words.eb_cut_out),
        (TrainSwitch::MainReservoirLow, words.main_reservoir_low),
        (TrainSwitch::SecurityBrake, words.security_brake),
        (TrainSwitch::ParkingBrake, words.parking_brake),
        (TrainSwitch::ForcedRelease, words.forced_release),
        (TrainSwitch::TurnBack, words.turn_back),
        (TrainSwitch::Regeneration, words.regeneration),
    ]
}

pub fn show(ui: &mut Ui, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words().bench;
    row(ui, words.doors, |ui, _| {
        for (closed, text) in [(true, words.doors_closed), (false, words.doors_open)] {
            let in_force = hand.seen.on(Signal::Doors) == Some(closed);
            let stimulus = Stimulus::Doors { closed };
            hand.choice(ui, words.doors, text, in_force, stimulus);
        }
    });
    for (left, name, signal) in [
        (true, words.doors_left, Signal::DoorsLeft),
        (false, words.doors_right, Signal::DoorsRight),
    ] {
        row(ui, name, |ui, _| {
            for (state, text, number) in [
                (DoorState::Locked, words.doors_closed, 2.0),
                (DoorState::Unlocked, words.doors_unlocked, 1.0),
                (DoorState::Open, words.doors_open, 0.0),
            ] {
                let in_force = hand.seen.is(signal, number);
                let stimulus = Stimulus::SideDoors { left, state };
                hand.choice(ui, name, text, in_force, stimulus);
            }
        });
    }
    row(ui, words.hcr, |ui, _| {
        let state = hand.seen.on(Signal::Hcr);
        hand.switch(ui, words.hcr, state, |on| Stimulus::Hcr { on });
    });
    row(ui, words.key, |ui, _| {
        let state = hand.seen.on(Signal::MaintenanceKey);
        hand.switch(ui, words.key, state, |on| Stimulus::MaintenanceKey { on });
    });
    row(ui, words.mode_switch, |ui, _| {
        let states = words.states(Signal::ModeSwitch);
        for (place, (position, text)) in ModeSwitch::ALL.iter().zip(states).enumerate() {
            let in_force = hand.seen.is(Signal::ModeSwitch, place as f64);
            let stimulus = Stimulus::ModeSwitch(*position);
            hand.choice(ui, words.mode_switch, text, in_force, stimulus);
        }
    });
    row(ui, words.buttons, |ui, _| {
        hand.button(ui, words.acknowledge, Stimulus::Acknowledge);
        hand.button(ui, words.start, Stimulus::Start);
    });
    for (switch, name) in switches(words) {
        row(ui, name, |ui, _| {
            hand.switch(ui, name, None, |on| Stimulus::Switch { switch, on });
        });
    }
}
