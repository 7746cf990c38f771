//! The generator: a code or TWC with level and noise, how it looks, and the orders to save or play it.

use std::sync::Arc;

use eframe::egui::{Button, Checkbox, ComboBox, Slider, TextEdit, Ui, vec2};
use protocol::config::UnitConfig;

use crate::PageContext;
use crate::parts::{drawings, named_combo, show_drawings};
use crate::request::CachedResponse;
use ptu_report::signal::sketch;
use ptu_report::words::Words;
use ptu_runs::signal::{self, SAMPLE_HZ, Strength, Wave};

/// Width of a slider, points.
const WIDE: f32 = 150.0;
/// How much of a waveform is sketched, s.
const SKETCHED_S: f64 = 0.5;
/// Height of the sketch, points.
const SKETCH: f32 = 180.0;
/// Longest code, s, and most bytes.
const LONGEST_S: f64 = 600.0;
const MOST_BYTES: usize = 200;
const SEED: u64 = 1;

/// What is filled in.
pub struct Generator {
    is_twc: bool,
    code: String,
    bytes: String,
    seconds: f64,
    level_mv: f64,
    noisy: bool,
    snr_db: f64,
    sketch: Sketch,
}

/// How it looks, and what it is the look of.
#[derive(Default)]
struct Sketch {
    of: Option<(Wave, Strength)>,
    samples: CachedResponse<Vec<f32>>,
}

impl Default for Generator {
    fn default() -> Self {
        Self {
            is_twc: false,
            code: String::new(),
            bytes: "01 fe 3c".to_owned(),
            seconds: 10.0,
            level_mv: 500.0,
            noisy: false,
            snr_db: 20.0,
            sketch: Sketch::default(),
        }
    }
}

/// What is done with what was made.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Order {
    Save,
    Play,
}

/// What is to be made.
pub struct Made {
    pub wave: Wave,
    pub strength: Strength,
    pub order: Order,
}

impl Generator {
    /// Sliders, sketch and buttons; what is ordered.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        unit: &Arc<UnitConfig>,
        free: bool,
        context: &PageContext<'_>,
    ) -> Option<Made> {
        let words = context.words;
        ui.strong(words.signals.generator);
        self.fields(ui, unit, words);
        let wave = self.wave();
        let strength = Strength {
            level_mv: self.level_mv,
            snr_db: self.noisy.then_some(self.snr_db),
            seed: SEED,
        };
        let mut order = None;
        ui.horizontal(|ui| {
            let may = free && wave.is_some();
            if ui
                .add_enabled(may, Button::new(words.signals.play))
                .clicked()
            {
                order = Some(Order::Play);
            }
            let save = ui.add_enabled(may, Button::new(words.signals.save));
            if save.on_hover_text(words.signals.save_hint).clicked() {
                order = Some(Order::Save);
            }
        });
        let Some(wave) = wave else {
            ui.label(words.signals.bytes_hint);
            return None;
        };
        self.sketch.show(ui, (&wave, strength), unit, context);
        order.map(|order| Made {
            wave,
            strength,
            order,
        })
    }

    fn fields(&mut self, ui: &mut Ui, unit: &UnitConfig, words: &Words) {
        let said = &words.signals;
        ui.spacing_mut().slider_width = WIDE;
        if !unit.codes.iter().any(|code| code.name == self.code) {
            self.code = unit
                .codes
                .first()
                .map_or_else(String::new, |code| code.name.clone());
        }
        ui.horizontal_wrapped(|ui| {
            ui.selectable_value(&mut self.is_twc, false, said.code);
            ui.selectable_value(&mut self.is_twc, true, said.twc);
            if self.is_twc {
                let label = ui.label(said.bytes);
                let edit = TextEdit::singleline(&mut self.bytes).char_limit(3 * MOST_BYTES);
                ui.add(edit.desired_width(WIDE)).labelled_by(label.id);
                return;
            }
            let combo = ComboBox::from_id_salt("speed code").selected_text(&self.code);
            let combo = combo.show_ui(ui, |ui| {
                for code in &unit.codes {
                    ui.selectable_value(&mut self.code, code.name.clone(), &code.name);
                }
            });
            named_combo(&combo.response, said.code_name, &self.code);
        });
        let slider = |ui: &mut Ui, name: &str, slider: Slider<'_>| {
            ui.horizontal_wrapped(|ui| {
                let label = ui.label(name);
                ui.add(slider).labelled_by(label.id);
            });
        };
        let level = Slider::new(&mut self.level_mv, 1.0..=4_000.0).logarithmic(true);
        slider(ui, said.level, level.fixed_decimals(0));
        if !self.is_twc {
            let seconds = Slider::new(&mut self.seconds, 0.5..=LONGEST_S).logarithmic(true);
            slider(ui, said.seconds, seconds.fixed_decimals(1));
        }
        ui.horizontal_wrapped(|ui| {
            ui.add(Checkbox::new(&mut self.noisy, said.noise));
            let snr = Slider::new(&mut self.snr_db, -10.0..=40.0).fixed_decimals(0);
            let label = ui.label(said.snr);
            ui.add_enabled(self.noisy, snr).labelled_by(label.id);
        });
    }

    /// What is filled in; none if the bytes are none.
    fn wave(&self) -> Option<Wave> {
        if !self.is_twc {
            return Some(Wave::Code {
                name: self.code.clone(),
                seconds: self.seconds,
            });
        }
        let bytes = signal::bytes_of(&self.bytes).ok()?;
        (bytes.len() <= MOST_BYTES).then_some(Wave::Twc(bytes))
    }
}

impl Sketch {
    fn show(
        &mut self,
        ui: &mut Ui,
        (wave, strength): (&Wave, Strength),
        unit: &Arc<UnitConfig>,
        context: &PageContext<'_>,
    ) {
        let now = (wave.clone(), strength);
        if self.of.as_ref() != Some(&now) {
            let (unit, (wave, strength)) = (unit.clone(), now.clone());
            self.samples.request(context.queries.run(move |_| {
                let samples = signal::samples(&wave, &unit, strength)?;
                let count = (SKETCHED_S * f64::from(SAMPLE_HZ)) as usize;
                Ok(samples.take(count).map(|mv| mv as f32).collect())
            }));
            self.of = Some(now);
        }
        self.samples.poll();
        let samples = self.samples.items();
        let plot = sketch(samples, f64::from(SAMPLE_HZ), context.words);
        let room = vec2(ui.available_width(), SKETCH);
        show_drawings(ui, &drawings(vec![plot], room), None);
    }
}
