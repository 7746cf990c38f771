//! The history of a unit, a train or a part, by its serial number.

use eframe::egui::{Grid, Key, RichText, ScrollArea, TextWrapMode, Ui};
use egui_material_icons::icons::{ICON_ARROW_BACK, ICON_SEARCH};
use fault_db::{Life, LifeEvent, LifeOf, LifeWhat};

use crate::page_context::Destination;
use crate::parts::{Face, Look, find_edit, link, rows, typed};
use crate::request::FollowingResponse;
use crate::{PageContext, Palette, Sizes};
use ptu_report::life;
use ptu_report::naming::PartNames;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

/// Width of the field, points.
const FIELD: f32 = 190.0;

/// The search field, and the histories that were found.
#[derive(Default)]
pub struct LifeView {
    typed: String,
    /// The serial number that is shown.
    of: Option<String>,
    found: FollowingResponse<String, (Vec<Life>, PartNames)>,
}

impl LifeView {
    /// Shows the history of the unit, train or part with this serial number.
    pub fn open(&mut self, serial: &str) {
        serial.clone_into(&mut self.typed);
        self.of = typed(serial);
    }

    /// Draws the search field and its button.
    pub fn search(&mut self, ui: &mut Ui, words: &Words) {
        let field = find_edit(ui, &mut self.typed, words.life.search, FIELD);
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let show = Face::new(Look::Quiet, "").icon(ICON_SEARCH);
        let show = show.named(words.life.show).hint(words.life.show);
        if show.show(ui).clicked() || entered {
            self.of = typed(&self.typed);
        }
    }

    /// Draws the history in place of the statistics; false if no serial number was entered.
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) -> bool {
        let Some(serial) = self.of.clone() else {
            return false;
        };
        let words = context.words;
        let wanted = (serial.clone(), false);
        self.found.keep_up(wanted, context, |paths, serial| {
            Ok((paths.read()?.lives(&serial)?, PartNames::of(&paths.scripts)))
        });
        let back = Face::new(Look::Quiet, words.life.back).icon(ICON_ARROW_BACK);
        if back.show(ui).clicked() {
            self.of = None;
        }
        let Some((lives, parts)) = self.found.get().value() else {
            if (self.found.get()).missing(ui, words, words.life.not_read) {
                self.found.read_again();
            }
            return true;
        };
        if lives.is_empty() {
            ui.label(fill(words.life.nothing, &[("serial", &serial)]));
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for life in lives {
                show(ui, (words, parts), life, context.go_to);
            }
        });
        true
    }
}

fn show(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    life: &Life,
    go_to: &mut Vec<Destination>,
) {
    ui.label(RichText::new(life::title(life, words)).size(Sizes::of(ui).title));
    if !life.stays.is_empty() {
        stays(ui, (words, parts), life, go_to);
    }
    ui.label(RichText::new(words.life.stored).strong());
    let count = life.events.len();
    rows(ui, ui.spacing().interact_size.y, count, |ui, range| {
        // The latest first, as in every list.
        for entry in life.events.iter().rev().skip(range.start).take(range.len()) {
            row(ui, (words, parts), (life.of, entry), go_to);
        }
    });
    ui.separator();
}

fn stays(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    life: &Life,
    go_to: &mut Vec<Destination>,
) {
    Grid::new((life.of.as_str(), &life.serial))
        .num_columns(4)
        .striped(true)
        .show(ui, |ui| {
            let quiet = Palette::of(ui).quiet;
            for name in [
                words.life.stays(life.of),
                words.life.from,
                words.life.until,
                words.life.runs,
            ] {
                ui.label(RichText::new(name).color(quiet));
            }
            ui.end_row();
            for stay in &life.stays {
                let [place, from, until, runs] = life::stay(life.of, stay, words, parts);
                let other = match life.of {
                    LifeOf::Unit => &stay.place,
                    LifeOf::Train | LifeOf::Part => &stay.unit,
                };
                if link(ui, place).clicked() {
                    go_to.push(Destination::Life(other.clone()));
                }
                ui.label(from);
                ui.label(until);
                ui.label(runs);
                ui.end_row();
            }
        });
}

/// One entry, which leads to its run or its fault.
fn row(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    (of, entry): (LifeOf, &LifeEvent),
    go_to: &mut Vec<Destination>,
) {
    let to = match &entry.what {
        LifeWhat::Run(run) => Some(Destination::Report(run.id)),
        LifeWhat::Fault(fault) => fault
            .faults
            .first()
            .map(|fault| Destination::Fault(fault.id)),
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(clock::local(entry.at_us)).color(Palette::of(ui).quiet));
        if of != LifeOf::Unit {
            ui.label(RichText::new(&entry.unit).strong());
        }
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        let said = life::happened(entry, words, parts);
        let row = ui.selectable_label(false, &said);
        // The tooltip has the whole text, which may be longer than the row.
        if row.on_hover_text(said).clicked() {
            go_to.extend(to);
        }
    });
}
