//! A bench of other makers' programs between `ptu` and a served unit: pymodbus is the relay and input module, pyvisa-sim plays
//! the instruments, sinstruments serves them. `bridge.py` is the wiring. Nothing of that crosses in frames.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::served::Unit;
use crate::common::{Place, list, scripts, text};
use crate::trace_files::python;

/// Where the example has generator, pulse generator, meter and module.
const ADDRESSES: [&str; 4] = [
    "192.0.2.21:5025",
    "192.0.2.22:5025",
    "192.0.2.23:5025",
    "192.0.2.20:502\"",
];

/// Longest time until the bench's programs listen.
const STARTS_WITHIN: Duration = Duration::from_secs(30);

/// A program of the bench; it ends with the value.
struct Program(Child);

impl Program {
    fn start(arguments: &[String]) -> (Self, BufReader<ChildStdout>) {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bench");
        // As urgent as the unit and its tester: it is their cable.
        let mut child = Command::new("nice")
            .args(["-n", "-15"])
            .arg(python())
            .args(arguments)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()
            .expect("Python starts");
        let said = BufReader::new(child.stdout.take().expect("its output"));
        (Self(child), said)
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Module and instruments, and their ports: generator, pulse generator, meter, module, supply.
struct Bench(Vec<Program>, [u16; 5]);

/// Serial lines of a place: of the generator, the supply and the module.
fn serial_lines(place: &Place) -> [String; 3] {
    ["generator", "supply", "module"].map(|name| place.path(name).display().to_string())
}

impl Bench {
    /// Each at a port; generator, supply and module also at serial lines of the place.
    fn start(place: &Place) -> Self {
        let free = [(); 5].map(|()| TcpListener::bind("127.0.0.1:0").expect("a port"));
        let ports = free.map(|free| free.local_addr().expect("bound").port());
        let mut instruments = vec!["instruments.py".to_owned(), "instruments.yaml".to_owned()];
        let [generator, supply, module] = serial_lines(place);
        let at = [ports[0], ports[1], ports[2], ports[4]];
        let names = ["generator", "pulses", "meter", "supply"].iter().zip(at);
        instruments.extend(names.map(|(name, port)| format!("{name}={port}")));
        instruments.extend([format!("generator={generator}"), format!("supply={supply}")]);
        let module = ["module.py".to_owned(), ports[3].to_string(), module];
        let programs = [&instruments[..], &module].map(|program| Program::start(program).0);
        let began = Instant::now();
        for port in ports {
            while TcpStream::connect(("127.0.0.1", port)).is_err() {
                let waited = began.elapsed();
                assert!(
                    waited < STARTS_WITHIN,
                    "no program of the bench at port {port}"
                );
                std::thread::sleep(Duration::from_millis(100));
            }
        }
        Self(programs.into(), ports)
    }

    /// The bench file of the example, at the addresses of these programs.
    fn file(&self, place: &Place) -> String {
        let example = scripts().join("benches/example.toml");
        let mut text = std::fs::read_to_string(example).expect("the example");
        for (address, port) in ADDRESSES.iter().zip(self.1) {
            let end = if address.ends_with('"') { "\"" } else { "" };
            text = text.replace(address, &format!("127.0.0.1:{port}{end}"));
        }
        place.write("bench.toml", &text)
    }

    /// Bench file with generator, module and a supply at serial lines.
    fn serial_file(&self, place: &Place) -> String {
        let [generator, supply, module] = serial_lines(place);
        let Self(_, ports) = self;
        let text = std::fs::read_to_string(self.file(place)).expect("a bench file");
        let replaced = [
            (
                format!("scpi:127.0.0.1:{}", ports[0]),
                format!("scpi:{generator}@115200"),
            ),
            (
                format!("modbus:127.0.0.1:{}", ports[3]),
                format!("modbus:{module}@115200"),
            ),
            ("\"meter\"]".into(), "\"meter\", \"supply\"]".into()),
            (
                "[stimuli]\n".into(),
                "[stimuli]\nsupply = { at = \"supply\", volts = 100.0 }\n".into(),
            ),
        ];
        let text = replaced
            .iter()
            .fold(text, |text, (was, is)| text.replace(was, is));
        let supply = format!(
            "\n[instruments.supply]\nat = \"scpi:{supply}@115200\"\nmodel = \"supply\"\nserial = \"SUP-0005\"\n\
             uncertainty_ms = 150\nby_hand = \"switch off the supply\"\n"
        );
        place.write("serial.toml", &(text + &supply))
    }

    /// Runs procedures on a served unit that is wired to the bench of this file; gives the exit code and the run.
    /// The last `unwired` ports of the bench have no wires.
    fn run(&self, place: &Place, asked: &str, file: &str, unwired: usize) -> (Option<i32>, Value) {
        let unit = Unit::on_tcp(&[]);
        let port = unit.port.rsplit(':').next().expect("a port").to_owned();
        let ports = self.1.map(|port| port.to_string());
        let (bridge, mut said) =
            Program::start(&[&["bridge.py".into(), port], &ports[..5 - unwired]].concat());
        let mut port = String::new();
        said.read_line(&mut port).expect("its port");
        let port = port.trim();
        let ran = place.ptu(&format!(
            "run {asked} --unit tcp:127.0.0.1:{port} --bench {file}"
        ));
        drop(bridge);
        let leaked: Vec<_> = said.lines().map_while(Result::ok).take(3).collect();
        assert!(leaked.is_empty(), "{leaked:?}");
        (ran.code, place.json("runs show latest --json"))
    }
}

/// Goal: the same scripts and verdicts on instruments one can buy. Method: four of the suite's procedures; what the bench has
/// not is skipped, and each measured limit names the instruments that it rests on.
#[test]
#[ignore = "long suite: instruments and modules of other makers"]
fn the_suite_passes_on_a_bench_of_other_makers_programs() {
    let place = Place::new();
    let bench = Bench::start(&place);
    let asked = "atp/limit_speed atp/overspeed door/interlocks twc/exchange";
    let (code, run) = bench.run(&place, asked, &bench.file(&place), 1);
    let steps = list(&run["steps"]);
    let not_passed: Vec<_> = steps
        .iter()
        .filter(|step| step["verdict"] != "passed")
        .collect();
    println!("{} steps, of which not passed {not_passed:#?}", steps.len());
    assert_eq!(code, Some(0));
    let skipped = |step: &&&Value| text(&step["message"]).contains("has no crosstalk");
    assert_eq!(not_passed.iter().filter(skipped).count(), not_passed.len());
    assert!(steps.len() > 100 && not_passed.len() < 5);
    place
        .ptu(&format!("doctor --bench {}", bench.file(&place)))
        .exits(0);
    assert_eq!(list(&place.json("instrument list --json")).len(), 4);
}

/// Goal: Modbus RTU, SCPI at serial lines and a supply. Method: a unit that says nothing without its supply; generator, module
/// and supply are at pseudo-terminals, and their wires and what they were told last are at TCP ports of the same programs.
#[test]
#[ignore = "long suite: instruments and modules of other makers, with pyserial"]
fn a_procedure_passes_at_serial_lines_and_the_supply_is_off_after_it() {
    let place = Place::new();
    let bench = Bench::start(&place);
    let (code, run) = bench.run(&place, "atp/limit_speed", &bench.serial_file(&place), 0);
    assert_eq!(code, Some(0), "{run:#}");
    let mut supply = TcpStream::connect(("127.0.0.1", bench.1[4])).expect("the supply");
    supply.write_all(b"VOLT?\nOUTP?\n").expect("asked");
    let lines = BufReader::new(supply).lines().take(2);
    let last: Vec<_> = lines.map(|line| line.expect("an answer")).collect();
    assert_eq!(last, ["100.0", "0"]);
}

/// Goal: a module that hangs ends the run at once, as an error of the bench, said alike wherever it is told. Method: its program
/// is stopped while a procedure runs.
#[test]
#[ignore = "long suite: instruments and modules of other makers"]
fn a_module_that_hangs_is_the_benchs_fault_everywhere() {
    let place = Place::new();
    let bench = Bench::start(&place);
    let (file, module) = (bench.file(&place), bench.0[1].0.id());
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs(25));
        let stopped = Command::new("kill")
            .args(["-STOP", &module.to_string()])
            .status();
        assert!(stopped.expect("kill runs").success());
    });
    let asked = format!(
        "atp/overspeed --events {} --report {} --report {}",
        place.path("run.jsonl").display(),
        place.path("run.html").display(),
        place.path("run.junit.xml").display()
    );
    let (code, run) = bench.run(&place, &asked, &file, 1);
    assert_eq!(code, Some(3));
    let attempts = list(&run["steps"])
        .iter()
        .filter(|step| step["kind"] == "attempt");
    assert_eq!(attempts.count(), 0, "{run:#}");
    let read = |name| std::fs::read_to_string(place.path(name)).expect(name);
    let told = [
        read("run.jsonl"),
        read("run.html"),
        read("run.junit.xml"),
        run.to_string(),
    ];
    for text in told {
        assert!(text.contains("instrument relays of the bench"), "{text}");
        assert!(
            !text.contains("link to the unit") && !text.contains("link lost"),
            "{text}"
        );
    }
    assert!(read("run.jsonl").contains("\"event\":\"bench_failed\""));
}

/// Goal: a run whose instruments are not reached ends like any other that errors. Method: no program of the bench is there; run
/// and check of the bench file alone.
#[test]
fn a_bench_that_is_not_reached_is_reported_like_any_error() {
    let place = Place::new();
    let unit = Unit::on_tcp(&[]);
    let example = std::fs::read_to_string(scripts().join("benches/example.toml")).expect("it");
    let nowhere = (1..)
        .zip(&ADDRESSES)
        .fold(example, |text, (port, address)| {
            text.replace(address.trim_end_matches('"'), &format!("127.0.0.1:{port}"))
        });
    let file = place.write("bench.toml", &nowhere);
    let (sheet, junit) = (place.path("run.html"), place.path("run.junit.xml"));
    let ran = place.ptu(&format!(
        "run atp/overspeed --unit {} --bench {file} --json --report {} --report {}",
        unit.address,
        sheet.display(),
        junit.display()
    ));
    assert_eq!(ran.code, Some(3), "{}", ran.err);
    let last: Value = serde_json::from_str(ran.out.lines().last().expect("lines")).expect("JSON");
    assert_eq!(
        (&last["event"], &last["verdict"], &last["exit"]),
        (&"run_finished".into(), &"error".into(), &3.into())
    );
    assert!(
        ran.out.contains("\"event\":\"bench_failed\""),
        "{}",
        ran.out
    );
    let run = place.json("runs show latest --json");
    assert_eq!(run["run"]["steps_not_run"], last["not_run"]);
    assert!(last["not_run"].as_u64() > Some(10));
    let of_whole = format!("instrument generator of bench {file} failed before the first");
    assert!(run.to_string().contains(&of_whole), "{run}");
    let diagnosis = place.json("diagnose latest --json");
    let says = format!("the bench failed, not the unit: `ptu doctor --bench {file}`");
    assert_eq!(diagnosis["conclusion"], says);
    let doctor = place.ptu(&format!("doctor --bench {file}")).exits(1);
    doctor.prints(&["generator GEN-0001: not reached", "check its supply"]);
    for file in [sheet, junit] {
        let text = std::fs::read_to_string(&file).expect("a report");
        assert!(
            text.contains("instrument generator of the bench: not reached"),
            "{text}"
        );
        assert!(
            !text.contains("check the cable and that the unit is served"),
            "{text}"
        );
    }
    let checked = place.ptu(&format!("run --check --bench {file}"));
    assert!(
        checked.out.contains("steps") && checked.err.contains("has no crosstalk"),
        "{}",
        checked.err
    );
    checked.exits(0);
    let wrong = place.write(
        "wrong.toml",
        &nowhere.replace("coils = [2]", "coils = [2, 3]"),
    );
    place.ptu(&format!("run --check --bench {wrong}")).exits(2);
}

/// Goal: an instrument that is gone is the bench's fault. Method: the program of the instruments ends while a procedure runs.
#[test]
#[ignore = "long suite: instruments and modules of other makers"]
fn an_instrument_that_is_gone_blames_no_part_of_the_unit() {
    let place = Place::new();
    let bench = Bench::start(&place);
    let file = bench.file(&place);
    let Bench(mut programs, ports) = bench;
    let instruments = programs.remove(0);
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs(25));
        drop(instruments);
    });
    let (code, run) = Bench(programs, ports).run(&place, "atp/overspeed", &file, 1);
    assert_eq!(code, Some(3));
    assert!(list(&run["faults"]).is_empty(), "{}", run["faults"]);
    let said = run.to_string();
    assert!(said.contains(" of the bench: disconnected"), "{said}");
}
