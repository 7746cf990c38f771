//! One function for each subject.

use std::path::Path;

use fault_db::{Address, Store, StoreError};

use super::Finding;
use crate::cli::gui;
use ptu_runs::clock::{ClockState, local_minute as day, now_us};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;
use ptu_runs::link::ports;
use ptu_runs::owner_only;
use ptu_runs::run::{BenchChoice, Suite};

/// Below this, runs may soon find no room, bytes, a value of this program: some thousand runs with their traces.
const LITTLE_ROOM: u64 = 1 << 30;
/// Below this, the next runs may, bytes, a value of this program.
const NO_ROOM: u64 = 100 << 20;
/// The newest run is at most this far ahead of a clock that is right, µs: another computer's clock may be off a little.
const AHEAD_US: i64 = 3_600_000_000;

/// The scripts load, and own ones do not silently replace what came with the program.
pub(super) fn scripts(found: Result<ScriptsDirectory, Failure>) -> Vec<Finding> {
    const SUBJECT: &str = "scripts";
    let remedy = "correct the file, or move it away; `ptu run --check` shows all errors";
    let directory = match found {
        Ok(directory) => directory,
        Err(failure) => {
            return vec![Finding::wrong(
                SUBJECT,
                failure.to_string(),
                "name another with --scripts",
            )];
        }
    };
    let places: Vec<_> = directory.places().iter().map(ToString::to_string).collect();
    let loaded = BenchChoice::default()
        .setup(&directory)
        .and_then(|setup| Suite::load(&directory, &[], &setup))
        .and_then(|suite| directory.check_data().map(|data| (suite, data)));
    let first = match loaded {
        Ok((suite, data)) if suite.errors.is_empty() => Finding::ok(
            SUBJECT,
            format!(
                "{} procedures and {data} data files: {}",
                suite.procedures.len(),
                places.join(", over ")
            ),
        ),
        Ok((suite, _)) => Finding::wrong(SUBJECT, suite.errors.join("; "), remedy),
        Err(failure) => Finding::wrong(SUBJECT, failure.to_string(), remedy),
    };
    let mut findings = vec![first];
    let replacing = directory.replacing().unwrap_or_default();
    if !replacing.is_empty() {
        findings.push(Finding::warning(
            SUBJECT,
            format!("in place of those of the program: {}", replacing.join(", ")),
            "after an update of the program, compare them with its own; remove those that are no longer needed",
        ));
    }
    findings
}

/// Serial ports can be opened.
pub(super) fn ports() -> Vec<Finding> {
    const SUBJECT: &str = "ports";
    let found = match ports::found() {
        Ok(found) => found,
        Err(failure) => {
            return vec![Finding::warning(
                SUBJECT,
                failure.to_string(),
                "name a port with --unit serial:PATH",
            )];
        }
    };
    if found.is_empty() {
        return vec![Finding::ok(
            SUBJECT,
            "none found; the simulated unit and units over TCP need none",
        )];
    }
    let mut findings = Vec::new();
    for port in &found {
        findings.push(match ports::closed_to_user(&port.path) {
            None => Finding::ok(SUBJECT, format!("{} ({})", port.path, port.kind)),
            Some(group) => closed_port(&port.path, port.kind, group.as_deref()),
        });
    }
    if found.iter().any(|port| port.kind == "usb") && ports::is_probed_by_others() {
        findings.push(Finding::warning(
            SUBJECT,
            "ModemManager writes to serial adapters that are plugged in",
            "install the rule of the package, 60-ptu.rules, or: sudo systemctl disable --now ModemManager",
        ));
    }
    findings
}

/// A port that this user may not open, and the group whose members may, if there is one.
fn closed_port(path: &str, kind: &str, group: Option<&str>) -> Finding {
    // Who joins the group "root" may do more than open ports.
    let remedy = match group.filter(|group| *group != "root") {
        Some(group) => format!("sudo usermod -aG {group} $USER, then log out and in again"),
        None => {
            "install the rule of the package, 60-ptu.rules; then: sudo usermod -aG dialout $USER, and log out and in \
             again"
                .into()
        }
    };
    Finding::warning(
        "ports",
        format!("{path} ({kind}) may not be opened by this user"),
        remedy,
    )
}

/// The window can open.
pub(super) fn display() -> Finding {
    const SUBJECT: &str = "display";
    if !gui::window().is_file() {
        return Finding::ok(SUBJECT, "the window is not installed");
    }
    let named = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    if cfg!(not(target_os = "linux")) {
        return Finding::ok(SUBJECT, "the system's own");
    }
    match named("WAYLAND_DISPLAY").or(named("DISPLAY")) {
        Some(display) => Finding::ok(SUBJECT, display),
        None => Finding::warning(
            SUBJECT,
            "none: neither DISPLAY nor WAYLAND_DISPLAY is set",
            "for the window, start `ptu` from a desktop; a bench without a screen needs none",
        ),
    }
}

/// The history can be read and written, and is not of the future.
pub(super) fn database(file: &Path) -> Vec<Finding> {
    const SUBJECT: &str = "database";
    let shown = file.display();
    if !file.exists() {
        return vec![match in_writable_folder(file) {
            true => Finding::ok(SUBJECT, format!("{shown} will be made by the first run")),
            false => Finding::wrong(
                SUBJECT,
                format!("{shown} cannot be made: its folder may not be written to"),
                "name another with --db, or ask for the right",
            ),
        }];
    }
    let remedy = "`ptu db check` says more; a backup is read with --db";
    let store = match Store::open_read_only(file) {
        Ok(store) => store,
        Err(StoreError::OlderSchema { .. }) => {
            return vec![Finding::ok(
                SUBJECT,
                format!("{shown} is of an earlier version; the next run brings it up to date"),
            )];
        }
        Err(error) => return vec![Finding::wrong(SUBJECT, error.to_string(), remedy)],
    };
    let mut findings = Vec::new();
    if std::fs::OpenOptions::new().append(true).open(file).is_err() {
        findings.push(Finding::wrong(
            SUBJECT,
            format!("{shown} can be read and not written: runs are not recorded"),
            "ask for the right to write it, or name another with --db",
        ));
    }
    if let Some(told) = owner_only::told_if_shared(file) {
        findings.push(Finding::warning(
            SUBJECT,
            told,
            "keep it to yourself, or leave it if that is meant",
        ));
    }
    let newest = store.resolve_run("latest").and_then(|id| store.run(id));
    match newest {
        Ok(run) if run.run.started_at_us > now_us() + AHEAD_US => findings.push(Finding::warning(
            "clock",
            format!(
                "the newest run is of {}, later than this computer's clock, {}",
                day(run.run.started_at_us),
                day(now_us())
            ),
            "set the clock: dates in the history come from it",
        )),
        Ok(run) => findings.push(Finding::ok(
            SUBJECT,
            format!("{shown}, newest run of {}", day(run.run.started_at_us)),
        )),
        Err(StoreError::NotFound { .. }) => {
            findings.push(Finding::ok(SUBJECT, format!("{shown}, without a run")));
        }
        Err(error) => findings.push(Finding::wrong(SUBJECT, error.to_string(), remedy)),
    }
    findings
}

/// There is room for runs.
pub(super) fn disk(file: &Path) -> Finding {
    const SUBJECT: &str = "disk";
    let Some(folder) = nearest_folder(file) else {
        return Finding::ok(SUBJECT, "not known yet");
    };
    let remedy = "free some space, or name a database on another disk with --db";
    match fs4::available_space(folder) {
        Ok(free) => {
            let found = format!("{} MiB free in {}", free >> 20, folder.display());
            match free {
                ..NO_ROOM => Finding::wrong(SUBJECT, found, remedy),
                NO_ROOM..LITTLE_ROOM => Finding::warning(SUBJECT, found, remedy),
                _ => Finding::ok(SUBJECT, found),
            }
        }
        Err(error) => Finding::warning(
            SUBJECT,
            format!("the room in {} is not told: {error}", folder.display()),
            "look whether the disk is there",
        ),
    }
}

/// Others keep the clock right.
pub(super) fn clock() -> Finding {
    const SUBJECT: &str = "clock";
    let today = day(now_us());
    match ClockState::now() {
        ClockState::Synchronised => Finding::ok(SUBJECT, format!("{today}, set by the network")),
        ClockState::NotSynchronised => Finding::warning(
            SUBJECT,
            format!("{today}, not set by the network since the computer was started"),
            "connect to the network once, or compare it with a clock that is right",
        ),
        ClockState::Unknown => Finding::ok(
            SUBJECT,
            format!("{today}; the system does not say whether it is set by the network"),
        ),
    }
}

/// The server answers, if there is one.
pub(super) fn server(server: Option<&Address>) -> Finding {
    const SUBJECT: &str = "server";
    let Some(server) = server else {
        return Finding::ok(SUBJECT, "none named; with --server it is tried");
    };
    match Store::connect_read_only(server) {
        Ok(_) => Finding::ok(SUBJECT, format!("{server} answers")),
        Err(error) => Finding::warning(
            SUBJECT,
            error.to_string(),
            "runs are recorded here all the same; sync them when it answers",
        ),
    }
}

fn nearest_folder(file: &Path) -> Option<&Path> {
    let folder = |path: &&Path| path.is_dir();
    let above = file.ancestors().skip(1);
    above
        .map(|path| match path.as_os_str().is_empty() {
            true => Path::new("."),
            false => path,
        })
        .find(folder)
}

fn in_writable_folder(file: &Path) -> bool {
    nearest_folder(file).is_some_and(|folder| tempfile::tempfile_in(folder).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::doctor::State;

    #[test]
    fn a_closed_port_is_a_warning_that_says_how_to_open_it() {
        for (group, remedy) in [
            (
                Some("uucp"),
                "sudo usermod -aG uucp $USER, then log out and in again",
            ),
            (
                Some("root"),
                "sudo usermod -aG dialout $USER, and log out and in again",
            ),
            (
                None,
                "sudo usermod -aG dialout $USER, and log out and in again",
            ),
        ] {
            let finding = closed_port("/dev/ttyUSB0", "usb", group);
            assert_eq!(finding.state, State::Warning);
            let said = finding.remedy.unwrap_or_default();
            assert!(said.ends_with(remedy), "{group:?}: {said}");
        }
    }
}
