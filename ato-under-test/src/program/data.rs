//! Reads configuration, track database and fault modes from the scripts directory.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::Result;
use ato_under_test::Setup;
use ato_under_test::flash::{BlockDevice, FileFlash};
use protocol::config::UnitConfig;
use protocol::injection::{FaultCatalogue, FaultMode};
use protocol::line::Line;

use super::Arguments;

/// Longest file that is read, bytes.
const LONGEST_FILE: u64 = 4 << 20;

/// The user asked for something that is not there.
#[derive(Debug)]
pub struct UsageError(String);

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for UsageError {}

/// The unit the arguments describe.
pub fn setup(arguments: &Arguments) -> Result<Setup> {
    let scripts = scripts_directory(arguments.scripts.as_deref())?;
    let unit_file = scripts.join(format!("units/{}.toml", arguments.unit_config));
    let line_file = scripts.join(format!("lines/{}.toml", arguments.line));
    let unit_text = read(&unit_file)?;
    let line_text = read(&line_file)?;
    Ok(Setup {
        serial: arguments.serial_no.clone(),
        config: UnitConfig::from_toml(&unit_text).map_err(|e| wrong(&unit_file, &e))?,
        config_crc: protocol::config::checksum(&unit_text),
        line: Line::from_toml(&line_text).map_err(|e| wrong(&line_file, &e))?,
        tdb_crc: protocol::line::checksum(&line_text),
        seed: arguments.seed,
        faults: faults(&scripts, &arguments.inject)?,
    })
}

/// The memory that the unit had before.
pub fn flash(file: &Path) -> Result<Box<dyn BlockDevice>> {
    match FileFlash::open(file) {
        Ok(flash) => Ok(Box::new(flash)),
        Err(why) => Err(UsageError(why).into()),
    }
}

fn scripts_directory(given: Option<&Path>) -> Result<PathBuf> {
    if let Some(directory) = given {
        return Ok(directory.to_owned());
    }
    let program = std::env::current_exe().unwrap_or_default();
    std::iter::once(Path::new("."))
        .chain(program.ancestors())
        .map(|place| place.join("scripts"))
        .find(|directory| directory.join("units").is_dir())
        .ok_or_else(|| {
            UsageError(
                "no scripts directory here or above the program; name it with --scripts".into(),
            )
            .into()
        })
}

fn faults(scripts: &Path, names: &[String]) -> Result<Vec<FaultMode>> {
    if names.is_empty() {
        return Ok(Vec::new());
    }
    let file = scripts.join("units/faults.toml");
    let catalogue = FaultCatalogue::from_toml(&read(&file)?).map_err(|e| wrong(&file, &e))?;
    let find = |name: &String| {
        let fault = catalogue.fault(name).cloned().ok_or_else(|| {
            UsageError(format!("no fault {name}; `ptu catalog faults` lists them"))
        })?;
        if fault.place.on_train() {
            let text = "is on the train around the unit: the bench injects it, `ptu run --inject`";
            return Err(UsageError(format!("fault {name} {text}")).into());
        }
        Ok(fault)
    };
    names.iter().map(find).collect()
}

fn read(file: &Path) -> Result<String, UsageError> {
    let cannot =
        |why: &dyn fmt::Display| UsageError(format!("cannot read {}: {why}", file.display()));
    let about = std::fs::metadata(file).map_err(|error| cannot(&error))?;
    // A pipe would be waited for, a device may never end.
    if !about.is_file() {
        return Err(cannot(&"it is no regular file"));
    }
    if about.len() > LONGEST_FILE {
        return Err(cannot(&format!("it is longer than {LONGEST_FILE} bytes")));
    }
    std::fs::read_to_string(file).map_err(|error| cannot(&error))
}

fn wrong(file: &Path, error: &dyn fmt::Display) -> UsageError {
    UsageError(format!("{}: {error}", file.display()))
}
