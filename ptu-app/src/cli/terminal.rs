//! Display of answers: colours, and a pager for what is longer than the screen.

use std::ffi::OsString;
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, ColorChoice};

use ptu_report::words::Language;
use ptu_runs::stdio;
use ptu_runs::stop::Stop;
use ptu_runs::terminal::{Terminal, wants_colour};

/// Place of these options in the help: after all others but `--help`.
const LAST: usize = 999;
/// Pager where `PAGER` names no other.
const PAGER: &str = "less";
/// Options of `less`: show colours (R), end by itself when all fits (F), leave on the screen what it showed (X).
const LESS: &str = "FRX";

/// Options that say how answers are shown on a terminal.
#[derive(Debug, Args)]
pub struct TerminalOption {
    /// Colours of verdicts, limits and parts: auto, always or never; auto follows NO_COLOR, CLICOLOR and CLICOLOR_FORCE
    #[arg(long, value_name = "WHEN", global = true, default_value = "auto", hide_default_value = true,
        hide_possible_values = true, display_order = LAST)]
    color: ColorChoice,
    /// Language of answers and reports: en or ko [default: that of the locale]
    #[arg(long, value_name = "LANGUAGE", global = true, display_order = LAST)]
    // `Language::shown` reads this option by itself, before clap reports a wrong command line.
    lang: Option<Language>,
    /// Never page an answer that is longer than the screen; PAGER says by which program [default: less]
    #[arg(long, global = true, display_order = LAST)]
    no_pager: bool,
}

impl TerminalOption {
    /// Finds the size and colours of the terminal, and sets them for all output.
    pub fn set(&self) {
        let screen = console::Term::stdout();
        let size = screen.size_checked();
        let colours = |is_terminal| match self.color {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => wants_colour(is_terminal),
        };
        let terminal = Terminal {
            size: size.map(|(rows, columns)| [columns.into(), rows.into()]),
            colours_answers: colours(screen.is_term()),
            colours_notes: colours(stdio::draws()),
        };
        terminal.set();
    }

    /// Whether an answer to a question may be shown in a pager.
    pub fn pages(&self) -> bool {
        !self.no_pager
    }
}

/// Whether answers are shown in a pager.
static PAGES: AtomicBool = AtomicBool::new(false);

/// From now on an answer that is longer than the screen is paged.
pub fn page_answers() {
    PAGES.store(true, Ordering::Relaxed);
}

/// Shows text that is longer than the screen in a pager, if answers are paged; `true` if the pager ran.
pub fn paged(text: &str) -> bool {
    let Some([_, rows]) = Terminal::get()
        .size
        .filter(|_| PAGES.load(Ordering::Relaxed))
    else {
        return false;
    };
    let pager = std::env::var("PAGER").unwrap_or_else(|_| PAGER.to_owned());
    let mut words = pager.split_whitespace();
    let (Some(program), true) = (words.next(), text.lines().count() >= rows) else {
        return false;
    };
    let mut command = Command::new(program);
    command.args(words).stdin(Stdio::piped());
    if std::env::var_os("LESS").is_none() {
        command.env("LESS", LESS);
    }
    let Ok(mut pager) = command.spawn() else {
        return false;
    };
    // Ctrl-C is for the pager, where it stops a search: it must not end this program.
    Stop::default().listen();
    if let Some(mut input) = pager.stdin.take() {
        // A reader may end the pager before it has read all.
        let _ = writeln!(input, "{}", stdio::shown(text));
    }
    let _ = pager.wait();
    true
}

/// The words after `gui`, without the options that the window does not have.
pub fn words_for_window() -> impl Iterator<Item = OsString> {
    let mut words = std::env::args_os().skip(1).skip_while(|word| word != "gui");
    words.next();
    let mut kept = Vec::new();
    while let Some(word) = words.next() {
        match word.to_str() {
            Some("--color") => drop(words.next()),
            Some(word) if word == "--no-pager" || word.starts_with("--color=") => {}
            _ => kept.push(word),
        }
    }
    kept.into_iter()
}
