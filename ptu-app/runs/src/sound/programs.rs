//! Programs of the system that carry sound: those of PulseAudio, which PipeWire has, too, or of ALSA.

use std::process::Command;

use ato_under_test::serve::is_there;
use serde::Serialize;

use super::Direction;
use crate::failure::{Failure, SoundTrouble, Why};
use crate::platform::without_window;

/// How long samples wait in the sound server, ms: with the 21 ms of the pipe, less than the 100 ms until silence.
pub(super) const LATENCY_MS: u32 = 60;

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DeviceFound {
    /// Name of the device in the sound server.
    pub name: String,
    /// Whether it plays or records.
    pub direction: Direction,
}

/// The program that plays on a device, or records from it, samples of 16 bits through its standard streams.
///
/// # Errors
/// There is no such program here.
pub(super) fn carrier(direction: Direction, device: &str) -> Result<Command, Failure> {
    found(direction, device)
        .map_err(|(one, other)| Failure::bench(SoundTrouble::NoProgram(one, other)))
}

/// As [`carrier`], to play; else the names of the programs that are missing.
pub(super) fn player(device: &str) -> Result<Command, (&'static str, &'static str)> {
    found(Direction::Output, device)
}

fn found(direction: Direction, device: &str) -> Result<Command, (&'static str, &'static str)> {
    let plays = direction == Direction::Output;
    let mut command = ato_under_test::serve::carrier(plays, device, LATENCY_MS)?;
    without_window(&mut command);
    Ok(command)
}

/// The devices there are.
///
/// # Errors
/// No program of the system tells them, or the sound server does not answer.
pub fn devices() -> Result<Vec<DeviceFound>, Failure> {
    let directions = [Direction::Output, Direction::Input];
    let mut found = Vec::new();
    for direction in directions {
        let plays = direction == Direction::Output;
        let names = if is_there("pactl") {
            let what = if plays { "sinks" } else { "sources" };
            let said = said(Command::new("pactl").args(["list", "short", what]))?;
            let names = said.lines().filter_map(|line| line.split('\t').nth(1));
            names.map(str::to_owned).collect::<Vec<_>>()
        } else {
            let said = said(Command::new(if plays { "aplay" } else { "arecord" }).arg("-L"))?;
            let names = (said.lines()).filter(|line| !line.starts_with(char::is_whitespace));
            names.map(str::to_owned).collect()
        };
        let names = names.into_iter().filter(|name| !name.is_empty());
        found.extend(names.map(|name| DeviceFound { name, direction }));
    }
    Ok(found)
}

fn said(command: &mut Command) -> Result<String, Failure> {
    let name = command.get_program().to_string_lossy().into_owned();
    let failed = |why| Failure::bench(SoundTrouble::NotListed(name.clone(), why));
    let output =
        (without_window(command).env("LC_ALL", "C").output()).map_err(|error| {
            match error.kind() {
                std::io::ErrorKind::NotFound => failed(Why::NotInstalled("pulseaudio-utils")),
                _ => failed(Why::of(error)),
            }
        })?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(failed(Why::of(
            String::from_utf8_lossy(&output.stderr).trim(),
        ))),
    }
}
