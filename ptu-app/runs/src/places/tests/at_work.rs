//! Placed signals, faults of instruments and the safe state.

use std::time::{Duration, Instant as Clock};

use btu_rig::rig::{InstrumentFault, LinkTrouble};
use protocol::link::{End, Link};
use protocol::message::{IoInput, IoOutput, Message, ModeSwitch, Outputs, TrainLines};
use protocol::{Instant, SCAN};

use super::{BENCH, METER, PULSES, RELAYS, opened, with_peers};
use crate::places::Placed;

/// Scans with these inputs until `done`, which gets the message that reached the unit and the one that reached the rig.
fn scans(
    placed: &mut Placed,
    input: IoInput,
    mut done: impl FnMut(&Message, &Message) -> bool,
) -> Result<(), LinkTrouble> {
    let (mut rig, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
    let (mut at_unit, mut at_rig) = (Link::new(End::Unit), Link::new(End::Bench));
    let mut now = Instant::ZERO;
    for scan in 0..300 {
        now += SCAN;
        let (mut sent, mut answered) = (Vec::new(), Vec::new());
        let (mut to_unit, mut to_rig) = (Vec::new(), Vec::new());
        // Level and marker edges rise every 20 scans, so that the instruments have something to do.
        let level_mv = input.level_mv + scan / 20;
        let marker_edges = (scan / 20) as u8;
        let input = IoInput {
            level_mv,
            marker_edges,
            ..input
        };
        rig.send(now, &input.into(), &mut sent);
        let output = IoOutput {
            outputs: Outputs::ALARM | Outputs::FSB,
            ..IoOutput::default()
        };
        unit.send(now, &output.into(), &mut answered);
        placed.take(now, &sent, &mut to_unit);
        placed.give(now, &answered, &mut to_rig)?;
        at_unit.push(&to_unit);
        at_rig.push(&to_rig);
        let heard = at_unit.poll(now).expect("a frame").message;
        if done(&heard, &at_rig.poll(now).expect("a frame").message) {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("it never came about")
}

fn input() -> IoInput {
    IoInput {
        carrier_hz: 3000,
        code_rate_chz: 1500,
        level_mv: 500,
        tacho1_count: 7,
        lines: TrainLines::HCR | TrainLines::DOORS_CLOSED,
        mode_switch: ModeSwitch::Manual,
        marker: 2,
        ..IoInput::default()
    }
}

/// Goal: what has a place goes there and nowhere else, and what instruments read is what the rig sees.
#[test]
fn what_has_a_place_leaves_the_frames() {
    let (placed, log) = opened("", "");
    let mut placed = placed.expect("a bench");
    scans(&mut placed, input(), |to_unit, to_rig| {
        let Message::IoInput(framed) = to_unit else {
            panic!("{to_unit:?}")
        };
        assert_eq!((framed.level_mv, framed.mode_switch), (0, ModeSwitch::Off));
        assert_eq!((framed.marker, framed.marker_edges), (0, 0));
        assert_eq!(
            (framed.lines, framed.tacho1_count),
            (TrainLines::DOORS_CLOSED, 7)
        );
        let Message::IoOutput(read) = to_rig else {
            panic!("{to_rig:?}")
        };
        // The closed input is an energised relay; a person hears the alarm; FSB is in the frames.
        assert_eq!(read.outputs, Outputs::EB_RELAY | Outputs::FSB);
        log.has("coils 0412") && log.has("OUTP1 1")
    })
    .expect("no fault");
    for said in [
        "watchdog 800",
        "SOUR1:FREQ 3000",
        "SOUR1:VOLT 0.5",
        "SOUR1:AM:INT:FREQ 15",
    ] {
        assert!(log.has(said), "{said}: {:?}", log.take());
    }
}

/// Goal: a fault of an instrument is told as the bench's, by name, and all outputs are off then. Method: a bench one
/// peer of which misbehaves after it was opened, or is not the instrument of the bench file; then a level too
/// high for the generator.
#[test]
fn each_fault_of_an_instrument_is_named() {
    for (of_module, of_generator, name, word) in [
        ("slow", "", "io", "slow: it took"),
        ("mute", "", "io", "no answer within 0.40 s"),
        ("leaves", "", "io", "disconnected"),
        ("stuck", "", "io", "the relay of hcr is stuck"),
        ("", "slow", "gen", "slow: it took"),
        ("", "mute", "gen", "no answer within 0.40 s"),
        ("", "leaves", "gen", "it closed the connection"),
        ("", "drips", "gen", "no answer within 0.40 s"),
        ("", "model", "gen", "wrong model: ACME,SCALE,G-1,1 answers"),
        ("", "serial", "gen", "another instrument: serial number G-2"),
        (
            "",
            "-350,\"Overflow\"",
            "gen",
            "its error queue is full: -350",
        ),
        (
            "",
            "-222,\"Range\"",
            "gen",
            "it refused SOUR1:VOLT 0.5: -222",
        ),
    ] {
        let (placed, log) = opened(of_module, of_generator);
        let ended = placed.and_then(|mut placed| scans(&mut placed, input(), |_, _| false));
        let said = ended.expect_err(word).to_string();
        let named = said.starts_with(&format!("instrument {name} of the bench"));
        assert!(
            named && said.contains(word),
            "{of_module} {of_generator}: {said}"
        );
        let told = log.take();
        let last = |of: &str| told.iter().rfind(|said| said.starts_with(of));
        let others_are_off = match (name, of_generator) {
            ("io", _) => last("OUTP1").is_some_and(|said| said == "OUTP1 0"),
            // The bench was not opened.
            (_, "model" | "serial") => told.is_empty(),
            _ => last("coils").is_some_and(|said| said == "coils 0000"),
        };
        assert!(others_are_off, "{of_module} {of_generator}: {told:?}");
    }
    let (placed, _) = opened("", "");
    let strong = IoInput {
        level_mv: 9000,
        ..input()
    };
    let ended = scans(&mut placed.expect("a bench"), strong, |_, _| false);
    let said = ended.expect_err("9 V").to_string();
    assert!(
        said.contains("gen") && said.contains("9 is out of range for level_v"),
        "{said}"
    );
}

/// Goal: outputs are off within a second, in the order of the bench file, at the end of a run and where nobody drives the bench
/// any more.
#[test]
fn outputs_are_off_in_their_order_on_every_end() {
    for dropped in [true, false] {
        let (placed, log) = opened("", "");
        let mut placed = placed.expect("a bench");
        scans(&mut placed, input(), |_, _| {
            log.has("coils 0412") && log.has("OUTP1 1")
        })
        .expect("no fault");
        log.take();
        let began = Clock::now();
        let mut kept = Some(placed).filter(|_| !dropped);
        while !log.has("coils 0000") && began.elapsed() < Duration::from_secs(1) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let told = log.take();
        let at = |wanted: &str| told.iter().position(|said| said == wanted);
        let off = (at("OUTP1 0"), at("coils 0000"));
        assert!(
            off.0.is_some() && off.0 < off.1,
            "dropped: {dropped}, {told:?}"
        );
        drop(kept.take());
    }
}

/// Goal: instruments that one program works with are left alone by a second, which says so.
#[test]
fn a_bench_that_is_in_use_is_not_touched() {
    let (places, log) = with_peers(BENCH, "", "");
    let placed = Placed::open(&places).expect("nobody has it");
    log.take();
    let checked = Placed::check(&places, 2);
    let [(_, Err(InstrumentFault::Taken))] = &checked[..] else {
        panic!("{checked:?}")
    };
    let second = Placed::open(&places).err().expect("it is taken");
    assert!(second.to_string().contains("another program"), "{second}");
    assert!(!log.take().iter().any(|said| said.starts_with("OUTP")));
    drop(placed);
    assert!(Placed::check(&places, 2).iter().all(|(_, how)| how.is_ok()));
}

/// Goal: overload of a meter is no reading.
#[test]
fn only_numbers_are_read() {
    for (answer, is_read) in [
        ("1.5", true),
        ("9.91E37", false),
        ("nan", false),
        ("inf", false),
    ] {
        let (places, _) = with_peers(METER, "", answer);
        let placed = Placed::open(&places);
        let said = placed.err().map(|fault| fault.to_string());
        let refused = |said: &String| said.contains(&format!("{answer} is no answer to MEAS"));
        assert_eq!(
            said.as_ref().map(refused),
            (!is_read).then_some(true),
            "{said:?}"
        );
    }
}

/// Goal: a relay that is stuck leaves no other closed where a bench is tried. Method: its contact stays open.
#[test]
fn a_check_that_fails_switches_outputs_off() {
    let (places, log) = with_peers(BENCH, "stuck", "");
    let checked = Placed::check(&places, 2);
    let said: Vec<_> = checked
        .iter()
        .map(|(name, how)| (&name[..], how.is_ok()))
        .collect();
    assert_eq!(said, [("gen", true), ("io", false)]);
    let told = log.take();
    let closed = told.iter().any(|said| said == "coils 0002");
    let relays = told.iter().rfind(|said| said.starts_with("coils"));
    assert!(
        closed && relays.is_some_and(|said| said == "coils 0000"),
        "{told:?}"
    );
}

/// Goal: an instrument that does not answer is told to switch all its outputs off. Method: a pulse generator of two
/// channels is mute.
#[test]
fn a_mute_instrument_is_told_every_command_that_switches_off() {
    let (places, log) = with_peers(PULSES, "", "pulses");
    let placed = Placed::open(&places).expect("it answers");
    log.take();
    drop(placed);
    assert_eq!(log.take(), ["PULS1:FREQ 0", "PULS2:FREQ 0"]);
}

/// Goal: a module that nothing is read of does not drop its relays, and is seen to be there. Method: the order of its
/// coils comes again and again.
#[test]
fn relays_without_inputs_are_ordered_again() {
    let (places, log) = with_peers(RELAYS, "", "");
    let placed = Placed::open(&places).expect("it answers");
    std::thread::sleep(Duration::from_millis(200));
    let told = log.take();
    assert!(told.len() > 4, "{told:?}");
    drop(placed);
}
