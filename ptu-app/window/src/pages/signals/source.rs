//! Opens, records, saves and plays waveforms: the choice of file and device, and the work on them.

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::{RichText, Ui};
use protocol::config::UnitConfig;

use super::generator::{GeneratedSignal, Order};
use super::seen::{Seen, Slot};
use crate::parts::{Done, Face, Job, Look, caption, file_place, pick, usual_folder};
use crate::{PageContext, Palette};
use ptu_options::sound_file;
use ptu_report::words::{Words, fill};
use ptu_runs::failure::Trouble;
use ptu_runs::new_file::free_beside;
use ptu_runs::pool::held;
use ptu_runs::signal::{self, FULL_SCALE_MV, Receivers};
use ptu_runs::sound::{
    self, CHANNELS, Calibrations, DeviceFound, Direction, Lead, SAMPLE_HZ, Side,
};

/// Number of samples after which the picture is made again during a recording: half a second.
const AGAIN: usize = SAMPLE_HZ as usize / 2;

/// The chosen file and devices.
pub struct Source {
    file: String,
    input: String,
    output: String,
}

impl Default for Source {
    fn default() -> Self {
        let default = || sound::DEFAULT.to_owned();
        let file = usual_folder().join("signal.wav");
        Self {
            file: file.display().to_string(),
            input: default(),
            output: default(),
        }
    }
}

/// Action on the file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    Open,
    Record,
}

impl Source {
    /// Draws the fields for the file, and for the device that plays (`plays`) or records.
    pub fn fields(
        &mut self,
        ui: &mut Ui,
        devices: &Result<Vec<DeviceFound>, Trouble>,
        plays: bool,
        words: &Words,
    ) {
        let said = &words.signals;
        let wide = ui.available_width();
        let name = words.common.file;
        file_place(ui, &mut self.file, (name, name));
        let devices = match devices {
            Ok(devices) => devices,
            Err(why) => {
                let none = RichText::new(said.no_sound).color(Palette::of(ui).warn);
                ui.label(none).on_hover_text(words.trouble(why));
                return;
            }
        };
        let (name, chosen, direction) = match plays {
            true => (said.output, &mut self.output, Direction::Output),
            false => (said.input, &mut self.input, Direction::Input),
        };
        let of = devices.iter().filter(|of| of.direction == direction);
        let offered = std::iter::once(sound::DEFAULT).chain(of.map(|of| of.name.as_str()));
        caption(ui, name);
        let offered = offered.map(|device| (device.to_owned(), device));
        pick(ui, (name, wide), chosen, offered);
    }

    pub fn orders(ui: &mut Ui, why_not: Option<&str>, words: &Words) -> Option<Asked> {
        let mut asked = None;
        ui.horizontal(|ui| {
            let open = Face::new(Look::Primary, words.signals.open).because(why_not);
            if open.show(ui).clicked() {
                asked = Some(Asked::Open);
            }
            let record = Face::new(Look::Secondary, words.signals.record);
            let record = record.hint(words.signals.record_hint).because(why_not);
            if record.show(ui).clicked() {
                asked = Some(Asked::Record);
            }
        });
        if let Some(why) = why_not {
            caption(ui, why);
        }
        asked
    }

    /// Begins to read or record, and puts the pictures into the slot.
    pub fn begin(
        &self,
        asked: Asked,
        (job, slot): (&mut Job, Slot),
        unit: Arc<UnitConfig>,
        context: &mut PageContext<'_>,
    ) {
        let words = context.words;
        let (file, device) = (PathBuf::from(self.file.trim()), self.input.clone());
        let told = (words.common.loading.to_owned(), words.signals.not_done);
        job.begin(context, told, move |_, told| {
            let show = |(reading, pictures), how_far: String| {
                let seen = Seen { reading, pictures };
                *held(&slot) = Some(seen);
                told.say(how_far);
            };
            if asked == Asked::Open {
                let read = signal::read_and_picture(&file, &unit, FULL_SCALE_MV)?;
                show(read, String::new());
                return Ok(Done::all(String::new(), Vec::new()));
            }
            let file = free_beside(&file);
            let known = Calibrations::load(&sound_file()?)?;
            let full_scale_mv = known.full_scale_mv(&device, Direction::Input);
            let mut receivers = Receivers::new(CHANNELS, f64::from(SAMPLE_HZ), &unit, true);
            let mut waiting = vec![Vec::new(); CHANNELS];
            let mut count = 0;
            let device_of = (device.as_str(), full_scale_mv);
            let mut hear = |block: &[Vec<f32>]| {
                for (waiting, block) in waiting.iter_mut().zip(block) {
                    waiting.extend_from_slice(block);
                }
                if waiting[0].len() < AGAIN {
                    return;
                }
                let now: Vec<Vec<f32>> = waiting
                    .iter_mut()
                    .map(|waiting| waiting.drain(..AGAIN).collect())
                    .collect();
                receivers.take(&now);
                count += AGAIN;
                let so_far = format!("{:.1} s", count as f64 / f64::from(SAMPLE_HZ));
                let how_far = fill(words.signals.recording, &[("time", &so_far)]);
                show(receivers.so_far(), how_far);
            };
            let recorded = sound::record_to_file(&file, device_of, None, &told.stop, &mut hear)?;
            receivers.take(&waiting);
            show(receivers.end(None), String::new());
            let seconds = format!("{:.2}", recorded.seconds);
            let file = file.display().to_string();
            let mut notes = uncalibrated(&known, &device, Direction::Input, words);
            for (channel, clipped) in Side::ALL.into_iter().zip(recorded.clipped) {
                if clipped > 0 {
                    let channel = name(channel);
                    let values: [(&str, &dyn std::fmt::Display); 2] =
                        [("n", &clipped), ("channel", &channel)];
                    notes.push(fill(words.signals.too_loud, &values));
                }
            }
            notes.extend(gaps(recorded.overruns, words));
            let text = fill(
                words.signals.recorded,
                &[("file", &file), ("time", &seconds)],
            );
            Ok(Done::all(text, notes))
        });
    }

    /// Begins to save or play the generated waveform.
    pub fn begin_made(
        &self,
        made: GeneratedSignal,
        job: &mut Job,
        unit: Arc<UnitConfig>,
        context: &mut PageContext<'_>,
    ) {
        let words = context.words;
        let (file, device) = (PathBuf::from(self.file.trim()), self.output.clone());
        let told = (words.signals.playing.to_owned(), words.signals.not_done);
        job.begin(context, told, move |_, told| {
            let GeneratedSignal {
                wave,
                strength,
                order,
            } = made;
            if order == Order::Save {
                let path = free_beside(&file);
                let made = signal::make(&wave, &unit, strength, (&path, FULL_SCALE_MV))?;
                let path = path.display().to_string();
                let clipped = cut_off(made.clipped, words);
                return Ok(Done::all(
                    fill(words.common.saved, &[("file", &path)]),
                    clipped.into_iter().collect(),
                ));
            }
            let known = Calibrations::load(&sound_file()?)?;
            let full_scale_mv = known.full_scale_mv(&device, Direction::Output);
            let samples = signal::samples(&wave, &unit, strength)?;
            let side = match wave {
                signal::Wave::Code { .. } => Side::Atp,
                signal::Wave::Twc(_) | signal::Wave::Marker { .. } => Side::Twc,
            };
            let lead = match side {
                Side::Atp => Lead::Within,
                Side::Twc => Lead::of_twc(&unit, strength.level_mv),
            };
            let on_one =
                samples.map(move |mv| Side::ALL.map(|of| if of == side { mv } else { 0.0 }));
            let played = sound::play(on_one, lead, (&device, full_scale_mv), &told.stop)?;
            let mut notes = uncalibrated(&known, &device, Direction::Output, words);
            notes.extend(cut_off(played.clipped, words));
            notes.extend(gaps(played.underruns, words));
            let seconds = format!("{:.2}", played.seconds);
            Ok(Done::all(
                fill(words.signals.played, &[("time", &seconds)]),
                notes,
            ))
        });
    }
}

fn cut_off(clipped: u64, words: &Words) -> Option<String> {
    (clipped > 0).then(|| fill(words.signals.cut_off, &[("n", &clipped)]))
}

fn gaps(count: u64, words: &Words) -> Option<String> {
    (count > 0).then(|| fill(words.signals.gaps, &[("n", &count)]))
}

fn name(channel: Side) -> &'static str {
    match channel {
        Side::Atp => "ATP",
        Side::Twc => "TWC",
    }
}

/// Note that names the channels without a calibration, if there are any.
fn uncalibrated(
    known: &Calibrations,
    device: &str,
    direction: Direction,
    words: &Words,
) -> Vec<String> {
    let without = Side::ALL
        .into_iter()
        .filter(|side| known.of(device, direction, *side).is_none());
    let without: Vec<_> = without.map(name).collect();
    match without.is_empty() {
        true => Vec::new(),
        false => vec![fill(
            words.signals.uncalibrated,
            &[("device", &device), ("channels", &without.join(", "))],
        )],
    }
}
