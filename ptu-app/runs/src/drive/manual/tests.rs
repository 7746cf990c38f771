//! Recorded driving sequences played with the embedded unit in the loop.

use btu_rig::drive::Row;
use btu_rig::drive::manual::AtpBrake;
use btu_rig::lever::Lever;
use btu_rig::stimulus::{Stimulus, TrainSwitch};
use protocol::message::FsbCause;

use super::*;
use crate::drive::SectionChoice;
use crate::test_support::scripts;

fn request() -> Request {
    Request {
        line: None,
        sections: None,
        controllers: Vec::new(),
        train: "line6".into(),
        mass_kg: None,
        load: None,
        fixed: Fixed::default(),
        code: None,
        unit_config: "sg100".into(),
        settings: Vec::new(),
        seed: 1,
    }
}

/// The case of a sequence written here.
fn case(text: &str) -> ManualCase {
    let mut case = request().manual(&scripts(), "figure5").unwrap();
    let sequence = Sequence::from_toml(text).unwrap();
    case.plan.sequence = sequence;
    case.plan.load_kg = 0.0;
    case
}

/// Goal: what was driven by keys is driven again by the file it was saved in. Method: actions at odd
/// times, then the saved sequence; every row is the same.
#[test]
fn a_run_by_hand_can_be_repeated_from_what_was_saved() {
    let mut by_hand = request().manual(&scripts(), KEYS).unwrap();
    by_hand.plan.load_kg = 40_000.0;
    let mut bench = by_hand.bench.fresh(1);
    let mut player = Player::new(by_hand.plan.clone());
    let mut began = None;
    let lever = |lever| Stimulus::Controller { lever };
    let regeneration_cut_out = Stimulus::Switch {
        switch: TrainSwitch::Regeneration,
        on: false,
    };
    let keys = [
        (0, lever(Lever::Power(3))),
        (7_130, regeneration_cut_out),
        (7_130, lever(Lever::Brake(4))),
        (9_010, lever(Lever::Emergency)),
    ];
    let outcome = loop {
        bench.tick().unwrap();
        let now = bench.now();
        assert!(player.step(now, bench.rig_mut()).is_none());
        if player.newest().is_none() {
            assert!(now.as_secs() < 10.0, "never ready");
            continue;
        }
        let began = *began.get_or_insert(now);
        let at_ms = now.since(began).as_us() / 1000;
        for (_, action) in keys.iter().filter(|key| key.0 == at_ms) {
            player.act(now, bench.rig_mut(), *action).unwrap();
        }
        if at_ms == 15_000 {
            break player.end(Ending::ByHand);
        }
    };
    let run = ManualRun {
        case: by_hand,
        outcome,
    };
    let saved = run.sequence().to_toml();
    let mut again = request().manual(&scripts(), KEYS).unwrap();
    again.plan.sequence = Sequence::from_toml(&saved).unwrap();
    again.plan.by_hand = false;
    again.plan.load_kg = 40_000.0;
    let repeated = again.play();
    assert_eq!(repeated.ending, Ending::Played);
    let told = |rows: &[Row]| {
        rows.iter()
            .map(|row| format!("{row:?}"))
            .collect::<Vec<_>>()
    };
    assert_eq!(told(&repeated.rows), told(&run.outcome.rows), "{saved}");
    assert!(repeated.rows.len() > 250 && repeated.figures.peak_speed_kmh > 10.0);
}

/// ATP brakes a train whose driver exceeds the limit of the speed code.
#[test]
fn a_brake_by_atp_ends_the_sequence_and_its_cause_is_given() {
    let mut slow = case("title = \"x\"\n[[steps]]\nafter_s = 0\nlever = \"P1\"\n");
    let code = "25";
    slow.plan.sequence.code = Some(code.into());
    let config = &slow.bench.config.content;
    let train = TrainData::Cars(slow.plan.train.clone());
    let line = &slow.bench.line.content;
    slow.plan = Plan::new(config, line, &train, 1, slow.plan.sequence.clone()).unwrap();
    let outcome = slow.play();
    let overspeed = AtpBrake::FullService(Some(FsbCause::Overspeed));
    assert_eq!(outcome.ending, Ending::Atp(overspeed), "{}", outcome.ending);
    assert!(
        outcome
            .ending
            .to_string()
            .ends_with("full service brake: overspeed")
    );
    assert!((25.0..35.0).contains(&outcome.figures.peak_speed_kmh));
    let last = outcome.rows.last().unwrap();
    assert!(
        last.t_s < 60.0 && last.speed_kmh < 26.0,
        "released below the limit: {last:?}"
    );
}

/// Without inverters P4 moves nothing.
#[test]
fn a_speed_that_is_not_reached_ends_the_sequence_at_its_line() {
    let cut: String = [2, 3, 6, 7]
        .map(|car| format!("[[steps]]\nafter_s = 0\ninverter_cut_out = {car}\n"))
        .concat();
    let tail = "[[steps]]\nafter_s = 0\nlever = \"P4\"\n[[steps]]\nat_kmh = 10\nlever = \"B7\"\n";
    let outcome = case(&format!("title = \"x\"\n{cut}{tail}")).play();
    assert_eq!(
        outcome.ending.to_string(),
        "line 17: 10 km/h not reached within 120 s"
    );
    assert_eq!(outcome.done.len(), 5);
    assert_eq!(outcome.figures.peak_speed_kmh, 0.0);
}

/// Of two departures the second standstill is the one that is waited for.
#[test]
fn standstill_means_after_having_moved() {
    let leg = "[[steps]]\nafter_s = 1\nlever = \"P4\"\n[[steps]]\nafter_s = 5\nlever = \"B7\"\n\
               [[steps]]\nat_standstill = true\nlever = \"N\"\n";
    let outcome = case(&format!("title = \"x\"\n{leg}{leg}")).play();
    assert_eq!(outcome.ending, Ending::Played);
    let stood: Vec<_> = outcome
        .done
        .iter()
        .filter(|done| done.speed_kmh == 0.0)
        .collect();
    assert_eq!(
        stood.len(),
        4,
        "two departures, two stops: {:?}",
        outcome.done
    );
    assert!(
        outcome
            .done
            .windows(2)
            .all(|pair| pair[1].t_s - pair[0].t_s > 0.9)
    );
}

#[test]
fn an_option_overrides_the_file() {
    let asked = Request {
        load: Some(Load::Empty),
        code: Some("65".into()),
        line: Some("line8".into()),
        sections: Some(SectionChoice::One(54)),
        ..request()
    };
    let plan = asked.manual(&scripts(), "figure5").unwrap().plan;
    assert_eq!(
        (plan.load_kg, plan.limit_kmh, plan.section.section),
        (0.0, 65.0, 54)
    );
    let plan = request().manual(&scripts(), "figure5").unwrap().plan;
    assert_eq!(
        (plan.load_kg, plan.limit_kmh, plan.section.section),
        (160_000.0, 75.0, 1)
    );
}
