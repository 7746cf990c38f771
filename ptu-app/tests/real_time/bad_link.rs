//! Links that do not work: an unknown port, nobody there, a silent unit, a unit speaking garbage, a
//! unit that goes away. The run is recorded as an error, and earlier ones stay.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use crate::common::proxy::{Change, frames, peer, proxy, unchanged};
use crate::common::served::Unit;
use crate::common::{Place, list, number, scripts, text};
use protocol::link::{End, Link};
use protocol::message::{Channel, KeepAlive, LogEntry, Message};

/// Time in which `ptu` must have given up, with room for a busy machine.
const GIVES_UP_WITHIN: Duration = Duration::from_secs(60);

/// Runs against this unit: exit 3 with these words, one more run recorded, as an error.
#[track_caller]
fn fails(unit: &str, words: &[&str]) {
    let place = Place::new();
    let earlier = place.recorded_run();
    let began = Instant::now();
    place
        .ptu(&["run", "tcms/link", "--unit", unit])
        .exits(3)
        .explains(words);
    assert!(began.elapsed() < GIVES_UP_WITHIN, "{:?}", began.elapsed());
    let runs = place.run_ids();
    assert_eq!(runs.len(), 2);
    assert_eq!(runs[1], earlier);
    let run = place.json(&["runs", "show", "latest", "--json"]);
    assert_eq!(run["run"]["verdict"], "error");
    assert_eq!(run["run"]["state"], "finished");
}

/// What a run may take beside its bench time.
const BESIDE_S: f64 = 2.0;

#[test]
fn an_unknown_port() {
    fails(
        "serial:/dev/ttyNowhere",
        &["/dev/ttyNowhere", "check the cable", "`ptu ports`"],
    );
}

#[test]
fn a_file_that_is_no_port() {
    fails("serial:/dev/null", &["/dev/null", "`ptu ports`"]);
}

#[test]
fn nobody_listens() {
    // A free port might be taken by another test.
    fails(
        "tcp:127.0.0.1:1",
        &["127.0.0.1:1", "check that the unit is served there"],
    );
}

#[test]
fn a_host_that_does_not_exist() {
    fails(
        "tcp:no-such-host.invalid:7000",
        &[
            "no-such-host.invalid:7000",
            "check that the unit is served there",
        ],
    );
}

#[test]
fn a_silent_unit() {
    let address = peer(|mut stream| {
        let mut ignored = [0; 4096];
        while stream.read(&mut ignored).is_ok_and(|count| count > 0) {}
    });
    fails(
        &format!("tcp:{address}"),
        &[&address.to_string(), "unit silent", "check the cable"],
    );
}

/// A peer that is held up until `ptu` gives up was silent.
#[test]
fn a_unit_speaking_garbage() {
    let address = peer(|mut stream| {
        // A fixed sequence without meaning (linear congruence), flags and escapes included.
        let mut state = 1_u32;
        let mut noise = [0_u8; 96];
        loop {
            for byte in &mut noise {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *byte = (state >> 24) as u8;
            }
            if stream.write_all(&noise).is_err() {
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    fails(
        &format!("tcp:{address}"),
        &[
            &address.to_string(),
            "garbage",
            "no valid frame",
            "baud rate",
        ],
    );
}

/// A loop-back plug, or two testers on one line: what is heard are the own frames.
#[test]
fn an_echo_instead_of_a_unit() {
    let address = peer(|mut stream| {
        let mut heard = [0; 4096];
        while let Ok(count @ 1..) = stream.read(&mut heard) {
            if stream.write_all(&heard[..count]).is_err() {
                return;
            }
        }
    });
    fails(
        &format!("tcp:{address}"),
        &[&address.to_string(), "no valid frame"],
    );
}

#[test]
fn a_unit_that_hangs_up() {
    let address = peer(|stream| {
        std::thread::sleep(Duration::from_millis(500));
        drop(stream);
    });
    fails(
        &format!("tcp:{address}"),
        &[&address.to_string(), "check the cable"],
    );
}

/// Another tester that has the unit, until this is dropped.
struct Other {
    address: SocketAddr,
    leaves: std::sync::mpsc::Sender<()>,
}

impl Other {
    fn on(unit: &Unit) -> Self {
        let mut stream = TcpStream::connect(&unit.port).expect("the unit");
        let address = stream.local_addr().expect("its address");
        let (leaves, stays) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let mut link = Link::new(End::Bench);
            for ms in (0..).step_by(100) {
                let mut frame = Vec::new();
                let now = protocol::Instant::from_ms(ms);
                link.send(now, &KeepAlive { session: 0 }.into(), &mut frame);
                stream.write_all(&frame).expect("the unit listens");
                let waited = stays.recv_timeout(Duration::from_millis(100));
                if waited != Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
                    return;
                }
            }
        });
        Self { address, leaves }
    }
}

#[test]
fn a_unit_that_another_tester_has_says_so_and_is_had_when_that_one_leaves() {
    let unit = Unit::on_tcp(&[]);
    let other = Other::on(&unit);
    let by = other.address.to_string();
    let taken = "the unit is taken by another tester";
    fails(&unit.address, &[taken, &by, "wait until it has left"]);
    let place = Place::new();
    place
        .ptu(&["faults", "import", "--unit", &unit.address])
        .exits(3)
        .explains(&[taken, &by]);
    drop(other.leaves);
    place
        .ptu(&["run", "tcms/link", "--unit", &unit.address])
        .exits(0);
}

/// Goal: nobody waits for what is not measured. Method: a short run on both kinds of port, the second right after
/// the first.
#[test]
fn a_run_on_a_port_takes_little_more_than_its_bench_time() {
    for unit in [Unit::on_tcp(&[]), Unit::on_pty(&[])] {
        let place = Place::new();
        for _ in 0..2 {
            let (said, report) = place.run(&["tcms/link", "--unit", &unit.address]);
            said.exits(0);
            let run = &report["run"];
            let beside_s = number(&run["wall_time_s"]) - number(&run["bench_time_s"]);
            assert!(beside_s < BESIDE_S, "{beside_s} s on {}", unit.address);
        }
    }
}

#[test]
fn a_unit_with_another_configuration_is_told_at_once() {
    let place = Place::new();
    let read = |name: &str| std::fs::read_to_string(scripts().join(name)).expect(name);
    for folder in ["units", "lines"] {
        std::fs::create_dir(place.path(folder)).expect("a folder");
    }
    place.write(
        "units/sg100.toml",
        &(read("units/sg100.toml") + "# another\n"),
    );
    place.write("lines/line8.toml", &read("lines/line8.toml"));
    let unit = Unit::in_lock_step(&["--scripts", &place.text_path("")]);
    place
        .ptu(&["run", "tcms/link", "--unit", &unit.address])
        .exits(3)
        .explains(&["unit configuration", "checksum", "--unit-config"]);
    let run = &place.json(&["runs", "show", "latest", "--json"])["run"];
    assert!(number(&run["wall_time_s"]) < BESIDE_S, "{run}");
}

/// Goal: a unit without a serial number is no unknown one. Method: its run, and one that reached nobody.
#[test]
fn a_unit_without_a_serial_number_is_shown_as_one() {
    let unit = Unit::in_lock_step(&["--serial-no", ""]);
    let place = Place::new();
    let (said, report) = place.run(&["tcms/link", "--unit", &unit.address]);
    said.exits(0);
    assert_eq!(text(&report["run"]["unit_serial"]), "(no serial number)");
    let (_, report) = place.run(&["tcms/link", "--serial-no", "A\u{1b}[2J"]);
    assert_eq!(text(&report["run"]["unit_serial"]), "A\\x1b[2J");
}

/// Flips a bit in one byte of a hundred, once the unit has been brought up.
fn flips(mut state: u32) -> Change {
    let began = Instant::now();
    Box::new(move |bytes| {
        let flip = |byte: &u8| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let hit = state >> 16 < 655 && began.elapsed() > Duration::from_secs(8);
            if hit { byte ^ 0x10 } else { *byte }
        };
        bytes.iter().map(flip).collect()
    })
}

/// Runs what judges every channel behind a proxy: exit 3 with these words, an error without faults.
#[track_caller]
fn blames_nobody(address: &str, words: &[&str]) {
    let place = Place::new();
    place
        .ptu(&["run", "twc/exchange", "--unit", address])
        .exits(3)
        .explains(words);
    let run = place.json(&["runs", "show", "latest", "--json"]);
    assert_eq!(run["run"]["verdict"], "error");
    assert!(list(&run["faults"]).is_empty(), "{}", run["faults"]);
}

#[test]
fn a_bad_line_is_an_error_of_the_line() {
    let unit = Unit::on_tcp(&[]);
    let address = proxy(&unit, flips(1), flips(2));
    blames_nobody(
        &address,
        &["the line between tester and unit is bad", "check the cable"],
    );
}

#[test]
fn a_log_that_is_never_answered() {
    let unit = Unit::on_tcp(&[]);
    let mute = frames(Channel::Ptu, |message, out| match message {
        Message::LogEntry(_) | Message::LogEnd(_) => {}
        other => out.push(other),
    });
    let address = proxy(&unit, unchanged(), mute);
    blames_nobody(
        &address,
        &[
            "the unit's log could not be read: asked ",
            " times, no answer",
        ],
    );
}

#[test]
fn another_unit_in_the_middle_of_a_run() {
    let unit = Unit::on_tcp(&["--serial-no", "A-1"]);
    let began = Instant::now();
    let other = frames(Channel::Ptu, move |message, out| {
        out.push(match message {
            Message::Identity(mut identity) if began.elapsed() > Duration::from_secs(8) => {
                identity.serial[0] = b'B';
                identity.into()
            }
            other => other,
        });
    });
    let address = proxy(&unit, unchanged(), other);
    blames_nobody(&address, &["another unit answers", "\"A-1\"", "\"B-1\""]);
}

/// Goal: a log without end costs neither the disk nor the time. Method: a unit without stored memory, which from
/// the first question for its log on sends 4 000 entries a second beyond those it has.
#[test]
fn a_log_without_end_is_read_within_its_time_and_bounded() {
    let unit = Unit::on_tcp(&[]);
    let mut logged = 0;
    let mut asked = false;
    let endless = frames(Channel::Ptu, move |message, out| match message {
        Message::Status(mut status) if asked => {
            let entries = (logged..logged + 200).map(|index| LogEntry {
                index,
                code: 221,
                at_ms: index,
                ..LogEntry::default()
            });
            status.events = logged + 100_000;
            out.push(status.into());
            out.extend(entries.map(Message::from));
            logged += 200;
        }
        Message::LogEntry(_) | Message::LogEnd(_) => asked = true,
        Message::StoredEntry(_) | Message::StoredClock(_) | Message::StoredEnd(_) => {}
        other => out.push(other),
    });
    let address = proxy(&unit, unchanged(), endless);
    let place = Place::new();
    let began = Instant::now();
    let said = place.ptu(&["faults", "import", "--unit", &address, "--json"]);
    let took = began.elapsed();
    let said = said.exits(3);
    assert!(took < Duration::from_secs(70), "{took:?}");
    let imported: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(imported["complete"], false);
    assert!(number(&imported["not_stored"]) >= 256.0, "{imported}");
    assert!(
        number(&imported["entries"]) <= 256.0 + 60.0 * 40.0,
        "{imported}"
    );
    let id = text(&imported["run_id"]).to_owned();
    assert_eq!(place.run_ids(), [id]);
}
