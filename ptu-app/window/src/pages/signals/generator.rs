//! The generator: a speed code or TWC frame with level and noise, a sketch of it, and buttons to save or play it.

use std::sync::Arc;

use eframe::egui::{Checkbox, Slider, Ui, vec2};
use protocol::config::UnitConfig;

use crate::PageContext;
use crate::parts::{
    ActionPlace, Face, Look, caption, drawings, path_edit, pick, segments, show_drawings,
};
use crate::request::FollowingResponse;
use ptu_report::signal::sketch;
use ptu_report::words::Words;
use ptu_runs::signal::{self, SAMPLE_HZ, Strength, Wave};

/// Width for the value beside a slider, points.
const VALUE: f32 = 72.0;
/// Length of the sketched waveform, s.
const SKETCHED_S: f64 = 0.5;
/// Height of the sketch, points.
const SKETCH: f32 = 320.0;
/// Longest duration of a speed code, s, and most bytes of a TWC frame.
const LONGEST_S: f64 = 600.0;
const MOST_BYTES: usize = 200;
const SEED: u64 = 1;

pub struct Generator {
    is_twc: bool,
    code: String,
    bytes: String,
    seconds: f64,
    level_mv: f64,
    noisy: bool,
    snr_db: f64,
    /// Beginning of the waveform, mV.
    sketch: FollowingResponse<(Wave, Strength), Vec<f32>>,
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
            sketch: FollowingResponse::default(),
        }
    }
}

/// Action on the generated waveform.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Order {
    Save,
    Play,
}

pub struct GeneratedSignal {
    pub wave: Wave,
    pub strength: Strength,
    pub order: Order,
}

impl Generator {
    /// Draws the buttons, play first; returns the waveform with the action that was chosen.
    pub fn orders(
        &self,
        ui: &mut Ui,
        why_not: Option<&str>,
        words: &Words,
    ) -> Option<GeneratedSignal> {
        let said = &words.signals;
        let wave = self.wave();
        let why_not = why_not.or_else(|| wave.is_none().then_some(said.bytes_hint));
        let mut order = None;
        let place = ActionPlace::new(ui, "orders of a generator", ());
        ui.horizontal(|ui| {
            let play = Face::new(Look::Primary, said.play).because(why_not);
            if place.clicked(&play.show(ui)) {
                order = Some(Order::Play);
            }
            let save = Face::new(Look::Secondary, said.save).hint(said.save_hint);
            if place.clicked(&save.because(why_not).show(ui)) {
                order = Some(Order::Save);
            }
        });
        if let Some(why) = why_not {
            caption(ui, why);
        }
        Some(GeneratedSignal {
            wave: wave?,
            strength: self.strength(),
            order: order?,
        })
    }

    pub fn fields(&mut self, ui: &mut Ui, unit: &UnitConfig, words: &Words) {
        let said = &words.signals;
        let first = unit.codes.first();
        if !unit.codes.iter().any(|code| code.name == self.code) {
            self.code = first.map_or_else(String::new, |code| code.name.clone());
        }
        segments(ui, &mut self.is_twc, [(false, said.code), (true, said.twc)]);
        let wide = ui.available_width();
        if self.is_twc {
            let label = caption(ui, said.bytes);
            let edit = path_edit(&mut self.bytes, wide).char_limit(3 * MOST_BYTES);
            ui.add(edit).labelled_by(label.id);
        } else {
            caption(ui, said.code_name);
            let codes = unit.codes.iter();
            let codes = codes.map(|code| (code.name.clone(), code.name.clone()));
            pick(ui, (said.code_name, wide), &mut self.code, codes);
        }
        ui.spacing_mut().slider_width = wide - VALUE;
        let slider = |ui: &mut Ui, name: &str, slider: Slider<'_>| {
            let label = caption(ui, name);
            ui.add(slider).labelled_by(label.id);
        };
        let level = Slider::new(&mut self.level_mv, 1.0..=4_000.0).logarithmic(true);
        slider(ui, said.level, level.fixed_decimals(0));
        if !self.is_twc {
            let seconds = Slider::new(&mut self.seconds, 0.5..=LONGEST_S).logarithmic(true);
            slider(ui, said.seconds, seconds.fixed_decimals(1));
        }
        ui.add(Checkbox::new(&mut self.noisy, said.noise));
        if self.noisy {
            let snr = Slider::new(&mut self.snr_db, -10.0..=40.0).fixed_decimals(0);
            slider(ui, said.snr, snr);
        }
    }

    /// Draws the waveform.
    pub fn sketch(&mut self, ui: &mut Ui, unit: &Arc<UnitConfig>, context: &PageContext<'_>) {
        let Some(wave) = self.wave() else { return };
        let (wanted, unit) = ((wave, self.strength()), unit.clone());
        let make = move |_: &_, (wave, strength)| {
            let samples = signal::samples(&wave, &unit, strength)?;
            let count = (SKETCHED_S * f64::from(SAMPLE_HZ)) as usize;
            Ok(samples.take(count).map(|mv| mv as f32).collect())
        };
        self.sketch.keep_up((wanted, true), context, make);
        let plot = sketch(self.sketch.items(), f64::from(SAMPLE_HZ), context.words);
        let room = vec2(ui.available_width(), SKETCH);
        show_drawings(ui, &drawings(vec![plot], room), None);
    }

    fn strength(&self) -> Strength {
        Strength {
            level_mv: self.level_mv,
            snr_db: self.noisy.then_some(self.snr_db),
            seed: SEED,
        }
    }

    /// Waveform of the form; none if the form has no bytes.
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
