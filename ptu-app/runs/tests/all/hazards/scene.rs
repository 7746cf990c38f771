//! A find as a check procedure, which `ptu run` repeats: what was done, by the verbs of the script language, and what a unit
//! that protects shows at the end.
//!
//! A script has no supply, and no truth of the track: a scene in which the supply was taken says so, and what is
//! expected is what the unit's contacts show. Fault modes are given when it is run.

use std::fmt::Write as _;

use btu_rig::stimulus::{
    CodeSignal, CutOut, DoorState, StationData, Stimulus, TachoCondition, TcmsCondition,
    TrainSwitch, WaysideCondition,
};
use protocol::event::{Event, Severity};
use protocol::message::TrainOrder;
use protocol::{Duration, Instant};

use super::find::Find;
use super::monitor::Invariant;
use super::plan::{Act, Plan};
use super::play::ends;

/// Signal, value: a train that is braked, or stands.
const BRAKED: &str =
    "any_of(is_(eb_loop, \"applied\"), is_(fsb, \"applied\"), is_(train_speed, below = kmh(1.5)))";
const NO_DOORS: &str = "all_of(is_(door_enable_left, False), is_(door_enable_right, False))";
const NO_POWER: &str = "is_(power_cut, True)";

/// The scene of a find.
pub fn script(plan: &Plan, find: &Find) -> String {
    let safe = match find.breach.invariant {
        Invariant::I4 => NO_DOORS,
        Invariant::I9 => NO_POWER,
        _ => BRAKED,
    };
    let faults = plan
        .faults
        .iter()
        .map(|fault| format!(" --inject {}", fault.id));
    let inject: String = faults.collect();
    let events = Event::ALL.iter().map(|event| event.definition());
    let provoked: Vec<_> = events
        .filter(|event| event.severity > Severity::Info)
        .map(|event| event.name)
        .collect();
    let name = format!("{:?}: {}", find.breach.invariant, find.breach.how);
    let mut text = format!(
        "\"\"\"Hazard scene {}: ptu run FILE{inject}\"\"\"\n\n",
        plan.number
    );
    let _ = writeln!(
        text,
        "procedure(title = {name:?}, suspect = \"-\", setup = [cab.active(True), cab.forward(), cab.controller(0), door.close()])\n"
    );
    let _ = writeln!(text, "step({name:?},\n    do = [");
    let (lines, lacks) = lines(find);
    for line in lines {
        let _ = writeln!(text, "        {line},");
    }
    let _ = writeln!(
        text,
        "    ],\n    expect = becomes({safe}, within = ms(100)),"
    );
    let _ = writeln!(text, "    provokes = {provoked:?},\n)");
    for lack in lacks {
        let _ = writeln!(text, "# Not in this scene: {lack}.");
    }
    text
}

/// Actions with the waits between them, and what has no verb.
fn lines(find: &Find) -> (Vec<String>, Vec<String>) {
    let (mut lines, mut lacks) = (Vec::new(), Vec::new());
    let Some((mut at, _)) = find.acts.first().copied() else {
        return (lines, lacks);
    };
    for (done_at, act) in timeline(find) {
        let waited = done_at.since(at);
        if waited > Duration::ZERO {
            lines.push(wait(waited));
        }
        at = done_at;
        match act {
            Some(Act::Do(stimulus)) => lines.push(verb(stimulus)),
            Some(other) => lacks.push(format!("{other}")),
            None => {}
        }
    }
    (repeated(lines), lacks)
}

/// Acts up to the breach, with each turn of those that alternated.
fn timeline(find: &Find) -> Vec<(Instant, Option<Act>)> {
    let mut timeline = Vec::new();
    let untils = find.acts.iter().skip(1).map(|(at, _)| *at).chain([find.at]);
    let mut turns = None;
    for ((at, act), until) in find.acts.iter().zip(untils) {
        match act {
            Act::Alternate(new) => turns = Some((*new, *at)),
            other => timeline.push((*at, Some(*other))),
        }
        if let Act::Do(stimulus) = act {
            turns = turns.filter(|(turns, _)| !ends(*turns, *stimulus));
        }
        while let Some(([one, other], due)) = turns.as_mut().filter(|(_, due)| *due < until) {
            std::mem::swap(one, other);
            timeline.push((*due, Some(Act::Do(one.0))));
            *due += one.1;
        }
    }
    timeline.push((find.at, None));
    timeline
}

fn wait(time: Duration) -> String {
    format!("wait(ms({}))", time.as_ms())
}

/// The lines, with a round of four that comes again written once.
fn repeated(lines: Vec<String>) -> Vec<String> {
    let (mut short, mut from) = (Vec::new(), 0);
    while from < lines.len() {
        let round = &lines[from..(from + 4).min(lines.len())];
        let same = lines[from..]
            .chunks_exact(4)
            .take_while(|next| *next == round);
        match same.count() {
            times @ 2.. => {
                short.push(format!("[[{}] for _ in range({times})]", round.join(", ")));
                from += 4 * times;
            }
            _ => {
                short.push(lines[from].clone());
                from += 1;
            }
        }
    }
    short
}

/// The verb that makes a stimulus of the search.
fn verb(stimulus: Stimulus) -> String {
    let flag = |on: bool| if on { "True" } else { "False" };
    let side = |left: bool| if left { "left" } else { "right" };
    let signal = |signal: CodeSignal| {
        let CodeSignal {
            carrier_hz,
            rate_hz,
            level_mv,
        } = signal;
        format!("carrier = hz({carrier_hz:?}), rate = hz({rate_hz:?}), level = mv({level_mv:?})")
    };
    match stimulus {
        Stimulus::Code(code) => format!("antenna.raw({})", signal(code)),
        // A neighbouring track gives a code of the table.
        Stimulus::Crosstalk(CodeSignal {
            rate_hz, level_mv, ..
        }) => format!(
            "antenna.crosstalk([c for c in codes if c.rate_hz == {rate_hz:?}][0], level = mv({level_mv:?}))"
        ),
        Stimulus::CodeOff => "antenna.off()".to_owned(),
        Stimulus::CodesAlong { on } => format!("antenna.along({})", flag(on)),
        Stimulus::Speed { to, accel_mps2 } => {
            format!(
                "tacho.ramp(to = kmh({:?}), rate = mps2({accel_mps2:?}))",
                to.kmh()
            )
        }
        Stimulus::Direction { backward: true } => "tacho.backward()".to_owned(),
        Stimulus::Direction { backward: false } => "tacho.forward()".to_owned(),
        Stimulus::Tacho { channel, condition } => {
            let condition = match condition {
                TachoCondition::Good => "\"good\"".to_owned(),
                TachoCondition::Dead => "\"dead\"".to_owned(),
                TachoCondition::Reversed => "\"reversed\"".to_owned(),
                TachoCondition::Noisy { per_s } => format!("\"noisy\", per_s = {per_s:?}"),
                TachoCondition::Scaled { factor } => format!("\"scaled\", factor = {factor:?}"),
            };
            format!("tacho.channel({channel}, {condition})")
        }
        Stimulus::TrainDriven { on } => format!("train.drive({})", flag(on)),
        Stimulus::Adhesion { coefficient } => {
            format!(
                "train.adhesion({})",
                coefficient.map_or(String::new(), |c| format!("{c:?}"))
            )
        }
        Stimulus::Marker { psm } => format!("psm.pulse({psm})"),
        Stimulus::MarkerMoved {
            psm,
            by_m: Some(by_m),
        } => format!("psm.moved({psm}, by = m({by_m:?}))"),
        Stimulus::MarkersAlong {
            section: Some(section),
        } => format!("psm.along({section})"),
        Stimulus::Station(data) => format!("twc.station({})", station(data)),
        Stimulus::Orders(Some(orders)) if orders.order != TrainOrder::None => {
            format!("twc.orders(order = {:?})", orders.order.label())
        }
        Stimulus::Orders(_) => "twc.orders()".to_owned(),
        Stimulus::Wayside(WaysideCondition::Good) => "twc.good()".to_owned(),
        Stimulus::Wayside(WaysideCondition::Silent) => "twc.silent()".to_owned(),
        Stimulus::Wayside(WaysideCondition::Corrupt) => "twc.corrupt()".to_owned(),
        Stimulus::SideDoors { left, state } => {
            let verb = match state {
                DoorState::Open => "open",
                DoorState::Unlocked => "unlock",
                DoorState::Locked => "close",
            };
            format!("door.{verb}({:?})", side(left))
        }
        Stimulus::DoorsFollow { on } => format!("door.automatic({})", flag(on)),
        Stimulus::DoorObstacle { left, times } => {
            format!("door.obstacle({:?}, {times})", side(left))
        }
        Stimulus::DoorLine { line, on } => {
            let on = on.map_or(String::new(), |on| format!(", on = {}", flag(on)));
            format!("door.line({:?}{on})", line.label())
        }
        Stimulus::Hcr { on } => format!("cab.active({})", flag(on)),
        Stimulus::MaintenanceKey { on } => format!("cab.key({})", flag(on)),
        Stimulus::WheelDiameter { diameter_mm } => {
            format!("cab.wheel_diameter(mm({diameter_mm:?}))")
        }
        Stimulus::ModeSwitch(mode) => format!("cab.mode({:?})", mode.label()),
        Stimulus::Controller { lever } => format!("cab.controller({:?})", lever.number()),
        Stimulus::ControllerContacts { contacts: None } => "cab.contacts()".to_owned(),
        Stimulus::ControllerContacts {
            contacts: Some((power, brake)),
        } => {
            format!(
                "cab.contacts(power = {}, brake = {})",
                flag(power),
                flag(brake)
            )
        }
        Stimulus::Reverser { position } => {
            format!(
                "cab.{}()",
                ["backward", "neutral", "forward"][(position + 1) as usize]
            )
        }
        Stimulus::Acknowledge => "cab.acknowledge()".to_owned(),
        Stimulus::Start => "cab.start()".to_owned(),
        Stimulus::Tcms(TcmsCondition::Good) => "tcms.good()".to_owned(),
        Stimulus::Tcms(TcmsCondition::Silent) => "tcms.silent()".to_owned(),
        Stimulus::Tcms(TcmsCondition::Stale) => "tcms.stale()".to_owned(),
        Stimulus::AtoEnable { on } => format!("tcms.ato_enable({})", flag(on)),
        Stimulus::Gradient { permille } => {
            format!(
                "train.gradient({})",
                permille.map_or(String::new(), |p| format!("{p:?}"))
            )
        }
        Stimulus::Switch { switch, on } => {
            let verb = match switch {
                TrainSwitch::Button1 => "cab.emergency_button",
                TrainSwitch::Button2 => {
                    return format!("cab.emergency_button({}, cab = 2)", flag(on));
                }
                TrainSwitch::MainReservoirLow => "train.main_reservoir_low",
                TrainSwitch::OtherCab => "cab.other_active",
                TrainSwitch::EbCutOut => "train.eb_cut_out",
                TrainSwitch::ForcedRelease => "cab.forced_release",
                TrainSwitch::TurnBack => "train.turn_back",
                other => panic!("the search has no {other:?}"),
            };
            format!("{verb}({})", flag(on))
        }
        Stimulus::CutOut {
            what: CutOut::Brake,
            car,
            on,
        } => {
            format!("train.brake_cut_out({car}, {})", flag(on))
        }
        Stimulus::PtuAskToArm => "ptu.ask_to_arm()".to_owned(),
        Stimulus::PtuRelease => "ptu.release()".to_owned(),
        Stimulus::PtuMarker { psm } => format!("ptu.marker({psm})"),
        Stimulus::PtuSpeed { to, .. } => format!("ptu.speed(kmh({:?}))", to.kmh()),
        Stimulus::PtuTwc(data) => format!("ptu.twc({})", station(data)),
        Stimulus::PtuCode(code) => format!("ptu.raw({})", signal(code)),
        other => panic!("the search has no {other}"),
    }
}

fn station(data: StationData) -> String {
    let speed = data
        .fixed_speed_kmh
        .map_or(String::new(), |kmh| format!(", fixed_speed = kmh({kmh})"));
    format!(
        "section = {}, station = {}, next_station = {}, loop = {}, running_mode = {:?}, door_side = {:?}, departure = {}, \
         train_number = {}, route = {}{speed}",
        data.section,
        data.station,
        data.next_station,
        data.loop_id,
        data.running_mode.label(),
        data.door_side.label(),
        if data.departure { "True" } else { "False" },
        data.train_number,
        data.route,
    )
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use btu_rig::procedure::{RunEvent, loader};
    use protocol::Verdict;

    use super::*;
    use crate::hazards::Search;
    use crate::setup;
    use ptu_runs::run::{RunPlan, SessionEvent, run_on_fresh};
    use ptu_runs::stop::Stop;

    /// Goal: a find is repeated by its procedure, which a sound unit passes. Method: finds with two fault modes, shortened.
    #[test]
    fn a_find_is_a_procedure_that_fails_as_it_did() {
        for (mode, invariant) in [
            ("fsb_output.dead", Invariant::I2),
            ("io_board.door_enable_stuck", Invariant::I4),
        ] {
            let search = Search::new(setup(&[]), mode);
            let (finds, _) = search.run(0..60);
            let same = |(_, find): &&(u64, Find)| {
                find.breach.invariant == invariant && find.breach.condition.is_none()
            };
            let (number, _) = finds.iter().find(same).expect("a find");
            let (plan, find) = search.shortened(*number).expect("again");
            assert!(plan.acts.len() <= 10, "{:?}", plan.acts);
            let text = script(&plan, &find);
            let texts = BTreeMap::from([("scene.star".to_owned(), text.clone())]);
            for (faults, passes) in [(vec![mode], false), (vec![], true)] {
                let setup = setup(&faults);
                let (config, line) = (&setup.config.content, &setup.line.content);
                let loaded = loader::load(&texts, config, line, &setup.train);
                assert!(loaded.errors.is_empty(), "{:?}\n{text}", loaded.errors);
                let plan = RunPlan::of(loaded.procedures);
                let mut verdict = None;
                let mut sink = |event| {
                    if let SessionEvent::Run(RunEvent::StepFinished(report)) = event {
                        verdict = Some(report.verdict);
                    }
                };
                run_on_fresh(&setup, &plan.tasks[0], &Stop::default(), &mut sink, &|| {
                    true
                });
                let expected = if passes {
                    Verdict::Passed
                } else {
                    Verdict::Failed
                };
                assert_eq!(verdict, Some(expected), "{faults:?}\n{text}");
            }
        }
    }
}
