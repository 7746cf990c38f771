//! Bench files, placed signals, faults of instruments and the safe state, with the smallest peers there can be.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant as Clock};

use btu_rig::procedure::plan::{Action, Condition, Operand, What};
use btu_rig::procedure::{Procedure, Step};
use btu_rig::rig::LinkTrouble;
use btu_rig::stimulus::{DoorLine, Stimulus};
use protocol::link::{End, Link};
use protocol::message::{IoInput, IoOutput, Message, ModeSwitch, Outputs, TrainLines};
use protocol::{Instant, SCAN};

use super::placed::PulseRate;
use super::{Model, Placed, Places};
use crate::test_support::{procedures, scripts, setup};

/// What the peers were told, in order.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<String>>>);

impl Log {
    fn note(&self, said: String) {
        self.0.lock().expect("the log").push(said);
    }

    fn take(&self) -> Vec<String> {
        std::mem::take(&mut self.0.lock().expect("the log"))
    }

    fn has(&self, said: &str) -> bool {
        self.0
            .lock()
            .expect("the log")
            .iter()
            .any(|one| one == said)
    }
}

/// How a peer misbehaves: a word, or the error that it answers; nothing = it does not.
type Wrong = &'static str;

fn served(act: impl Fn(TcpStream) + Send + 'static) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("bound").port();
    std::thread::spawn(move || listener.incoming().flatten().for_each(act));
    port
}

/// A module alone, which nothing is read of.
const RELAYS: &str = r#"
safe = ["io"]
stimuli = { hcr = { at = "io", coils = [1] } }
instruments.io = { at = "modbus:127.0.0.1:MODULE", serial = "R-1", uncertainty_ms = 150, watchdog = { register = 7, ms = 800 } }
"#;

/// A meter alone.
const METER: &str = r#"
safe = ["meter"]
readings = { speed = { at = "meter", read = "volts1" } }
instruments.meter = { at = "scpi:127.0.0.1:GENERATOR", model = "meter", serial = "M-1", uncertainty_ms = 150 }
"#;

/// A pulse generator alone.
const PULSES: &str = r#"
safe = ["pulses"]
stimuli = { tacho1 = { at = "pulses", channel = 1 } }
instruments.pulses = { at = "scpi:127.0.0.1:GENERATOR", model = "pulses", serial = "P-1", uncertainty_ms = 150, by_hand = "it" }
"#;

fn waits(wrong: Wrong, slow_ms: u64) {
    match wrong {
        "slow" => std::thread::sleep(Duration::from_millis(slow_ms)),
        "mute" => std::thread::sleep(Duration::from_secs(2)),
        _ => {}
    }
}

/// Sixteen coils that are their own inputs, and an input 16 that is closed; one that is stuck keeps its coils open.
fn module(wrong: Wrong, log: Log) -> u16 {
    served(move |mut stream| {
        let mut coils = [0u8; 2];
        let mut asked = 0;
        let mut head = [0; 7];
        while stream.read_exact(&mut head).is_ok() {
            let mut body = vec![0; usize::from(head[5]) - 1];
            if stream.read_exact(&mut body).is_err() {
                return;
            }
            asked += 1;
            if asked > 4 {
                if wrong == "leaves" {
                    return;
                }
                waits(wrong, 180);
            }
            let answer = match body[0] {
                15 => {
                    for (coil, set) in coils.iter_mut().zip(&body[6..]) {
                        *coil = *set;
                    }
                    log.note(format!("coils {:02x}{:02x}", coils[1], coils[0]));
                    body[..5].to_vec()
                }
                6 => {
                    let ms = u16::from_be_bytes([body[3], body[4]]);
                    log.note(format!("watchdog {ms}"));
                    body.clone()
                }
                _ if wrong == "stuck" => vec![2, 3, 0, 0, 1],
                _ => vec![2, 3, coils[0], coils[1], 1],
            };
            head[5] = answer.len() as u8 + 1;
            if stream.write_all(&[&head[..], &answer].concat()).is_err() {
                return;
            }
        }
    })
}

fn generator(wrong: Wrong, log: Log) -> u16 {
    served(move |mut stream| {
        let lines = BufReader::new(stream.try_clone().expect("a clone")).lines();
        for (asked, line) in lines.map_while(Result::ok).enumerate() {
            if asked > 6 {
                if wrong == "leaves" {
                    return;
                }
                waits(wrong, 40);
            }
            if wrong == "drips" && asked > 6 && line.ends_with('?') {
                while stream.write_all(b"0").is_ok() {
                    std::thread::sleep(Duration::from_millis(50));
                }
                return;
            }
            let answer = match (line.as_str(), wrong) {
                ("*IDN?", "pulses") => "ACME,PULSES,1,1",
                ("SYST:ERR?", "pulses") if asked > 5 => {
                    std::thread::sleep(Duration::from_secs(2));
                    continue;
                }
                ("*IDN?", "model") => "ACME,SCALE,1,1",
                ("*IDN?", _) => "ACME,GENERATOR,METER,1",
                ("MEAS:VOLT? (@101)", answer) => answer,
                ("SYST:ERR?", error) if asked > 6 && error.starts_with('-') => error,
                ("SYST:ERR?", _) => "0,\"No error\"",
                _ => {
                    log.note(line);
                    continue;
                }
            };
            if stream.write_all(format!("{answer}\n").as_bytes()).is_err() {
                return;
            }
        }
    })
}

const BENCH: &str = r#"
safe = ["gen", "io"]

[instruments.io]
at = "modbus:127.0.0.1:MODULE"
serial = "R-1"
uncertainty_ms = 150
watchdog = { register = 7, ms = 800 }

[instruments.gen]
at = "scpi:127.0.0.1:GENERATOR"
model = "generator"
serial = "G-1"
uncertainty_ms = 150
by_hand = "switch off the generator"

[stimuli]
code = { at = "gen" }
crosstalk = { at = "none" }
hcr = { at = "io", coils = [1], proved_by = 1 }
forward = { at = "io", coils = [2] }
mode_switch = { at = "io", coils = [8, 9, 10, 11, 12, 13] }
maintenance_key = { at = "operator", within_s = 20 }
marker = { at = "io", coils = [3, 4, 5, 6], pulse_ms = 2000 }

[readings]
eb = { at = "io", input = 16, inverted = true }
alarm = { at = "operator", within_s = 30 }
"#;

fn bench(text: &str) -> Result<Places, String> {
    let model = |name: &str| {
        let text = scripts()
            .text(&format!("instruments/{name}.toml"))
            .map_err(|e| e.message.to_string())?;
        Model::from_toml(&text).map_err(|error| error.to_string())
    };
    let places = Places::from_toml(text, model).map_err(|error| error.to_string())?;
    Ok(Places {
        name: "bench".into(),
        ..places
    })
}

fn opened(of_module: Wrong, of_generator: Wrong) -> (Result<Placed, LinkTrouble>, Log) {
    let log = Log::default();
    let text = BENCH.replace("MODULE", &module(of_module, log.clone()).to_string());
    let text = text.replace(
        "GENERATOR",
        &generator(of_generator, log.clone()).to_string(),
    );
    (Placed::open(&Arc::new(bench(&text).expect("a bench"))), log)
}

/// Goal: a wrong bench file is refused with its line and in words. Method: the file of these tests, one thing in it changed.
#[test]
fn a_wrong_bench_file_is_refused_with_line_and_words() {
    let right_file = BENCH.replace("MODULE", "1").replace("GENERATOR", "2");
    bench(&right_file).expect("a bench");
    let table = r#"
[stimuli]|[stimuly]|17|stimuly
hcr =|hrc =|20|no such stimulus
eb =|fbs =|27|no contact or display
coils = [2]|coils = [2, 3]|21|1 coils, not 2
input = 16|input = "16"|27|invalid type
code = { at = "gen" }|code = { at = "io" }|18|no instrument for it
code = { at = "gen" }|code = { at = "operator" }|18|quick enough
hcr = { at = "io"|hcr = { at = "oi"|20|no instrument oi
by_hand|by_foot|15|by_foot
by_hand = "switch off the generator"||10|killed
["gen", "io"]|["gen"]|2|see io
model = "generator"|model = "oscillator"|10|oscillator
modbus:127|modem:127|4|modbus:HOST:PORT
ms = 800|ms = 10|4|longer than poll_ms
uncertainty_ms = 150|uncertainty_ms = 18446744073709551|4|at most 500
uncertainty_ms = 150|uncertainty_ms = 501|4|at most 500
coils = [2]|coils = [1968]|21|0 to 1967
input = 16|input = 65535|27|0 to 1967
proved_by = 1|proved_by = 2000|20|0 to 1967
within_s = 20|within_s = 18446744073709552|23|within_s is 1 to 3600
within_s = 20|within_s = 0|23|within_s is 1 to 3600
pulse_ms = 2000|pulse_ms = 9223372036854775807|24|at most 60000
inverted = true|uncertainty = -0.1|27|not negative
inverted = true|uncertainty = nan|27|not negative
inverted = true|scale = nan|27|scale is a number
, pulse_ms = 2000||24|pulse_ms is at least 1
coils = [2]|coils = [1]|20|another use
11, 12, 13]|11, 12, 13], proved_by = 9|22|one relay
eb = {|speed = {|27|no display
at = "operator", within_s = 30|at = "gen", read = "volts"|28|read by an input
maintenance_key|eb_loop|23|no step moves it"#;
    for row in table.trim().lines() {
        let [right, wrong, line, word] = row.split('|').collect::<Vec<_>>()[..] else {
            panic!("{row}")
        };
        let said = bench(&right_file.replacen(right, wrong, 1)).expect_err(row);
        let at = said.contains(&format!("line {line}"));
        assert!(at && said.contains(word), "{row}: {said}");
    }
    let driver = "idn = \"A\"\nerror = \"E?\"\n[acts.code]\non = [\"F {speed}\"]\noff = []\n";
    for (text, line, word) in [
        (driver.to_owned(), 4, "speed"),
        (format!("# pulse {{speed}}\n{driver}"), 5, "speed"),
        (
            format!("# pulse\n{}", driver.replace(".code", ".pulse")),
            4,
            "no act \"pulse\"",
        ),
        (
            driver.replace("speed", "hz").replace(".code", ".pulses") + "[ranges]\nherz = [0, 1]\n",
            7,
            "herz",
        ),
    ] {
        let said = Model::from_toml(&text).expect_err(word).to_string();
        assert!(
            said.contains(&format!("line {line}")) && said.contains(word),
            "{said}"
        );
    }
}

/// Scans until `done` with these inputs; the unit's side of each.
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
        // Now and then a little more, so that there is something to do.
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

/// Goal: a fault of an instrument is told as the bench's, by name, and all outputs are off then. Method: a bench that works,
/// one peer of which misbehaves after it was opened.
#[test]
fn each_fault_of_an_instrument_is_named() {
    for (of_module, of_generator, name, word) in [
        ("slow", "", "io", "slow: it took"),
        ("mute", "", "io", "no answer within 0.40 s"),
        ("leaves", "", "io", "disconnected"),
        ("stuck", "", "io", "the relay of hcr is stuck"),
        ("", "slow", "gen", "slow: it took"),
        ("", "mute", "gen", "no answer within 0.40 s"),
        ("", "leaves", "gen", "disconnected"),
        ("", "drips", "gen", "no answer within 0.40 s"),
        ("", "model", "gen", "wrong model: ACME,SCALE,1,1 answers"),
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
            (_, "model") => told.is_empty(),
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

/// Goal: a code that a generator cannot make skips its step, and one of no level is none.
#[test]
fn a_code_beyond_the_generator_is_skipped() {
    let places = bench(&BENCH.replace("MODULE", "1").replace("GENERATOR", "2")).expect("a bench");
    let (id, name) = ("atp/overspeed", "FSB without effect");
    for (carrier_hz, level_mv, lacks) in [
        (3000.0, 2100.0, Some("2.1 is out of range for level_v")),
        (3000.0, 1900.0, None),
        (3000.0, 0.0, None),
        (0.0, 2100.0, None),
    ] {
        let mut plain = procedures(&setup(&[]));
        for procedure in plain.iter_mut().filter(|one| one.id == id) {
            let code = Stimulus::Code {
                carrier_hz,
                rate_hz: 15.0,
                level_mv,
            };
            for step in &mut Arc::make_mut(procedure).steps {
                step.continues = false;
                step.actions.push(Action::Stimulus(code));
            }
        }
        let fitted = places.fit(plain, &|note| note.to_string());
        let said = step(&fitted, id, name).lacks.as_deref();
        let fits = said.is_some_and(|said| lacks.is_some_and(|lacks| said.contains(lacks)));
        assert!(
            fits || said.is_none() && lacks.is_none(),
            "{level_mv} mV: {said:?}"
        );
    }
}

/// Goal: a door line needs its own relay alone, all doors need theirs by side only where the train tells of sides, and what is
/// waited for has more time wherever it stands.
#[test]
fn doors_and_waits_are_fitted() {
    let places = |none: &str| {
        let text = BENCH.replace("MODULE", "1").replace("GENERATOR", "2");
        let none = none
            .split(' ')
            .map(|line| format!("{line} = {{ at = \"none\" }}\n"));
        let stimuli = format!("[stimuli]\n{}", none.collect::<String>());
        bench(&text.replace("[stimuli]\n", &stimuli)).expect("a bench")
    };
    let all = Stimulus::Doors { closed: true };
    let line = |line| Stimulus::DoorLine {
        line,
        on: Some(true),
    };
    let by_side = "doors_by_side left_closed left_locked right_closed right_locked";
    for (none, stimulus, lacks) in [
        ("doors_by_side", line(DoorLine::All), None),
        ("doors_closed", line(DoorLine::LeftLocked), None),
        (
            "left_locked",
            line(DoorLine::LeftLocked),
            Some("left_locked"),
        ),
        ("left_locked", all, Some("left_locked")),
        (by_side, all, None),
        ("doors_by_side doors_closed", all, Some("doors_closed")),
    ] {
        let mut plain = procedures(&setup(&[]));
        plain.truncate(1);
        let procedure = Arc::make_mut(&mut plain[0]);
        let until = Action::Until {
            condition: Condition::All(Vec::new()),
            within: protocol::Duration::from_ms(100),
        };
        procedure.lacks = None;
        procedure.setup = vec![Action::OnBench(Box::new(until)), Action::Stimulus(stimulus)];
        let fitted = places(none).fit(plain, &|note| note.to_string());
        let said = lacks.map(|what| format!("bench bench has no {what}"));
        assert_eq!(fitted[0].lacks, said, "{none}: {stimulus}");
        let Action::OnBench(until) = &fitted[0].setup[0] else {
            panic!("{:?}", fitted[0].setup)
        };
        assert!(
            matches!(**until, Action::Until { within, .. } if within == protocol::Duration::from_ms(400))
        );
    }
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
        let port = generator(answer, Log::default());
        let text = METER.replace("GENERATOR", &port.to_string());
        let placed = Placed::open(&Arc::new(bench(&text).expect("a bench")));
        let said = placed.err().map(|fault| fault.to_string());
        let refused = |said: &String| said.contains(&format!("{answer} is no answer to MEAS"));
        assert_eq!(
            said.as_ref().map(refused),
            (!is_read).then_some(true),
            "{said:?}"
        );
    }
}

/// Goal: a step that continues a moving one is wider by the motion, too. Method: a step that measures at a moment of a motion,
/// and the same again without its motion.
#[test]
fn motion_of_a_step_that_is_continued_counts() {
    let text = BENCH.replace("MODULE", "1").replace("GENERATOR", "2");
    let moves = |action: &Action| {
        matches!(
            action,
            Action::Stimulus(Stimulus::Speed { .. } | Stimulus::Travel { .. })
        )
    };
    let at = |step: &Step| {
        let what = step.measures.first().map(|measure| &measure.what);
        matches!(what, Some(What::At { signal, .. }) if signal.definition().unit == "m"
            || signal.definition().unit == "km/h")
    };
    let places = bench(&text).expect("a bench");
    let fit = |plain| places.fit(plain, &|note| note.to_string());
    let all = procedures(&setup(&[]));
    let steps = |all: &[Arc<Procedure>]| {
        all.iter()
            .flat_map(|one| one.steps.clone())
            .collect::<Vec<_>>()
    };
    let wider = |(plain, fitted): &(Step, Step)| {
        at(plain)
            && plain.actions.iter().any(moves)
            && plain.measures[0].high != fitted.measures[0].high
    };
    let mut pairs = steps(&all).into_iter().zip(steps(&fit(all.clone())));
    let (first, _) = pairs.find(wider).expect("a step");
    let mut second = Step {
        continues: true,
        ..first.clone()
    };
    second.actions.retain(|action| !moves(action));
    let last = Step {
        continues: false,
        ..second.clone()
    };
    let mut moved = all[..1].to_vec();
    Arc::make_mut(&mut moved[0]).steps = vec![first.clone(), second, last];
    let fitted = fit(moved);
    let [one, two, three] = &fitted[0].steps[..] else {
        panic!("{:?}", fitted[0].steps)
    };
    assert_ne!(one.measures[0].high, first.measures[0].high);
    assert_eq!(one.measures[0].high, two.measures[0].high);
    assert_eq!(three.measures[0].high, first.measures[0].high);
}

/// Goal: a relay that is stuck leaves no other closed where a bench is tried. Method: its contact stays open.
#[test]
fn a_check_that_fails_switches_outputs_off() {
    let log = Log::default();
    let text = BENCH.replace("MODULE", &module("stuck", log.clone()).to_string());
    let text = text.replace("GENERATOR", &generator("", log.clone()).to_string());
    let checked = Placed::check(&bench(&text).expect("a bench"), 2);
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

/// Goal: an instrument that does not answer has all its outputs off. Method: a pulse generator of two channels is mute.
#[test]
fn a_mute_instrument_is_told_every_command_that_switches_off() {
    let log = Log::default();
    let text = PULSES.replace("GENERATOR", &generator("pulses", log.clone()).to_string());
    let placed = Placed::open(&Arc::new(bench(&text).expect("a bench"))).expect("it answers");
    log.take();
    drop(placed);
    assert_eq!(log.take(), ["PULS1:FREQ 0", "PULS2:FREQ 0"]);
}

/// Goal: a module that nothing is read of keeps its relays, and is seen to be there.
#[test]
fn relays_without_inputs_are_ordered_again() {
    let log = Log::default();
    let text = RELAYS.replace("MODULE", &module("", log.clone()).to_string());
    let placed = Placed::open(&Arc::new(bench(&text).expect("a bench"))).expect("it answers");
    std::thread::sleep(Duration::from_millis(200));
    let told = log.take();
    assert!(told.len() > 4, "{told:?}");
    drop(placed);
}

#[test]
fn the_rate_of_pulses_follows_their_edges() {
    let mut rate = PulseRate::default();
    let pulse_us = |count: u64| count * 2_700;
    let mut hz = 0.0;
    for scan in 1..100u64 {
        let now_us = scan * 10_000;
        let count = now_us / 2_700;
        hz = rate.step(
            Instant::from_us(now_us),
            count as u16,
            (now_us - pulse_us(count)) as u16,
        );
    }
    assert!((hz - 1e6 / 2_700.0).abs() < 0.5, "{hz}");
    let last = (990_000 / 2_700) as u16;
    let stands =
        (100..3_200u64).map(|scan| rate.step(Instant::from_us(scan * 10_000), last, u16::MAX));
    let slower: Vec<_> = stands.collect();
    assert!(slower.is_sorted_by(|before, after| before >= after) && slower[3_000] == 0.0);
}

/// The step of this procedure whose name begins so.
fn step<'a>(all: &'a [Arc<Procedure>], id: &str, name: &str) -> &'a Step {
    let procedure = all.iter().find(|one| one.id == id).expect("a procedure");
    let mut steps = procedure.steps.iter();
    let begins = |step: &&Step| step.name.starts_with(name);
    steps.find(begins).expect("a step")
}

/// By how much the limits of its first measurement differ.
fn wider(before: &Step, after: &Step) -> [f64; 2] {
    let number = |limit: &Option<Operand>| match limit {
        Some(Operand::Literal(number)) => *number,
        other => panic!("{other:?}"),
    };
    let [before, after] = [before, after].map(|step| &step.measures[0]);
    let low = number(&after.low) - number(&before.low);
    [low, number(&after.high) - number(&before.high)]
}

/// Goal: what a bench cannot do is skipped with its reason, a person is asked for the rest, and limits are wider by what the
/// instruments are uncertain, which their source says.
#[test]
fn procedures_are_fitted_to_the_bench() {
    let places = bench(&BENCH.replace("MODULE", "1").replace("GENERATOR", "2")).expect("a bench");
    let plain = procedures(&setup(&[]));
    let fitted = places.fit(plain.clone(), &|note| note.to_string());
    let two_codes = step(&fitted, "atp/limit_speed", "two codes that come near");
    let why = "bench bench has no crosstalk";
    assert_eq!(two_codes.lacks.as_deref(), Some(why));
    // Decoding is timed from a generator that is 150 ms late to a display in the frames.
    let decoding = ("atp/limit_speed", "code 55 gives");
    let after = step(&fitted, decoding.0, decoding.1);
    let before = step(&plain, decoding.0, decoding.1);
    assert_eq!(wider(before, after), [-150.0, 150.0]);
    let source = after.measures[0].origin.text().unwrap_or_default();
    let said = source.contains("gen G-1") && source.contains("wider by 150.0 ms");
    assert!(said, "{source}");
    // EB comes by the module, too.
    let proof = ("atp/overspeed", "FSB without effect");
    let after = step(&fitted, proof.0, proof.1);
    let before = step(&plain, proof.0, proof.1);
    assert_eq!(wider(before, after), [-300.0, 300.0]);
    assert!(after.time_limit > before.time_limit);
    // The alarm is heard by a person, who also turns the key.
    let seen = step(&fitted, "atp/overspeed", "FSB comes before EB");
    let asks = |action: &Action| matches!(action, Action::Prompt { text, .. } if text == "Please look: alarm = off. Is it so?");
    assert!(seen.actions.iter().any(asks), "{:?}", seen.actions);
    let self_test = fitted.iter().find(|one| one.id == "ptu/self_test");
    assert!(self_test.expect("a procedure").asks());
    let notes: Vec<_> = places.by_hand().map(|note| note.to_string()).collect();
    assert!(
        notes.len() == 1 && notes[0].contains("switch off the generator"),
        "{notes:?}"
    );
}
