//! Search for hazards: scenes that follow no rule against an independent monitor of what is true.
//!
//! A breach is explained by a condition that `docs/protection.md` exports by name: one of the scene, or a failed part that
//! the condition names. Any other is a gap of the unit. `HAZARD_SEEDS=17..18` shows one scene, shortened, and as a procedure.

#![expect(
    clippy::print_stdout,
    reason = "what a search found is read by a person"
)]

mod acts;
mod authority;
mod find;
mod forms;
mod guards;
mod memory;
mod monitor;
mod observed;
mod permitted;
mod place;
mod plan;
mod play;
mod proceeding;
mod ride;
mod scene;
mod wayside_acts;

use std::collections::BTreeMap;
use std::ops::Range;

use self::acts::Kind;
use self::find::Find;
use self::monitor::{Invariant, UNDER_STOP};
use self::plan::Plan;
use self::play::play;
use crate::{scripts, setup};
use fuzzing::draw;
use protocol::injection::FaultMode;
use ptu_runs::pool;
use ptu_runs::run::{BenchChoice, BenchSetup, Signals};
use ptu_runs::stop::Stop;

const PROTECTION: &str = include_str!("../../../../../docs/protection.md");

/// Finds of a kind that are shortened.
const SHORTENED: usize = 6;

/// A condition that others than the unit have to see to.
struct Exported {
    name: &'static str,
    invariants: Vec<&'static str>,
    /// Failed parts that are this condition; none where the monitor sees it in the scene.
    modes: Vec<glob::Pattern>,
}

/// The table under the heading "Exported conditions".
fn exported() -> Vec<Exported> {
    let (_, table) = PROTECTION
        .split_once("## Exported conditions")
        .expect("exported conditions");
    let rows = table.lines().skip_while(|line| !line.starts_with("|---"));
    let rows = rows.skip(1).take_while(|line| line.starts_with('|'));
    let row = |row: &'static str| {
        let cells: Vec<_> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [name, invariants, _, modes] = cells[..] else {
            panic!("columns of {row}")
        };
        let modes = modes.split('`').skip(1).step_by(2);
        Exported {
            name,
            invariants: invariants.split(' ').collect(),
            modes: modes
                .map(|mode| glob::Pattern::new(mode).expect("a glob"))
                .collect(),
        }
    };
    rows.map(row).collect()
}

/// Most that a fast clock hides of the speed before TCMS's alive counter contradicts it, km/h: `clock_share` of 85 km/h, and
/// what the monitor's speed is ahead of a measured one.
const CLOCK_HIDES_KMH: f64 = 8.0;

/// The condition that explains a find.
fn explained(find: &Find, exported: &[Exported]) -> Option<&'static str> {
    let invariant = format!("{:?}", find.breach.invariant);
    let holds = |one: &&Exported| {
        let applies = match one.name {
            "clock_fast" => find.hidden_kmh < CLOCK_HIDES_KMH,
            "stop_unheard" => find.breach.how == UNDER_STOP,
            _ => true,
        };
        let failed = |fault: &String| applies && one.modes.iter().any(|mode| mode.matches(fault));
        one.invariants.contains(&invariant.as_str())
            && (find.breach.condition == Some(one.name) || find.faults.iter().any(failed))
    };
    exported.iter().find(holds).map(|one| one.name)
}

/// A bench, with the fault modes of the catalogue that are drawn from.
struct Search {
    setup: BenchSetup,
    modes: Vec<FaultMode>,
    /// Kind of scene with which each plan begins; none = each kind in turn.
    first: Option<Kind>,
}

impl Search {
    fn new(setup: BenchSetup, modes: &str) -> Self {
        let mut catalogue = scripts().faults().expect("fault modes").faults;
        let glob = glob::Pattern::new(modes).expect("a glob");
        // The monitor holds what the bench knows for the truth.
        catalogue.retain(|mode| glob.matches(&mode.id) && !mode.place.on_bench());
        Self {
            setup,
            modes: catalogue,
            first: None,
        }
    }

    fn plan(&self, number: u64) -> Plan {
        Plan::draw(&self.setup, &self.modes, self.first, number)
    }

    /// Plays the plans of these numbers on all processors: finds, and the time played, min.
    fn run(&self, numbers: Range<u64>) -> (Vec<(u64, Find)>, f64) {
        let number = |place: usize| numbers.start + place as u64;
        let work = |place| {
            let plan = self.plan(number(place));
            (play(&self.setup, &plan), plan.length_ms)
        };
        let count = (numbers.end - numbers.start) as usize;
        let played = pool::run(count, pool::cores(), &Stop::default(), &mut |_| {}, work);
        let minutes = played
            .iter()
            .map(|(_, (_, ms))| f64::from(*ms) / 60_000.0)
            .sum();
        let found = |(place, (find, _)): (usize, (Option<Find>, u32))| Some((number(place), find?));
        (played.into_iter().filter_map(found).collect(), minutes)
    }

    /// A plan with as few acts as still lead to this breach.
    fn shortened(&self, number: u64) -> Option<(Plan, Find)> {
        let mut plan = self.plan(number);
        let mut find = play(&self.setup, &plan)?;
        loop {
            let invariant = find.breach.invariant;
            let shorter = plan.shorter().find_map(|shorter| {
                let find = play(&self.setup, &shorter)?;
                let same = find.breach.invariant == invariant && find.breach.condition.is_none();
                same.then_some((shorter, find))
            });
            match shorter {
                Some((shorter, less)) => (plan, find) = (shorter, less),
                None => return Some((plan, find)),
            }
        }
    }
}

/// Tells what was found: each exported condition with its count, and no breach without one.
fn judge(search: &Search, finds: &[(u64, Find)], minutes: f64) {
    let exported = exported();
    let mut counts = BTreeMap::<_, usize>::new();
    let mut gaps = Vec::new();
    for (number, find) in finds {
        match explained(find, &exported) {
            Some(name) => *counts.entry((find.breach.invariant, name)).or_default() += 1,
            None => gaps.push((*number, find)),
        }
    }
    println!("{minutes:.0} min");
    for ((invariant, name), count) in &counts {
        println!("exported: {count} {invariant:?} by {name}");
    }
    let mut kinds = BTreeMap::<_, Vec<u64>>::new();
    for (number, find) in &gaps {
        let kind = (find.breach.invariant, find.breach.how);
        kinds.entry(kind).or_default().push(*number);
    }
    for ((invariant, how), numbers) in &kinds {
        println!("{invariant:?} {how}: {}, {numbers:?}", numbers.len());
        for number in numbers.iter().take(SHORTENED) {
            if let Some((plan, find)) = search.shortened(*number) {
                println!("  {number}: {find}\n{}", scene::script(&plan, &find));
            }
        }
    }
    assert!(
        gaps.is_empty(),
        "{} breaches that no condition explains",
        gaps.len()
    );
}

fn judged(setup: BenchSetup, modes: &str, numbers: Range<u64>) {
    let search = Search::new(setup, modes);
    let (finds, minutes) = search.run(numbers);
    judge(&search, &finds, minutes);
}

/// The same 150 scenes with each commit; other scenes are searched by hand or in the long suite.
#[test]
fn scenes_break_no_invariant() {
    judged(setup(&[]), "*", 0..150);
}

/// A unit that stops and proceeds, with codes of the yard.
fn seoul34() -> BenchSetup {
    let choice = BenchChoice {
        unit_config: "seoul34".to_owned(),
        ..BenchChoice::default()
    };
    choice.setup(&scripts()).expect("a bench")
}

#[test]
fn scenes_of_a_unit_that_stops_and_proceeds_break_no_invariant() {
    judged(seoul34(), "*", 0..40);
}

/// Codes, pulses, markers and data as waveforms.
fn sampled() -> BenchSetup {
    let choice = BenchChoice {
        signals: Signals::Sampled(None),
        ..BenchChoice::default()
    };
    choice.setup(&scripts()).expect("a bench")
}

/// Goal: the search finds what is there. Method: with a fault that takes a protection away, some scenes show the breach.
/// What is rare is looked for where such scenes are.
#[test]
fn a_protection_that_is_taken_away_shows() {
    use Invariant::*;
    for (mode, invariant, from) in draw::drawn(
        [
            ("fsb_output.dead", I2, 0),
            ("eb_relay.welded", I3, 1_200),
            ("io_board.door_enable_stuck", I4, 0),
            ("atp_receiver.unselective", I2, 90),
            ("atp_cpu.wheel_guard_dead", I2, 1_050),
        ],
        2,
    ) {
        shows(mode, invariant, from);
    }
}

/// Plays 300 scenes at most, in blocks so small that few are played after the one that shows the breach.
fn shows(mode: &str, invariant: Invariant, from: u64) {
    let search = Search::new(setup(&[]), mode);
    let shown = (0..20).any(|block| {
        let first = from + block * 15;
        let (finds, _) = search.run(first..first + 15);
        finds.iter().any(|(_, find)| {
            let by_mode = find.faults.iter().any(|id| id == mode);
            by_mode && find.breach.invariant == invariant && find.breach.condition.is_none()
        })
    });
    assert!(shown, "{mode}: no {invariant:?}");
}

/// The scenes of the promise, or those of `HAZARD_SEEDS`, on `HAZARD_BENCH`: `seoul34` or `sampled`; with parts that fail of
/// `HAZARD_MODES` alone.
#[test]
#[ignore = "long suite: a part of them; all take an hour: cargo test --release -p ptu-runs many_scenes -- --ignored"]
fn many_scenes_break_no_invariant() {
    let asked = std::env::var("HAZARD_SEEDS").ok();
    let (from, to) = match asked.as_deref().map(|asked| asked.split_once("..")) {
        None => (1_000, 201_000),
        Some(Some((from, to))) => (number(from), number(to)),
        Some(None) => panic!("HAZARD_SEEDS is FROM..TO"),
    };
    let setup = match std::env::var("HAZARD_BENCH").as_deref() {
        Ok("seoul34") => seoul34(),
        Ok("sampled") => sampled(),
        _ => setup(&[]),
    };
    let modes = std::env::var("HAZARD_MODES");
    judged(setup, modes.as_deref().unwrap_or("*"), from..to);
}

fn number(text: &str) -> u64 {
    text.parse().expect("HAZARD_SEEDS is FROM..TO")
}
