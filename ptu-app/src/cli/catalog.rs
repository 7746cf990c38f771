//! `ptu catalog`: the names that commands and scripts can use.

use btu_rig::procedure::describe::bit_names;
use btu_rig::procedure::plan::Connection;
use btu_rig::tcms::Consist;
use btu_rig::train::{CarSet, MAX_CARS, Role, TrainData};
use clap::{Args, ValueEnum};
use protocol::injection::OutOfReach;
use protocol::signal::{Kind, Origin, Signal};
use ptu_report::words::Words;
use serde_json::{Value, json};

use super::output::Form;
use super::{ScriptsOption, answered, print_json};
use ptu_runs::clauses;
use ptu_runs::failure::{DriveTrouble, Exit, Failure};
use ptu_runs::run_diagnosis::choose;
use ptu_runs::stdio;
use ptu_runs::structure::Structure;
use ptu_runs::symptoms;
use ptu_runs::table::Table;

/// Show faults, signals, speed codes, lines, parts, the structure, symptoms, clauses or a train's cars
#[derive(Debug, Args)]
pub struct CatalogArguments {
    /// What to show
    #[arg(value_enum)]
    what: CatalogTopic,
    /// Only entries with this text in them, as `eb`
    text: Option<String>,
    /// Unit configuration whose speed codes to show
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Train whose cars to show: line6 or another trains/NAME.toml, or a file ending in .toml
    #[arg(long, value_name = "NAME|FILE", default_value = "line6")]
    train: String,
    #[command(flatten)]
    form: Form,
    #[command(flatten)]
    scripts: ScriptsOption,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CatalogTopic {
    /// Fault modes that can be injected
    Faults,
    /// Recorded signals
    Signals,
    /// Speed codes of the unit configuration
    Codes,
    /// Lines and their sections
    Lines,
    /// Parts that can be replaced
    Parts,
    /// Parts that each signal comes through, from the sensors on
    Structure,
    /// Symptoms of a unit, and the parts that they may come from
    Symptoms,
    /// Clauses of standards and papers, the steps that prove them, and the injected faults that make these steps fail
    Clauses,
    /// Masses and brake forces of a train: of each car, each MT pair and the whole train
    Train,
}

impl CatalogArguments {
    /// Prints the catalogue.
    pub fn run(self) -> Result<Exit, Failure> {
        let mut entries = match self.what {
            CatalogTopic::Clauses => return self.clauses(),
            CatalogTopic::Faults => self.faults()?,
            CatalogTopic::Signals => signals(),
            CatalogTopic::Codes => self.codes()?,
            CatalogTopic::Lines => self.lines()?,
            CatalogTopic::Parts => self.parts()?,
            CatalogTopic::Structure => self.structure()?,
            CatalogTopic::Symptoms => self.symptoms()?,
            CatalogTopic::Train => self.train()?,
        };
        entries.retain(|entry| self.is_about(entry));
        self.form.print(&entries, || as_table(&entries))
    }

    /// Whether a value of the entry contains the text that was asked for.
    fn is_about(&self, entry: &Value) -> bool {
        let wanted = self.text.as_deref().unwrap_or_default().to_lowercase();
        let values = entry
            .as_object()
            .into_iter()
            .flat_map(|entry| entry.values());
        let mut texts = values.map(|value| match value {
            Value::String(text) => text.to_lowercase(),
            other => other.to_string().to_lowercase(),
        });
        texts.any(|text| text.contains(&wanted))
    }

    fn faults(&self) -> Result<Vec<Value>, Failure> {
        let catalogue = self.scripts.find()?.faults()?;
        let entry = |fault: &protocol::injection::FaultMode| {
            json!({
                "id": fault.id, "part": fault.lru, "mode": fault.mode,
                "severity": fault.severity, "weight": fault.weight, "unsafe": fault.unsafe_,
                "on": on(fault.place), "car": fault.car,
                "kind": fault.kind().word(), "out_of_reach": fault.out_of_reach.map(OutOfReach::word),
            })
        };
        Ok(catalogue.faults.iter().map(entry).collect())
    }

    fn parts(&self) -> Result<Vec<Value>, Failure> {
        let catalogue = self.scripts.find()?.faults()?;
        let entry = |lru: &protocol::injection::Lru| json!({ "id": lru.id, "name": lru.name, "name_ko": lru.name_ko });
        Ok(catalogue.lrus.iter().map(entry).collect())
    }

    fn structure(&self) -> Result<Vec<Value>, Failure> {
        let directory = self.scripts.find()?;
        let structure = Structure::load(&directory, &directory.faults()?)?;
        let entry =
            |(signal, parts): (Signal, _)| json!({ "signal": signal.name(), "parts": parts });
        Ok(structure.signals().map(entry).collect())
    }

    fn symptoms(&self) -> Result<Vec<Value>, Failure> {
        let entry = |symptom: symptoms::Symptom| json!({ "id": symptom.id, "name": symptom.name, "parts": symptom.parts });
        let directory = self.scripts.find()?;
        let symptoms = symptoms::load(&directory, &directory.faults()?.lrus)?;
        Ok(symptoms.into_iter().map(entry).collect())
    }

    /// Prints the matrix of clauses. A clause without a step or a step without a clause gives exit code 1.
    fn clauses(&self) -> Result<Exit, Failure> {
        let directory = self.scripts.find()?;
        let chosen = choose(None, &directory, Connection::Btu)?;
        for warning in &chosen.warnings {
            stdio::note(&warning.to_string());
        }
        let mut matrix = clauses::matrix(&clauses::load(&directory)?, &chosen.dictionary);
        let is_whole =
            matrix.clauses_without_step.is_empty() && matrix.steps_without_clause.is_empty();
        matrix.clauses.retain(|proof| self.is_about(&json!(proof)));
        let told = match self.form.is_json() {
            true => print_json(&matrix),
            false => {
                let rows: Vec<_> = matrix.clauses.iter().map(|proof| json!(proof)).collect();
                self.form.print(&rows, || clauses_text(&matrix))
            }
        };
        answered(told, if is_whole { Exit::Passed } else { Exit::Failed })
    }

    fn codes(&self) -> Result<Vec<Value>, Failure> {
        let config = self.scripts.find()?.unit_config(&self.unit_config)?.content;
        let entry = |(index, code): (usize, &protocol::config::SpeedCode)| {
            json!({
                "index": index, "name": code.name, "limit_kmh": code.limit_kmh,
                "carrier_hz": code.carrier_hz, "rate_hz": code.rate_hz,
                "meaning": code.meaning.label(), "stands_for": code.stands_for,
            })
        };
        Ok(config.codes.iter().enumerate().map(entry).collect())
    }

    fn lines(&self) -> Result<Vec<Value>, Failure> {
        let scripts = self.scripts.find()?;
        let mut entries = Vec::new();
        for name in scripts.line_names() {
            let file = scripts.line(&name)?;
            for section in file.content.sections {
                entries.push(json!({
                    "line": name, "section": section.section, "length_m": section.length_m,
                    "from_station": section.from_station, "to_station": section.to_station,
                    "checksum": format!("{:08x}", file.crc),
                }));
            }
        }
        Ok(entries)
    }
}

impl CatalogArguments {
    /// The table of cars of S3, computed from the train's file: each car, each MT pair, the whole train.
    fn train(&self) -> Result<Vec<Value>, Failure> {
        let TrainData::Cars(data) = self.scripts.find()?.train(&self.train)? else {
            return Err(Failure::usage(DriveTrouble::PointMass(self.train.clone())));
        };
        let empty = Consist::new(&data);
        let mut full = empty.clone();
        full.weigh(data.cars.iter().map(|car| car.full_load_kg).sum());
        let row = |number: Option<usize>, name: &str, role: &str, pair, cars: CarSet| {
            let pair: Option<usize> = pair;
            let sum =
                |value: &dyn Fn(usize) -> f64| cars.iter().map(value).sum::<f64>().round() as i64;
            let car = |i: usize| &data.cars[i];
            json!({
                "car": number, "name": name, "role": role, "pair": pair,
                "empty_kg": sum(&|i| car(i).empty_kg),
                "bogies_kg": sum(&|i| car(i).bogies_kg),
                "full_kg": sum(&|i| car(i).weight_kg(1.0)),
                "braking_empty_kg": sum(&|i| car(i).empty_kg + car(i).rotating_kg),
                "braking_full_kg":
                    sum(&|i| car(i).full_inertia_kg()),
                "brake_empty_n": sum(&|i| empty.full_service_n[i]),
                "brake_full_n": sum(&|i| full.full_service_n[i]),
                "regeneration_empty_n": sum(&|i| empty.electric_n[i]),
                "regeneration_full_n": sum(&|i| full.electric_n[i]),
            })
        };
        let mut rows = Vec::new();
        let mut all = CarSet::NONE;
        for (i, car) in data.cars.iter().enumerate() {
            let role = match car.role {
                Role::Motor => "motor",
                Role::Trailer => "trailer",
            };
            rows.push(row(
                Some(i + 1),
                &car.name,
                role,
                Some(car.pair),
                CarSet::one(i),
            ));
            all.set(i, true);
        }
        for (i, pair) in full.pairs.iter().enumerate() {
            let cars = pair.motors.with(pair.trailers);
            let names: Vec<_> = cars
                .iter()
                .map(|car| data.cars[car].name.as_str())
                .collect();
            rows.push(row(None, &names.join("+"), "pair", Some(i + 1), cars));
        }
        rows.push(row(None, &data.name, "train", None, all));
        Ok(rows)
    }
}

fn signals() -> Vec<Value> {
    let entry = |signal: &Signal| {
        let definition = signal.definition();
        let (kind, lsb, labels) = match definition.kind {
            Kind::Number { lsb } => ("number", Some(lsb), None),
            Kind::Enum(labels) => ("enum", None, Some(labels)),
            Kind::Bit => ("bit", None, None),
        };
        json!({
            "name": definition.name, "unit": definition.unit, "kind": kind, "lsb": lsb,
            "labels": labels, "bits": bits(*signal), "low": definition.low, "high": definition.high,
            "from": match definition.origin { Origin::Rig => "rig", Origin::Unit => "unit" },
            "about": definition.doc,
        })
    };
    Signal::ALL.iter().map(entry).collect()
}

/// Names of a signal's bits from bit 0; `None` for a signal that is not a set of named bits.
fn bits(signal: Signal) -> Option<Vec<String>> {
    let cars = (signal == Signal::NotReleased).then_some(MAX_CARS);
    let count = cars.unwrap_or(u16::BITS as usize);
    let names = (0..count).map_while(|bit| bit_names(signal, 1 << bit));
    Some(names.collect()).filter(|names: &Vec<_>| !names.is_empty())
}

/// Table with a row for each entry; its columns are the keys of the first entry, in their order.
fn as_table(entries: &[Value]) -> String {
    let Some(keys) = entries.first().and_then(Value::as_object).map(|o| o.keys()) else {
        return Words::shown().terminal.nothing_there.into();
    };
    let keys: Vec<_> = keys.map(String::as_str).collect();
    let parts = keys
        .iter()
        .position(|key| *key == "part" || *key == "parts");
    let mut table = Table::new(&keys).parts(parts);
    for entry in entries {
        table.row(keys.iter().map(|key| match &entry[*key] {
            Value::String(text) => text.clone(),
            Value::Null => String::new(),
            Value::Array(items) => {
                let words: Vec<_> = items.iter().filter_map(Value::as_str).collect();
                words.join("/")
            }
            other => other.to_string(),
        }));
    }
    table.render()
}

fn clauses_text(matrix: &clauses::Matrix) -> String {
    let mut table = Table::new(&[
        "CLAUSE",
        "STEPS",
        "FAULTS",
        "NOT SHOWN TO FAIL",
        "DEMANDS",
        "SOURCE",
    ]);
    for proof in &matrix.clauses {
        table.row([
            proof.clause.clone(),
            proof.steps.len().to_string(),
            proof.faults.len().to_string(),
            proof.unproved.len().to_string(),
            proof.text.clone(),
            proof.source.clone(),
        ]);
    }
    let mut text = table.render() + "\n\n";
    for clause in &matrix.clauses_without_step {
        text += &format!("clause {clause}: no step proves it\n");
    }
    for step in &matrix.steps_without_clause {
        text += &format!("{step}: cites no clause\n");
    }
    text += &format!(
        "{} of {} steps fail under an injected fault; the others are listed by --json as `unproved`\n",
        matrix.steps - matrix.steps_without_fault,
        matrix.steps
    );
    text
}

/// Where a fault mode acts: `train`, `bench` or `unit`.
fn on(place: protocol::injection::Place) -> &'static str {
    match () {
        () if place.on_train() => "train",
        () if place.on_bench() => "bench",
        () => "unit",
    }
}
