//! `ptu faults life`: the life of a unit, a part or a train on the command line.

use crate::common::{Place, list, record_bad_unit, relay_fault, text};

/// Goal: one serial number tells where the part is, in both languages, and what is mistyped is corrected. Method: a unit with
/// a slow relay, repaired and passed.
#[test]
fn a_serial_number_tells_its_life_in_both_languages() {
    let place = Place::new();
    record_bad_unit(&place);
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let repair = [
        "faults", "repair", &fault, "--part", "eb_relay", "--old", "SN-1", "--new", "SN-2",
        "--who", "Kim",
    ];
    place.ptu(&repair).exits(0);
    let pass = [
        "run",
        "atp/overspeed",
        "--serial-no",
        "BAD-1",
        "--train-no",
        "612",
    ];
    place.ptu(&pass).exits(0);

    let life = place.json(&["faults", "life", "BAD-1", "--json"]);
    assert_eq!(life[0]["of"], "unit");
    assert_eq!(life[0]["stays"][0]["place"], "612");
    let events = list(&life[0]["events"]);
    let kinds: Vec<_> = events.iter().map(|event| text(&event["kind"])).collect();
    assert_eq!(
        (kinds[0], events[0]["verdict"].as_str()),
        ("run", Some("failed"))
    );
    let place_of = |kind: &str| kinds.iter().position(|known| *known == kind);
    assert!(place_of("opened") < place_of("repair"), "{kinds:?}");
    assert!(place_of("repair") < place_of("confirmed"), "{kinds:?}");
    let times: Vec<_> = events.iter().map(|event| text(&event["at"])).collect();
    assert!(times.is_sorted(), "{times:?}");

    let part = place.json(&["faults", "life", "SN-2", "--json"]);
    assert_eq!(part[0]["stays"][0]["unit"], "BAD-1");
    assert_eq!(part[0]["stays"][0]["until"], serde_json::Value::Null);
    let train = place.json(&["faults", "life", "612", "--json"]);
    assert_eq!(train[0]["of"], "train");

    for (language, words) in [
        (
            "en",
            [
                "part SN-2",
                "UNITS IT WAS IN",
                "EB relay SN-1 → SN-2",
                "now",
            ],
        ),
        (
            "ko",
            [
                "부품 SN-2",
                "장착된 장치",
                "비상제동 계전기 SN-1 → SN-2",
                "현재",
            ],
        ),
    ] {
        let told = place
            .ptu(&["faults", "life", "SN-2", "--lang", language])
            .exits(0);
        assert!(
            words.iter().all(|said| told.out.contains(said)),
            "{}",
            told.all()
        );
    }
    let last = place
        .ptu(&["faults", "life", "BAD-1", "--limit", "1"])
        .exits(0);
    assert!(
        last.out.contains("earlier entries are not listed"),
        "{}",
        last.all()
    );
    let unknown = place.ptu(&["faults", "life", "bad-1"]).exits(2);
    unknown.explains(&["bad-1", "did you mean", "BAD-1"]);
}

/// Goal: a repair that was taken back was not made: the part was never there. Method: a repair is recorded and undone.
#[test]
fn a_repair_that_was_taken_back_is_not_in_a_life() {
    let place = Place::new();
    record_bad_unit(&place);
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let repair = [
        "faults", "repair", &fault, "--part", "eb_relay", "--old", "SN-1", "--new", "SN-2",
        "--who", "Kim",
    ];
    place.ptu(&repair).exits(0);
    let undo = [
        "faults",
        "undo",
        &fault,
        "--who",
        "Kim",
        "--note",
        "wrong unit",
    ];
    place.ptu(&undo).exits(0);
    place.ptu(&["faults", "life", "SN-2"]).exits(2);
    let life = place.json(&["faults", "life", "BAD-1", "--json"]);
    let events = list(&life[0]["events"]);
    let repairs = events.iter().filter(|event| event["kind"] == "repair");
    assert_eq!(repairs.count(), 0, "{life}");
}
