//! A button that reads what the chosen unit has stored: its log into the fault history, or its run record into traces.

use eframe::egui::Ui;

use super::{Done, Face, Job, Look, more};
use crate::{DataPaths, PageContext};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::Phase;
use ptu_runs::failure::Failure;
use ptu_runs::link::Endpoint;
use ptu_runs::record::pull_reading;
use ptu_runs::stop::Stop;
use ptu_runs::unit_log::AskedUnit;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stored {
    Log,
    /// The record of automatic runs.
    Runs,
}

/// The button, and the work that it begins. Reading takes minutes and has a thread of its own.
#[derive(Default)]
pub struct MemoryReader {
    job: Job,
}

impl MemoryReader {
    /// Shows the button that reads `stored`; true when a reading has ended, completed or not.
    pub fn show(&mut self, ui: &mut Ui, stored: Stored, context: &mut PageContext<'_>) -> bool {
        let has_stored = self.job.poll(context, context.words.memory.failed);
        let words = context.words;
        if self.job.is_under_way() {
            self.job.progress(ui, words, true);
            return has_stored;
        }
        let asked = asked(context);
        let text = match stored {
            Stored::Log => words.memory.import,
            Stored::Runs => words.memory.pull,
        };
        let face = Face::new(Look::Secondary, text).off(asked.as_ref().err().copied());
        let clicked = more(ui, words.memory.title, |ui| {
            let clicked = face.show(ui).clicked();
            if clicked {
                ui.close();
            }
            clicked
        });
        if let (Some(true), Ok(asked)) = (clicked, asked) {
            let unit = context.units.chosen().choice.endpoint.clone();
            let said = fill(words.memory.reading, &[("unit", &unit)]);
            self.job
                .begin(context, (said, words.memory.failed), move |paths, told| {
                    read(&asked, stored, paths, &told.stop, words)
                });
        }
        self.job.result(ui);
        has_stored
    }
}

/// The chosen unit, if it can be read now; else the reason why not.
fn asked(context: &PageContext<'_>) -> Result<AskedUnit, &'static str> {
    if let Some(why) = context.only_reads() {
        return Err(why);
    }
    let unit = context.units.chosen();
    let on_port = unit.choice.endpoint.parse::<Endpoint>();
    let endpoint = on_port
        .ok()
        .filter(|endpoint| matches!(endpoint, Endpoint::Serial { .. } | Endpoint::Tcp(_)));
    let endpoint = endpoint.ok_or(context.words.memory.on_port_only)?;
    if unit.phase() != Phase::Offline {
        return Err(context.words.memory.disconnect_first);
    }
    let choice = &unit.choice;
    Ok(AskedUnit {
        endpoint,
        serial: (!choice.serial.is_empty()).then(|| choice.serial.clone()),
        unit_config: choice.unit_config.clone(),
        line: choice.line.clone(),
        train: choice.train_no.clone(),
        operator: context.settings.operator.clone(),
    })
}

fn read(
    asked: &AskedUnit,
    stored: Stored,
    paths: &DataPaths,
    stop: &Stop,
    words: &Words,
) -> Result<Done, Failure> {
    let mut reading = asked.read(&paths.scripts, stored == Stored::Runs, stop)?;
    let store = paths.open()?;
    let unit = reading.source.serial.clone();
    let text = match stored {
        Stored::Log => {
            let log = reading.import(&store, None)?;
            fill(
                words.memory.imported,
                &[
                    ("unit", &unit),
                    ("entries", &reading.read.entries.len()),
                    ("new", &log.imported.new.len()),
                    ("known", &log.imported.known),
                ],
            )
        }
        Stored::Runs => {
            let pulled = pull_reading(&store, &reading)?;
            let rows = reading
                .read
                .stored
                .as_ref()
                .map_or(0, |stored| stored.rows.len());
            fill(
                words.memory.pulled,
                &[
                    ("unit", &unit),
                    ("rows", &rows),
                    ("new", &pulled.new.len()),
                    ("known", &pulled.known),
                ],
            )
        }
    };
    store.close()?;
    let broken_off = reading.complete().err().map(|why| why.message);
    Ok(Done {
        text,
        notes: reading.warnings,
        broken_off,
    })
}
