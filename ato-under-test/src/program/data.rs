//! Reads configuration, track database and fault modes from the scripts directory.

use std::fmt;
use std::path::Path;

use ato_under_test::Setup;
use ato_under_test::flash::{BlockDevice, FileFlash};
use protocol::config::UnitConfig;
use protocol::injection::{FaultCatalogue, FaultMode};
use protocol::line::Line;
use script_files::{Found, ScriptFiles};

use super::{Arguments, Failure};

/// Longest file that is read, bytes.
const LONGEST_FILE: u64 = 4 << 20;

/// The user asked for something that is not there.
#[derive(Debug)]
pub struct UsageError(pub String);

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for UsageError {}

/// The unit the arguments describe.
pub fn setup(arguments: &Arguments) -> Result<Setup, Failure> {
    let scripts = ScriptFiles::find(arguments.scripts.as_deref())
        .map_err(|error| UsageError(error.to_string()))?;
    let unit_file = format!("units/{}.toml", arguments.unit_config);
    let line_file = format!("lines/{}.toml", arguments.line);
    let unit_text = read(&scripts, &unit_file)?;
    let line_text = read(&scripts, &line_file)?;
    Ok(Setup {
        serial: arguments.serial_no.clone(),
        config: UnitConfig::from_toml(&unit_text).map_err(|e| wrong(&scripts, &unit_file, &e))?,
        config_crc: protocol::config::checksum(&unit_text),
        line: Line::from_toml(&line_text).map_err(|e| wrong(&scripts, &line_file, &e))?,
        tdb_crc: protocol::line::checksum(&line_text),
        seed: arguments.seed,
        faults: faults(&scripts, &arguments.inject)?,
    })
}

/// The memory that the unit had before.
pub fn flash(file: &Path) -> Result<Box<dyn BlockDevice>, Failure> {
    match FileFlash::open(file) {
        Ok(flash) => Ok(Box::new(flash)),
        Err(why) => Err(UsageError(why).into()),
    }
}

fn faults(scripts: &ScriptFiles, names: &[String]) -> Result<Vec<FaultMode>, Failure> {
    if names.is_empty() {
        return Ok(Vec::new());
    }
    let files = scripts.catalogue();
    let texts: Result<Vec<_>, _> = files.iter().map(|file| read(scripts, file)).collect();
    let catalogue = FaultCatalogue::from_toml(&texts?.join("\n"))
        .map_err(|e| wrong(scripts, &files.join(" with "), &e))?;
    let find = |name: &String| {
        let fault = catalogue.fault(name).cloned().ok_or_else(|| {
            UsageError(format!("no fault {name}; `ptu catalog faults` lists them"))
        })?;
        if !fault.place.in_unit() {
            let text = "is around the unit: the bench injects it, `ptu run --inject`";
            return Err(UsageError(format!("fault {name} {text}")).into());
        }
        Ok(fault)
    };
    names.iter().map(find).collect()
}

fn read(scripts: &ScriptFiles, name: &str) -> Result<String, UsageError> {
    let file = match scripts.file(name) {
        Some(Found::File(file)) => file,
        Some(Found::Embedded(_, bytes)) => return Ok(String::from_utf8_lossy(bytes).into_owned()),
        None => {
            return Err(UsageError(format!(
                "there is no file {}",
                scripts.shown(name)
            )));
        }
    };
    let cannot =
        |why: &dyn fmt::Display| UsageError(format!("cannot read {}: {why}", file.display()));
    let about = std::fs::metadata(&file).map_err(|error| cannot(&error))?;
    // Reading a pipe would wait, reading a device may never end.
    if !about.is_file() {
        return Err(cannot(&"it is no regular file"));
    }
    if about.len() > LONGEST_FILE {
        return Err(cannot(&format!("it is longer than {LONGEST_FILE} bytes")));
    }
    std::fs::read_to_string(&file).map_err(|error| cannot(&error))
}

fn wrong(scripts: &ScriptFiles, name: &str, error: &dyn fmt::Display) -> UsageError {
    UsageError(format!("{}: {error}", scripts.shown(name)))
}
