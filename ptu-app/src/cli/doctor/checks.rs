//! The checks of `ptu doctor`, a function for each subject.

use std::path::Path;

use fault_db::{Address, Instrument, Store, StoreError};

use super::Finding;
use crate::cli::gui;
use ptu_report::words::{Doctor, Words, fill};
use ptu_runs::clock::{ClockState, local_minute as day, now_us};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;
use ptu_runs::link::ports;
use ptu_runs::owner_only;
use ptu_runs::places::{Placed, Places};
use ptu_runs::run::{BenchChoice, Suite};

/// Free bytes below which later runs may not fit (warning): some thousand runs with traces. A value of this program.
const LITTLE_ROOM: u64 = 1 << 30;
/// Free bytes below which the next runs may not fit (wrong). A value of this program.
const NO_ROOM: u64 = 100 << 20;
/// Rounds in which each instrument is tried.
const ROUNDS: u32 = 20;
/// Kind under which a Modbus module is registered. Its reaction time is registered under a unit of its own, as it is
/// not the uncertainty of a measured time.
const MODULE: &str = "modbus module";
const REACTION: &str = "ms reaction";
/// The newest run may be this far ahead of a clock that is right, µs: the other computer's clock may be off a little.
const AHEAD_US: i64 = 3_600_000_000;

/// Checks that the scripts load, and says which shipped files the user's own files replace.
pub(super) fn scripts(found: Result<ScriptsDirectory, Failure>, words: &Words) -> Vec<Finding> {
    let doctor = &words.doctor;
    let subject = doctor.scripts;
    let remedy = doctor.correct_script;
    let directory = match found {
        Ok(directory) => directory,
        Err(failure) => {
            let found = words.told(&failure.message);
            return vec![Finding::wrong(subject, found, doctor.other_scripts)];
        }
    };
    let places: Vec<_> = directory.places().iter().map(ToString::to_string).collect();
    let loaded = BenchChoice::default()
        .setup(&directory)
        .and_then(|setup| Suite::load(&directory, &[], &setup))
        .and_then(|suite| directory.check_data().map(|data| (suite, data)));
    let first = match loaded {
        Ok((suite, data)) if suite.errors.is_empty() => {
            let (n, places) = (suite.procedures.len(), places.join(doctor.over));
            let of = [
                ("n", &n as _),
                ("data", &data as _),
                ("places", &places as _),
            ];
            Finding::ok(subject, fill(doctor.loaded, &of))
        }
        Ok((suite, _)) => Finding::wrong(subject, suite.errors.join("; "), remedy),
        Err(failure) => Finding::wrong(subject, words.told(&failure.message), remedy),
    };
    let mut findings = vec![first];
    let replacing = directory.replacing().unwrap_or_default();
    if !replacing.is_empty() {
        let found = fill(doctor.replacing, &[("names", &replacing.join(", "))]);
        findings.push(Finding::warning(subject, found, doctor.compare_them));
    }
    findings
}

/// Checks that this user can open the serial ports.
pub(super) fn ports(words: &Words) -> Vec<Finding> {
    let doctor = &words.doctor;
    let subject = doctor.ports;
    let found = match ports::found() {
        Ok(found) => found,
        Err(failure) => {
            let found = words.told(&failure.message);
            return vec![Finding::warning(subject, found, doctor.name_port)];
        }
    };
    if found.is_empty() {
        return vec![Finding::ok(subject, doctor.no_port)];
    }
    let mut findings = Vec::new();
    for port in &found {
        findings.push(match ports::closed_to_user(&port.path) {
            None => Finding::ok(subject, format!("{} ({})", port.path, port.kind)),
            Some(group) => closed_port(&port.path, port.kind, group.as_deref(), doctor),
        });
    }
    if found.iter().any(|port| port.kind == "usb") && ports::is_probed_by_others() {
        let remedy = doctor.stop_probing;
        findings.push(Finding::warning(subject, doctor.probed, remedy));
    }
    findings
}

/// Finding on a port that this user may not open; the remedy names the group whose members may.
fn closed_port(path: &str, kind: &str, group: Option<&str>, doctor: &Doctor) -> Finding {
    // Nobody should join the group "root": its members may do more than open ports.
    let remedy = match group.filter(|group| *group != "root") {
        Some(group) => fill(doctor.join_group, &[("group", &group)]),
        None => doctor.install_rule.into(),
    };
    let of = [("path", &path as _), ("kind", &kind as _)];
    Finding::warning(doctor.ports, fill(doctor.port_closed, &of), remedy)
}

/// Checks that there is a display for the window.
pub(super) fn display(words: &Words) -> Finding {
    let doctor = &words.doctor;
    let subject = doctor.display;
    if !gui::window().is_file() {
        return Finding::ok(subject, doctor.no_window);
    }
    let named = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    if cfg!(not(target_os = "linux")) {
        return Finding::ok(subject, doctor.own_display);
    }
    match named("WAYLAND_DISPLAY").or(named("DISPLAY")) {
        Some(display) => Finding::ok(subject, display),
        None => Finding::warning(subject, doctor.no_display, doctor.begin_at_desktop),
    }
}

/// Checks that the history can be read and written, and that its newest run is not of the future.
pub(super) fn database(file: &Path, words: &Words) -> Vec<Finding> {
    let doctor = &words.doctor;
    let subject = doctor.database;
    let shown = file.display();
    let of_file = |wording| fill(wording, &[("file", &shown)]);
    if !file.exists() {
        return vec![match in_writable_folder(file) {
            true => Finding::ok(subject, of_file(doctor.will_be_made)),
            false => Finding::wrong(subject, of_file(doctor.not_made), doctor.other_database),
        }];
    }
    let broken = |error| {
        let found = words.told(&Failure::from(error).message);
        Finding::wrong(subject, found, doctor.check_database)
    };
    let store = match Store::open_read_only(file) {
        Ok(store) => store,
        Err(StoreError::OlderSchema { .. }) => {
            return vec![Finding::ok(subject, of_file(doctor.older))];
        }
        Err(error) => return vec![broken(error)],
    };
    let mut findings = Vec::new();
    if std::fs::OpenOptions::new().append(true).open(file).is_err() {
        let found = of_file(doctor.read_only);
        findings.push(Finding::wrong(subject, found, doctor.other_database));
    }
    if let Some(told) = owner_only::told_if_shared(file) {
        let told = words.told(&told);
        findings.push(Finding::warning(subject, told, doctor.keep_to_yourself));
    }
    let newest = store.resolve_run("latest").and_then(|id| store.run(id));
    findings.push(match newest.map(|run| run.run.started_at_us) {
        Ok(at_us) if at_us > now_us() + AHEAD_US => {
            let of = [("run", &day(at_us) as _), ("now", &day(now_us()) as _)];
            let found = fill(doctor.later_run, &of);
            Finding::warning(doctor.clock, found, doctor.set_clock)
        }
        Ok(at_us) => {
            let of = [("file", &shown as _), ("run", &day(at_us) as _)];
            Finding::ok(subject, fill(doctor.newest, &of))
        }
        Err(StoreError::NotFound { .. }) => Finding::ok(subject, of_file(doctor.no_run)),
        Err(error) => broken(error),
    });
    findings
}

/// Checks the room on the disk for runs.
pub(super) fn disk(file: &Path, words: &Words) -> Finding {
    let doctor = &words.doctor;
    let subject = doctor.disk;
    let Some(folder) = nearest_folder(file) else {
        return Finding::ok(subject, doctor.not_known);
    };
    let remedy = doctor.free_space;
    let shown = folder.display();
    match fs4::available_space(folder) {
        Ok(free) => {
            let found = fill(doctor.room, &[("n", &(free >> 20)), ("folder", &shown)]);
            match free {
                ..NO_ROOM => Finding::wrong(subject, found, remedy),
                NO_ROOM..LITTLE_ROOM => Finding::warning(subject, found, remedy),
                _ => Finding::ok(subject, found),
            }
        }
        Err(error) => {
            let of = [("folder", &shown as _), ("why", &error as _)];
            Finding::warning(
                subject,
                fill(doctor.room_unknown, &of),
                doctor.look_for_disk,
            )
        }
    }
}

/// Checks that the computer's clock is set by the network.
pub(super) fn clock(words: &Words) -> Finding {
    let doctor = &words.doctor;
    let subject = doctor.clock;
    let today = |wording| fill(wording, &[("now", &day(now_us()))]);
    match ClockState::now() {
        ClockState::Synchronised => Finding::ok(subject, today(doctor.set_by_network)),
        ClockState::NotSynchronised => {
            Finding::warning(subject, today(doctor.not_set), doctor.connect_once)
        }
        ClockState::Unknown => Finding::ok(subject, today(doctor.clock_unknown)),
    }
}

/// Checks that the server answers, if one is named.
pub(super) fn server(server: Option<&Address>, words: &Words) -> Finding {
    let doctor = &words.doctor;
    let subject = doctor.server;
    let Some(server) = server else {
        return Finding::ok(subject, doctor.no_server);
    };
    match Store::connect_read_only(server) {
        Ok(_) => Finding::ok(subject, fill(doctor.answers, &[("server", server)])),
        Err(error) => {
            let found = words.told(&Failure::from(error).message);
            Finding::warning(subject, found, doctor.recorded_here)
        }
    }
}

/// Tries each instrument of a bench, and registers the reaction time that was measured.
pub(super) fn bench(
    places: &Places,
    store: &Store,
    words: &Words,
) -> Result<Vec<Finding>, Failure> {
    let doctor = &words.doctor;
    let known = store.instruments()?;
    let mut findings = Vec::new();
    for (name, tried) in Placed::check(places, ROUNDS) {
        let entry = &places.instruments[&name];
        let of = [("name", &name as _), ("serial", &entry.serial as _)];
        let took_ms = match tried {
            Ok(took_ms) => took_ms,
            Err(fault) => {
                let why = words.told(&fault);
                let found = fill(doctor.instrument_wrong, &[of[0], of[1], ("why", &why)]);
                findings.push(Finding::wrong(doctor.bench, found, doctor.remedy(&fault)));
                continue;
            }
        };
        let took = format!("{took_ms:.1}");
        let does = match places.times_more_than_off(&name) {
            true => doctor.acts_and_reads,
            false => doctor.switches_off,
        };
        let of = [
            of[0],
            of[1],
            ("does", &does as _),
            ("took", &took as _),
            ("stated", &entry.uncertainty_ms as _),
        ];
        if took_ms > entry.uncertainty_ms as f64 {
            let found = fill(doctor.instrument_late, &of);
            findings.push(Finding::wrong(doctor.bench, found, doctor.state_more));
            continue;
        }
        let before = known.iter().find(|one| one.serial_no == entry.serial);
        let mut registered = before.cloned().unwrap_or_else(|| Instrument {
            kind: entry.model.clone().unwrap_or_else(|| MODULE.into()),
            serial_no: entry.serial.clone(),
            ..Instrument::default()
        });
        let rounded_ms = (10.0 * took_ms).round() / 10.0;
        registered.uncertainty.insert(REACTION.into(), rounded_ms);
        registered.at_us = now_us();
        store.register_instrument(&registered)?;
        let found = fill(doctor.instrument_ok, &of);
        findings.push(match registered.calibrated {
            Some(_) => Finding::ok(doctor.bench, found),
            None => Finding::warning(doctor.bench, found, fill(doctor.not_calibrated, &of)),
        });
    }
    for note in places.by_hand() {
        let told = words.told(&note);
        findings.push(Finding::ok(doctor.bench, told));
    }
    Ok(findings)
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
    use ptu_report::words::Language;

    #[test]
    fn a_closed_port_is_a_warning_that_says_how_to_open_it() {
        let of_rule = "sudo usermod -aG dialout $USER, and log out and in again";
        let of_group = "sudo usermod -aG uucp $USER, then log out and in again";
        for (group, remedy) in [
            (Some("uucp"), of_group),
            (Some("root"), of_rule),
            (None, of_rule),
        ] {
            let words = Language::English.words();
            let finding = closed_port("/dev/ttyUSB0", "usb", group, &words.doctor);
            assert_eq!(finding.state, State::Warning);
            let said = finding.remedy.unwrap_or_default();
            assert!(said.ends_with(remedy), "{group:?}: {said}");
        }
    }
}
