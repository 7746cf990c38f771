//! Waveforms to a sound card and back, on a sound server of the test's own: a null sink is the coil, its monitor the
//! antenna. Where no sound server is installed these tests say that they are skipped.

#![allow(
    clippy::print_stderr,
    reason = "says why a test proves nothing here, and how late silence was"
)]

use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use ptu_runs::signal::{FULL_SCALE_MV, Wav};
use rustix::process::{Pid, Signal, kill_process};

use crate::common::{Place, Typed, has, list, number, text};

/// Time that may pass from a stop to silence.
const SILENT_WITHIN: Duration = Duration::from_millis(100);
/// Time that the way back to the test takes at most, on a machine that has other work.
const WAY_BACK: Duration = Duration::from_millis(150);

/// A sound server with a null sink, gone with the value.
struct SoundServer {
    place: Place,
    server: Child,
}

impl SoundServer {
    /// Starts one, where its programs are.
    fn start() -> Option<Self> {
        for program in ["pulseaudio", "pacat", "parec", "pactl"] {
            if Command::new(program).arg("--version").output().is_err() {
                eprintln!("skipped, {program} is not installed (pulseaudio, pulseaudio-utils)");
                return None;
            }
        }
        let place = Place::new();
        let protocol = format!(
            "module-native-protocol-unix socket={} auth-anonymous=1",
            place.text_path("socket")
        );
        let server = Command::new("pulseaudio")
            .args(["-n", "--daemonize=no", "--exit-idle-time=-1"])
            .args(["--use-pid-file=no", "--disable-shm=yes"])
            .args([
                "-L",
                "module-null-sink sink_name=coil rate=48000 channels=2",
            ])
            .args(["-L", &protocol])
            .env("HOME", place.path(""))
            .env("XDG_RUNTIME_DIR", place.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the sound server starts");
        let started = Self { place, server };
        let until = Instant::now() + Duration::from_secs(20);
        while !started.ptu("signal devices").out.contains("coil") {
            assert!(Instant::now() < until, "the sound server does not answer");
            std::thread::sleep(Duration::from_millis(100));
        }
        Some(started)
    }

    fn command(&self, arguments: &(impl Typed + ?Sized)) -> Command {
        let mut command = self.place.command(arguments);
        let address = format!("unix:{}", self.place.text_path("socket"));
        command.env("PULSE_SERVER", address);
        command
    }

    fn ptu(&self, arguments: &(impl Typed + ?Sized)) -> crate::common::Said {
        let output = self.command(arguments).output().expect("ptu starts");
        crate::common::Said::from(output)
    }

    fn begin(&self, arguments: &(impl Typed + ?Sized)) -> Child {
        let mut command = self.command(arguments);
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        piped.spawn().expect("ptu starts")
    }

    /// Records for so many seconds while something is done.
    fn recorded(&self, seconds: &str, meanwhile: impl FnOnce()) -> crate::common::Said {
        let record = "signal record --device coil.monitor --out r.wav";
        let recorder = self.begin(&format!("{record} --seconds {seconds}"));
        std::thread::sleep(Duration::from_millis(500));
        meanwhile();
        let output = recorder.wait_with_output().expect("it ends");
        crate::common::Said::from(output).exits(0)
    }
}

impl Drop for SoundServer {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Goal: what is played is what is heard: the code on the first channel, the bytes on the second, at their levels, and it
/// begins 20 dB below. Method: both are played to the null sink while its monitor is recorded, and the file is read.
#[test]
fn what_is_played_comes_back_by_sound() {
    let Some(server) = SoundServer::start() else {
        return;
    };
    let mut kept_up = false;
    let said = server.recorded("6", || {
        let play = "signal play code 55 --seconds 2";
        let said = server.ptu(&format!("{play} --device coil"));
        let said = said.exits(0).prints(&["Played: 2.00 s"]);
        has(&said.err, &["not calibrated for atp, twc"]);
        assert!(!said.out.contains("cut off"), "{}", said.all());
        let play = ["signal", "play", "twc", "01 fe 3c", "--device", "coil"];
        let twc = server.ptu(&play).exits(0);
        kept_up = !(said.out.contains("underruns") || twc.out.contains("underruns"));
    });
    assert!(said.out.contains("r.wav: 6.00 s"), "{}", said.all());
    if !kept_up || said.out.contains("overruns") {
        eprintln!("skipped, this machine is too busy for sound without gaps");
        return;
    }
    let reading = server.place.json("signal read r.wav --json");
    let sources = list(&reading["sources"]);
    let heard = |kind: &str| sources.iter().find(|source| text(&source["kind"]) == kind);
    let code = heard("code").unwrap_or_else(|| panic!("{reading}"));
    assert_eq!((text(&code["what"]), number(&code["channel"])), ("55", 1.0));
    let twc = heard("twc").unwrap_or_else(|| panic!("{reading}"));
    assert_eq!(
        (text(&twc["what"]), number(&twc["channel"])),
        ("01 fe 3c", 2.0)
    );

    let mut wav = Wav::open(&server.place.path("r.wav")).expect("a recording");
    let (channels, _) = wav.block(6 * 48_000, 2, FULL_SCALE_MV);
    let atp = &channels[0];
    let begin = atp.iter().position(|mv| mv.abs() > 1.0).expect("sound");
    let peak = |samples: &[f32]| samples.iter().fold(0.0f32, |peak, mv| peak.max(mv.abs()));
    let (first, later) = (
        &atp[begin..begin + 480],
        &atp[begin + 48_000..begin + 72_000],
    );
    assert!((peak(later) - 707.0).abs() < 15.0, "{}", peak(later));
    // The card may lose the first milliseconds; it rises by 2 dB in 50 ms.
    assert!(peak(first) < 106.0, "{}", peak(first));
}

/// Goal: the coil is silent within 100 ms, whether somebody stops the program, or it is killed, or it hangs. Method: the
/// monitor is listened to while a code is played; when the last loud sample has come is compared with when the signal
/// was sent.
#[test]
fn a_stop_a_crash_and_a_tester_that_hangs_are_silent_at_once() {
    let Some(server) = SoundServer::start() else {
        return;
    };
    for signal in [Signal::INT, Signal::KILL, Signal::STOP] {
        let mut listener = Command::new("parec")
            .args(["--raw", "--format=s16le", "--rate=48000", "--channels=1"])
            .args(["--latency-msec=10", "--device=coil.monitor"])
            .env(
                "PULSE_SERVER",
                format!("unix:{}", server.place.text_path("socket")),
            )
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("parec starts");
        let mut sound = listener.stdout.take().expect("its output");
        let (loud, heard) = channel();
        let hearing = std::thread::spawn(move || {
            let mut bytes = [0; 480];
            while let Ok(count @ 1..) = sound.read(&mut bytes) {
                let pairs = bytes[..count].chunks_exact(2);
                let mut samples = pairs.map(|pair| i16::from_le_bytes([pair[0], pair[1]]));
                if samples.any(|sample| sample.unsigned_abs() > 400) {
                    let _ = loud.send(Instant::now());
                }
            }
        });
        // A code has pauses; the reference is a tone without any.
        let tone = "signal calibrate --device coil --channel both --instrument x";
        let by = "--measured 500 --seconds 60 --within 1%";
        let mut player = server.begin(&format!("{tone} {by}"));
        heard
            .recv_timeout(Duration::from_secs(20))
            .expect("it is heard");
        std::thread::sleep(Duration::from_millis(1_200));
        let pid = Pid::from_child(&player);
        let sent = Instant::now();
        kill_process(pid, signal).expect("it runs");
        std::thread::sleep(Duration::from_millis(900));
        let last = heard.try_iter().last().expect("it was heard");
        let late = last.saturating_duration_since(sent);
        eprintln!("{signal:?}: the last sound came back after {late:?}");
        assert!(late < SILENT_WITHIN + WAY_BACK, "{signal:?}: {late:?}");
        assert!(
            last.elapsed() > Duration::from_millis(600),
            "{signal:?}: still loud"
        );
        let _ = player.kill();
        let _ = player.wait();
        let _ = listener.kill();
        let _ = listener.wait();
        hearing.join().expect("it ends with parec");
    }
}

/// Goal: a level is what an instrument shows. Method: an output whose instrument showed 4 % less than was asked for plays
/// 4 % more from then on; an input is calibrated against it, and the list of devices says by which instrument.
#[test]
fn levels_follow_the_calibration() {
    let Some(server) = SoundServer::start() else {
        return;
    };
    let by = ["--instrument", "Fluke 87 serial 123", "--within", "2%"];
    let output = ["signal", "calibrate", "--device", "coil", "--level", "500"];
    let measured = ["--measured", "480", "--seconds", "0.2"];
    let said = server.ptu(&[&output[..], &measured, &by].concat()).exits(0);
    assert!(said.out.contains("3840.0 mV ± 2 %"), "{}", said.all());
    server.recorded("4", || {
        let play = "signal play code 55 --seconds 3";
        let said = server.ptu(&format!("{play} --device coil"));
        // The other channel has no calibration.
        let said = said.exits(0);
        has(&said.err, &["not calibrated for twc"]);
    });
    let mut wav = Wav::open(&server.place.path("r.wav")).expect("a recording");
    let (channels, _) = wav.block(4 * 48_000, 2, FULL_SCALE_MV);
    let peak = channels[0]
        .iter()
        .fold(0.0f32, |peak, mv| peak.max(mv.abs()));
    assert!((peak / 2f32.sqrt() - 520.8).abs() < 10.0, "{peak}");

    // The reference, still 500 mV for whoever measures, is applied to the input.
    let measured = ["--measured", "500", "--seconds", "5"];
    let player = server.begin(&[&output[..], &measured, &by].concat());
    std::thread::sleep(Duration::from_millis(1_500));
    let input = ["signal", "calibrate", "--input", "--device", "coil.monitor"];
    let said = server.ptu(&[&input[..], &["--level", "500"], &by].concat());
    let said = said.exits(0);
    let full_scale = said.out.split("full scale is ").nth(1).expect("said");
    let full_scale: f64 = full_scale
        .split(' ')
        .next()
        .expect("a number")
        .parse()
        .expect("one");
    assert!((full_scale - 3_840.0).abs() < 40.0, "{}", said.all());
    player.wait_with_output().expect("it ends");
    let said = server.ptu("signal devices").exits(0);
    assert!(said.out.contains("Fluke 87 serial 123"), "{}", said.all());
}

#[test]
fn what_cannot_be_played_or_recorded_is_said() {
    let Some(server) = SoundServer::start() else {
        return;
    };
    server
        .ptu("signal play code 55 --seconds 1 --device nothing")
        .exits(3)
        .explains(&["play on nothing", "No such entity"]);
    server
        .ptu("signal record --out x.wav --seconds 1 --device nothing")
        .exits(3)
        .explains(&["record from nothing"]);
    let loud = "signal play code 55 --seconds 0.5 --level 4000";
    let said = server.ptu(&format!("{loud} --device coil")).exits(0);
    assert!(said.out.contains("lower the level"), "{}", said.all());
    for wrong in ["code", "twc"] {
        server
            .ptu(&["signal", "play", wrong, "--device", "coil"])
            .exits(2);
    }
    let calibrate = "signal calibrate --device coil --instrument x";
    for wrong in ["-1%", "much", "101%"] {
        server
            .ptu(&format!("{calibrate} --measured 1 --within {wrong}"))
            .exits(2);
    }
    server
        .ptu(&format!("{calibrate} --within 1%"))
        .exits(2)
        .explains(&["--measured"]);
}
