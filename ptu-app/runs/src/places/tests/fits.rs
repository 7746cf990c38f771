//! What a bench makes of procedures.

use std::sync::Arc;

use btu_rig::procedure::plan::{Action, Condition, Operand, What};
use btu_rig::procedure::{Procedure, Step};
use btu_rig::stimulus::{CodeSignal, DoorLine, Stimulus};

use super::{BENCH, ENGLISH, at_ports, bench};
use crate::test_support::{procedures, setup};

/// Goal: a code that a generator cannot make skips its step, and one of no level is none.
#[test]
fn a_code_beyond_the_generator_is_skipped() {
    let places = bench(&at_ports(BENCH, 1, 2)).expect("a bench");
    let (id, name) = ("atp/overspeed", "FSB without effect");
    for (carrier_hz, level_mv, lacks) in [
        (3000.0, 2100.0, Some("2.1 is out of range for level_v")),
        (3000.0, 1900.0, None),
        (3000.0, 0.0, None),
        (0.0, 2100.0, None),
    ] {
        let mut plain = procedures(&setup(&[]));
        for procedure in plain.iter_mut().filter(|one| one.id == id) {
            let code = Stimulus::Code(CodeSignal::new(carrier_hz, 15.0, level_mv));
            for step in &mut Arc::make_mut(procedure).steps {
                step.continues = false;
                step.actions.push(Action::Stimulus(code));
            }
        }
        let fitted = places.fit(plain, &ENGLISH);
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
        let text = at_ports(BENCH, 1, 2);
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
        let fitted = places(none).fit(plain, &ENGLISH);
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

/// Goal: what a person reads is asked for, in place of waiting and of looking, and the source says by how much longer that
/// takes; a time of it is too quick for a person.
#[test]
fn a_person_reads_a_contact_where_the_time_allows_it() {
    let text = at_ports(BENCH, 1, 2);
    let by_person = "eb = { at = \"operator\", within_s = 30 }";
    let places = bench(&text.replace(
        "eb = { at = \"io\", input = 16, inverted = true }",
        by_person,
    ));
    let fitted = places
        .expect("a bench")
        .fit(procedures(&setup(&[])), &ENGLISH);
    let asks = |action: &Action| matches!(action, Action::Prompt { text, .. } if text.starts_with("Please look: eb = released"));
    let seen = fitted
        .iter()
        .find(|one| one.id == "atp/speed_input")
        .expect("it");
    assert_eq!(seen.lacks, None);
    assert!(seen.setup.iter().any(asks), "{:?}", seen.setup);
    let released = step(&fitted, "ptu/at_rest", "the emergency brake is released");
    assert_eq!(released.lacks, None);
    assert!(released.actions.iter().any(asks), "{:?}", released.actions);
    let sources = format!("{:?}", released.origin);
    assert!(
        sources.contains("a person (limits wider by 30 s)"),
        "{sources}"
    );
    for (name, why) in [
        (
            "at rest for five seconds",
            "a person reads eb, too slowly for this step",
        ),
        (
            "emergency brake released again with a cab",
            "does not read eb_loop",
        ),
    ] {
        let lacks = step(&fitted, "atp/power_up", name).lacks.as_deref();
        assert!(
            lacks.is_some_and(|lacks| lacks.ends_with(why)),
            "{name}: {lacks:?}"
        );
    }
}

/// Goal: a step that continues a moving one is wider by the motion, too. Method: a step that measures at a moment of a motion,
/// and the same again without its motion.
#[test]
fn motion_of_a_step_that_is_continued_counts() {
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
    let places = bench(&at_ports(BENCH, 1, 2)).expect("a bench");
    let fit = |plain| places.fit(plain, &ENGLISH);
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
    let places = bench(&at_ports(BENCH, 1, 2)).expect("a bench");
    let plain = procedures(&setup(&[]));
    let fitted = places.fit(plain.clone(), &ENGLISH);
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
