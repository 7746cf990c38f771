//! Serial numbers as links to the history of the unit, train or part.

use eframe::egui::Ui;
use fault_db::RepairRecord;

use super::link;
use crate::Destination;
use ptu_report::words::{Words, fill};

/// A serial number as a link to the history of its unit, train or part.
pub fn serial_link(ui: &mut Ui, words: &Words, serial: &str, go_to: &mut Vec<Destination>) {
    let open = fill(words.life.open, &[("serial", &serial)]);
    if link(ui, serial).on_hover_text(open).clicked() {
        go_to.push(Destination::Life(serial.to_owned()));
    }
}

/// A repair in one line: `said` (the part), its serial numbers before and after, and what was done.
pub fn repair_line(
    ui: &mut Ui,
    words: &Words,
    said: &str,
    repair: &RepairRecord,
    go_to: &mut Vec<Destination>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.label(said);
        let mut number = |ui: &mut Ui, serial: &Option<String>| match serial {
            Some(serial) => serial_link(ui, words, serial, go_to),
            None => drop(ui.label("?")),
        };
        number(ui, &repair.serial_old);
        ui.label("→");
        number(ui, &repair.serial_new);
        ui.label(&repair.note);
    });
}
