//! The window: takes what other threads have produced, then draws the frame and the page.

use std::path::PathBuf;
use std::time::Duration;

use eframe::egui::{self, CentralPanel, Context, Panel, ThemePreference, Ui, ViewportCommand};

use super::Page;
use super::data_paths::DataPaths;
use super::data_watch::DataWatch;
use super::frame::{Frame, only_look};
use super::messages::{About, Messages};
use super::page_context::Destination;
use super::page_context::PageContext;
use super::pages::Pages;
use super::query_worker::QueryWorker;
use super::settings::Settings;
use super::units::{Unit, Units};
use super::{fonts, theme};
use crate::messages::told;
use ptu_report::words::Words;
use ptu_runs::bench_worker::{Wake, Watched};
use ptu_runs::clock;
use ptu_runs::failure::Failure;
use ptu_runs::stop::Stop;

/// Interval at which a closing window looks whether all units are disconnected.
const CLOSING: Duration = Duration::from_millis(50);

/// Options with which a window is opened.
pub struct Options {
    /// Places of database and scripts.
    pub paths: DataPaths,
    /// Settings of the last time.
    pub settings: Settings,
    /// File in which the settings are saved; none = they are not saved.
    pub settings_file: Option<PathBuf>,
    /// Connect the unit at once.
    pub connect: bool,
    /// Pressed when the system asks the program to end.
    pub interrupted: Stop,
}

pub struct App {
    /// Thread for queries to the database and to files.
    pub queries: QueryWorker,
    database: DataWatch,
    /// A message has said that the database is gone.
    told_gone: bool,
    /// The units; public for programs that drive the window, such as tests.
    pub units: Units,
    pub settings: Settings,
    /// The operator's name in the previous frame.
    operator: String,
    saved: Settings,
    settings_file: Option<PathBuf>,
    messages: Messages,
    frame: Frame,
    pages: Pages,
    go_to: Vec<Destination>,
    closing: bool,
    /// The window may close: every run is recorded, every unit disarmed.
    pub closed: bool,
    /// A person has acknowledged that outputs were not confirmed safe.
    noted_not_safe: bool,
    /// Pressed when the system asks the program to end.
    interrupted: Stop,
}

impl App {
    /// A window before its first frame; `wake` requests a new frame.
    ///
    /// # Errors
    /// The system gives no threads.
    pub fn new(context: &Context, options: Options, wake: Wake) -> Result<Self, Failure> {
        fonts::set(context);
        theme::set(context);
        let settings = options.settings;
        let mut units = Units::new(settings.unit.clone(), wake.clone())?;
        let database = DataWatch::new(options.paths.clone(), wake.clone())?;
        let queries = QueryWorker::new(options.paths, wake)?;
        if options.connect {
            units.chosen_mut().connect(&queries);
        }
        Ok(Self {
            units,
            queries,
            database,
            told_gone: false,
            saved: settings.clone(),
            operator: settings.operator.clone(),
            settings,
            settings_file: options.settings_file,
            messages: Messages::default(),
            frame: Frame::default(),
            pages: Pages::default(),
            go_to: Vec::new(),
            closing: false,
            closed: false,
            noted_not_safe: false,
            interrupted: options.interrupted,
        })
    }

    pub fn show(&mut self, ui: &mut Ui) {
        self.follow_operator();
        let words = self.settings.language.words();
        self.units.lock(self.settings.is_locked());
        self.units.poll(words, &mut self.messages);
        self.tell_if_gone(words);
        self.apply_settings(ui.ctx());
        self.close_in_order(ui.ctx());
        let mut page_context = PageContext {
            words,
            queries: &self.queries,
            database: &self.database,
            units: &mut self.units,
            settings: &mut self.settings,
            messages: &mut self.messages,
            go_to: &mut self.go_to,
        };
        self.frame.keys(ui, &mut page_context);
        self.pages.poll(&mut page_context);
        self.frame.around(ui, &mut page_context);
        if page_context.units.chosen().waiting_run().is_some() && !page_context.settings.is_locked()
        {
            let goes_on = self.pages.procedures.goes_on(&page_context);
            Panel::top("lost").show(ui, |ui| self.frame.lost(ui, goes_on, &mut page_context));
        }
        if page_context.settings.is_locked() {
            Panel::top("locked").show(ui, |ui| self.frame.locked(ui, &mut page_context));
        }
        let page = page_context.settings.page;
        page_context.units.watch(match page {
            Page::Bench => Watched::All,
            Page::Procedures if page_context.settings.live_plot => Watched::Curves,
            _ => Watched::Bar,
        });
        let panel = match page {
            // The page's own panels reach to the edges.
            Page::Case => CentralPanel::no_frame(),
            _ => CentralPanel::default(),
        };
        panel.show(ui, |ui| {
            if page_context.settings.is_locked() {
                only_look(ui);
            }
            self.pages.show(page, ui, &mut page_context);
        });
        let procedures = match self.frame.find.open {
            true => self.pages.procedures.loaded(&page_context),
            false => &[],
        };
        // A dialog that was asked for is shown, and bars what is below, in the same frame.
        let asked = std::mem::take(page_context.go_to);
        asked.iter().for_each(|to| self.frame.go_to(to));
        self.frame.over(ui, procedures, &mut page_context);
        if self.closing {
            let not_safe = page_context.units.any_not_safe() && !self.noted_not_safe;
            self.noted_not_safe |= self.frame.closing(ui, words, not_safe);
        }
        let asked_over = std::mem::take(page_context.go_to);
        asked_over.iter().for_each(|to| self.frame.go_to(to));
        for to in asked.into_iter().chain(asked_over) {
            page_context.settings.page = self.pages.go_to(to, &mut page_context);
            ui.ctx().request_repaint();
        }
    }

    pub fn page(&self) -> Page {
        self.settings.page
    }

    /// Adds a message when the database is gone, and ends the message when the database is back.
    fn tell_if_gone(&mut self, words: &Words) {
        let gone = self.database.is_gone();
        if std::mem::replace(&mut self.told_gone, gone) == gone {
            return;
        }
        self.messages.over(About::Database);
        if gone {
            let file = self.queries.paths.database.display().to_string();
            self.messages
                .trouble_about(About::Database, words.frame.database_gone, told(file));
        }
    }

    /// Notes when the operator's name was written; a name from another shift is cleared, unless a run is under way.
    fn follow_operator(&mut self) {
        let now_us = clock::now_us();
        self.settings.note_operator(&self.operator, now_us);
        self.operator.clone_from(&self.settings.operator);
        let running = |unit: &Unit| unit.run.as_ref().is_some_and(|run| run.is_running());
        if !self.units.iter().any(running) {
            self.settings.forget_operator(now_us);
        }
    }

    fn apply_settings(&mut self, context: &Context) {
        let theme = match self.settings.dark {
            Some(true) => ThemePreference::Dark,
            Some(false) => ThemePreference::Light,
            None => ThemePreference::System,
        };
        if context.options(|options| options.theme_preference) != theme {
            context.set_theme(theme);
        }
        context.set_zoom_factor(self.settings.zoom.into());
        self.settings.density.keep(context);
    }

    /// Closes the window once runs are stopped and recorded, outputs safe and units disarmed.
    fn close_in_order(&mut self, context: &Context) {
        let asked = context.input(|input| input.viewport().close_requested());
        if (asked || self.interrupted.presses() > 0) && !self.closing {
            self.closing = true;
            self.save(context);
        }
        if !self.closing {
            return;
        }
        let let_go = self.units.close();
        // Before the window closes, a person acknowledges that outputs were not confirmed safe.
        let known = !self.units.any_not_safe() || self.noted_not_safe;
        if let_go && known {
            self.closed = true;
            context.send_viewport_cmd(ViewportCommand::Close);
        } else {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            context.request_repaint_after(CLOSING);
        }
    }

    fn save(&mut self, context: &Context) {
        self.settings.unit = self.units.chosen().choice.clone();
        let size =
            context.input(|input| input.viewport().inner_rect.map(|rect| rect.size().into()));
        self.settings.window_size = size.or(self.settings.window_size);
        if self.settings == self.saved {
            return;
        }
        let Some(file) = &self.settings_file else {
            return;
        };
        // If saving fails, the window closes all the same.
        if self.settings.save(file).is_ok() {
            self.saved = self.settings.clone();
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::ground(visuals).to_normalized_gamma_f32()
    }
}
