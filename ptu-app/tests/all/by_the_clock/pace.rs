//! Tests of durations, and of work at the pace of the clock.

use std::time::{Duration, Instant};

use crate::common::proxy::{frames, proxy};
use crate::common::served::{Running, Unit};
use crate::common::{Place, number, scripts, text};
use protocol::message::{Channel, LogEntry, Message};

/// A procedure of a second.
const SHORT: &str = "procedure(title = \"Short\", suspect = \"tcms\")\nstep(\"lasts\", do = wait(s(1)), measure = value(\"v\", speed))\n";
/// Time that a run may take beside its bench time.
const BESIDE_S: f64 = 2.0;

/// Goal: nobody waits for what is not measured. Method: short runs on both kinds of port, each right after the one before.
/// A computer that stands still makes a run longer and never shorter, so the shortest tells.
#[test]
fn a_run_on_a_port_takes_little_more_than_its_bench_time() {
    let judged = |unit: Unit| {
        let place = Place::new();
        place.write("short.star", SHORT);
        let beside_s = || {
            let (said, report) = place.run(&["short.star", "--unit", &unit.address]);
            said.exits(0);
            let run = &report["run"];
            number(&run["wall_time_s"]) - number(&run["bench_time_s"])
        };
        beside_s();
        let after_another = [beside_s(), beside_s(), beside_s()];
        let shortest = after_another.into_iter().fold(f64::INFINITY, f64::min);
        assert!(
            shortest < BESIDE_S,
            "{after_another:?} s on {}",
            unit.address
        );
    };
    std::thread::scope(|scope| {
        for unit in [Unit::on_tcp(&[]), Unit::on_pty(&[])] {
            scope.spawn(move || judged(unit));
        }
    });
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
        .explains(&["unit configuration", "checksum", "choose"]);
    let run = &place.json("runs show latest --json")["run"];
    assert!(number(&run["wall_time_s"]) < BESIDE_S, "{run}");
}

/// Goal: a log without end costs neither the disk nor the time. Method: a unit without stored memory, which from
/// the first question for its log on sends 4 000 entries a second, from the one asked for on.
#[test]
fn a_log_without_end_is_read_within_its_time_and_bounded() {
    let unit = Unit::on_tcp(&[]);
    let (asks, asked) = std::sync::mpsc::channel();
    let listens = frames(Channel::Ptu, move |message, out| {
        if let Message::ReadLog(read) = &message {
            let _ = asks.send(read.from_index);
        }
        out.push(message);
    });
    let mut next = None;
    let endless = frames(Channel::Ptu, move |message, out| match message {
        Message::Status(mut status) => {
            next = asked.try_iter().last().or(next);
            let Some(logged) = next else {
                return out.push(status.into());
            };
            let entries = (logged..logged + 200).map(|index| LogEntry {
                index,
                code: 221,
                at_ms: index,
                ..LogEntry::default()
            });
            status.events = logged + 100_000;
            out.push(status.into());
            out.extend(entries.map(Message::from));
            next = Some(logged + 200);
        }
        Message::LogEntry(_) | Message::LogEnd(_) => {}
        Message::StoredEntry(_) | Message::StoredClock(_) | Message::StoredEnd(_) => {}
        other => out.push(other),
    });
    let address = proxy(&unit, listens, endless);
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

#[test]
fn a_tester_slower_than_the_unit_is_told() {
    let slower_on = |unit: &[&str]| {
        let (unit, place) = (Unit::on_pty(unit), Place::new());
        place.write("short.star", SHORT);
        Running::start(&place, &unit, &["short.star", "--slower", "2"]).finish()
    };
    std::thread::scope(|scope| {
        scope.spawn(|| slower_on(&["--slower", "2"]).exits(0));
        let said = slower_on(&[]).exits(3);
        said.explains(&["times as fast", "slow both"]);
    });
}

#[test]
fn the_embedded_unit_can_be_run_at_the_wall_clocks_pace() {
    let place = Place::new();
    place.write("short.star", SHORT);
    let (said, report) = place.run("short.star --realtime");
    said.exits(0);
    let (bench, wall) = (
        &report["run"]["bench_time_s"],
        &report["run"]["wall_time_s"],
    );
    assert!(number(wall) >= number(bench), "{wall} s for {bench} s");
}
