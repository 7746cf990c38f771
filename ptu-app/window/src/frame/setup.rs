//! The form of the bench choice: endpoint, line, unit configuration, train and injected faults.

use btu_rig::rig::Harness;
use eframe::egui::{
    ComboBox, DragValue, Grid, Id, Key, Label, PopupCloseBehavior, Pos2, RichText, Role,
    ScrollArea, TextEdit, Ui, WidgetInfo, Window,
};

use crate::parts::{field, go_on, name_edit, named_combo};
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::words::Words;
use ptu_runs::bench_worker::Phase;
use ptu_runs::link::ports;
use ptu_runs::run::BenchChoice;

/// A window so wide has the faults beside what else is set up, points.
const BESIDE: f32 = 1000.0;
/// Width of the faults, and of the field that finds one.
const FAULTS: f32 = 430.0;
const FIND: f32 = 220.0;
/// Title and edges of the dialog, and the least height of what scrolls in it.
const AROUND: f32 = 60.0;
const LOWEST: f32 = 120.0;

struct Names {
    ports: Vec<String>,
    lines: Vec<String>,
    configs: Vec<String>,
    trains: Vec<String>,
    faults: Vec<(String, String)>,
}

/// The setup's own state.
#[derive(Default)]
pub struct Setup {
    names: Request<Names>,
    find: String,
    open: bool,
    opened: bool,
}

impl Setup {
    /// Where the unit is; what is around it behind a button.
    pub fn endpoint(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        if self.names.is_idle() {
            self.ask(context);
        }
        if self.names.poll()
            && let Request::Failed(why) = &self.names
        {
            context
                .messages
                .trouble(context.words.frame.cannot_list, why.clone());
        }
        let free = context.units.chosen().phase() == Phase::Offline && ui.is_enabled();
        let words = context.words;
        let choice = &mut context.units.chosen_mut().choice;
        let shown = if choice.is_simulated() {
            words.frame.simulated.to_owned()
        } else {
            choice.endpoint.clone()
        };
        let mut opened = false;
        let mut below = ui.cursor().min;
        ui.add_enabled_ui(free, |ui| {
            let combo = ComboBox::from_id_salt("endpoint")
                .selected_text(&shown)
                .width(150.0);
            let combo = combo.close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            let response = combo.show_ui(ui, |ui| self.endpoints(ui, words, choice));
            named_combo(&response.response, words.common.unit, &shown);
            opened = response.response.clicked();
            let setup = ui.selectable_label(self.open, words.frame.setup);
            if setup.clicked() {
                self.open = !self.open;
                self.opened = self.open;
            }
            below = setup.rect.left_bottom();
        });
        if opened {
            self.ask(context);
        }
        self.open &= free;
        if self.open {
            self.window(ui, below, context);
        }
    }

    /// A window rather than a menu: lists open over it, and several things are chosen before it is closed.
    fn window(&mut self, ui: &Ui, below: Pos2, context: &mut PageContext<'_>) {
        let words = context.words;
        let mut open = !ui.input(|input| input.key_pressed(Key::Escape));
        let choice = &mut context.units.chosen_mut().choice;
        let depot = &mut context.settings.depot;
        let screen = ui.ctx().content_rect();
        let high = (screen.bottom() - below.y - AROUND).max(LOWEST);
        Window::new(words.frame.setup)
            .id(Id::unique("setup"))
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .default_pos(below)
            .show(ui.ctx(), |ui| {
                if screen.width() >= BESIDE && choice.is_simulated() {
                    ui.horizontal_top(|ui| {
                        ui.vertical(|ui| self.surroundings(ui, words, choice, depot));
                        ui.separator();
                        ui.vertical(|ui| self.injected(ui, words, choice, Some(high)));
                    });
                    return;
                }
                let area = ScrollArea::vertical().max_height(high);
                area.min_scrolled_height(high).show(ui, |ui| {
                    self.surroundings(ui, words, choice, depot);
                    if choice.is_simulated() {
                        ui.separator();
                        self.injected(ui, words, choice, None);
                    }
                });
            });
        self.open = open;
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

    fn endpoints(&self, ui: &mut Ui, words: &Words, choice: &mut BenchChoice) {
        ui.set_min_width(260.0);
        let endpoint = &mut choice.endpoint;
        if ui
            .selectable_value(endpoint, "sim".into(), words.frame.simulated)
            .clicked()
        {
            ui.close();
        }
        for port in self
            .names
            .value()
            .map(|names| &names.ports)
            .into_iter()
            .flatten()
        {
            let value = format!("serial:{port}");
            if ui.selectable_value(endpoint, value, port).clicked() {
                ui.close();
            }
        }
        let label = ui.label(words.frame.other_port);
        ui.add(TextEdit::singleline(endpoint).desired_width(250.0))
            .labelled_by(label.id);
    }

    fn surroundings(
        &mut self,
        ui: &mut Ui,
        words: &Words,
        choice: &mut BenchChoice,
        depot: &mut String,
    ) {
        let frame = &words.frame;
        ui.set_min_width(430.0);
        let none = Vec::new();
        let names = self.names.value();
        let of = |pick: fn(&Names) -> &Vec<String>| names.map_or(&none, pick);
        Grid::new("surroundings").num_columns(2).show(ui, |ui| {
            ui.label(frame.connection_kind);
            ui.horizontal(|ui| {
                for (harness, text) in [
                    (Harness::Auto, frame.harness_auto),
                    (Harness::Bench, frame.as_btu),
                    (Harness::None, frame.as_ptu),
                ] {
                    ui.selectable_value(&mut choice.harness, harness, text);
                }
            });
            ui.end_row();
            pick(ui, frame.line, &mut choice.line, of(|names| &names.lines));
            let configs = of(|names| &names.configs);
            pick(ui, frame.unit_config, &mut choice.unit_config, configs);
            pick(
                ui,
                frame.train,
                &mut choice.train,
                of(|names| &names.trains),
            );
            let serial = field(ui, frame.serial, name_edit(&mut choice.serial, 140.0));
            let train_no = name_edit(&mut choice.train_no, 140.0);
            let train_no = field(ui, words.common.train_no, train_no);
            go_on(ui, &[serial, train_no]);
            // It stays with the window, whatever unit is chosen.
            field(ui, words.report.depot, name_edit(depot, 140.0));
            if choice.is_simulated() {
                let label = ui.label(frame.seed);
                ui.horizontal(|ui| {
                    ui.add(DragValue::new(&mut choice.seed))
                        .labelled_by(label.id);
                    ui.checkbox(&mut choice.scatter, frame.scatter);
                });
                ui.end_row();
            }
        });
        if choice.is_simulated() {
            ui.checkbox(&mut choice.realtime, frame.realtime);
        }
    }

    /// The injected faults, each with a button that takes it out, and all there are: in a list of its own that ends at
    /// this height, or as a part of what scrolls already.
    fn injected(
        &mut self,
        ui: &mut Ui,
        words: &Words,
        choice: &mut BenchChoice,
        high: Option<f32>,
    ) {
        let top = ui.cursor().top();
        ui.set_width(FAULTS);
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
            let label = ui.label(frame.find);
            let find = ui.add(TextEdit::singleline(&mut self.find).desired_width(FIND));
            // What is mostly wanted can be typed at once.
            if std::mem::take(&mut self.opened) {
                find.request_focus();
            }
            find.labelled_by(label.id);
        });
        let Some(high) = high else {
            return self.all_faults(ui, words, choice);
        };
        let left = (high - (ui.cursor().top() - top)).max(LOWEST);
        let area = ScrollArea::vertical().max_height(left).auto_shrink(false);
        let area = area.min_scrolled_height(left);
        area.show(ui, |ui| self.all_faults(ui, words, choice));
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

fn pick(ui: &mut Ui, label: &str, chosen: &mut String, names: &[String]) {
    ui.label(label);
    let before = chosen.clone();
    let combo = ComboBox::from_id_salt(label).selected_text(&before);
    let shown = combo.show_ui(ui, |ui| {
        for name in names {
            ui.selectable_value(chosen, name.clone(), name);
        }
    });
    named_combo(&shown.response, label, &before);
    ui.end_row();
}
