//! Dialog to choose the unit and its bench: endpoint, line, unit configuration, train and injected faults.

use btu_rig::rig::Harness;
use eframe::egui::{DragValue, Grid, Label, RichText, Role, ScrollArea, Ui, WidgetInfo};

use crate::parts::{
    Face, Look, dialog, field, find_edit, go_on, last_row, name_edit, pick, segments,
};
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::words::Words;
use ptu_runs::bench_worker::Phase;
use ptu_runs::link::ports;
use ptu_runs::run::BenchChoice;

/// Width of a field, points.
const FIELD: f32 = 220.0;
/// Height that the list of faults leaves to the rest of the dialog, and the list's least height, points.
const AROUND: f32 = 120.0;
const LOWEST: f32 = 120.0;

struct Names {
    ports: Vec<String>,
    lines: Vec<String>,
    configs: Vec<String>,
    trains: Vec<String>,
    faults: Vec<(String, String)>,
}

/// State of the dialog.
#[derive(Default)]
pub struct Setup {
    names: Request<Names>,
    find: String,
    open: bool,
    opened: bool,
    /// The second tab, for practice, is shown: injected faults.
    practice: bool,
}

impl Setup {
    pub fn open(&mut self) {
        self.open = true;
        self.opened = true;
        self.names = Request::Idle;
    }

    /// Shows the dialog while it is open; it closes when the unit is connected.
    pub fn show(&mut self, ui: &Ui, context: &mut PageContext<'_>) {
        self.open &= context.units.chosen().phase() == Phase::Offline;
        if !self.open {
            return;
        }
        if self.names.is_idle() {
            self.ask(context);
        }
        if self.names.poll()
            && let Request::Failed(why) = &self.names
        {
            let said = context.words.frame.cannot_list;
            context.messages.trouble(said, why.clone());
        }
        let words = context.words;
        let choice = &mut context.units.chosen_mut().choice;
        let mut done = false;
        let open = dialog(ui, "setup", words.frame.setup, |ui| {
            if choice.is_simulated() {
                let tabs = [
                    (false, words.frame.connection),
                    (true, words.frame.practice),
                ];
                segments(ui, &mut self.practice, tabs);
                ui.add_space(8.0);
            }
            match self.practice && choice.is_simulated() {
                true => self.injected(ui, words, choice),
                false => self.connection(ui, words, choice),
            }
            last_row(ui, |ui| {
                done = Face::new(Look::Primary, words.frame.close_anyway)
                    .show(ui)
                    .clicked();
            });
        });
        self.open = open && !done;
    }

    fn ask(&mut self, context: &PageContext<'_>) {
        self.names = Request::Pending(context.queries.run(|paths| {
            let scripts = &paths.scripts;
            let faults = scripts.faults()?.faults;
            Ok(Names {
                ports: ports::found()?.into_iter().map(|port| port.path).collect(),
                lines: scripts.line_names(),
                configs: scripts.unit_config_names(),
                trains: scripts.train_names(),
                faults: faults
                    .into_iter()
                    .map(|fault| (fault.id, fault.mode))
                    .collect(),
            })
        }));
    }

    fn connection(&mut self, ui: &mut Ui, words: &Words, choice: &mut BenchChoice) {
        let simulated = Some(("sim".to_owned(), words.frame.simulated.to_owned()));
        let found = self
            .names
            .value()
            .into_iter()
            .flat_map(|names| &names.ports);
        let ports = found.map(|port| (format!("serial:{port}"), port.clone()));
        ui.horizontal_wrapped(|ui| {
            for (value, name) in simulated.into_iter().chain(ports) {
                ui.selectable_value(&mut choice.endpoint, value, name);
            }
        });
        let label = ui.label(words.frame.other_port);
        let wide = ui.available_width();
        ui.add(name_edit(&mut choice.endpoint, wide))
            .labelled_by(label.id);
        ui.add_space(8.0);
        self.surroundings(ui, words, choice);
    }

    fn surroundings(&mut self, ui: &mut Ui, words: &Words, choice: &mut BenchChoice) {
        let frame = &words.frame;
        let none = Vec::new();
        let names = self.names.value();
        let of = |pick: fn(&Names) -> &Vec<String>| names.map_or(&none, pick);
        Grid::new("surroundings").num_columns(2).show(ui, |ui| {
            ui.label(frame.connection_kind);
            let ways = [
                (Harness::Auto, frame.harness_auto),
                (Harness::Bench, frame.as_btu),
                (Harness::None, frame.as_ptu),
            ];
            segments(ui, &mut choice.harness, ways);
            ui.end_row();
            row(ui, frame.line, &mut choice.line, of(|names| &names.lines));
            let configs = of(|names| &names.configs);
            row(ui, frame.unit_config, &mut choice.unit_config, configs);
            let trains = of(|names| &names.trains);
            row(ui, frame.train, &mut choice.train, trains);
            let serial = field(ui, frame.serial, name_edit(&mut choice.serial, FIELD));
            let train_no = name_edit(&mut choice.train_no, FIELD);
            let train_no = field(ui, words.common.train_no, train_no);
            go_on(ui, &[serial, train_no]);
        });
    }

    /// Draws the injected faults, each with a button to remove it, all fault modes, and the simulated unit's options.
    fn injected(&mut self, ui: &mut Ui, words: &Words, choice: &mut BenchChoice) {
        let frame = &words.frame;
        ui.label(RichText::new(frame.inject).strong());
        if choice.faults.is_empty() {
            ui.label(RichText::new(frame.none).color(Palette::of(ui).quiet));
        }
        choice.faults.retain(|fault| {
            let taken_out = ui.horizontal(|ui| {
                let button = ui.button("×").on_hover_text(frame.take_out);
                let name = format!("{}: {fault}", frame.take_out);
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
                ui.add(Label::new(RichText::new(fault).strong()).truncate());
                button.clicked()
            });
            !taken_out.inner
        });
        ui.horizontal(|ui| {
            let find = find_edit(ui, &mut self.find, frame.find, FIELD);
            // The search field has the keyboard at once, to type the name of a fault.
            if std::mem::take(&mut self.opened) {
                find.request_focus();
            }
        });
        let high = (ui.ctx().content_rect().height() / 2.0 - AROUND).max(LOWEST);
        let area = ScrollArea::vertical().max_height(high).auto_shrink(false);
        let area = area.min_scrolled_height(high);
        area.show(ui, |ui| self.all_faults(ui, words, choice));
        ui.separator();
        ui.horizontal_wrapped(|ui| {
            let label = ui.label(frame.seed);
            ui.add(DragValue::new(&mut choice.seed))
                .labelled_by(label.id);
            ui.checkbox(&mut choice.scatter, frame.scatter);
            ui.checkbox(&mut choice.realtime, frame.realtime);
        });
    }

    fn all_faults(&self, ui: &mut Ui, words: &Words, choice: &mut BenchChoice) {
        let known = self.names.value().map(|names| names.faults.as_slice());
        let wanted = self.find.trim().to_lowercase();
        for (id, mode) in known.unwrap_or_default() {
            let mode = words.content(mode);
            if !id.contains(&wanted) && !mode.to_lowercase().contains(&wanted) {
                continue;
            }
            let mut on = choice.faults.contains(id);
            let clicked = ui.horizontal(|ui| {
                let clicked = ui.checkbox(&mut on, id).clicked();
                let mode = RichText::new(mode).small().color(Palette::of(ui).quiet);
                ui.add(Label::new(mode).truncate());
                clicked
            });
            if clicked.inner {
                choice.faults.retain(|fault| fault != id);
                if on {
                    choice.faults.push(id.clone());
                }
            }
        }
    }
}

/// Draws a list to choose from, with its name before it.
fn row(ui: &mut Ui, name: &str, chosen: &mut String, names: &[String]) {
    ui.label(name);
    let names = names.iter().map(|name| (name.clone(), name.clone()));
    pick(ui, (name, FIELD), chosen, names);
    ui.end_row();
}
