//! Waveforms: a file or the sound card as the unit's receivers hear it, and a generator.

mod generator;
mod seen;
mod source;

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{CentralPanel, RichText, ScrollArea, Ui};

use crate::pages::signals::generator::Generator;
use crate::pages::signals::seen::{Seen, View};
use crate::pages::signals::source::Source;
use crate::parts::{FirstHalf, Job};
use crate::request::Request;
use crate::{PageContext, Palette};
use protocol::config::UnitConfig;
use ptu_runs::failure::Trouble;
use ptu_runs::sound::{self, DeviceFound};

/// Where a thread that reads or records puts how it looks now.
type Slot = Arc<Mutex<Option<Seen>>>;

/// What there is to choose from.
struct Offered {
    unit: Arc<UnitConfig>,
    /// Devices for sound, or why there are none.
    devices: Result<Vec<DeviceFound>, Trouble>,
}

#[derive(Default)]
pub struct SignalsPage {
    offered: Request<Offered>,
    source: Source,
    generator: Generator,
    job: Job,
    seen: Slot,
    view: View,
}

impl SignalsPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.poll(context);
        let first = FirstHalf {
            name: "signals",
            width: 590.0,
            share: 0.5,
        };
        first.show(ui, |ui| {
            let area = ScrollArea::vertical().id_salt("signals of a file");
            area.auto_shrink(false)
                .show(ui, |ui| self.controls(ui, context));
        });
        CentralPanel::default().show(ui, |ui| {
            let area = ScrollArea::vertical().id_salt("signals drawn");
            area.auto_shrink(false)
                .show(ui, |ui| self.view.draw(ui, context.words));
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
        let seen = self
            .seen
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if let Some(seen) = seen {
            self.view.take(seen);
        }
    }

    fn controls(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let offered = match &self.offered {
            Request::Ready(offered) => offered,
            Request::Failed(why) => {
                ui.label(RichText::new(&*words.trouble(why)).color(Palette::of(ui).bad));
                if ui.button(words.common.refresh).clicked() {
                    self.offered = Request::Idle;
                }
                return;
            }
            Request::Idle | Request::Pending(_) => {
                ui.label(words.common.loading);
                return;
            }
        };
        let free = !self.job.is_under_way();
        let mut asked = None;
        ui.scope(|ui| {
            if !free || context.settings.locked {
                ui.disable();
            }
            self.source.show(ui, &offered.devices, words);
            asked = self.source.buttons(ui, words);
        });
        let unit = offered.unit.clone();
        if let Some(asked) = asked {
            self.seen = Slot::default();
            let slot = self.seen.clone();
            self.source
                .begin(asked, (&mut self.job, slot), unit.clone(), context);
        }
        if self.job.is_under_way() {
            self.job.progress(ui, words, true);
        } else {
            self.job.result(ui);
        }
        self.view.heard(ui, words);
        ui.separator();
        let made = self
            .generator
            .show(ui, &unit, free && !context.settings.locked, context);
        if let Some(made) = made {
            self.source.begin_made(made, &mut self.job, unit, context);
        }
    }
}
