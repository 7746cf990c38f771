//! Buttons for manual stimuli: enabled only while the stimulus is permitted, with the reason otherwise.

use protocol::signal::Signal;
use std::ops::RangeInclusive;

use btu_rig::procedure::plan::Connection;
use btu_rig::stimulus::{StationData, Stimulus};
use eframe::egui::emath::Numeric;
use eframe::egui::{
    Align, Button, Checkbox, ComboBox, DragValue, Id, Layout, Rect, Response, RichText, Role,
    Sense, Ui, WidgetInfo, vec2,
};

use crate::messages::told;
use crate::pages::bench::live_copy::BenchSnapshot;
use crate::{Messages, Palette};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::BenchWorker;

/// Width of a row's name, points.
const NAME: f32 = 94.0;
/// Gap between two buttons of a row, and between a button's edge and its text, points.
const GAP: f32 = 3.0;
const BESIDE: f32 = 5.0;

/// Stimuli that the page remembers, because no signal shows whether they are in force.
#[derive(Debug, Default)]
pub struct StimuliGiven {
    pub laid: Option<u16>,
    pub station: Option<StationData>,
}

/// Controls of one frame that give stimuli to the bench.
pub struct StimulusPanel<'a> {
    pub bench: &'a BenchWorker,
    /// The bench at the beginning of the frame.
    pub seen: &'a BenchSnapshot,
    pub words: &'static Words,
    pub messages: &'a mut Messages,
    pub given: &'a mut StimuliGiven,
}

impl StimulusPanel<'_> {
    pub fn connection(&self) -> Connection {
        self.bench.live().connection.unwrap_or(Connection::Btu)
    }

    /// A button that gives a stimulus; screen readers read its text.
    pub fn button(&mut self, ui: &mut Ui, text: &str, stimulus: Stimulus) {
        self.add(ui, Button::new(text), stimulus);
    }

    /// A button of a row; screen readers read the row's name and the text. Marked while its stimulus is in force.
    pub fn choice(
        &mut self,
        ui: &mut Ui,
        name: &str,
        text: &str,
        in_force: bool,
        stimulus: Stimulus,
    ) -> bool {
        let shown = if in_force {
            RichText::new(text).strong().underline()
        } else {
            RichText::new(text)
        };
        let button = Button::new(shown).selected(in_force);
        let response = self.add(ui, button, stimulus);
        let enabled = response.enabled();
        response.widget_info(|| {
            WidgetInfo::selected(Role::Button, enabled, in_force, format!("{name}: {text}"))
        });
        response.clicked()
    }

    /// A row of buttons; of each the text, whether its stimulus is in force, and the stimulus.
    pub fn choices<'t>(
        &mut self,
        ui: &mut Ui,
        name: &str,
        all: impl IntoIterator<Item = (&'t str, bool, Stimulus)>,
    ) {
        row(ui, name, |ui, _| {
            for (text, in_force, stimulus) in all {
                self.choice(ui, name, text, in_force, stimulus);
            }
        });
    }
    /// A row of buttons that bring a signal to each of its states, in their order.
    pub fn states(
        &mut self,
        ui: &mut Ui,
        name: &str,
        signal: Signal,
        stimuli: impl Iterator<Item = Stimulus>,
    ) {
        let texts = self.words.bench.states(signal).into_iter();
        let all = stimuli.zip(texts).enumerate();
        let seen = self.seen;
        let all =
            all.map(|(place, (stimulus, text))| (text, seen.is(signal, place as f64), stimulus));
        self.choices(ui, name, all);
    }
    /// A row of two buttons, on and off.
    pub fn switch(
        &mut self,
        ui: &mut Ui,
        name: &str,
        state: Option<bool>,
        stimulus: impl Fn(bool) -> Stimulus,
    ) {
        let words = &self.words.bench;
        let both = [(true, words.on), (false, words.off)];
        let both = both.map(|(on, text)| (text, state == Some(on), stimulus(on)));
        self.choices(ui, name, both);
    }

    /// Applies the stimulus, unless something has changed since the frame began.
    pub fn give(&mut self, stimulus: Stimulus) {
        match self.bench.apply(stimulus) {
            Ok(()) => match stimulus {
                Stimulus::MarkersAlong { section } => self.given.laid = section,
                Stimulus::Station(data) | Stimulus::PtuTwc(data) => {
                    self.given.station = Some(data);
                }
                _ => {}
            },
            Err(why) => {
                let what = stimulus.to_string();
                let text = fill(self.words.frame.not_done, &[("what", &what)]);
                self.messages
                    .trouble(text, told(self.words.bench.refusal(why)));
            }
        }
    }

    /// Whether a stimulus can be given now, or in words why not.
    pub fn may(&self, stimulus: &Stimulus) -> Result<(), &'static str> {
        let permitted = self.bench.permits(stimulus);
        permitted.map_err(|why| self.words.bench.refusal(why))
    }

    fn add(&mut self, ui: &mut Ui, button: Button<'_>, stimulus: Stimulus) -> Response {
        let may = self.may(&stimulus);
        let mut response = ui.add_enabled(may.is_ok(), button);
        if let Err(why) = may {
            response = response.on_disabled_hover_text(why);
        }
        if response.clicked() {
            self.give(stimulus);
        }
        response
    }
}

/// From now on only rows whose name contains `sought` are shown; a row without a name goes with the row before it.
pub fn seek(ui: &Ui, sought: &str) {
    ui.data_mut(|data| data.insert_temp(sought_id(), (sought.to_lowercase(), false)));
}

fn is_sought(ui: &Ui, name: &str) -> bool {
    ui.data_mut(|data| {
        let (sought, is_it) = data.get_temp_mut_or_default::<(String, bool)>(sought_id());
        if !name.is_empty() {
            *is_it = name.to_lowercase().contains(&**sought);
        }
        *is_it || sought.is_empty()
    })
}

fn sought_id() -> Id {
    Id::unique("sought stimuli")
}

/// A row with its name at the left.
pub fn row(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui, Id)) {
    if !is_sought(ui, name) {
        return;
    }
    ui.horizontal_top(|ui| {
        let height = ui.spacing().interact_size.y;
        let layout = Layout::left_to_right(Align::Center);
        let label = ui.allocate_ui_with_layout(vec2(NAME, height), layout, |ui| {
            ui.set_min_width(NAME);
            ui.label(RichText::new(name).color(Palette::of(ui).quiet))
        });
        ui.spacing_mut().item_spacing.x = GAP;
        ui.spacing_mut().button_padding.x = BESIDE;
        ui.horizontal_wrapped(|ui| add(ui, label.inner.id));
    });
}

/// The only input field of a row, for a number.
pub fn number<N: Numeric>(
    ui: &mut Ui,
    label: Id,
    value: &mut N,
    range: RangeInclusive<N>,
    unit: &str,
) -> Response {
    let suffix = if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    };
    let span = range.end().to_f64() - range.start().to_f64();
    let drag = DragValue::new(value)
        .range(range)
        .speed((span / 2_000.0).max(0.01))
        .max_decimals(if N::INTEGRAL { 0 } else { 2 })
        .suffix(suffix);
    ui.add(drag).labelled_by(label)
}

/// An input field for a number in a row of several; `name` is its tooltip and its name for screen readers.
pub fn named_number<N: Numeric>(
    ui: &mut Ui,
    name: &str,
    value: &mut N,
    range: RangeInclusive<N>,
    unit: &str,
) {
    let at = Rect::from_min_size(ui.cursor().min, vec2(0.0, 0.0));
    let label = ui.interact(at, ui.scope_id().with(name), Sense::hover());
    label.widget_info(|| WidgetInfo::labeled(Role::Label, true, name));
    number(ui, label.id, value, range, unit).on_hover_text(name);
}

/// A list from which one value is chosen.
pub fn one_of<T: PartialEq + Copy>(
    ui: &mut Ui,
    label: Id,
    value: &mut T,
    all: impl IntoIterator<Item = (T, String)>,
) {
    let all: Vec<_> = all.into_iter().collect();
    let chosen = all.iter().find(|(one, _)| one == value);
    let text = chosen.map_or("", |(_, text)| text.as_str());
    let combo = ComboBox::from_id_salt(label).selected_text(text);
    let response = combo.show_ui(ui, |ui| {
        for (one, text) in &all {
            ui.selectable_value(value, *one, text);
        }
    });
    response.response.labelled_by(label);
}

/// A checkbox.
pub fn check(ui: &mut Ui, text: &str, value: &mut bool) {
    ui.add(Checkbox::new(value, text));
}
