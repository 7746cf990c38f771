//! The served unit acts on no frame that was damaged on the way, whether a tester has armed it or not, and takes no
//! memory for it.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

mod damage;
mod tester;
mod watch;

use std::time::{Duration, Instant};

use protocol::message::IoInput;

use crate::maintenance::{SESSION, test_speed};
use crate::served::Unit;
use damage::{Damager, Kind};
use tester::Tester;

/// Damaged frames on one connection, at most.
const ROUND: u64 = 100_000;
/// Damaged frames are added in a scan up to so many bytes: the unit reads 4096, and one of them has at most 900.
const FILLED: usize = 3200;
/// Time after which this program has been held up; after 200 ms without inputs a unit brakes, and rightly.
const HELD_UP: Duration = Duration::from_millis(100);
/// Rounds that may be spoiled by that, beside one in ten.
const MOST_SPOILED: u64 = 3;
/// After the first tenth memory may grow by one part in this many.
const MOST_GROWTH: u64 = 10;

/// Figures of a campaign.
#[derive(Clone, Default)]
struct Figures {
    kinds: [u64; Kind::ALL.len()],
    left_whole: u64,
    refused: u64,
    sound: u64,
    answered: u64,
    bytes: u64,
    took: Duration,
    slowest: Duration,
    rounds: u64,
    /// Rounds in which this program was held up and the unit did something.
    spoiled: u64,
    /// Memory of the unit after each tenth, kB.
    memory_kb: Vec<u64>,
}

impl Figures {
    fn frames(&self) -> u64 {
        self.kinds.iter().sum()
    }

    /// Damaged frames and bytes in a second.
    fn rates(&self) -> [u64; 2] {
        let per_second = |count: u64| (count as f64 / self.took.as_secs_f64()) as u64;
        [self.frames(), self.bytes].map(per_second)
    }
}

/// A round could not be judged as it went; whether this program was held up in it.
struct Broken {
    faults: Vec<String>,
    held_up: bool,
}

/// Sends damaged frames on a connection of its own, until there are `amount` in all.
fn round(
    unit: &Unit,
    armed: bool,
    damager: &mut Damager,
    amount: u64,
    figures: &mut Figures,
) -> Result<(), Broken> {
    let mut tester = Tester::begin(unit, armed);
    let end = (figures.frames() + ROUND).min(amount);
    let (began, bytes) = (Instant::now(), tester.bytes);
    while figures.frames() < end {
        tester.scan(|tester, out| {
            while figures.frames() < end && out.len() < FILLED {
                figures.kinds[tester.damage(damager, out) as usize] += 1;
            }
        });
        if figures.frames() * 10 >= amount * (figures.memory_kb.len() as u64 + 1) {
            let pid = unit.program.0.id().to_string();
            figures.memory_kb.push(fuzzing::memory_kb(&pid, "VmRSS"));
        }
    }
    figures.took += began.elapsed();
    figures.bytes += tester.bytes - bytes;
    figures.rounds += 1;
    let ended = tester.end();
    figures.sound += ended.sound;
    figures.answered += ended.answered;
    figures.refused += ended.refused;
    figures.slowest = figures.slowest.max(ended.slowest);
    match ended.faults.is_empty() {
        true => Ok(()),
        false => Err(Broken {
            faults: ended.faults,
            held_up: ended.silent >= HELD_UP,
        }),
    }
}

/// Sends so many damaged frames to a unit. A round in which this program was held up is done again when the unit did
/// something meanwhile.
fn campaign(armed: bool, amount: u64) -> Figures {
    let unit = Unit::serve();
    let seed = fuzzing::seed().wrapping_mul(2) + u64::from(armed);
    let mut damager = Damager::new(seed, SESSION);
    let mut figures = Figures::default();
    while figures.frames() < amount {
        let mut next = figures.clone();
        match round(&unit, armed, &mut damager, amount, &mut next) {
            Ok(()) => figures = next,
            Err(broken) => {
                let faults = broken.faults.join("\n");
                assert!(broken.held_up, "armed: {armed}\n{faults}");
                figures.spoiled += 1;
                let most = MOST_SPOILED + figures.rounds / 10;
                assert!(figures.spoiled <= most, "armed: {armed}\n{faults}");
            }
        }
    }
    figures.left_whole = damager.left_whole;
    figures
}

fn print(columns: &[Figures; 2]) {
    let row = |name: &str, value: &dyn Fn(&Figures) -> u64| {
        let [idle, armed] = columns.each_ref().map(value);
        println!("{name:46} {idle:>12} {armed:>12}");
    };
    println!(
        "{:46} {:>12} {:>12}",
        "frames damaged by", "not armed", "armed"
    );
    for (place, kind) in Kind::ALL.iter().enumerate() {
        row(kind.label(), &|f| f.kinds[place]);
    }
    row("damaged frames sent", &Figures::frames);
    row("frames refused, as the unit counts", &|f| f.refused);
    row("frames left whole by damage, not sent", &|f| f.left_whole);
    row("sound frames among them", &|f| f.sound);
    row("requests answered as due", &|f| f.answered);
    row("damaged frames a second", &|f| f.rates()[0]);
    row("bytes a second", &|f| f.rates()[1]);
    row("longest time to an answer, ms", &|f| {
        f.slowest.as_millis() as u64
    });
    row("connections", &|f| f.rounds);
    row("of them done again, tester held up", &|f| f.spoiled);
    for tenth in 0..10 {
        let name = format!("memory of the unit after {} %, kB", 10 * (tenth + 1));
        row(&name, &|f| f.memory_kb[tenth]);
    }
}

/// Goal: no damaged frame is acted on, and none costs memory. Method: two served units, one of them armed, get sound
/// frames in each scan and, as fast as they read, frames of every message damaged in twelve ways. All that they say
/// is watched: only what the sound frames ask is answered, outputs, inputs, modes, test signals and log stay as they
/// are, and exactly the damaged frames are counted as refused.
#[test]
fn damaged_frames_are_never_acted_on() {
    let each = fuzzing::amount(50_000) / 2;
    let columns = std::thread::scope(|scope| {
        let units = [false, true].map(|armed| scope.spawn(move || campaign(armed, each)));
        units.map(|unit| unit.join().expect("a campaign"))
    });
    print(&columns);
    for figures in &columns {
        let [first, .., last] = figures.memory_kb[..] else {
            panic!("memory is not told");
        };
        let most = first + first / MOST_GROWTH;
        assert!(first > 0 && last <= most, "{:?}", figures.memory_kb);
        assert!(figures.kinds.iter().all(|&count| count > 0));
    }
}

/// Goal: the campaign would notice a damaged frame that is acted on. Method: two sound frames pass for damaged ones.
#[test]
fn a_frame_that_is_acted_on_is_noticed() {
    let unit = Unit::serve();
    let mut tester = Tester::begin(&unit, true);
    tester.scan(|tester, out| tester.pass_for_damaged(test_speed(500), out));
    tester.scan(|tester, out| tester.pass_for_damaged(IoInput::default(), out));
    let faults = tester.end().faults;
    for part in [
        "refused 0 of 2",
        "not asked for: StimulusAnswer",
        "became TrainState",
    ] {
        let noticed = faults.iter().any(|fault| fault.contains(part));
        assert!(noticed, "{part}: {faults:?}");
    }
}
