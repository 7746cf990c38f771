//! `ptu instrument`: the register of what measures and generates on this bench.

use std::collections::BTreeMap;

use clap::{Args, Subcommand};
use fault_db::{Instrument, Store};
use serde_json::json;

use super::signing::SigningOption;
use super::{Database, Json, print_out};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::{Asked, Exit, Failure, Unknown, did_you_mean_number};
use ptu_runs::keys::day_argument;
use ptu_runs::table::Table;

/// Register what measures and generates on this bench, with its calibration
///
/// Once an instrument is registered, a run on a port does not begin while an instrument's calibration has expired; `ptu
/// run --uncalibrated` runs all the same, and the sheet says so. Runs on the simulated unit need no instrument.
///
/// Examples:
///   ptu instrument add B-0031 --kind bench
///   ptu instrument calibrate B-0031 --calibrated-by "KRISS 26-1187" --due 2027-11-26 --uncertainty ms=2 --uncertainty km/h=0.05
///   ptu instrument list
///   ptu instrument retire B-0031
///
/// Exit codes: 0 done, 2 no such instrument, 3 database.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct InstrumentArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Register an instrument; until `calibrate` states a calibration it counts as not calibrated
    Add {
        /// Its serial number
        #[arg(value_name = "SERIAL")]
        serial_no: String,
        /// What it is: bench, sound card, coil, adapter …
        #[arg(long, value_name = "KIND")]
        kind: String,
        /// Who registers the instrument
        #[arg(long, value_name = "TEXT", default_value = "")]
        who: String,
        #[command(flatten)]
        signing: SigningOption,
    },
    /// State a calibration
    Calibrate {
        /// Its serial number
        #[arg(value_name = "SERIAL")]
        serial_no: String,
        /// The day of the calibration, as 2026-11-26 [default: today]
        #[arg(long, value_name = "DAY", value_parser = day_argument)]
        on: Option<String>,
        /// Who calibrated it, and the number of the certificate
        #[arg(long = "calibrated-by", value_name = "TEXT")]
        by: String,
        /// First day on which the calibration is no longer valid
        #[arg(long, value_name = "DAY", value_parser = day_argument)]
        due: String,
        /// Expanded uncertainty (k = 2) of measured values in a unit of measure, as ms=2; repeatable
        #[arg(long, value_name = "UNIT=NUMBER", value_parser = uncertainty)]
        uncertainty: Vec<(String, f64)>,
        /// Who states the calibration
        #[arg(long, value_name = "TEXT", default_value = "")]
        who: String,
        #[command(flatten)]
        signing: SigningOption,
    },
    /// Take an instrument off the bench; what runs recorded of the instrument stays
    Retire {
        /// Its serial number
        #[arg(value_name = "SERIAL")]
        serial_no: String,
        /// Who takes the instrument off
        #[arg(long, value_name = "TEXT", default_value = "")]
        who: String,
        #[command(flatten)]
        signing: SigningOption,
    },
    /// List the instruments, and how each stands today
    List {
        #[command(flatten)]
        json: Json,
    },
}

fn uncertainty(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("\"{text}\" is no uncertainty; write it as ms=2");
    let (unit, number) = text.split_once('=').ok_or_else(wrong)?;
    let number: f64 = number.trim().parse().map_err(|_| wrong())?;
    match number.is_finite() && number >= 0.0 && !unit.trim().is_empty() {
        true => Ok((unit.trim().to_owned(), number)),
        false => Err(wrong()),
    }
}

impl InstrumentArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        if let Verb::List { json } = self.verb {
            return list(&self.database.open_read_only()?, json);
        }
        let store = self.database.open_file()?;
        let at_us = clock::now_us();
        let terminal = &Words::shown().terminal;
        match self.verb {
            Verb::List { .. } => Ok(Exit::Passed),
            Verb::Add {
                serial_no,
                kind,
                who,
                signing,
            } => {
                signing.sign(&store)?;
                let (serial_no, kind) = (serial_no.trim().to_owned(), kind.trim().to_owned());
                if serial_no.is_empty() || kind.is_empty() {
                    return Err(Failure::usage(Asked::InstrumentUnnamed));
                }
                if store
                    .instruments()?
                    .iter()
                    .any(|known| known.serial_no == serial_no)
                {
                    return Err(Failure::usage(Asked::InstrumentKnown(
                        serial_no.to_string(),
                    )));
                }
                store.register_instrument(&Instrument {
                    kind: kind.clone(),
                    serial_no: serial_no.clone(),
                    at_us,
                    who,
                    ..Instrument::default()
                })?;
                let of = [("kind", &kind as _), ("serial", &serial_no as _)];
                print_out(&fill(terminal.instrument_new, &of))
            }
            Verb::Calibrate {
                serial_no,
                on,
                by,
                due,
                uncertainty,
                who,
                signing,
            } => {
                signing.sign(&store)?;
                let known = find(&store, &serial_no)?;
                let on = on.unwrap_or_else(|| clock::local_day(at_us));
                if due <= on {
                    return Err(Failure::usage(Asked::DueBefore(
                        due.to_string(),
                        on.to_string(),
                    )));
                }
                let uncertainty: BTreeMap<_, _> = uncertainty.into_iter().collect();
                store.register_instrument(&Instrument {
                    calibrated: Some(on.clone()),
                    by,
                    due: Some(due.clone()),
                    uncertainty: if uncertainty.is_empty() {
                        known.uncertainty
                    } else {
                        uncertainty
                    },
                    at_us,
                    who,
                    ..known
                })?;
                let of = [
                    ("serial", &serial_no as _),
                    ("on", &on as _),
                    ("due", &due as _),
                ];
                print_out(&fill(terminal.instrument_calibrated, &of))
            }
            Verb::Retire {
                serial_no,
                who,
                signing,
            } => {
                signing.sign(&store)?;
                let known = find(&store, &serial_no)?;
                store.register_instrument(&Instrument {
                    retired: true,
                    at_us,
                    who,
                    ..known
                })?;
                print_out(&fill(
                    terminal.instrument_retired,
                    &[("serial", &serial_no)],
                ))
            }
        }
    }
}

fn find(store: &Store, serial_no: &str) -> Result<Instrument, Failure> {
    let known = store.instruments()?;
    let found = known
        .iter()
        .find(|known| known.serial_no == serial_no)
        .cloned();
    found.ok_or_else(|| {
        let hint = did_you_mean_number(
            serial_no,
            known.iter().map(|known| known.serial_no.as_str()),
        );
        Failure::usage(Unknown::Instrument(serial_no.to_owned(), hint))
    })
}

fn list(store: &Store, json: Json) -> Result<Exit, Failure> {
    let known = store.instruments()?;
    let today = clock::local_day(clock::now_us());
    let document = || {
        let one = |one: &Instrument| {
            json!({
                "kind": one.kind, "serial_no": one.serial_no, "calibrated": one.calibrated, "by": one.by, "due": one.due,
                "uncertainty": one.uncertainty, "is_calibrated": one.is_calibrated_on(&today),
            })
        };
        known.iter().map(one).collect::<Vec<_>>()
    };
    let terminal = &Words::shown().terminal;
    json.answer(document, || {
        if known.is_empty() {
            return terminal.no_instrument.into();
        }
        let mut table = Table::headed(&[
            terminal.kind,
            terminal.serial,
            terminal.calibrated,
            terminal.by,
            terminal.due,
            terminal.uncertainty,
            terminal.today,
        ]);
        for one in &known {
            let uncertainty = one
                .uncertainty
                .iter()
                .map(|(unit, number)| format!("{number} {unit}"));
            table.row([
                one.kind.clone(),
                one.serial_no.clone(),
                one.calibrated.clone().unwrap_or_default(),
                one.by.clone(),
                one.due.clone().unwrap_or_default(),
                uncertainty.collect::<Vec<_>>().join(", "),
                if one.is_calibrated_on(&today) {
                    terminal.calibrated
                } else {
                    terminal.not_calibrated
                }
                .to_owned(),
            ]);
        }
        table.render()
    })
}
