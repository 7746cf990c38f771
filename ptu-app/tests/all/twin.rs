//! Expected and recorded traces: good twins, first deviations, differences, replays.

use crate::common::{Place, has_shape, list, number, text};
use fault_db::Store;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::replay::{Original, explain, good_twin};
use serde_json::Value;

/// A good unit that cannot pass: a train is driven by hand, and the limit is one no train can keep.
const PULLS_AWAY: &str = r#"procedure(title = "Impossible", title_ko = "불가능", suspect = "tcms")
step("pulls away",
    do = [cab.acknowledge(), cab.mode("yard"), until(mode, "yard", within = s(2)), until(eb, "released", within = s(2)),
          train.drive(True), cab.controller(4), wait(s(3)), cab.controller(-7), wait(s(4)), cab.controller(0)],
    measure = maximum("greatest_speed", train_speed, high = kmh(0.1)),
)
"#;

/// Fault mode, the procedure run on a unit with it, and the signals of the faulty part: the first deviation
/// must be one of them.
const FIRST_DEVIATIONS: [(&str, &str, &[&str]); 8] = [
    ("speed_sensor_1.dead", "atp/speed_input", &["speed1"]),
    ("speed_sensor_2.dead", "atp/speed_input", &["speed2"]),
    ("eb_relay.slow", "atp/overspeed", &["eb"]),
    ("fsb_output.dead", "atp/overspeed", &["fsb"]),
    ("tra.dead", "ato/markers", &["tra_ok", "marker"]),
    ("marker_antenna.deaf_to_psm4", "ato/markers", &["marker"]),
    (
        "rs485_link.receiver_dead",
        "tcms/link",
        &["tcms_ok", "rejected_frames"],
    ),
    ("door_contact.open", "tcms/train_lines", &["doors"]),
];

impl Place {
    fn store(&self) -> Store {
        Store::open_read_only(&self.path("history.db")).expect("a database")
    }

    /// The latest trace with where it deviates.
    fn explained(&self) -> Value {
        self.json("trace show latest --twin --json")
    }
}

fn directory() -> ScriptsDirectory {
    ScriptsDirectory::find(Some(&crate::common::scripts())).expect("scripts")
}

/// Every trace of the place and its twin, bit by bit; only the sign of a zero is not stored.
fn twins_are_identical(place: &Place, directory: &ScriptsDirectory) -> usize {
    let store = place.store();
    let mut count = 0;
    for run in place.run_ids() {
        let run = store.resolve_run(&run).expect("a run");
        for summary in store.traces(run).expect("traces") {
            let original = Original::read(&store, summary.id).expect("a recording");
            let (twin, _) = good_twin(&original, directory).expect("a twin");
            let bits = |columns: &[Vec<f64>]| -> Vec<Vec<u64>> {
                let column =
                    |column: &Vec<f64>| column.iter().map(|v| (v + 0.0).to_bits()).collect();
                columns.iter().map(column).collect()
            };
            let (came, expected) = (bits(&original.trace.columns), bits(&twin.columns));
            for (channel, (came, expected)) in twin.channels.iter().zip(came.iter().zip(&expected))
            {
                assert_eq!(came, expected, "{} of {}", channel.name, original.procedure);
            }
            assert_eq!(original.trace.trigger_row, twin.trigger_row);
            count += 1;
        }
    }
    count
}

/// Goal: what deviates under a fault deviates because of it. Method: traces of good units that a limit no
/// unit can keep cut, in nominal and scattered trains, with another configuration, after other procedures.
#[test]
fn the_twin_of_a_good_unit_is_its_trace_bit_by_bit() {
    let place = Place::new();
    let script = place.write("impossible.star", PULLS_AWAY);
    for arguments in [
        "--seed 7",
        "--seed 8 --scattered",
        "--seed 9 --set ato.gently_mps2=0.4 --serial-no X-9",
        "--seed 10 --line line6 --train ideal tcms/link",
    ] {
        place.ptu(&format!("run {script} {arguments}")).exits(1);
    }
    assert_eq!(twins_are_identical(&place, &directory()), 4);
    let shown = place.explained();
    assert_eq!(shown["first_deviation"], Value::Null);
    assert_eq!(list(&shown["deviations"]).len(), 0);
    let said = place.ptu("trace show latest").exits(0);
    assert!(said.out.contains("as expected"), "{}", said.all());
}

#[test]
fn the_first_deviation_is_at_the_faulty_part() {
    for (mode, procedure, signals) in FIRST_DEVIATIONS {
        let place = Place::new();
        place.ptu(&["run", procedure, "--inject", mode]).exits(1);
        let trace = first_trace(&place);
        let shown = place.json(&["trace", "show", &trace, "--twin", "--json"]);
        let first = &shown["first_deviation"];
        has_shape(
            first,
            &[
                ("signal", "text"),
                ("at_s", "number"),
                ("value", "number?"),
                ("expected", "number?"),
            ],
        );
        assert!(
            signals.contains(&text(&first["signal"])),
            "{mode}: {first}\n{}",
            shown["deviations"]
        );
        assert_eq!(first, &list(&shown["deviations"])[0]);
        let chain = list(&shown["chain"]);
        assert_eq!(chain[0]["signal"], first["signal"], "{mode}: {chain:?}");
        assert!(
            chain.iter().any(|link| link["kind"] == "fault"),
            "{mode}: {chain:?}"
        );
        let times: Vec<_> = chain.iter().map(|link| number(&link["at_s"])).collect();
        // Within one report of the unit the way through it decides.
        let ordered = times.windows(2).all(|pair| pair[0] <= pair[1] + 0.101);
        assert!(ordered, "{mode}: {times:?}");
    }
}

/// The first trace of the latest run.
fn first_trace(place: &Place) -> String {
    let store = place.store();
    let run = store.resolve_run("latest").expect("a run");
    let traces = store.traces(run).expect("traces");
    traces.first().expect("a trace").id.to_string()
}

/// Diagnosis asks for explanations by the dozen.
#[test]
fn an_explanation_comes_from_the_library_too() {
    let place = Place::new();
    place.ptu("run ato/markers --inject tra.dead").exits(1);
    let store = place.store();
    let id = store.resolve_trace(&first_trace(&place)).expect("a trace");
    let explanation = explain(&store, &directory(), id).expect("explained");
    assert_eq!(explanation.procedure, "ato/markers");
    assert!(explanation.first().is_some());
    assert!(!explanation.chain.is_empty());
}
