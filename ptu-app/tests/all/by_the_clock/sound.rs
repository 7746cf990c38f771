//! Tester and unit as two programs that sound joins: codes, TWC and markers go through a sound card, contacts and pulses
//! through the link. Its programs are stand-ins that hand on what they get, by a pipe with a name.

use std::fs::File;
use std::io::Read as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

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

/// What a card holds, and how many bytes that are: of two channels at 48 kHz.
const CARD: Duration = Duration::from_millis(60);
const CARD_BYTES: usize = 48 * 60 * 4;
const PATIENCE: Duration = Duration::from_secs(60);

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

    fn command(&self, asked: &str) -> Command {
        let mut command = self.place.command(asked);
        command.env(
            "PATH",
            format!("{}:/usr/bin:/bin", self.place.text_path("bin")),
        );
        command
    }

    fn run(&self, asked: &str) -> Said {
        let bin = self.place.text_path("bin");
        let unit = Unit::with_programs(&bin, &["--signals", &format!("sound:{}", self.device)]);
        let bench = self.place.text_path("sound.toml");
        let run = format!("run {asked} --unit {} --bench {bench}", unit.address);
        Said::from(self.command(&run).output().expect("ptu starts"))
    }

    /// How long sound goes on after this signal to a run, ms. A card that holds 60 ms plays what comes out of the pipe.
    fn sounds_on_ms(&self, unit: &Unit, signal: Signal) -> f64 {
        let bench = self.place.text_path("sound.toml");
        let run = format!(
            "run atp/limit_speed --unit {} --bench {bench}",
            unit.address
        );
        let mut tester = self.command(&run);
        let tester = tester.stdout(Stdio::null()).stderr(Stdio::null());
        let mut tester = tester.spawn().expect("ptu starts");
        let mut pipe = File::open(self.place.path("card")).expect("the pipe");
        let (loud, heard) = channel();
        let card = std::thread::spawn(move || {
            let (mut bytes, mut plays_until) = ([0; CARD_BYTES / 6], Instant::now());
            while let Ok(count @ 1..) = pipe.read(&mut bytes) {
                let now = Instant::now();
                if plays_until < now {
                    plays_until = now + CARD;
                }
                plays_until += CARD * count as u32 / CARD_BYTES as u32;
                if bytes[..count].iter().any(|byte| *byte != 0) {
                    let _ = loud.send(plays_until);
                }
                std::thread::sleep((plays_until - CARD).saturating_duration_since(now));
            }
        });
        heard.recv_timeout(PATIENCE).expect("it is heard");
        std::thread::sleep(Duration::from_millis(1_500));
        let sent = Instant::now();
        kill_process(Pid::from_child(&tester), signal).expect("it runs");
        tester.wait().expect("it ends");
        card.join().expect("the pipe ends with it");
        let last = heard.try_iter().last().expect("it was heard");
        last.saturating_duration_since(sent).as_secs_f64() * 1000.0
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

/// Goal: a tester that is killed falls silent within 100 ms, and one that is stopped. Method: twenty times each.
#[test]
#[ignore = "measures: silence after the end of a run"]
fn figures_of_silence() {
    let card = SoundCard::new("silent", "cat");
    let unit = Unit::on_tcp(&[]);
    for signal in [Signal::KILL, Signal::INT] {
        let mut all: Vec<_> = (0..20).map(|_| card.sounds_on_ms(&unit, signal)).collect();
        all.sort_by(f64::total_cmp);
        println!(
            "{signal:?}: median {:.0}, {:.0} to {:.0} ms",
            all[10], all[0], all[19]
        );
    }
}

#[test]
fn a_tester_that_is_killed_is_silent_at_once() {
    let card = SoundCard::new("killed", "cat");
    let late_ms = card.sounds_on_ms(&Unit::on_tcp(&[]), Signal::KILL);
    assert!(
        late_ms < 250.0,
        "{late_ms}: 100 ms, and what this computer takes"
    );
}

/// Goal: how long sound takes is measured where the bench file says where it is heard.
#[test]
fn doctor_hears_how_long_sound_takes() {
    let card = SoundCard::new("beeps", "cat");
    let bench = BENCH.replace("DEVICE\"", "beeps\"\nheard_at = \"beeps.monitor\"");
    let bench = card.place.write("heard.toml", &bench);
    let doctor = card
        .command(&format!("doctor --bench {bench} --json"))
        .output();
    let said = Said::from(doctor.expect("ptu starts")).exits(0);
    let registered = card.place.json("instrument list --json");
    let took = registered[0]["uncertainty"]["ms reaction"].as_f64();
    assert!(
        took.is_some_and(|took| (5.0..250.0).contains(&took)),
        "{} {registered}",
        said.all()
    );
    let deaf = "#!/bin/sh\nexec cat /dev/zero\n";
    let file = card.place.write("bin/parec", deaf);
    std::fs::set_permissions(file, std::fs::Permissions::from_mode(0o755)).expect("set");
    let doctor = card.command(&format!("doctor --bench {bench}")).output();
    let said = Said::from(doctor.expect("ptu starts")).exits(1);
    said.prints(&[
        "nothing that it plays is heard at beeps.monitor",
        "check the sound card",
    ]);
}
