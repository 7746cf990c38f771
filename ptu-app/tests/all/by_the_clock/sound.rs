//! Tester and unit as two programs that sound joins: codes, TWC and markers go through a sound card, contacts and pulses
//! through the link. Its programs are stand-ins that hand on what they get, by a pipe with a name.

use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use crate::common::served::Unit;
use crate::common::{Place, Said, list, text};

const BENCH: &str = r#"
safe = ["coil"]
[instruments.coil]
at = "sound:DEVICE"
serial = "7"
uncertainty_ms = 250
[stimuli]
code = { at = "coil" }
twc = { at = "coil" }
marker = { at = "coil" }
"#;

/// The stand-ins: what is played is heard. Each test has a device of its own, which one tester at a time uses.
struct SoundCard {
    place: Place,
    device: &'static str,
}

impl SoundCard {
    fn new(device: &'static str, plays: &str) -> Self {
        let place = Place::new();
        std::fs::create_dir(place.path("bin")).expect("a folder");
        let pipe = place.text_path("card");
        let made = Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo starts").success());
        let play = format!("exec {plays} > {pipe}");
        // The recorder hears nothing, and waits, while nobody plays.
        let record = format!("exec cat <> {pipe}");
        for (name, does) in [("pacat", play), ("parec", record)] {
            let file = place.write(&format!("bin/{name}"), &format!("#!/bin/sh\n{does}\n"));
            let all = std::fs::Permissions::from_mode(0o755);
            std::fs::set_permissions(Path::new(&file), all).expect("it can be run");
        }
        place.write("sound.toml", &BENCH.replace("DEVICE", device));
        Self { place, device }
    }

    fn run(&self, asked: &str) -> Said {
        let bin = self.place.text_path("bin");
        let unit = Unit::with_programs(&bin, &["--signals", &format!("sound:{}", self.device)]);
        let bench = self.place.text_path("sound.toml");
        let run = format!("run {asked} --unit {} --bench {bench}", unit.address);
        let mut command = self.place.command(&run);
        command.env("PATH", format!("{bin}:/usr/bin:/bin"));
        Said::from(command.output().expect("ptu starts"))
    }
}

/// Goal: what passes by frames passes by sound, and each limit of a time says by how much sound made it wider.
#[test]
fn tester_and_unit_joined_by_sound_pass() {
    let card = SoundCard::new("heard", "cat");
    card.run("atp/limit_speed").exits(0);
    let run = card.place.json("runs show latest --json");
    let steps = list(&run["steps"]).iter();
    let all = steps.flat_map(|step| list(&step["measurements"]));
    let times = all.filter(|of| text(&of["name"]).contains("_time"));
    let sources: Vec<_> = times.map(|of| text(&of["limit_source"])).collect();
    let wider = |source: &&str| source.contains("coil 7 (limits wider by 250.0 ms)");
    assert!(
        !sources.is_empty() && sources.iter().all(wider),
        "{sources:?}"
    );
}

/// Goal: a sound card that is gone is the bench's fault. Method: the program that plays ends in the middle of a procedure.
#[test]
fn a_card_that_is_gone_blames_no_part_of_the_unit() {
    let card = SoundCard::new("gone", "head -c 2000000");
    let said = card.run("atp/limit_speed").exits(3);
    said.prints(&[
        "instrument coil of the bench: the program that plays on it has ended",
        "0 faults: error",
    ]);
}
