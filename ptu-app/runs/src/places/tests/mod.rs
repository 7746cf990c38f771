//! Bench files, placed signals, faults of instruments and the safe state, with the smallest peers there can be.

mod at_work;
mod fits;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use btu_rig::rig::LinkTrouble;
use protocol::Instant;

use super::placed::PulseRate;
use super::{Model, Placed, Places, Teller};
use crate::test_support::scripts;

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
                ("*IDN?", "pulses") => "ACME,PULSES,P-1,1",
                ("SYST:ERR?", "pulses") if asked > 5 => {
                    std::thread::sleep(Duration::from_secs(2));
                    continue;
                }
                ("*IDN?", "model") => "ACME,SCALE,G-1,1",
                ("*IDN?", "serial") => "ACME,GENERATOR,G-2,1",
                // What tells no serial number is taken as it is.
                ("*IDN?", _) => "ACME,GENERATOR,0,METER",
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

/// As the command line tells it in English.
const ENGLISH: Teller<'_> = Teller {
    note: &|note| note.to_string(),
    signal: &|signal| signal.name().to_owned(),
    text: &|text| text.to_owned(),
    condition: &|seen| seen.to_string(),
};

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

/// Text of a bench file with the ports of its module and its generator.
fn at_ports(text: &str, module: u16, generator: u16) -> String {
    let text = text.replace("MODULE", &module.to_string());
    text.replace("GENERATOR", &generator.to_string())
}

/// The bench of this file with a module and a generator that misbehave so, and what both were told.
fn with_peers(text: &str, of_module: Wrong, of_generator: Wrong) -> (Arc<Places>, Log) {
    let log = Log::default();
    let module = module(of_module, log.clone());
    let text = at_ports(text, module, generator(of_generator, log.clone()));
    (Arc::new(bench(&text).expect("a bench")), log)
}

fn opened(of_module: Wrong, of_generator: Wrong) -> (Result<Placed, LinkTrouble>, Log) {
    let (places, log) = with_peers(BENCH, of_module, of_generator);
    (Placed::open(&places), log)
}

/// Goal: a wrong bench file is refused with its line and in words. Method: the file of these tests, one thing in it changed.
#[test]
fn a_wrong_bench_file_is_refused_with_line_and_words() {
    let right_file = at_ports(BENCH, 1, 2);
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
scpi:127.0.0.1:2|scpi:127.0.0.1:1|4|alone may share
scpi:127|sound:127|10|has a model
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
maintenance_key|eb_loop|23|no step moves it
maintenance_key|supply|23|an instrument switches it
code = { at = "gen" }|supply = { at = "gen" }|18|no act supply
scpi:127.0.0.1:2|scpi:/dev/ttyUSB0@fast|10|SERIALPORT@BAUD
modbus:127.0.0.1:1|modbus:/dev/usbtmc0|4|SERIALPORT@BAUD
within_s = 20|volts = -1|23|volts is a number"#;
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
