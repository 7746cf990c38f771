//! The TWC data sent by the wayside.

use btu_rig::stimulus::{Stimulus, WaysideCondition};
use eframe::egui::Ui;
use protocol::line::Line;
use protocol::message::{DoorSide, RunningMode, TrainOrder};
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, check, named_number, number, one_of, row};
use super::markers::sections;
use crate::pages::bench::forms::{StationForm, StimulusPath};
use ptu_report::words::Bench;

/// Conditions in the order of the labels of the signal `wayside`.
const CONDITIONS: [WaysideCondition; 3] = [
    WaysideCondition::Silent,
    WaysideCondition::Good,
    WaysideCondition::Corrupt,
];
/// Greatest speed that can be ordered, km/h; in the frame 255 stands for no order.
const MAX_ORDER_KMH: u8 = 254;

pub fn show(ui: &mut Ui, form: &mut StationForm, line: &Line, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    let conditions = CONDITIONS.into_iter().map(Stimulus::Wayside);
    hand.states(ui, words.wayside, Signal::Wayside, conditions);
    fields(ui, form, line, words);
    row(ui, "", |ui, _| {
        hand.button(ui, words.send_frame, form.send(StimulusPath::Harness));
    });
    ui.separator();
    orders(ui, form, line, hand);
}

/// Buttons for the train orders that are sent beside the station data until another order, or none, is chosen.
fn orders(ui: &mut Ui, form: &mut StationForm, line: &Line, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    row(ui, words.destination, |ui, label| {
        number(ui, label, &mut form.destination, 0..=u16::MAX, "");
    });
    row(ui, words.wayside_order, |ui, _| {
        let names = words.states(Signal::WaysideOrder);
        for (place, (order, text)) in TrainOrder::ALL.iter().zip(names).enumerate() {
            let in_force = hand.seen.is(Signal::WaysideOrder, place as f64);
            let stimulus = form.order(*order, line);
            hand.choice(ui, words.wayside_order, text, in_force, stimulus);
        }
        hand.button(ui, words.no_orders, Stimulus::Orders(None));
    });
}

pub fn fields(ui: &mut Ui, form: &mut StationForm, line: &Line, words: &Bench) {
    const ALL: std::ops::RangeInclusive<u16> = 0..=u16::MAX;
    row(ui, words.section, |ui, label| {
        let mut section = form.data.section;
        one_of(ui, label, &mut section, sections(line));
        if section != form.data.section
            && let Some(chosen) = line.section(section)
        {
            form.departing(chosen);
        }
        fill_in(ui, form, line, words);
    });
    let data = &mut form.data;
    row(ui, words.route, |ui, label| {
        number(ui, label, &mut data.route, ALL, "");
        named_number(ui, words.train_number, &mut data.train_number, ALL, "");
    });
    row(ui, words.station, |ui, label| {
        number(ui, label, &mut data.station, ALL, "");
        named_number(ui, words.next_station, &mut data.next_station, ALL, "");
    });
    row(ui, words.loop_id, |ui, label| {
        number(ui, label, &mut data.loop_id, ALL, "");
        check(ui, words.departure, &mut data.departure);
    });
    row(ui, words.running_mode, |ui, label| {
        let states = words.states(Signal::WaysideMode);
        let all = RunningMode::ALL.iter().copied();
        one_of(ui, label, &mut data.running_mode, all.zip(owned(states)));
        let label = ui.label(words.door_side).id;
        let states = words.states(Signal::WaysideDoorSide);
        let all = DoorSide::ALL.iter().copied();
        one_of(ui, label, &mut data.door_side, all.zip(owned(states)));
    });
    row(ui, words.fixed_speed, |ui, label| {
        let range = 0..=MAX_ORDER_KMH;
        number(ui, label, &mut form.fixed_speed_kmh, range, "km/h");
        check(ui, words.order, &mut form.ordered);
    });
}

/// Buttons that fill in the station data of the section's start or end from the line.
fn fill_in(ui: &mut Ui, form: &mut StationForm, line: &Line, words: &Bench) {
    let Some(section) = line.section(form.data.section) else {
        return;
    };
    if ui.button(words.at_departure).clicked() {
        form.departing(section);
    }
    if ui.button(words.at_arrival).clicked() {
        form.arriving(section, line);
    }
}

fn owned(states: Vec<&'static str>) -> impl Iterator<Item = String> {
    states.into_iter().map(str::to_owned)
}
