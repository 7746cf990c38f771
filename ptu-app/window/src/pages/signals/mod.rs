//! Waveforms: a file or the sound card as the unit's receivers hear it, and a generator.

mod generator;
mod seen;
mod source;

use std::sync::Arc;

use eframe::egui::{CentralPanel, ScrollArea, Ui};

use crate::PageContext;
use crate::pages::signals::generator::Generator;
use crate::pages::signals::seen::{Slot, View};
use crate::pages::signals::source::Source;
use crate::parts::{Job, foot, form, segments};
use crate::request::Request;
use protocol::config::UnitConfig;
use ptu_runs::failure::Trouble;
use ptu_runs::pool::held;
use ptu_runs::sound::{self, DeviceFound};

struct Offered {
    unit: Arc<UnitConfig>,
    /// Sound devices, or why they cannot be listed.
    devices: Result<Vec<DeviceFound>, Trouble>,
}

#[derive(Default)]
pub struct SignalsPage {
    offered: Request<Offered>,
    /// The page generates a waveform instead of reading one.
    makes: bool,
    source: Source,
    generator: Generator,
    job: Job,
    seen: Slot,
    view: View,
}

impl SignalsPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.poll(context);
        form(ui, "signals", |ui| self.form(ui, context));
        let words = context.words;
        CentralPanel::default().show(ui, |ui| {
            match self.job.is_under_way() {
                true => self.job.progress(ui, words, true),
                false => self.job.result(ui),
            }
            match (&self.offered, self.makes) {
                (Request::Ready(offered), true) => {
                    self.generator.sketch(ui, &offered.unit, context);
                }
                _ => self.view.show(ui, words),
            }
        });
    }

    fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.offered.is_idle() {
            let unit_config = context.settings.unit.unit_config.clone();
            self.offered = Request::Pending(context.queries.run(move |paths| {
                Ok(Offered {
                    unit: Arc::new(paths.scripts.unit_config(&unit_config)?.content),
                    devices: sound::devices().map_err(|failure| failure.message),
                })
            }));
        }
        self.offered.poll();
        self.job.poll(context, context.words.signals.not_done);
        if let Some(seen) = held(&self.seen).take() {
            self.view.take(seen);
        }
    }

    /// Form of the file, the devices and the waveform; its main button stands at the foot.
    fn form(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let Some(offered) = self.offered.shown(ui, words) else {
            let is_failed = matches!(self.offered, Request::Failed(_));
            if is_failed && ui.button(words.common.refresh).clicked() {
                self.offered = Request::Idle;
            }
            return;
        };
        let unit = offered.unit.clone();
        let why_not = match (self.job.is_under_way(), context.settings.is_locked()) {
            (true, _) => Some(words.signals.under_way),
            (_, true) => Some(words.frame.locked),
            (false, false) => None,
        };
        let (asked, made) = foot(ui, "orders for signals", |ui| match self.makes {
            true => (None, self.generator.orders(ui, why_not, words)),
            false => (Source::orders(ui, why_not, words), None),
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if why_not.is_some() {
                ui.disable();
            }
            let both = [
                (false, words.signals.recording_of),
                (true, words.signals.generator),
            ];
            segments(ui, &mut self.makes, both);
            if self.makes {
                self.generator.fields(ui, &unit, words);
            }
            self.source.fields(ui, &offered.devices, self.makes, words);
        });
        if let Some(asked) = asked {
            self.seen = Slot::default();
            let slot = self.seen.clone();
            (self.source).begin(asked, (&mut self.job, slot), unit, context);
        } else if let Some(made) = made {
            self.source.begin_made(made, &mut self.job, unit, context);
        }
    }
}
