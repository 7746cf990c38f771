//! A button that reads what the chosen unit has stored: its log into the fault history, or its run record into traces.

use eframe::egui::{Button, RichText, Ui};

use crate::gui::query_worker::QueryWorker;
use crate::gui::request::Request;
use crate::gui::{DataPaths, PageContext, Palette};
use ptu_bench::bench_worker::Phase;
use ptu_bench::failure::Failure;
use ptu_bench::field::AskedUnit;
use ptu_bench::link::Endpoint;
use ptu_bench::record::pull_reading;
use ptu_bench::stop::Stop;
use ptu_report::words::{Words, fill};

/// What is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stored {
    /// The event log.
    #[default]
    Log,
    /// The record of automatic runs.
    Runs,
}

/// The button, and what becomes of it. Reading takes minutes: it has a thread of its own.
#[derive(Default)]
pub struct MemoryReader {
    stored: Stored,
    thread: Option<QueryWorker>,
    under_way: Request<Done>,
    stop: Stop,
    done: Option<Done>,
}

/// What a reading came to, in words.
struct Done {
    text: String,
    notes: Vec<String>,
    /// It was not read to its end: why.
    broken_off: Option<String>,
}

impl MemoryReader {
    /// A button for one of the two.
    pub fn of(stored: Stored) -> Self {
        Self {
            stored,
            ..Self::default()
        }
    }

    /// Shows it; true when something was stored.
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) -> bool {
        let stored = self.poll(context);
        let words = context.words;
        if matches!(self.under_way, Request::Pending(_)) {
            ui.horizontal(|ui| {
                ui.spinner();
                let unit = context.units.chosen().choice.endpoint.clone();
                ui.label(fill(words.memory.reading, &[("unit", &unit)]));
                if ui.button(words.memory.stop).clicked() {
                    self.stop.press_once();
                }
            });
            return stored;
        }
        let asked = asked(context);
        let text = match self.stored {
            Stored::Log => words.memory.import,
            Stored::Runs => words.memory.pull,
        };
        let button = ui.add_enabled(asked.is_ok(), Button::new(text));
        match asked {
            Ok(asked) if button.clicked() => self.begin(asked, context),
            Ok(_) => {}
            Err(why) => {
                button.on_disabled_hover_text(why);
            }
        }
        if let Some(done) = &self.done {
            ui.label(&done.text);
            for note in &done.notes {
                ui.label(RichText::new(note).color(Palette::of(ui).warn));
            }
        }
        stored
    }

    fn begin(&mut self, asked: AskedUnit, context: &mut PageContext<'_>) {
        let queries = context.queries;
        if self.thread.is_none() {
            match QueryWorker::new(queries.paths().clone(), queries.wake().clone()) {
                Ok(thread) => self.thread = Some(thread),
                Err(failure) => {
                    return context
                        .messages
                        .trouble(context.words.memory.failed, failure.message);
                }
            }
        }
        self.stop = Stop::default();
        self.done = None;
        let (stop, stored, words) = (self.stop.clone(), self.stored, context.words);
        if let Some(thread) = &self.thread {
            let reading = thread.run(move |paths| read(&asked, stored, paths, &stop, words));
            self.under_way = Request::Pending(reading);
        }
    }

    fn poll(&mut self, context: &mut PageContext<'_>) -> bool {
        if !self.under_way.poll() {
            return false;
        }
        let words = context.words;
        match std::mem::take(&mut self.under_way) {
            Request::Ready(done) => {
                if let Some(why) = &done.broken_off {
                    context.messages.trouble(words.memory.failed, why.clone());
                }
                self.done = Some(done);
                true
            }
            Request::Failed(why) => {
                context.messages.trouble(words.memory.failed, why);
                false
            }
            Request::Idle | Request::Pending(_) => false,
        }
    }
}

/// The chosen unit, if it can be read now; why it cannot otherwise.
fn asked(context: &PageContext<'_>) -> Result<AskedUnit, &'static str> {
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
    Ok(Done {
        text,
        notes: reading.warnings,
        broken_off: reading.read.broken_off,
    })
}
