//! All manual stimuli, in groups.

mod acting;
mod atp;
mod buttons;
mod controller;
mod lines;
mod markers;
mod self_test;
mod speed;
mod tcms;
mod test_board;
mod twc;

use btu_rig::procedure::plan::Connection;
use eframe::egui::{CollapsingHeader, RichText, ScrollArea, Ui};

pub use buttons::{StimuliGiven, StimulusPanel};

use super::forms::Forms;
use crate::parts::find_edit;
use buttons::seek;
use ptu_report::words::Bench;
use ptu_runs::run::BenchSetup;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    TestBoard,
    Atp,
    Speed,
    Markers,
    Twc,
    Lines,
    Controller,
    Tcms,
}

impl Group {
    /// All groups; the TEST board, which needs no harness, is the last.
    const ALL: [Self; 8] = [
        Self::Atp,
        Self::Speed,
        Self::Markers,
        Self::Twc,
        Self::Lines,
        Self::Controller,
        Self::Tcms,
        Self::TestBoard,
    ];

    fn name(self, words: &Bench) -> &'static str {
        match self {
            Self::TestBoard => words.group_test_board,
            Self::Atp => words.group_atp,
            Self::Speed => words.group_speed,
            Self::Markers => words.group_markers,
            Self::Twc => words.group_twc,
            Self::Lines => words.group_lines,
            Self::Controller => words.group_controller,
            Self::Tcms => words.group_tcms,
        }
    }

    /// Whether the group is open at first: the groups of most use with this connection are.
    fn first_open(self, connection: Connection) -> bool {
        match connection {
            Connection::Ptu => self == Self::TestBoard,
            Connection::Btu => matches!(self, Self::Atp | Self::Speed | Self::Lines),
        }
    }
}

/// Draws all groups; on a PTU, which can use no other, the TEST board's group stands first.
pub fn stimuli(ui: &mut Ui, forms: &mut Forms, setup: &BenchSetup, hand: &mut StimulusPanel<'_>) {
    let connection = hand.connection();
    let mut groups = Group::ALL;
    if connection == Connection::Ptu {
        groups.rotate_right(1);
    }
    let words = &hand.words.bench;
    find_edit(ui, &mut forms.find, words.find, f32::INFINITY);
    seek(ui, "");
    acting::acting(ui, forms, hand);
    let sought = forms.find.trim().to_lowercase();
    ScrollArea::vertical()
        .id_salt("stimuli")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            for group in groups {
                let name = group.name(words);
                // A group whose own name matches the search is shown whole.
                let is_whole = name.to_lowercase().contains(&sought);
                seek(ui, if is_whole { "" } else { &sought });
                CollapsingHeader::new(RichText::new(name).strong())
                    .id_salt((group as u8, connection == Connection::Ptu))
                    .default_open(group.first_open(connection))
                    .open((!sought.is_empty()).then_some(true))
                    .show_unindented(ui, |ui| show(ui, group, forms, setup, hand));
            }
            follow_focus(ui);
        });
}

/// Scrolls the page to the field that has just got the keyboard focus.
fn follow_focus(ui: &Ui) {
    let focused = ui.memory(|memory| memory.focused());
    let response = focused.and_then(|id| ui.ctx().read_response(id));
    if let Some(response) = response.filter(|response| response.gained_focus())
        && response.layer_id == ui.layer_id()
        && ui.min_rect().contains_rect(response.rect)
    {
        ui.scroll_to_rect(response.rect, None);
    }
}

fn show(
    ui: &mut Ui,
    group: Group,
    forms: &mut Forms,
    setup: &BenchSetup,
    hand: &mut StimulusPanel<'_>,
) {
    let (config, line) = (&setup.config.content, &setup.line.content);
    match group {
        Group::TestBoard => test_board::show(ui, forms, config, line, hand),
        Group::Atp => atp::show(ui, &mut forms.code, config, hand),
        Group::Speed => speed::show(ui, &mut forms.motion, hand),
        Group::Markers => markers::show(ui, &mut forms.markers, line, hand),
        Group::Twc => twc::show(ui, &mut forms.station, line, hand),
        Group::Lines => lines::show(ui, hand),
        Group::Controller => controller::show(ui, &mut forms.train, hand),
        Group::Tcms => tcms::show(ui, &mut forms.train, &setup.train, hand),
    }
}
