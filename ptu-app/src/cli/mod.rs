//! The command line: one file per verb.

mod campaign;
mod catalog;
mod completions;
mod config;
mod db;
mod diagnose;
mod doctor;
mod drive;
mod faults;
mod gui;
mod help;
mod help_files;
mod instrument;
mod keep;
mod key;
mod matrix;
mod new;
mod output;
mod ports;
mod questions;
mod record;
mod report;
mod reports;
mod run;
mod run_list;
mod runs;
mod saved;
mod signal;
mod signing;
mod terminal;
mod trace;
mod train;
mod unit_option;
mod usage;
mod verify;
#[cfg(test)]
mod words;

use std::ffi::OsString;

use clap::builder::RangedI64ValueParser;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use fault_db::Store;
use output::{Json, answered, print_json, print_out};

use ptu_options::{Database, ScriptsOption, WindowOptions, presets, refuse_password};
use ptu_report::words::{Language, tell};
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, FileTrouble, Unknown, did_you_mean_number};
use ptu_runs::platform::running_program;
use ptu_runs::run::loading;
use ptu_runs::stdio;

/// Tests an on-board ATC unit (ATP + ATO + TWC) and finds the part that failed.
///
/// Examples:
///   ptu                                      the technician's window
///   ptu run                                  whole acceptance suite on the simulated unit
///   ptu run atp/overspeed --unit serial:/dev/ttyUSB0
///   ptu run --inject eb_relay.slow --report result.json
///   ptu faults list --state open
#[derive(Debug, Parser)]
#[command(name = "ptu", version, verbatim_doc_comment)]
pub struct Cli {
    /// Verb; `None` for `ptu` alone, which opens the window as it was left.
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    terminal: terminal::TerminalOption,
}

#[derive(Debug, Subcommand)]
enum Verb {
    // Variants without a comment take the help of their argument type; a comment here would hide exit codes and
    // examples.
    Gui(Box<WindowOptions>),
    Run(Box<run::RunArguments>),
    Diagnose(diagnose::DiagnoseArguments),
    /// Show recorded runs
    Runs(runs::RunsArguments),
    Report(report::ReportArguments),
    /// Query and keep the fault history
    Faults(faults::FaultsArguments),
    Saved(saved::SavedArguments),
    /// Show and export recorded traces
    Trace(trace::TraceArguments),
    Record(record::RecordArguments),
    Signal(signal::SignalArguments),
    Key(key::KeyArguments),
    Instrument(instrument::InstrumentArguments),
    Verify(verify::VerifyArguments),
    /// Check, back up, prune, merge, sync or query the database
    Db(db::DbArguments),
    /// Show faults, signals, speed codes, lines or parts
    Catalog(catalog::CatalogArguments),
    /// List serial ports
    Ports(ports::PortsArguments),
    Doctor(doctor::DoctorArguments),
    Config(config::ConfigArguments),
    Campaign(Box<campaign::CampaignArguments>),
    Drive(Box<drive::DriveArguments>),
    Matrix(matrix::MatrixArguments),
    New(new::NewArguments),
    Completions(completions::CompletionsArguments),
    Train(Box<train::TrainArguments>),
    /// Write manual pages and shell completions, for packages
    #[command(name = "help-files", hide = true)]
    HelpFiles(help_files::HelpFilesArguments),
    /// Load scripts for another process of this program
    #[command(name = loading::WORD, hide = true)]
    LoadScripts,
}

impl Verb {
    /// Whether the verb only answers a question: such an answer may be shown in a pager. A verb that works for long
    /// with nobody watching must not wait in a pager.
    fn is_question(&self) -> bool {
        match self {
            Self::Run(arguments) => arguments.list,
            Self::Drive(_) | Self::Campaign(_) | Self::Train(_) | Self::Signal(_) => false,
            Self::Completions(_) | Self::LoadScripts => false,
            _ => true,
        }
    }
}

impl Cli {
    /// Reads the command line; ends the program after printing help, or where the command line is wrong.
    ///
    /// # Errors
    /// The command line holds a server's password (checked first: every other error would print the password); or a
    /// file of defaults is wrong.
    pub fn asked() -> Result<Self, Failure> {
        refuse_password()?;
        completions::answer();
        let presets = presets::presets()?;
        let language = presets.iter().rfind(|preset| preset.option == "lang");
        if let Some(Ok(language)) = language.map(|preset| preset.value.parse::<Language>()) {
            language.prefer();
        }
        let words = form_last(std::env::args_os());
        let command = presets::applied(Self::command(), &presets, &words);
        let matches = help::sectioned(help::flowing(command)).try_get_matches_from(words);
        Ok(matches
            .and_then(|matches| Self::from_arg_matches(&matches))
            .unwrap_or_else(|error| std::process::exit(told(&error).code().into())))
    }

    /// The arguments of `ptu saved`, or the whole command line of any other verb.
    fn saved(self) -> Result<saved::SavedArguments, Box<Self>> {
        match self.verb {
            Some(Verb::Saved(arguments)) => Ok(arguments),
            verb => Err(Box::new(Self { verb, ..self })),
        }
    }

    /// Runs the verb.
    ///
    /// # Errors
    /// With a message for a person and an exit code.
    pub fn run(self) -> Result<Exit, Failure> {
        loading::load_apart(running_program());
        self.terminal.set();
        if self.terminal.pages() && self.verb.as_ref().is_some_and(Verb::is_question) {
            terminal::page_answers();
        }
        let Some(verb) = self.verb else {
            return Err(gui::start(std::iter::empty()));
        };
        match verb {
            // `ptu-window` reads these options itself; `ptu` only checks them and shows their help.
            Verb::Gui(_) => Err(gui::start(terminal::words_for_window())),
            Verb::Run(arguments) => arguments.run(),
            Verb::Drive(arguments) => arguments.run(),
            Verb::Catalog(arguments) => arguments.run(),
            Verb::Campaign(arguments) => arguments.run(),
            Verb::Diagnose(arguments) => arguments.run(),
            Verb::Runs(arguments) => arguments.run(),
            Verb::Faults(arguments) => arguments.run(),
            Verb::Record(arguments) => arguments.run(),
            Verb::Report(arguments) => arguments.run(),
            Verb::Saved(arguments) => arguments.run(),
            Verb::Trace(arguments) => arguments.run(),
            Verb::Db(arguments) => arguments.run(),
            Verb::Key(arguments) => arguments.run(),
            Verb::Instrument(arguments) => arguments.run(),
            Verb::Verify(arguments) => arguments.run(),
            Verb::Train(arguments) => arguments.run(),
            Verb::Matrix(arguments) => arguments.run(),
            Verb::Signal(arguments) => arguments.run(),
            Verb::Ports(arguments) => arguments.run(),
            Verb::Doctor(arguments) => arguments.run(),
            Verb::Config(arguments) => arguments.run(),
            Verb::New(arguments) => arguments.run(),
            Verb::Completions(arguments) => arguments.run(),
            Verb::HelpFiles(arguments) => arguments.run(),
            Verb::LoadScripts => loading::serve().map(|()| Exit::Passed),
        }
    }
}

/// Moves `--json` and `--csv` from before the verb to the end of the command line, where each verb looks for them.
fn form_last(words: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut words: Vec<_> = words.collect();
    for form in ["--json", "--csv"] {
        if let Some(at) = words.iter().take(3).position(|word| word == form) {
            let form = words.remove(at);
            let end = words.iter().position(|word| word == "--");
            words.insert(end.unwrap_or(words.len()), form);
        }
    }
    words
}

/// Prints the help that was asked for, or why the command line cannot be read.
fn told(error: &clap::Error) -> Exit {
    if error.use_stderr() {
        let korean = match Language::shown() {
            Language::Korean => usage::korean(error),
            Language::English => None,
        };
        let said = korean.unwrap_or_else(|| error.render().to_string());
        stdio::note(said.trim_end());
        return Exit::Usage;
    }
    match error.print() {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            tell(&Failure::bench(FileTrouble::Unanswered(error.to_string())));
            Exit::Bench
        }
        _ => Exit::Passed,
    }
}

/// Refuses a unit that the history does not know, and names the nearest serial number if there is one.
fn check_unit(store: &Store, serial: &str) -> Result<(), Failure> {
    let known = store.known_units()?;
    if known.iter().any(|known| known == serial) {
        return Ok(());
    }
    let hint = did_you_mean_number(serial, known.iter().map(String::as_str));
    Err(Failure::usage(Unknown::Unit(serial.to_owned(), hint)))
}

/// Line for a report: when it was made, and by which command.
fn made_by() -> String {
    let words: Vec<_> = std::env::args().skip(1).map(|word| quoted(&word)).collect();
    let at = clock::local(clock::now_us());
    format!("Made {at} by: ptu {}", words.join(" "))
}

/// An argument quoted for a POSIX shell.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@+%".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', "'\\''"))
}

/// Parser of a number of entries to show, 1 or more.
fn at_least_one() -> RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(1..)
}

/// Parses the beginning of a span of time, as `30d`, `12h`, `2026-03` or `2026-03-21`; the result is in µs.
fn since_argument(text: &str) -> Result<i64, String> {
    if text.contains("..") {
        return Err(format!(
            "\"{text}\" is a span; write its beginning only, such as 2026-03"
        ));
    }
    let span: clock::Span = text.parse()?;
    span.since_us.ok_or_else(|| {
        format!("\"{text}\" has no beginning; write 30d, 12h, 2026-03 or 2026-03-21")
    })
}
