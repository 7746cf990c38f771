//! JSON Schemas of the data files, made of the types that read them, for editors that complete and check while one writes.

use btu_rig::bench_scatter::BenchScatter;
use btu_rig::drive::scatter::Scatter;
use btu_rig::train::TrainData;
use diagnosis::Settings;
use protocol::config::UnitConfig;
use protocol::injection::FaultCatalogue;
use schemars::{JsonSchema, Schema, SchemaGenerator};

use crate::{clauses, fleet, places, structure, symptoms};

/// A schema, and the files that have it.
pub struct FileSchema {
    /// Name of the schema, without the ending.
    pub name: &'static str,
    /// Paths under the scripts directory, with `*` for any name.
    pub files: &'static [&'static str],
    /// Paths among `files` that have another schema.
    pub except: &'static [&'static str],
    pub schema: Schema,
}

/// All schemas.
pub fn all() -> Vec<FileSchema> {
    let file = |name, files, schema| FileSchema {
        name,
        files,
        except: &[],
        schema,
    };
    // Modes that a user adds use the parts that the embedded catalogue lists.
    let mut further_faults = of::<FaultCatalogue>();
    further_faults.insert("required".to_owned(), ["faults"].into());
    vec![
        FileSchema {
            except: &["units/faults.toml", "units/structure.toml"],
            ..file("unit", &["units/*.toml"], of::<UnitConfig>())
        },
        file("faults", &["units/faults.toml"], of::<FaultCatalogue>()),
        file("further_faults", &["faults/*.toml"], further_faults),
        file(
            "structure",
            &["units/structure.toml"],
            of::<structure::Written>(),
        ),
        file("line", &["lines/*.toml"], protocol::line::file_schema()),
        file("train", &["trains/*.toml"], of::<TrainData>()),
        file("scatter", &["scatter.toml"], of::<Scatter>()),
        file(
            "bench_scatter",
            &["bench_scatter.toml"],
            of::<BenchScatter>(),
        ),
        file("bench", &["benches/*.toml"], of::<places::Written>()),
        file("instrument", &["instruments/*.toml"], of::<places::Model>()),
        file("diagnosis", &["diagnosis.toml"], of::<Settings>()),
        file("fleet", &["fleet.toml"], of::<fleet::FleetFile>()),
        file("symptoms", &["symptoms.toml"], of::<symptoms::Written>()),
        file("clauses", &["clauses.toml"], of::<clauses::Written>()),
    ]
}

fn of<T: JsonSchema>() -> Schema {
    SchemaGenerator::default().into_root_schema_for::<T>()
}
