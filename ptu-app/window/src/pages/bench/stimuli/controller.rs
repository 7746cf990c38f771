//! Master controller and reverser.

use btu_rig::lever::Lever;
use btu_rig::stimulus::Stimulus;
use eframe::egui::{Slider, Ui};
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, number, row};
use crate::pages::bench::forms::TrainForm;
use ptu_report::words::Bench;

const MAX_VOLTS: f64 = 10.0;
const SLIDER: f32 = 190.0;

pub fn show(ui: &mut Ui, form: &mut TrainForm, hand: &mut StimulusPanel<'_>) {
    let words = &hand.words.bench;
    lever(ui, form, hand, words);
    let positions = [(1, words.forward), (0, words.neutral), (-1, words.backward)];
    let positions =
        positions.map(|(position, text)| (text, false, Stimulus::Reverser { position }));
    hand.choices(ui, words.reverser, positions);
    row(ui, words.volts, |ui, label| {
        number(ui, label, &mut form.volts, 0.0..=MAX_VOLTS, "V");
        for (text, volts) in [(words.set, Some(form.volts)), (words.as_lever, None)] {
            let stimulus = Stimulus::ControllerVolts { volts };
            hand.choice(ui, words.volts, text, false, stimulus);
        }
    });
    let contacts = [
        ("P", Some((true, false))),
        ("B", Some((false, true))),
        ("P + B", Some((true, true))),
        ("—", Some((false, false))),
        (words.as_lever, None),
    ]
    .map(|(text, contacts)| (text, false, Stimulus::ControllerContacts { contacts }));
    hand.choices(ui, words.contacts, contacts);
}

/// A slider that moves the lever while it is dragged, and a button for each notch.
fn lever(ui: &mut Ui, form: &mut TrainForm, hand: &mut StimulusPanel<'_>, words: &Bench) {
    row(ui, words.lever, |ui, label| {
        let may = hand.may(&form.controller());
        let slider = Slider::new(&mut form.lever, 0..=Lever::ALL.len() - 1)
            .custom_formatter(|place, _| {
                Lever::ALL
                    .get(place as usize)
                    .map_or_else(String::new, Lever::to_string)
            })
            .custom_parser(|name| {
                let lever = Lever::from_name(name.trim())?;
                let place = Lever::ALL.iter().position(|one| *one == lever)?;
                Some(place as f64)
            });
        ui.spacing_mut().slider_width = SLIDER;
        let mut response = ui.add_enabled(may.is_ok(), slider).labelled_by(label);
        if let Err(why) = may {
            response = response.on_disabled_hover_text(why);
        }
        if response.changed() {
            hand.give(form.controller());
        }
    });
    row(ui, "", |ui, _| {
        for (place, lever) in Lever::ALL.into_iter().enumerate() {
            // The unit's input has no half notch: half power reads as P1, so its button is never marked.
            let in_force = lever != Lever::HalfPower
                && hand.seen.is(Signal::Controller, f64::from(lever.wire()));
            let stimulus = Stimulus::Controller { lever };
            let name = lever.to_string();
            if hand.choice(ui, words.lever, &name, in_force, stimulus) {
                form.lever = place;
            }
        }
    });
}
