//! Work that takes minutes, on a thread of its own: its progress, a button that stops it, and its result.

use std::sync::{Arc, Mutex};

use eframe::egui::{RichText, Ui};

use crate::query_worker::QueryWorker;
use crate::request::Request;
use crate::{DataPaths, PageContext, Palette};
use ptu_report::words::Words;
use ptu_runs::bench_worker::Wake;
use ptu_runs::failure::{Failure, Trouble};
use ptu_runs::pool::held;
use ptu_runs::stop::Stop;

/// Result of work, in words.
pub struct Done {
    pub text: String,
    pub notes: Vec<String>,
    /// Reason for which the work was not completed; none = completed.
    pub broken_off: Option<Trouble>,
}

impl Done {
    /// Result of work that was completed.
    pub fn all(text: String, notes: Vec<String>) -> Self {
        Self {
            text,
            notes,
            broken_off: None,
        }
    }
}

/// The work, while it goes on and after it.
#[derive(Default)]
pub struct Job {
    thread: Option<QueryWorker>,
    under_way: Request<Done>,
    told: Told,
    done: Option<Done>,
}

/// What window and work share: the stop, and the text of the progress.
#[derive(Clone, Default)]
pub struct Told {
    pub stop: Stop,
    said: Arc<Mutex<String>>,
    wake: Option<Wake>,
}

impl Told {
    /// Sets the text of the progress.
    pub fn say(&self, how_far: String) {
        *held(&self.said) = how_far;
        if let Some(wake) = &self.wake {
            wake();
        }
    }
}

impl Job {
    pub fn is_under_way(&self) -> bool {
        matches!(self.under_way, Request::Pending(_))
    }

    /// Begins the work; `said` is shown until the work tells its progress. Trouble is a message headed `failed`.
    pub fn begin(
        &mut self,
        context: &mut PageContext<'_>,
        (said, failed): (String, &str),
        work: impl FnOnce(&DataPaths, &Told) -> Result<Done, Failure> + Send + 'static,
    ) {
        let queries = context.queries;
        if self.thread.is_none() {
            match QueryWorker::new(queries.paths.clone(), queries.wake.clone()) {
                Ok(thread) => self.thread = Some(thread),
                Err(failure) => return context.messages.trouble(failed, failure.message),
            }
        }
        self.told = Told {
            stop: Stop::default(),
            said: Arc::new(Mutex::new(said)),
            wake: Some(queries.wake.clone()),
        };
        self.done = None;
        let told = self.told.clone();
        if let Some(thread) = &self.thread {
            self.under_way = Request::Pending(thread.run(move |paths| work(paths, &told)));
        }
    }

    /// Takes the result; true when the work has ended, completed or not.
    pub fn poll(&mut self, context: &mut PageContext<'_>, failed: &str) -> bool {
        let Some(done) = self.under_way.take(failed, context.messages) else {
            return false;
        };
        if let Some(why) = &done.broken_off {
            context.messages.trouble(failed, why.clone());
        }
        self.done = Some(done);
        true
    }

    /// Progress of the work, with a button that stops it, if it can be stopped.
    pub fn progress(&self, ui: &mut Ui, words: &Words, stops: bool) {
        ui.horizontal_wrapped(|ui| {
            ui.spinner();
            // The button stands before the text, whose length changes, so that the button does not move.
            if stops && ui.button(words.memory.stop).clicked() {
                self.told.stop.press_once();
            }
            ui.label(&*held(&self.told.said));
        });
    }

    /// Shows the last result.
    pub fn result(&self, ui: &mut Ui) {
        if let Some(done) = &self.done {
            if !done.text.is_empty() {
                ui.label(&done.text);
            }
            for note in &done.notes {
                ui.label(RichText::new(note).color(Palette::of(ui).warn));
            }
        }
    }
}
