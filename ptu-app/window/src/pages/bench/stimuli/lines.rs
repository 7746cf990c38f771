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
    let words = &hand.words.bench;
    let now = hand.seen.on(Signal::Doors);
    let doors = [(true, words.doors_closed), (false, words.doors_open)];
    let doors = doors.map(|(closed, text)| (text, now == Some(closed), Stimulus::Doors { closed }));
    hand.choices(ui, words.doors, doors);
    for (left, name, signal) in [
        (true, words.doors_left, Signal::DoorsLeft),
        (false, words.doors_right, Signal::DoorsRight),
    ] {
        let states = [
            (DoorState::Locked, words.doors_closed, 2.0),
            (DoorState::Unlocked, words.doors_unlocked, 1.0),
            (DoorState::Open, words.doors_open, 0.0),
        ];
        let is_now = |number| hand.seen.is(signal, number);
        let states = states.map(|(state, text, number)| {
            (text, is_now(number), Stimulus::SideDoors { left, state })
        });
        hand.choices(ui, name, states);
    }
    let state = hand.seen.on(Signal::Hcr);
    hand.switch(ui, words.hcr, state, |on| Stimulus::Hcr { on });
    let state = hand.seen.on(Signal::MaintenanceKey);
    hand.switch(ui, words.key, state, |on| Stimulus::MaintenanceKey { on });
    let positions = ModeSwitch::ALL.iter().copied().map(Stimulus::ModeSwitch);
    hand.states(ui, words.mode_switch, Signal::ModeSwitch, positions);
    row(ui, words.buttons, |ui, _| {
        hand.button(ui, words.acknowledge, Stimulus::Acknowledge);
        hand.button(ui, words.start, Stimulus::Start);
    });
    for (switch, name) in switches(words) {
        hand.switch(ui, name, None, |on| Stimulus::Switch { switch, on });
    }
}
