//! `ptu faults`: the fault history.

mod figures;
mod import;

use clap::{Args, Subcommand, ValueEnum};
use fault_db::{FaultDetail, FaultFilter, FaultState, FreezeSample, RepairRecord, Store};
use serde_json::{Value, json};

use self::figures::{stats, trend};
use super::{Database, print_json, print_out, since_argument};
use crate::clock::{local, now_us, rfc3339};
use crate::failure::{Exit, Failure};
use crate::report::fault_json;
use crate::table::Table;

/// Query and keep the fault history
#[derive(Debug, Args)]
pub struct FaultsArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// List faults, last seen first
    List(ListArguments),
    /// Show one fault with its occurrences and freeze frame
    Show {
        /// The fault: an id, its beginning or end (at least 4 digits), or `latest`
        id: String,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Count faults by code or part
    Stats {
        /// What to count by
        #[arg(long, value_enum, default_value = "code")]
        by: By,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Show a measurement over time
    Trend {
        /// The measurement's name
        measurement: String,
        /// Only of this unit (serial number)
        #[arg(long, value_name = "SERIAL")]
        unit: Option<String>,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Change a fault's state: open, acknowledged, repaired, verified, closed
    State {
        /// The fault
        id: String,
        /// The new state
        state: FaultState,
        /// Who decides
        #[arg(long, default_value = "")]
        who: String,
        /// Why
        #[arg(long, default_value = "")]
        note: String,
    },
    Import(import::ImportArguments),
    /// Record a repair
    Repair {
        /// The fault
        id: String,
        /// Part changed or worked on
        #[arg(long)]
        part: String,
        /// Serial number of the part taken out
        #[arg(long, value_name = "TEXT")]
        old: Option<String>,
        /// Serial number of the part put in
        #[arg(long, value_name = "TEXT")]
        new: Option<String>,
        /// What was done
        #[arg(long, default_value = "")]
        note: String,
        /// Who did it
        #[arg(long, default_value = "")]
        who: String,
    },
}

#[derive(Debug, Args)]
struct ListArguments {
    /// Only of this unit (serial number)
    #[arg(long, value_name = "SERIAL")]
    unit: Option<String>,
    /// Only this code, number or name
    #[arg(long)]
    code: Option<String>,
    /// Only this part
    #[arg(long)]
    lru: Option<String>,
    /// Only this severity
    #[arg(long)]
    severity: Option<String>,
    /// Only in this state
    #[arg(long)]
    state: Option<FaultState>,
    /// Only seen in this run
    #[arg(long, value_name = "RUN")]
    run: Option<String>,
    /// Only seen since: 30d, 12h, 2026-03, 2026-03-21
    #[arg(long, value_name = "TIME", value_parser = since_argument)]
    since: Option<i64>,
    /// At most so many
    #[arg(long, value_name = "N", default_value_t = 50)]
    limit: u32,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum By {
    /// By fault code
    Code,
    /// By replaceable part
    Lru,
}

impl FaultsArguments {
    /// Lists, shows, counts or records.
    pub fn run(self) -> Result<Exit, Failure> {
        let writes = matches!(
            self.verb,
            Verb::State { .. } | Verb::Repair { .. } | Verb::Import(_)
        );
        let store = if writes {
            self.database.open()?
        } else {
            self.database.open_read_only()?
        };
        match self.verb {
            Verb::List(arguments) => arguments.list(&store),
            Verb::Import(arguments) => arguments.import(store),
            Verb::Show { id, json } => {
                let fault = store.fault(store.resolve_fault(&id)?)?;
                if json {
                    print_json(&detail_json(&fault))
                } else {
                    print_out(&detail(&fault))
                }
            }
            Verb::Stats { by, json } => stats(&store, by, json),
            Verb::Trend {
                measurement,
                unit,
                json,
            } => trend(&store, &measurement, unit.as_deref(), json),
            Verb::State {
                id,
                state,
                who,
                note,
            } => {
                let id = store.resolve_fault(&id)?;
                let state = store.set_state(id, state, &who, &note, now_us())?;
                print_out(&format!("fault {} is {}", id.short(), state.as_str()))
            }
            Verb::Repair {
                id,
                part,
                old,
                new,
                note,
                who,
            } => {
                let id = store.resolve_fault(&id)?;
                let repair = RepairRecord {
                    part,
                    serial_old: old,
                    serial_new: new,
                    note,
                };
                let state = store.record_repair(id, &repair, &who, now_us())?;
                print_out(&format!("fault {} is {}", id.short(), state.as_str()))
            }
        }
    }
}

impl ListArguments {
    fn list(self, store: &Store) -> Result<Exit, Failure> {
        let run = self.run.map(|run| store.resolve_run(&run)).transpose()?;
        let filter = FaultFilter {
            unit: self.unit,
            code: self.code,
            lru: self.lru,
            severity: self.severity,
            state: self.state,
            run,
            since_us: self.since,
            until_us: None,
            limit: Some(self.limit),
        };
        let faults = store.faults(&filter)?;
        if self.json {
            return print_json(&faults.iter().map(fault_json).collect::<Vec<_>>());
        }
        if faults.is_empty() {
            return print_out("no faults recorded");
        }
        let headings = [
            "FAULT",
            "LAST SEEN",
            "UNIT",
            "CODE",
            "PART",
            "SEVERITY",
            "STATE",
            "SEEN",
            "TRACE",
        ];
        let mut table = Table::new(&headings);
        for fault in &faults {
            table.row([
                fault.id.short(),
                local(fault.last_at_us),
                fault.unit_serial.clone(),
                format!("{} {}", fault.code, fault.code_name),
                fault.lru.clone(),
                fault.severity.clone(),
                fault.state.as_str().into(),
                fault.occurrences.to_string(),
                fault.trace_id.map_or_else(String::new, |id| id.short()),
            ]);
        }
        print_out(&table.render())
    }
}

fn detail_json(detail: &FaultDetail) -> Value {
    let mut value = fault_json(&detail.fault);
    value["occurrence_list"] = detail
        .occurrences
        .iter()
        .map(|seen| {
            json!({
                "id": seen.id.to_string(), "run_id": seen.run_id.to_string(),
                "step_index": seen.step_index, "at": rfc3339(seen.at_us),
                "bench_time_s": seen.bench_us as f64 / 1e6, "message": seen.message,
                "trace_id": seen.trace_id.map(|id| id.to_string()), "freeze_frame": seen.freeze,
            })
        })
        .collect();
    value["events"] = detail
        .events
        .iter()
        .map(|event| {
            json!({
                "kind": event.kind, "at": rfc3339(event.at_us), "who": event.who,
                "note": event.note, "state": event.state.map(|state| state.as_str()),
                "repair": event.repair,
            })
        })
        .collect();
    value
}

fn detail(detail: &FaultDetail) -> String {
    let fault = &detail.fault;
    let mut text = format!(
        "fault {}  {} {}  {}\nunit {}  part {}  {}  seen {} times, {} .. {}\n",
        fault.id,
        fault.code,
        fault.code_name,
        fault.severity,
        fault.unit_serial,
        fault.lru,
        fault.state.as_str(),
        fault.occurrences,
        local(fault.first_at_us),
        local(fault.last_at_us),
    );
    let mut table = Table::new(&["SEEN AT", "RUN", "TRACE", "WHAT"]);
    for seen in &detail.occurrences {
        table.row([
            local(seen.at_us),
            seen.run_id.short(),
            seen.trace_id.map_or_else(String::new, |id| id.short()),
            seen.message.clone(),
        ]);
    }
    text.push_str(&format!("\n{}\n", table.render()));
    if let Some(last) = detail.occurrences.first() {
        text.push_str(&format!("\nfreeze frame\n{}\n", freeze_frame(&last.freeze)));
    }
    let mut table = Table::new(&["AT", "EVENT", "WHO", "NOTE"]);
    for event in &detail.events {
        let repair = event.repair.as_ref().map_or_else(String::new, |repair| {
            format!(
                "{} {} → {} {}",
                repair.part,
                repair.serial_old.as_deref().unwrap_or("?"),
                repair.serial_new.as_deref().unwrap_or("?"),
                repair.note
            )
        });
        let note = format!("{}{repair}", event.note);
        table.row([
            local(event.at_us),
            event.kind.clone(),
            event.who.clone(),
            note,
        ]);
    }
    text.push_str(&format!("\n{}", table.render()));
    text
}

fn freeze_frame(samples: &[FreezeSample]) -> String {
    let mut table = Table::new(&["SIGNAL", "VALUE"]);
    for sample in samples {
        let value = match (&sample.label, sample.value) {
            (Some(label), _) => label.clone(),
            (None, Some(value)) => format!("{value:.2} {}", sample.unit),
            (None, None) => "not known".into(),
        };
        table.row([sample.name.clone(), value]);
    }
    table.render()
}
