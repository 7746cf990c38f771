//! A line between tester and unit that is taken, bad, or has somebody else at its end.

use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use crate::common::proxy::{Change, frames, proxy, unchanged};
use crate::common::served::Unit;
use crate::common::{Place, list};
use crate::no_unit::fails;
use protocol::link::{End, Link};
use protocol::message::{Channel, KeepAlive, Message};

/// A second tester that has the unit, until this value is dropped.
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

/// Flips a bit in one byte of a hundred, once the unit has been brought up, which takes fewer bytes than this.
fn flips(mut state: u32) -> Change {
    let mut passed = 0;
    Box::new(move |bytes| {
        let flip = |byte: &u8| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            passed += 1;
            let hit = state >> 16 < 655 && passed > 40_000;
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
    let run = place.json("runs show latest --json");
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

/// Lets nothing pass any more once the unit has been brought up, which takes fewer bytes than this.
fn falls_silent() -> Change {
    let mut passed = 0;
    Box::new(move |bytes| {
        passed += bytes.len();
        if passed > 40_000 {
            Vec::new()
        } else {
            bytes.to_vec()
        }
    })
}

/// Goal: a cable that is pulled, which closes no connection, is no fault of the unit, whichever partner misses it first.
#[test]
fn a_cable_pulled_in_mid_run_blames_nobody() {
    for to_unit in [unchanged(), falls_silent()] {
        let unit = Unit::on_tcp(&[]);
        let address = proxy(&unit, to_unit, falls_silent());
        blames_nobody(&address, &["unit silent for"]);
    }
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
    let mut asked = 0;
    let other = frames(Channel::Ptu, move |message, out| {
        asked += u32::from(matches!(message, Message::Identity(_)));
        out.push(match message {
            Message::Identity(mut identity) if asked > 1 => {
                identity.serial[0] = b'B';
                identity.into()
            }
            other => other,
        });
    });
    let address = proxy(&unit, unchanged(), other);
    blames_nobody(&address, &["another unit answers", "\"A-1\"", "\"B-1\""]);
}
