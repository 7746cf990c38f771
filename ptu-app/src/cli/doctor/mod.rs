//! `ptu doctor`: what this computer lacks for testing units, and how to get it.

mod checks;

use clap::Args;
use fault_db::Address;
use serde::Serialize;

use super::{Database, Json, ScriptsOption, answered};
use ptu_report::words::{Doctor, Words};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::table::padded;

/// Check this computer: scripts, ports, display, database, disk, clock and server
///
/// Without --bench nothing is changed and no port is opened; each finding says what to do. With --bench only the
/// bench's instruments are examined: relays that prove themselves are switched, and the measured times are registered.
///
/// Examples:
///   ptu doctor
///   ptu doctor --server postgres://kim@depot/history
///   ptu doctor --bench example
///
/// A port, display or server that is missing is a warning: the simulated unit needs none.
///
/// Exit codes: 0 the simulated unit can be tested; 1 it cannot.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DoctorArguments {
    /// Server that this computer syncs with: postgres://USER@HOST/DATABASE
    #[arg(long, value_name = "ADDRESS")]
    server: Option<Address>,
    /// Examine the instruments of a bench, benches/NAME.toml or a file ending in .toml; switches and registers them
    #[arg(long, value_name = "NAME|FILE")]
    bench: Option<String>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

/// How a checked thing stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum State {
    /// As it should be, or not needed.
    Ok,
    /// Some uses are not possible, or soon will not be.
    Warning,
    /// Not even the simulated unit can be tested, or recorded runs are lost.
    Wrong,
}

impl State {
    fn word(self, doctor: &Doctor) -> &'static str {
        match self {
            Self::Ok => doctor.ok,
            Self::Warning => doctor.warning,
            Self::Wrong => doctor.wrong,
        }
    }
}

/// What a check found of one subject.
#[derive(Debug, Serialize)]
struct Finding {
    subject: &'static str,
    state: State,
    found: String,
    /// The step by which a person removes the trouble; `None` where nothing is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    remedy: Option<String>,
}

impl Finding {
    fn ok(subject: &'static str, found: impl Into<String>) -> Self {
        Self {
            subject,
            state: State::Ok,
            found: found.into(),
            remedy: None,
        }
    }

    fn warning(subject: &'static str, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            state: State::Warning,
            remedy: Some(remedy.into()),
            ..Self::ok(subject, found)
        }
    }

    fn wrong(subject: &'static str, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            state: State::Wrong,
            ..Self::warning(subject, found, remedy)
        }
    }

    fn line(&self, doctor: &Doctor) -> String {
        let state = padded(self.state.word(doctor), 8);
        let mut text = format!("{state} {} {}", padded(self.subject, 9), self.found);
        if let Some(remedy) = &self.remedy {
            text.push_str(&format!("\n{:18} → {remedy}", ""));
        }
        text
    }
}

impl DoctorArguments {
    /// Makes all checks and prints the findings.
    pub fn run(self) -> Result<Exit, Failure> {
        let words = self.json.words();
        if let Some(bench) = &self.bench {
            let places = self.scripts.find()?.bench_places(bench)?;
            let store = self.database.open_file()?;
            let findings = checks::bench(&places, &store, words)?;
            store.close()?;
            return self.answer(&findings, words);
        }
        let mut findings = checks::scripts(self.scripts.find(), words);
        findings.extend(checks::ports(words));
        findings.push(checks::display(words));
        let file = self
            .database
            .server()?
            .is_none()
            .then(|| self.database.file());
        if let Some(file) = file.transpose()? {
            findings.extend(checks::database(&file, words));
            findings.push(checks::disk(&file, words));
        }
        findings.push(checks::clock(words));
        let server = match &self.server {
            Some(server) => Some(server.clone()),
            None => self.database.server()?,
        };
        findings.push(checks::server(server.as_ref(), words));
        self.answer(&findings, words)
    }

    fn answer(&self, findings: &[Finding], words: &Words) -> Result<Exit, Failure> {
        let exit = match findings.iter().any(|found| found.state == State::Wrong) {
            true => Exit::Failed,
            false => Exit::Passed,
        };
        let lines = findings.iter().map(|found| found.line(&words.doctor));
        let lines = || lines.collect::<Vec<_>>();
        let told = self.json.answer(|| &findings, || lines().join("\n"));
        answered(told, exit)
    }
}
