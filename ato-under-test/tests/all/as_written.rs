//! The unit does what `protocol/WIRE.md` says: its table of values outside a field's range, and its worked
//! sessions.

use std::path::Path;

use crate::common::{Bench, config, confirm};
use crate::maintenance::{SESSION, answer_within, armed_with};
use ato_under_test::flash::RamFlash;
use ato_under_test::{LOG_CAPACITY, RUN_ROWS};
use protocol::link::{End, Link};
use protocol::message::{
    Answer, ArmConfirm, ArmRefusal, ArmRequest, BIT_SETS, CATALOGUE, CoilSamples, ENUMS, FieldSpec,
    IoOutput, Message, MessageSpec, ModeSwitch, ReadStored, Status, StatusBits, Subscribe,
    TcmsToAtcBits, TrainLines, TwcOrders,
};
use protocol::{Duration, Instant};

/// A row of the table begins like this one's head.
const TABLE: &str = "| Field | Takes | Any other value |";

/// A file of the wire's description.
fn described(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../protocol")
        .join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A row of the table.
struct Rule {
    spec: &'static MessageSpec,
    field: &'static FieldSpec,
    /// Offset in the payload.
    offset: usize,
    low: i64,
    high: i64,
    bits: bool,
    otherwise: String,
}

fn rules() -> Vec<Rule> {
    let text = described("WIRE.md");
    let (_, table) = text.split_once(TABLE).expect("the table of fields");
    let rows = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let [_, field, takes, otherwise, _] = cells[..] else {
            panic!("{row}")
        };
        let name = field.trim_matches('`');
        let (message, field) = name.split_once('.').expect("`Message.field`");
        let spec = CATALOGUE.iter().find(|spec| spec.name == message);
        let spec = spec.unwrap_or_else(|| panic!("no message {message}"));
        let place = spec.fields.iter().position(|f| f.name == field);
        let place = place.unwrap_or_else(|| panic!("no field {name}"));
        let (bits, span) = match takes.strip_prefix("bits ") {
            Some(span) => (true, span),
            None => (false, takes),
        };
        let (low, high) = span.split_once(" to ").expect("from and to");
        let number = |text: &str| text.replace('−', "-").parse().expect("a number");
        Rule {
            spec,
            field: &spec.fields[place],
            offset: 1 + spec.fields[..place].iter().map(|f| f.size).sum::<usize>(),
            low: number(low),
            high: number(high),
            bits,
            otherwise: otherwise.to_owned(),
        }
    })
    .collect()
}

impl Rule {
    fn name(&self) -> String {
        format!("{}.{}", self.spec.name, self.field.name)
    }

    /// Least and greatest number of the field's type.
    fn bounds(&self) -> (i64, i64) {
        let bits = 8 * self.field.size as u32;
        match self.field.ty {
            "i8" | "i16" | "i32" => (-(1 << (bits - 1)), (1 << (bits - 1)) - 1),
            _ => (0, (1 << bits) - 1),
        }
    }

    /// Values the unit does not know: next to the range, at the type's ends, and some between.
    fn others(&self) -> Vec<i64> {
        let (least, most) = self.bounds();
        if self.bits {
            let unknown = (self.high + 1)..(8 * self.field.size as i64);
            return unknown.clone().map(|bit| 1 << bit).collect();
        }
        let between = [(self.high + most) / 2, (self.low + least) / 2, most - 1];
        let all = [self.low - 1, self.high + 1, least, most];
        let mut others: Vec<i64> = all.into_iter().chain(between).collect();
        others.retain(|v| (least..=most).contains(v) && !(self.low..=self.high).contains(v));
        others.sort_unstable();
        others.dedup();
        others
    }

    /// The message with this value in the field.
    fn set(&self, message: impl Into<Message>, value: i64) -> Message {
        set(
            self.spec,
            self.offset,
            self.field.size,
            message.into(),
            value,
        )
    }
}

fn set(spec: &MessageSpec, offset: usize, size: usize, message: Message, value: i64) -> Message {
    let mut payload = Vec::new();
    message.encode(&mut payload);
    assert_eq!(message.name(), spec.name);
    payload[offset..offset + size].copy_from_slice(&value.to_be_bytes()[8 - size..]);
    Message::decode(spec.channel, &payload).expect("fields take any value")
}

#[test]
fn every_enumeration_and_set_of_bits_towards_the_unit_has_a_rule() {
    let rules: Vec<String> = rules().iter().map(Rule::name).collect();
    for spec in CATALOGUE.iter().filter(|spec| !spec.sent_by_unit()) {
        for field in spec.fields {
            let words = ENUMS.iter().chain(BIT_SETS);
            let listed = words.clone().any(|word| word.name == field.ty);
            let name = format!("{}.{}", spec.name, field.name);
            assert!(!listed || rules.contains(&name), "{name}: no rule");
        }
    }
    for (i, name) in rules.iter().enumerate() {
        assert!(!rules[..i].contains(name), "{name} twice");
    }
}

#[test]
fn the_prose_names_what_the_unit_keeps_and_is_configured_to() {
    let text = described("WIRE.md");
    let config = crate::common::config();
    let (tacho, link) = (&config.tacho, &config.link);
    for phrase in [
        format!("keeps the newest {LOG_CAPACITY} entries"),
        format!("up to {RUN_ROWS} rows"),
        format!(
            "at most {} km/h for {} ms",
            tacho.standstill_kmh, tacho.standstill_ms
        ),
        format!(
            "| 0 to {:.0} | the frame",
            (config.ato.train.empty_kg / 100.0).floor()
        ),
        format!(
            "**{} ms of silence** (unit configuration, `io_timeout_ms`)",
            link.io_timeout_ms
        ),
        format!(
            "after {} ms of silence or of a standing `alive`",
            link.tcms_timeout_ms
        ),
        format!(
            "steady for {} ms (unit\nconfiguration",
            config.receiver.detect_ms
        ),
    ] {
        let plain = |text: &str| text.replace('\n', " ");
        assert!(plain(&text).contains(&plain(&phrase)), "not said: {phrase}");
    }
}

/// A good request of each kind that the TEST board answers.
fn requests() -> Vec<Message> {
    let files = described("vectors/ptu.hex");
    let frames = files.lines().filter_map(|line| line.strip_prefix("frame "));
    let mut unit = Vec::new();
    for frame in frames {
        // Each in a receiver of its own: the vectors are no conversation.
        let mut link = Link::new(End::Unit);
        link.push(&bytes(frame));
        unit.extend(link.poll(Instant::ZERO).map(|received| received.message));
    }
    unit.retain(|m| matches!(m.spec().code, 0x10..=0x14));
    assert_eq!(unit.len(), 5);
    // Each begins with its session.
    let of_session = |message: Message| set(message.spec(), 1, 4, message, SESSION.into());
    unit.into_iter().map(of_session).collect()
}

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace()
        .map(|pair| u8::from_str_radix(pair, 16).expect("two digits"))
        .collect()
}

/// Goal: no request is carried out with a value that has no meaning, and none with a meaning is refused.
/// Method: each field of each stimulus, at and beyond the ends of what the table says it takes.
#[test]
fn the_test_board_refuses_what_it_cannot_make_and_nothing_else() {
    let rules = rules();
    for request in requests() {
        let spec = request.spec();
        let mut offset = 1;
        for field in spec.fields {
            let rule = rules
                .iter()
                .find(|rule| rule.spec.name == spec.name && rule.field.name == field.name);
            let (least, most) = (0, (1i64 << (8 * field.size)) - 1);
            let at = |value| set(spec, offset, field.size, request, value);
            let (good, refused) = match rule {
                Some(rule) if rule.otherwise == "refused: `out_of_range`" => {
                    (vec![rule.low, rule.high], rule.others())
                }
                // No other value, or one that changes nothing.
                _ => (vec![least, 1, most], vec![]),
            };
            for value in good.into_iter().filter(|_| field.name != "session") {
                let answer = answer_within(0.02, &mut armed_with(&[]), at(value));
                assert_eq!(answer, Answer::Accepted, "{:?}", at(value));
            }
            for value in refused {
                let mut bench = armed_with(&[]);
                let answer = answer_within(0.02, &mut bench, at(value));
                assert_eq!(answer, Answer::OutOfRange, "{:?}", at(value));
                bench.run(0.1);
                assert!(bench.status.test_signals.is_empty(), "{:?}", at(value));
            }
            offset += field.size;
        }
    }
}

/// Act of a bench while the unit is watched.
type Act = Box<dyn Fn(&mut Bench)>;

/// All that a unit in automatic mode, ready to depart, says while this is done to it.
fn said(act: &Act) -> (Vec<(IoOutput, Status)>, Vec<Message>) {
    let mut bench = Bench::new(&[]);
    bench.input.mode_switch = ModeSwitch::Automatic;
    bench.code("55");
    bench.run(1.0);
    act(&mut bench);
    let scan = |_| {
        bench.scan();
        (bench.output, bench.status)
    };
    let scans = (0..90).map(scan).collect();
    (scans, bench.answers)
}

/// The bench goes on with this value in the field.
fn holding(rule: &Rule, value: i64) -> Act {
    let (spec, offset, size) = (rule.spec, rule.offset, rule.field.size);
    let set = move |message: Message, value| set(spec, offset, size, message, value);
    Box::new(move |bench| match spec.name {
        "IoInput" => {
            // A marker is passed in this frame.
            bench.input.marker_edges += 1;
            if let Message::IoInput(input) = set(bench.input.into(), value) {
                bench.input = input;
            }
        }
        "TcmsToAtc" => {
            let frame = bench.tcms.expect("TCMS speaks");
            if let Message::TcmsToAtc(frame) = set(frame.into(), value) {
                bench.tcms = Some(frame);
            }
        }
        "TwcWayside" => {
            let data = bench.station.expect("the wayside speaks");
            if let Message::TwcWayside(data) = set(data.into(), value) {
                bench.station = Some(data);
            }
        }
        "CoilSamples" => {
            let mut samples = CoilSamples::default();
            samples.samples.0.fill(i16::MAX);
            bench.send(set(samples.into(), value));
        }
        "Subscribe" => bench.send(set(Subscribe::default().into(), value)),
        other => panic!("{other}"),
    })
}

/// Goal: what holds in place of a value without a meaning is what the table says. Method: two units, one
/// given the value and one what stands for it, say the same.
#[test]
fn what_holds_in_place_of_an_unknown_value_is_what_is_written() {
    for rule in rules() {
        for value in rule.others() {
            let name = format!("{} {value}", rule.name());
            let (given, held): (Act, Act) = match rule.otherwise.as_str() {
                "refused: `out_of_range`" => continue,
                "refused: `bad_answer`" => {
                    refuses_to_arm(rule.set(ArmRequest { session: SESSION }, value));
                    continue;
                }
                "the orders are refused" => {
                    refuses_orders(rule.set(TwcOrders::default(), value), &name);
                    continue;
                }
                "not answered" => {
                    let request = ReadStored::default();
                    answers_nothing_to(rule.set(request, value));
                    continue;
                }
                "the data are refused" => {
                    refuses_station(holding(&rule, value), &name);
                    continue;
                }
                // What changes nothing is accepted, and held above.
                "passed over" if rule.spec.name == "TestRelease" => continue,
                "passed over" => (beside(&rule, value), beside(&rule, 0)),
                "no marker" | "the samples are passed over" => {
                    (holding(&rule, value), Box::new(|_| {}))
                }
                "not neutral" => (holding(&rule, value), holding(&rule, 1)),
                "the frame is as good as lost" => {
                    (holding(&rule, value), Box::new(|bench| bench.tcms = None))
                }
                other => {
                    let zero = other.strip_prefix("as ").and_then(|n| n.parse().ok());
                    let zero = zero.unwrap_or_else(|| panic!("what is \"{other}\"?"));
                    (holding(&rule, value), holding(&rule, zero))
                }
            };
            let same = said(&given) == said(&held);
            assert!(same, "{name} is not {}", rule.otherwise);
        }
    }
}

#[track_caller]
fn refuses_station(act: Act, name: &str) {
    let mut bench = Bench::new(&[]);
    bench.keep_alive = true;
    bench.run(1.0);
    assert!(bench.status.bits.contains(StatusBits::STATION_VALID));
    act(&mut bench);
    bench.run(0.5);
    assert!(
        !bench.status.bits.contains(StatusBits::STATION_VALID),
        "{name}"
    );
}

#[track_caller]
fn refuses_orders(orders: Message, name: &str) {
    let Message::TwcOrders(orders) = orders else {
        panic!("{orders:?}")
    };
    let train_number = config().train.number;
    let mut bench = Bench::new(&[]);
    bench.send(TwcOrders {
        train_number,
        ..orders
    });
    bench.run(0.1);
    let [Message::TwcReport(report)] = bench.answers[..] else {
        panic!("{:?}", bench.answers)
    };
    assert_eq!(report.refused, 1, "{name}");
}

#[track_caller]
fn answers_nothing_to(request: Message) {
    let mut bench = Bench::new(&[]);
    bench.answers.clear();
    bench.send(request);
    bench.run(0.2);
    assert!(bench.answers.is_empty(), "{:?}", bench.answers);
}

#[track_caller]
fn refuses_to_arm(request: Message) {
    let mut bench = Bench::new(&[]);
    bench.input.lines.insert(TrainLines::MAINTENANCE_KEY);
    bench.run(0.1);
    bench.answers.clear();
    bench.send(request);
    bench.run(0.1);
    let [Message::ArmState(state)] = bench.answers[..] else {
        panic!("{:?}", bench.answers)
    };
    assert_eq!((state.armed, state.refusal), (0, ArmRefusal::BadAnswer));
}

/// Bits beside those that are held anyway.
fn beside(rule: &Rule, bits: i64) -> Act {
    let name = rule.name();
    Box::new(move |bench| match name.as_str() {
        "IoInput.tacho_backward" => bench.backward_bits = bits as u8,
        "IoInput.lines" => {
            let unknown = TrainLines::from_bits_retain(bits as u16);
            bench.input.lines = bench.input.lines.union(unknown);
        }
        "TcmsToAtc.bits" => {
            let frame = bench.tcms.as_mut().expect("TCMS speaks");
            let unknown = TcmsToAtcBits::from_bits_retain(bits as u16);
            frame.bits = frame.bits.union(unknown);
        }
        other => panic!("{other}"),
    })
}

/// Fields of a worked session that are not the same on every unit, or each time.
const VARIES: [&str; 9] = [
    "challenge",
    "serial",
    "config_crc",
    "tdb_crc",
    "software",
    "uptime_ms",
    "at_ms",
    "position_cm",
    "request_seq",
];

/// A tester that plays the requests of a worked session to a unit, and keeps the line going in between.
struct Player {
    bench: Bench,
    link: Link,
    heard: Vec<(Instant, Message)>,
}

impl Player {
    fn new() -> Self {
        let mut bench = Bench::alone(Box::new(RamFlash::default()));
        (bench.keep_alive, bench.tcms_obeys) = (false, true);
        let mut player = Self {
            bench,
            link: Link::new(End::Bench),
            heard: Vec::new(),
        };
        player.run_until(Instant::from_ms(2000));
        player
    }

    /// Takes a request of the session; the challenge is the unit's own.
    fn request(&mut self, message: Message) {
        let bench = &mut self.bench;
        match message {
            Message::IoInput(input) => {
                bench.input = input;
                (bench.io, bench.keep_alive) = (true, true);
            }
            Message::TcmsToAtc(mut frame) => {
                // What it says of brakes follows the unit's outputs.
                frame.bits.remove(
                    TcmsToAtcBits::FULL_SERVICE_BRAKE
                        | TcmsToAtcBits::SERVICE_BRAKE_APPLIED
                        | TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED,
                );
                bench.tcms = Some(frame);
            }
            Message::KeepAlive(alive) => {
                bench.session = alive.session;
                bench.send(message);
            }
            Message::ArmConfirm(ArmConfirm { session, .. }) => {
                bench.session = session;
                bench.send(confirm(bench.last().expect("a challenge"), session));
            }
            other => bench.send(other),
        }
    }

    /// Messages of this name within the last cycles.
    fn said(&self, name: &str) -> Vec<Message> {
        let lately = |at: Instant| self.bench.now.since(at) < Duration::from_ms(100);
        let heard = self.heard.iter().filter(|(at, _)| lately(*at));
        let said = heard.map(|(_, message)| *message);
        said.filter(|message| message.name() == name).collect()
    }

    fn run_until(&mut self, at: Instant) {
        while self.bench.now < at {
            self.bench.scan();
            let now = self.bench.now;
            self.link.push(&self.bench.sent);
            let heard = std::iter::from_fn(|| self.link.poll(now));
            self.heard
                .extend(heard.map(|received| (now, received.message)));
        }
    }
}

/// Goal: the worked sessions are what a unit does. Method: their requests to a unit with the configuration
/// they are of; what it says at the times of its messages is what stands there, but for what varies.
#[test]
fn the_unit_answers_as_in_the_worked_sessions() {
    let mut differ = Vec::new();
    for file in ["session.hex", "overspeed.hex"] {
        let mut player = Player::new();
        let mut ends = [Link::new(End::Unit), Link::new(End::Bench)];
        for line in described(&format!("vectors/{file}")).lines() {
            let columns: Vec<&str> = line.split_whitespace().collect();
            let [at_ms, direction @ ("<" | ">"), name, ref hex @ ..] = columns[..] else {
                continue;
            };
            let after = Duration::from_ms(at_ms.parse().expect("a time in ms"));
            let end = &mut ends[usize::from(direction == "<")];
            end.push(&bytes(&hex.join(" ")));
            let written = end.poll(Instant::ZERO + after).expect("a good frame");
            player.run_until(Instant::from_ms(2000) + after);
            if direction == ">" {
                player.request(written.message);
                continue;
            }
            let said = player.said(name);
            let differences = said.iter().map(|said| differences(&written.message, said));
            let least = differences.min_by_key(Vec::len);
            if least != Some(Vec::new()) {
                differ.push(format!("{file} {at_ms} ms {name}: {least:#?}"));
            }
        }
    }
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

/// Fields that are not what is written, but for those that vary.
fn differences(written: &Message, said: &Message) -> Vec<String> {
    let (written, said) = (written.show(), said.show());
    let fields = written.iter().zip(said);
    let other = fields
        .filter(|((field, wanted), (_, said))| wanted != said && !VARIES.contains(&field.name));
    other
        .map(|((field, wanted), (_, said))| {
            format!("{}: written {wanted}, said {said}", field.name)
        })
        .collect()
}
