//! The options that select faults.

use clap::Args;
use fault_db::{FaultFilter, FaultState, Store, code_number};
use protocol::event::{Event, Severity};

use crate::cli::{ScriptsOption, check_unit};
use ptu_runs::clock::Span;
use ptu_runs::failure::{Asked, Failure, did_you_mean, did_you_mean_number};

/// Options that select faults.
#[derive(Debug, Args)]
pub struct FilterArguments {
    /// Only of this unit (serial number)
    #[arg(long, value_name = "TEXT")]
    pub serial_no: Option<String>,
    /// Only faults whose repair put in or took out a part of this serial number
    #[arg(long, value_name = "TEXT")]
    part_serial_no: Option<String>,
    /// Only of units in this train
    #[arg(long, value_name = "TEXT")]
    pub train_no: Option<String>,
    /// Only this fault code, a number or a name; several with commas between
    #[arg(long, value_name = "CODE[,CODE]")]
    code: Option<String>,
    /// Only faults that point at this part
    #[arg(long, value_name = "PART")]
    part: Option<String>,
    /// Only faults with this part as cause, found by a diagnosis or a person; where nobody found one, pointing at it
    #[arg(long, value_name = "PART")]
    pub cause: Option<String>,
    /// Only this severity
    #[arg(long, ignore_case = true, value_parser = Severity::OF_FAULTS.map(Severity::label))]
    severity: Option<String>,
    /// Only in this state: open, acknowledged, repaired, verified, closed; several with commas between
    #[arg(long, value_name = "STATE[,STATE]", value_delimiter = ',')]
    state: Vec<FaultState>,
    /// Only seen in this procedure
    #[arg(long, value_name = "PROCEDURE")]
    procedure: Option<String>,
    /// Only on this line
    #[arg(long, value_name = "NAME")]
    pub line: Option<String>,
    /// Only seen in this run
    #[arg(long, value_name = "RUN")]
    run: Option<String>,
    /// Only seen in this time: 30d, today, 2026-03, 2026-03..2026-05, 2026-03-21..
    // A span that begins with a hyphen is a mistake; the parser of spans explains it better than clap.
    #[arg(long, value_name = "SPAN", allow_hyphen_values = true)]
    pub when: Option<Span>,
    /// Only with these words in a note on the fault, on its repair, or on a run that saw the fault
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl FilterArguments {
    /// Span of time of the filter, all times where none is given.
    pub fn span(&self) -> Span {
        self.when.unwrap_or_default()
    }

    /// The filter as `fault-db` takes it.
    pub fn filter(&self, store: &Store) -> Result<FaultFilter, Failure> {
        if let Some(unit) = &self.serial_no {
            check_unit(store, unit)?;
        }
        // An unknown code in a list of several would go unnoticed: the other codes still find faults.
        if self.code.as_ref().is_some_and(|codes| codes.contains(','))
            && let Some(unknown) = self.unknown_code(store)?
        {
            return Err(Failure::usage(unknown));
        }
        let run = self.run.as_deref().map(|run| store.resolve_run(run));
        let span = self.span();
        Ok(FaultFilter {
            unit: self.serial_no.clone(),
            serial: self.part_serial_no.clone(),
            train: self.train_no.clone(),
            code: self.code.clone(),
            lru: self.part.clone(),
            cause: self.cause.clone(),
            severity: self.severity.clone(),
            states: self.state.clone(),
            procedure: self.procedure.clone(),
            line: self.line.clone(),
            run: run.transpose()?,
            since_us: span.since_us,
            until_us: span.until_us,
            note: self.note.clone(),
            limit: None,
        })
    }

    /// Sentence for an empty answer: no fault fits the filter, or no fault is recorded at all.
    ///
    /// # Errors
    /// A name asked for is known neither in this history nor in the scripts.
    pub fn nothing(&self, store: &Store) -> Result<String, Failure> {
        if let Some(said) = self.unknown(store)? {
            return Err(Failure::usage(said));
        }
        Ok(match self.filter(store)? == FaultFilter::default() {
            true => "no faults recorded",
            false => "no such faults recorded",
        }
        .to_owned())
    }

    /// Refusal of the first code that neither the history nor the unit's list of events knows.
    fn unknown_code(&self, store: &Store) -> Result<Option<Asked>, Failure> {
        let Some(codes) = &self.code else {
            return Ok(None);
        };
        let known = store.known_codes()?;
        let names = || known.iter().map(|(_, name)| name.as_str());
        let events = || Event::ALL.iter().map(|event| event.definition());
        let is_known = |code: &str| match code_number(code) {
            Some(number) => {
                known.iter().any(|(known, _)| *known == number)
                    || events().any(|event| i64::from(event.code) == number)
            }
            None => names()
                .chain(events().map(|event| event.name))
                .any(|name| name.eq_ignore_ascii_case(code)),
        };
        let mut named = codes.split(',').map(str::trim);
        Ok(named.find(|code| !is_known(code)).map(|code| {
            let hint = did_you_mean(code, names());
            Asked::CodeNever(code.to_string(), hint)
        }))
    }

    /// Refusal of the first name that neither the history nor the scripts have, with the nearest name in the
    /// history.
    fn unknown(&self, store: &Store) -> Result<Option<Asked>, Failure> {
        if let Some(said) = self.unknown_code(store)? {
            return Ok(Some(said));
        }
        if let Some(part) = &self.part {
            let known = store.known_lrus()?;
            if !known.iter().any(|known| known.eq_ignore_ascii_case(part))
                && !is_part(&self.scripts, part)
            {
                let hint = did_you_mean(part, known.iter().map(String::as_str));
                return Ok(Some(Asked::PartNever(part.to_string(), hint)));
            }
        }
        if let Some(cause) = &self.cause {
            let known = store.known_causes()?;
            if !known.iter().any(|known| known.eq_ignore_ascii_case(cause))
                && !is_part(&self.scripts, cause)
            {
                let hint = did_you_mean(cause, known.iter().map(String::as_str));
                return Ok(Some(Asked::CauseNever(cause.to_string(), hint)));
            }
        }
        if let Some(train) = &self.train_no {
            let known = store.known_trains()?;
            if !known.contains(train) {
                let hint = did_you_mean_number(train, known.iter().map(String::as_str));
                return Ok(Some(Asked::TrainNever(train.to_string(), hint)));
            }
        }
        if let Some(line) = &self.line {
            let known = store.known_lines()?;
            if !known.contains(line) && !self.has_script(&format!("lines/{line}.toml")) {
                let hint = did_you_mean(line, known.iter().map(String::as_str));
                return Ok(Some(Asked::LineNever(line.to_string(), hint)));
            }
        }
        if let Some(procedure) = &self.procedure {
            let known = store.known_procedures()?;
            if !known.contains(procedure) && !self.has_script(&format!("{procedure}.star")) {
                let hint = did_you_mean(procedure, known.iter().map(String::as_str));
                return Ok(Some(Asked::ProcedureNever(procedure.to_string(), hint)));
            }
        }
        if let Some(serial) = &self.part_serial_no {
            let known = store.known_part_serials()?;
            if !known.contains(serial) {
                let hint = did_you_mean_number(serial, known.iter().map(String::as_str));
                return Ok(Some(Asked::SerialNever(serial.to_string(), hint)));
            }
        }
        Ok(None)
    }

    /// Whether the scripts directory has this file.
    fn has_script(&self, path: &str) -> bool {
        let scripts = self.scripts.find();
        scripts.is_ok_and(|directory| directory.has(path))
    }
}

/// Whether the fault catalogue of the scripts has a part of this name.
pub(super) fn is_part(scripts: &ScriptsOption, name: &str) -> bool {
    let catalogue = scripts.find().and_then(|directory| directory.faults());
    catalogue.is_ok_and(|catalogue| {
        let mut parts = catalogue.lrus.iter();
        parts.any(|lru| lru.id.as_str().eq_ignore_ascii_case(name))
    })
}
