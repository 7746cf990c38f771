//! `ptu completions`, and the answers to a shell that completes a command line: names from scripts and history.

use btu_rig::procedure::loader::is_library;
use clap::builder::PossibleValuesParser;
use clap::{Arg, Args, Command, CommandFactory as _, Parser};
use clap_complete::CompleteEnv;
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate as Candidate};
use clap_complete::env::Shells;
use fault_db::{FaultFilter, RunFilter, Store};
use protocol::signal::Signal;

use super::{Cli, Database, ScriptsOption, print_out};
use ptu_runs::clock;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Exit, Failure};

/// Environment variable by which a shell asks the program for completions.
const VARIABLE: &str = "PTU_COMPLETE";
/// Most runs or faults that are offered, the newest.
const NEWEST: u32 = 100;
/// Last line for zsh, which runs the script as the function `_ptu` at the first completion: the line then calls the
/// completer.
const ZSH_FILE: &str = "[[ $funcstack[1] == _ptu ]] && _clap_dynamic_completer_ptu \"$@\"\n";

/// Write a script by which a shell completes commands, and names of procedures, faults, parts, runs and more
///
/// Examples:
///   ptu completions bash  >> ~/.bashrc
///   ptu completions zsh  > ~/.zfunc/_ptu
///   ptu completions fish  > ~/.config/fish/completions/ptu.fish
///   ptu completions powershell  >> $PROFILE
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_parser = PossibleValuesParser::new(["bash", "zsh", "fish", "powershell"]))]
    shell: String,
}

impl CompletionsArguments {
    /// Prints the script.
    pub fn run(self) -> Result<Exit, Failure> {
        print_out(script(&self.shell).trim_end())
    }
}

/// Script that a shell reads at its start.
pub(super) fn script(shell: &str) -> String {
    let mut script = Vec::new();
    if let Some(shell) = Shells::builtins().completer(shell) {
        // Writing to memory cannot fail.
        let _ = shell.write_registration(VARIABLE, "ptu", "ptu", "ptu", &mut script);
    }
    let script = String::from_utf8_lossy(&script).trim_start().to_owned();
    if shell == "zsh" {
        script + ZSH_FILE
    } else {
        script
    }
}

/// If a shell asks for completions, answers and ends the program.
pub(super) fn answer() {
    let command = || named(super::help::flowing(Cli::command()));
    CompleteEnv::with_factory(command).var(VARIABLE).complete();
}

/// The command with the names that can be offered for each argument.
fn named(command: Command) -> Command {
    let verb = command.get_name().to_owned();
    named_below(command, &verb)
}

fn named_below(command: Command, verb: &str) -> Command {
    let command = command.mut_args(|argument| match names_of(verb, &argument) {
        Some(names) => argument.add(ArgValueCandidates::new(move || {
            Typed::read()
                .and_then(|asked| names(&asked))
                .unwrap_or_default()
        })),
        None => argument,
    });
    command.mut_subcommands(|below| {
        // The verb after `ptu` says what an `id` stands for.
        let verb = if verb == "ptu" {
            below.get_name().to_owned()
        } else {
            verb.to_owned()
        };
        named_below(below, &verb)
    })
}

type Names = fn(&Typed) -> Option<Vec<Candidate>>;

/// Source of the names that an argument takes; `None` for an argument whose values have no names.
fn names_of(verb: &str, argument: &Arg) -> Option<Names> {
    let value = argument.get_value_names().and_then(|names| names.first());
    Some(match (argument.get_id().as_str(), value?.as_str()) {
        (_, "FAULT[,FAULT]") => Typed::modes,
        (_, "PART") => Typed::parts,
        (_, "SYMPTOM") => Typed::symptoms,
        (_, "PATH|GLOB" | "PROCEDURE") => Typed::procedures,
        (_, "RUN" | "RUN|CASE" | "RUN|FILE") => Typed::runs,
        (_, "NAME[,NAME]") | ("signals", _) => Typed::signals,
        ("line", _) => Typed::lines,
        ("train", _) => Typed::trains,
        ("unit_config", _) => Typed::unit_configs,
        ("serial_no" | "serial", "TEXT" | "SERIAL" | "SERIAL_NO") => Typed::units,
        ("id" | "came" | "expected" | "before" | "after" | "trace", _) => match verb {
            "runs" => Typed::runs,
            "faults" => Typed::faults,
            "trace" | "record" => Typed::traces,
            _ => return None,
        },
        _ => return None,
    })
}

/// Options `--db` and `--scripts` of the command line that is being typed.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct Typed {
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl Typed {
    fn read() -> Option<Self> {
        // A shell that splits words at `=`, as bash does, passes `=` as a word of its own.
        let mut words = std::env::args().filter(|word| word != "=");
        let mut said = Vec::new();
        while let Some(word) = words.next() {
            if ["--db", "--scripts"].contains(&word.as_str()) {
                said.push(format!("{word}={}", words.next()?));
            } else if word.starts_with("--db=") || word.starts_with("--scripts=") {
                said.push(word);
            }
        }
        Self::try_parse_from(said).ok()
    }

    fn files(&self) -> Option<ScriptsDirectory> {
        self.scripts.find().ok()
    }

    fn history(&self) -> Option<Store> {
        self.database.open_read_only().ok()
    }

    fn modes(&self) -> Option<Vec<Candidate>> {
        let modes = self.files()?.faults().ok()?.faults;
        Some(
            modes
                .iter()
                .map(|mode| told(&mode.id, &mode.mode))
                .collect(),
        )
    }

    fn parts(&self) -> Option<Vec<Candidate>> {
        let parts = self.files()?.faults().ok()?.lrus;
        Some(
            parts
                .iter()
                .map(|part| told(part.id.to_string(), &part.name))
                .collect(),
        )
    }

    fn symptoms(&self) -> Option<Vec<Candidate>> {
        let files = self.files()?;
        let symptoms = ptu_runs::symptoms::load(&files, &files.faults().ok()?.lrus).ok()?;
        Some(
            symptoms
                .iter()
                .map(|symptom| told(&symptom.id, &symptom.name))
                .collect(),
        )
    }

    fn procedures(&self) -> Option<Vec<Candidate>> {
        let procedures = self.files()?.procedures().ok()?;
        let names = procedures.keys().filter(|file| !is_library(file));
        let names = names.map(|file| file.trim_end_matches(".star"));
        Some(plain(names.map(str::to_owned).collect()))
    }

    fn lines(&self) -> Option<Vec<Candidate>> {
        Some(plain(self.files()?.line_names()))
    }

    fn trains(&self) -> Option<Vec<Candidate>> {
        Some(plain(self.files()?.train_names()))
    }

    fn unit_configs(&self) -> Option<Vec<Candidate>> {
        Some(plain(self.files()?.unit_config_names()))
    }

    fn signals(&self) -> Option<Vec<Candidate>> {
        let signal = |signal: &Signal| told(signal.name(), signal.definition().doc);
        Some(Signal::ALL.iter().map(signal).collect())
    }

    fn units(&self) -> Option<Vec<Candidate>> {
        Some(plain(self.history()?.known_units().ok()?))
    }

    fn runs(&self) -> Option<Vec<Candidate>> {
        let filter = RunFilter {
            limit: Some(NEWEST),
            ..RunFilter::default()
        };
        let runs = self.history()?.runs(&filter).ok()?;
        let run = |run: &fault_db::RunSummary| {
            let state = run
                .verdict
                .map_or(run.state.as_str(), |verdict| verdict.as_str());
            let at = clock::local(run.started_at_us);
            told(run.id.short(), &format!("{at} {} {state}", run.unit_serial))
        };
        Some(with_latest(runs.iter().map(run)))
    }

    fn faults(&self) -> Option<Vec<Candidate>> {
        Some(with_latest(self.newest_faults()?.iter().map(|fault| {
            told(
                fault.id.short(),
                &format!("{} {}", fault.unit_serial, fault.code_name),
            )
        })))
    }

    fn traces(&self) -> Option<Vec<Candidate>> {
        let faults = self.newest_faults()?;
        Some(with_latest(faults.iter().filter_map(|fault| {
            let what = format!("{} {}", fault.unit_serial, fault.code_name);
            Some(told(fault.trace_id?.short(), &what))
        })))
    }

    fn newest_faults(&self) -> Option<Vec<fault_db::FaultSummary>> {
        let filter = FaultFilter {
            limit: Some(NEWEST),
            ..FaultFilter::default()
        };
        self.history()?.faults(&filter).ok()
    }
}

fn plain(names: Vec<String>) -> Vec<Candidate> {
    names.into_iter().map(Candidate::new).collect()
}

fn with_latest(entries: impl Iterator<Item = Candidate>) -> Vec<Candidate> {
    std::iter::once(Candidate::new("latest"))
        .chain(entries)
        .collect()
}

fn told(name: impl Into<String>, about: &str) -> Candidate {
    Candidate::new(name.into()).help(Some(about.to_owned().into()))
}
