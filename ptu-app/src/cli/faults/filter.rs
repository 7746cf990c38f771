//! Which faults are meant, as options.

use clap::Args;
use fault_db::{FaultFilter, FaultState, Store};

use crate::cli::since_argument;
use crate::clock::Span;
use crate::failure::{Failure, did_you_mean};

/// Which faults.
#[derive(Debug, Args)]
pub struct FilterArguments {
    /// Only of this unit (serial number)
    #[arg(long, value_name = "SERIAL")]
    pub unit: Option<String>,
    /// Only repaired with a part of this serial number, taken out or put in
    #[arg(long, value_name = "SERIAL")]
    serial: Option<String>,
    /// Only of units in this train
    #[arg(long, value_name = "TRAIN")]
    pub train: Option<String>,
    /// Only this code, number or name
    #[arg(long)]
    code: Option<String>,
    /// Only this part
    #[arg(long)]
    lru: Option<String>,
    /// Only this severity
    #[arg(long)]
    severity: Option<String>,
    /// Only in this state: open, acknowledged, repaired, verified, closed
    #[arg(long)]
    state: Option<FaultState>,
    /// Only seen in this procedure
    #[arg(long, value_name = "PROCEDURE")]
    procedure: Option<String>,
    /// Only on this line
    #[arg(long, value_name = "LINE")]
    pub line: Option<String>,
    /// Only seen in this run
    #[arg(long, value_name = "RUN")]
    run: Option<String>,
    /// Only seen then: 30d, today, 2026-03, 2026-03..2026-05, 2026-03-21..
    #[arg(long, value_name = "SPAN", conflicts_with = "since")]
    pub when: Option<Span>,
    /// Only seen since: 30d, 12h, 2026-03, 2026-03-21
    #[arg(long, value_name = "TIME", value_parser = since_argument)]
    pub since: Option<i64>,
    /// Only with these words in a note on it, on its repair, or on a run that saw it
    #[arg(long, value_name = "WORDS")]
    note: Option<String>,
}

impl FilterArguments {
    /// The span of time it asks for.
    pub fn span(&self) -> Span {
        self.when.unwrap_or(Span {
            since_us: self.since,
            until_us: None,
        })
    }

    /// As the history takes it.
    pub fn filter(&self, store: &Store) -> Result<FaultFilter, Failure> {
        let run = self.run.as_deref().map(|run| store.resolve_run(run));
        let span = self.span();
        Ok(FaultFilter {
            unit: self.unit.clone(),
            serial: self.serial.clone(),
            train: self.train.clone(),
            code: self.code.clone(),
            lru: self.lru.clone(),
            severity: self.severity.clone(),
            state: self.state,
            procedure: self.procedure.clone(),
            line: self.line.clone(),
            run: run.transpose()?,
            since_us: span.since_us,
            until_us: span.until_us,
            note: self.note.clone(),
            limit: None,
        })
    }

    /// What to say when nothing was found: that a name asked for is not in this history at all, or that
    /// there is nothing.
    pub fn nothing(&self, store: &Store) -> Result<String, Failure> {
        if let Some(code) = self
            .code
            .as_deref()
            .filter(|code| code.parse::<i64>().is_err() && !code.starts_with("0x"))
        {
            let known = store.known_codes()?;
            let names: Vec<_> = known.iter().map(|(_, name)| name.as_str()).collect();
            if !names.iter().any(|name| name.eq_ignore_ascii_case(code)) {
                let hint = did_you_mean(code, names);
                return Ok(format!("no fault \"{code}\" was ever recorded{hint}"));
            }
        }
        if let Some(lru) = &self.lru {
            let known = store.known_lrus()?;
            if !known.iter().any(|known| known.eq_ignore_ascii_case(lru)) {
                let hint = did_you_mean(lru, known.iter().map(String::as_str));
                return Ok(format!("no fault ever named the part \"{lru}\"{hint}"));
            }
        }
        Ok("no faults recorded".to_owned())
    }
}
