//! `WIRE.md` says what the declared layouts say.
//!
//! With `WRITE_WIRE=1` in the environment the generated sections are rewritten instead.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use protocol::Speed;
use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::frame::{FCS_LEN, HEADER_LEN, MAX_BODY, MAX_PAYLOAD, Reject, VERSION};
use protocol::link::{MAX_AHEAD, MAX_DELAY, RESYNC};
use protocol::message::{
    Address, BIT_SETS, CATALOGUE, Channel, ENUMS, FieldSpec, MessageSpec, WordSpec,
};

/// Bytes in 50 ms each end stays below.
const BUDGET: usize = 400;
const OPENING: &str = "<!-- generated: ";
const CLOSING: &str = "<!-- end -->\n";

#[test]
fn the_document_is_up_to_date() {
    let path = root("WIRE.md");
    let old = fs::read_to_string(&path).expect("WIRE.md is there");
    let new = rewritten(&old);
    if std::env::var_os("WRITE_WIRE").is_some() {
        fs::write(&path, new).expect("WIRE.md can be written");
    } else if let Some((old, new)) = old.lines().zip(new.lines()).find(|(old, new)| old != new) {
        panic!("WIRE.md is out of date, run protocol/regenerate\n has   {old}\n wants {new}");
    } else {
        assert_eq!(
            old.len(),
            new.len(),
            "WIRE.md is out of date, run protocol/regenerate"
        );
    }
}

/// Tables that people write name constants; here they are held to them.
#[test]
fn prose_names_the_constants() {
    let text = fs::read_to_string(root("WIRE.md")).expect("WIRE.md is there");
    for reason in Reject::ALL {
        assert!(
            text.contains(&format!("| `{}` |", reason.label())),
            "{}",
            reason.label()
        );
    }
    for phrase in [
        format!("1 to {MAX_AHEAD} ahead"),
        format!("more than {} ms late", MAX_DELAY.as_ms()),
        format!(
            "After {} s without an\naccepted frame",
            RESYNC.as_ms() / 1000
        ),
        format!("more than {MAX_BODY} bytes"),
        format!("fewer than {} bytes", HEADER_LEN + FCS_LEN),
        format!("**below {BUDGET} bytes in any 50 ms**"),
        format!("| {HEADER_LEN} | 1–{MAX_PAYLOAD} | payload |"),
        format!("| 0 | 1 | version | {VERSION} |"),
    ] {
        assert!(text.contains(&phrase), "WIRE.md does not say \"{phrase}\"");
    }
}

#[test]
fn every_type_is_described_once() {
    let words: Vec<&str> = ENUMS.iter().chain(BIT_SETS).map(|word| word.name).collect();
    for (i, name) in words.iter().enumerate() {
        assert!(!words[..i].contains(name), "{name} is listed twice");
        let used = |spec: &MessageSpec| spec.fields.iter().any(|field| field.ty == *name);
        let told = |event: &Event| event.definition().parameter.contains(&format!("`{name}`"));
        assert!(
            CATALOGUE.iter().any(used) || Event::ALL.iter().any(told),
            "{name} is listed but the type of no field and no event's parameter"
        );
    }
    for field in CATALOGUE.iter().flat_map(|spec| spec.fields) {
        let primitive = matches!(
            field.ty,
            "u8" | "i8" | "u16" | "i16" | "u32" | "i32" | "u64"
        ) || field.ty.starts_with("[u8")
            || field.ty == "Samples";
        assert!(
            primitive || words.contains(&field.ty),
            "{} is not described",
            field.ty
        );
    }
}

#[test]
fn codes_are_unique_on_their_channel() {
    for (i, a) in CATALOGUE.iter().enumerate() {
        let same = |b: &&MessageSpec| (b.channel, b.code) == (a.channel, a.code);
        assert_eq!(CATALOGUE[..i].iter().find(same), None, "{}", a.name);
    }
}

fn root(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The document with every generated section made again.
fn rewritten(old: &str) -> String {
    let mut new = String::new();
    let mut rest = old;
    while let Some(at) = rest.find(OPENING) {
        let line_end = at + rest[at..].find('\n').expect("a marker ends its line") + 1;
        let name = rest[at + OPENING.len()..line_end]
            .trim_end()
            .trim_end_matches(" -->");
        let end = line_end + rest[line_end..].find(CLOSING).expect("a marker is closed");
        new += &rest[..line_end];
        new += "\n";
        new += section(name).trim_end();
        new += "\n\n";
        rest = &rest[end..];
        new += CLOSING;
        rest = &rest[CLOSING.len()..];
    }
    new + rest
}

fn section(name: &str) -> String {
    match name {
        "limits" => limits(),
        "channels" => channels(),
        "example" => vector("example.txt"),
        "budget" => budget(),
        "messages" => messages(),
        "enums" => words(ENUMS, "Value", "Label", |code| code.to_string()),
        "bits" => words(BIT_SETS, "Bit", "Name", |bit| bit.to_string()),
        "events" => events(),
        "configuration" => configuration(),
        "session" => vector("session.hex"),
        "overspeed" => vector("overspeed.hex"),
        other => panic!("no section is called {other}"),
    }
}

fn limits() -> String {
    format!(
        "| | bytes |\n|---|---:|\n| header | {HEADER_LEN} |\n| longest payload | {MAX_PAYLOAD} |\n\
         | FCS | {FCS_LEN} |\n| longest body | {MAX_BODY} |\n"
    )
}

/// Values of the configuration that the prose names: of the unit in the worked sessions.
fn configuration() -> String {
    let text = fs::read_to_string(root("../scripts/units/sg100.toml")).expect("sg100 is there");
    let config = UnitConfig::from_toml(&text).expect("sg100 is sound");
    let (tacho, speed) = (&config.tacho, &config.overspeed);
    let mut table = String::from("| Value | of `sg100` |\n|---|---:|\n");
    for (key, value) in [
        ("`tacho.pulses_per_turn`", tacho.pulses_per_turn.to_string()),
        (
            "`tacho.wheel_diameter_mm`",
            format!("{} mm", tacho.wheel_diameter_mm),
        ),
        (
            "way for a pulse, π × diameter / pulses",
            format!("{:.3} mm", 1000.0 * config.metres_per_pulse()),
        ),
        (
            "`tacho.standstill_kmh`, `standstill_ms`",
            margin(tacho.standstill_kmh, tacho.standstill_ms),
        ),
        (
            "`tacho.creep_m`, way without a stop from which on a train moves",
            format!("{} m", tacho.creep_m),
        ),
        (
            "`overspeed.alarm_margin_kmh`, `alarm_delay_ms`",
            margin(speed.alarm_margin_kmh, speed.alarm_delay_ms),
        ),
        (
            "`overspeed.fsb_margin_kmh`, `fsb_delay_ms`",
            margin(speed.fsb_margin_kmh, speed.fsb_delay_ms),
        ),
        (
            "`overspeed.eb_margin_kmh`, `eb_delay_ms`",
            margin(
                speed.eb_margin_kmh.expect("sg100 has one"),
                speed.eb_delay_ms,
            ),
        ),
        (
            "`overspeed.brake_proof_mps2`, `brake_proof_ms`",
            format!(
                "{} m/s², {} ms",
                speed.brake_proof_mps2, speed.brake_proof_ms
            ),
        ),
        (
            "`overspeed.step_down_grace_ms`",
            format!("{} ms", speed.step_down_grace_ms),
        ),
        (
            "`overspeed.yard_kmh`, limit in yard mode",
            format!("{} km/h", speed.yard_kmh),
        ),
        (
            "`overspeed.emergency_kmh`, limit in emergency mode",
            format!("{} km/h", speed.emergency_kmh),
        ),
    ] {
        let _ = writeln!(table, "| {key} | {value} |");
    }
    table += "\n| Code | Limit, km/h | Limit, cm/s | Carrier, Hz | Code rate, Hz |\n|---:|---:|---:|---:|---:|\n";
    for (index, code) in config.codes.iter().enumerate() {
        let limit_cms = Speed::from_kmh(code.limit_kmh).to_cms();
        let _ = writeln!(
            table,
            "| {index} | {} | {limit_cms} | {} | {:.2} |",
            code.limit_kmh, code.carrier_hz, code.rate_hz
        );
    }
    table
}

fn margin(kmh: f64, ms: u32) -> String {
    format!("{kmh} km/h, {ms} ms")
}

fn channels() -> String {
    let mut text = format!(
        "| Channel | Number | Partner of the unit | Its address |\n|---|---:|---|---:|\n\
         | – | – | the unit itself | `0x{:02X}` |\n",
        Address::Unit.code()
    );
    for channel in Channel::ALL {
        let partner = Address::partner(channel);
        let (word, code) = (person(partner), partner.code());
        let _ = writeln!(
            text,
            "| {} | {} | {word} | `0x{code:02X}` |",
            title(channel),
            channel.code()
        );
    }
    text
}

const fn title(channel: Channel) -> &'static str {
    match channel {
        Channel::Ptu => "PTU",
        Channel::Io => "I/O",
        Channel::Tcms => "TCMS",
        Channel::Twc => "TWC",
    }
}

const fn person(address: Address) -> &'static str {
    match address {
        Address::Tester => "tester",
        Address::Unit => "unit",
        Address::IoRack => "I/O rack",
        Address::Tcms => "TCMS",
        Address::Wayside => "wayside",
    }
}

/// Messages sent regularly: name, interval in ms, and when.
const REGULAR: [(&str, usize, &str); 15] = [
    ("IoInput", 10, "always"),
    ("TcmsToAtc", 50, "always"),
    ("CabEntries", 50, "while a number is keyed in at the cab"),
    ("WheelEntry", 50, "while a diameter is keyed in at the cab"),
    ("Crosstalk", 50, "while a second code is in the ATP antenna"),
    ("TwcWayside", 250, "over a loop"),
    (
        "TwcOrders",
        250,
        "over a loop, by a wayside that gives orders",
    ),
    ("KeepAlive", 500, "while a tester is at work; at the latest"),
    (
        "Subscribe",
        500,
        "while a tester wants `TrainState`; at the latest",
    ),
    ("IoOutput", 10, "always"),
    ("AtcToTcms", 50, "always"),
    ("TwcTrain", 250, "in answer to each `TwcWayside`"),
    ("TwcReport", 250, "in answer to each `TwcOrders`"),
    ("Status", 50, "while a tester was heard within 1 s"),
    (
        "TrainState",
        50,
        "while `Subscribe` was heard within 1 s; changes beside",
    ),
];

/// Most `TrainState` beside the regular ones in 50 ms, to a tester that asks for changes.
const CHANGES: usize = 2;

/// Two log entries in a cycle are the most a unit sends while its log is read.
const LOG_ENTRIES: usize = 2;

fn budget() -> String {
    let mut text = String::from(
        "| Message | Direction | Every | When | Bytes on the wire | in 50 ms |\n\
         |---|---|---:|---|---:|---:|\n",
    );
    let (mut sums, mut ptu) = ([0.0; 2], 0.0);
    for (name, every_ms, when) in REGULAR {
        let spec = message(name);
        let bytes = wire_len(spec);
        let in_cycle = bytes as f64 * 50.0 / every_ms as f64;
        sums[usize::from(spec.sent_by_unit())] += in_cycle;
        if spec.channel == Channel::Ptu && spec.sent_by_unit() {
            ptu += in_cycle;
        }
        let way = direction(spec);
        let _ = writeln!(
            text,
            "| `{name}` | {way} | {every_ms} ms | {when} | {bytes} | {in_cycle:.1} |"
        );
    }
    let log = (LOG_ENTRIES * wire_len(message("LogEntry"))) as f64;
    let [to_unit, from_unit] = sums;
    let busiest = from_unit + log;
    let changing = ptu + log + (CHANGES * wire_len(message("TrainState"))) as f64;
    assert!(
        to_unit.max(busiest).max(changing) < BUDGET as f64,
        "{to_unit}, {busiest} and {changing} bytes in a cycle"
    );
    let _ = writeln!(
        text,
        "\nTogether {to_unit:.0} bytes in 50 ms towards the unit and {from_unit:.0} from it, flags \
         counted, stuffing not;\n{busiest:.0} while the log is read. Without a harness the unit sends \
         {ptu:.0}, and {:.0} while the log is read;\n{changing:.0} in a cycle in which as much as \
         possible changes.",
        ptu + log
    );
    text
}

fn message(name: &str) -> &'static MessageSpec {
    CATALOGUE
        .iter()
        .find(|spec| spec.name == name)
        .expect("a message of this name")
}

fn wire_len(spec: &MessageSpec) -> usize {
    2 + HEADER_LEN + spec.payload_len() + FCS_LEN
}

fn direction(spec: &MessageSpec) -> String {
    let partner = person(Address::partner(spec.channel));
    if spec.sent_by_unit() {
        format!("unit → {partner}")
    } else {
        format!("{partner} → unit")
    }
}

fn messages() -> String {
    let mut text = String::new();
    for channel in Channel::ALL {
        let _ = writeln!(text, "### Channel {}, {}\n", channel.code(), title(channel));
        for spec in CATALOGUE.iter().filter(|spec| spec.channel == channel) {
            let (name, code, len) = (spec.name, spec.code, spec.payload_len());
            let _ = writeln!(
                text,
                "#### `{name}` – code `0x{code:02X}`, {}, payload {len} bytes\n\n{}\n",
                direction(spec),
                spec.doc
            );
            text += &fields(spec.fields);
        }
    }
    text
}

fn fields(fields: &[FieldSpec]) -> String {
    if fields.is_empty() {
        return String::from("No fields.\n\n");
    }
    let mut text = String::from("| Offset | Field | Type | Meaning |\n|---:|---|---|---|\n");
    let mut offset = 1;
    for field in fields {
        let ty = field
            .ty
            .replace("[u8; ", "u8[")
            .replace("Samples", "u8[192]");
        let _ = writeln!(
            text,
            "| {offset} | `{}` | {ty} | {} |",
            field.name, field.doc
        );
        offset += field.size;
    }
    text + "\n"
}

fn words(list: &[WordSpec], number: &str, word: &str, show: impl Fn(u8) -> String) -> String {
    let mut text = String::new();
    for spec in list {
        let _ = writeln!(text, "### `{}`\n\n{}\n", spec.name, spec.doc);
        let _ = writeln!(text, "| {number} | {word} | Meaning |\n|---:|---|---|");
        for &(code, label, doc) in spec.entries {
            let _ = writeln!(text, "| {} | `{label}` | {doc} |", show(code));
        }
        text += "\n";
    }
    text
}

fn events() -> String {
    let mut text = String::from(
        "| Code | Name | Severity | Meaning | `parameter` |\n|---:|---|---|---|---|\n",
    );
    for event in Event::ALL.iter().map(|event| event.definition()) {
        let parameter = if event.parameter.is_empty() {
            "–"
        } else {
            event.parameter
        };
        let (name, severity) = (event.name, event.severity.label());
        let _ = writeln!(
            text,
            "| {} | `{name}` | {severity} | {} | {parameter} |",
            event.code, event.text
        );
    }
    text
}

/// A file of `vectors/` as a block of text.
fn vector(name: &str) -> String {
    let text = fs::read_to_string(root("vectors").join(name)).unwrap_or_default();
    format!("```text\n{}\n```\n", text.trim_end())
}
