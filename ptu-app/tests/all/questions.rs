//! Questions about the history as a depot asks them, from the first fault to the closed one.

#![allow(clippy::print_stderr, reason = "says why a test proves nothing here")]

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use crate::common::{Place, Said, list, number, relay_fault, text};
use chrono::{Local, Utc};

/// A unit of train 8203 with a slow relay, which is repaired, proven by a run and closed.
pub(crate) fn mended() -> Place {
    let place = Place::new();
    let unit = "run atp/overspeed --serial-no BAD-1 --train-no 8203";
    let unit: Vec<_> = unit.split(' ').collect();
    let slow = [&unit[..], &["--inject", "eb_relay.slow"]].concat();
    place.ptu(&slow).exits(1);
    let fault = relay_fault(&place);
    let id = text(&fault["id"]);
    let repair = [
        "faults",
        "repair",
        id,
        "--part",
        "EB_relay",
        "--old",
        "R-17",
        "--new",
        "R/99_b",
        "--who",
        "김",
        "--note",
        "비상제동 릴레이 교체함",
    ];
    place.ptu(&repair).exits(0);
    place.ptu(&unit).exits(0);
    place
}

#[test]
fn a_repair_is_verified_by_the_run_that_passes_and_then_closed() {
    let place = mended();
    let fault = relay_fault(&place);
    assert_eq!(fault["state"], "verified");
    let id = text(&fault["id"]);
    let shown = place.ptu(&["faults", "show", id]).exits(0).out;
    assert!(
        shown.contains("confirmed") && shown.contains("in run ") && shown.contains("R-17 → R/99_b"),
        "{shown}"
    );
    place
        .ptu(&["faults", "note", id, "released to service", "--who", "Lee"])
        .exits(0);
    place
        .ptu(&["faults", "state", id, "closed", "--who", "Lee"])
        .exits(0);
    let stats = place.json(&[
        "faults", "stats", "--by", "part", "--part", "eb_relay", "--json",
    ]);
    let relay = &stats[0];
    for (key, value) in [
        ("faults", 1.0),
        ("not_closed", 0.0),
        ("repairs", 1.0),
        ("closed", 1.0),
        ("no_fault_found", 0.0),
        ("units", 1.0),
        // Nobody knows yet whether it holds.
        ("repairs_judged", 0.0),
    ] {
        assert_eq!(number(&relay[key]), value, "{key} of {relay}");
    }
    assert!(number(&relay["mttr_hours"]) < 1.0, "{relay}");
    // The same again is a new fault, and the repair did not hold.
    place
        .ptu(&[
            "run",
            "atp/overspeed",
            "--serial-no",
            "BAD-1",
            "--inject",
            "eb_relay.slow",
        ])
        .exits(1);
    let stats = place.json(&[
        "faults", "stats", "--by", "part", "--part", "eb_relay", "--json",
    ]);
    assert_eq!(
        (
            number(&stats[0]["faults"]),
            number(&stats[0]["repairs_back"])
        ),
        (2.0, 1.0),
        "{stats}"
    );
}

/// Makes a test that speaks of today; again if it fails while another day, or month, began.
pub(crate) fn within_a_day(test: impl Fn()) {
    let today = || (Local::now().date_naive(), Utc::now().date_naive());
    loop {
        let day = today();
        match catch_unwind(AssertUnwindSafe(&test)) {
            Ok(()) => return,
            Err(panic) if day == today() => resume_unwind(panic),
            Err(_) => eprintln!("another day began"),
        }
    }
}

#[test]
fn faults_are_found_by_what_people_know() {
    within_a_day(are_found_by_what_people_know);
}

fn are_found_by_what_people_know() {
    let place = mended();
    let found = |options: &[&str]| {
        let faults = place.json(&[&["faults", "list", "--json"], options].concat());
        list(&faults)
            .iter()
            .any(|fault| fault["part"] == "eb_relay")
    };
    let today = ["--when", "today"];
    let relay = relay_fault(&place);
    let all = place.json(&["db", "query", "SELECT DISTINCT code FROM faults", "--json"]);
    let codes: Vec<_> = list(&all["rows"])
        .iter()
        .map(|row| row[0].to_string())
        .collect();
    let (codes, severity) = (codes.join(","), text(&relay["severity"]));
    for options in [
        &["--note", "릴레이"][..],
        &["--note", "교체"],
        &["--note", "비상제동 교체"],
        &["--note", "R-17"],
        &["--part-serial-no", "R-17"],
        &["--part-serial-no", "R/99_b"],
        &["--train-no", "8203"],
        &["--part", "EB_RELAY"],
        &["--procedure", "atp/overspeed"],
        &["--serial-no", "BAD-1", "--state", "verified"],
        &["--state", "open,verified"],
        &["--code", &codes],
        &["--severity", &severity.to_uppercase()],
        &["--when", "2026..", "--line", "line8"],
        &today,
    ] {
        assert!(found(options), "{options:?}");
    }
    for options in [
        &["--note", "릴레이 브레이크"][..],
        &["--procedure", "atp/power_up"],
        &["--state", "closed"],
        &["--state", "open,closed"],
        &["--when", "..2020"],
        &["--line", "line6"],
    ] {
        assert!(!found(options), "{options:?}");
    }
}

#[test]
fn counts_come_as_table_json_and_csv() {
    within_a_day(come_as_table_json_and_csv);
}

fn come_as_table_json_and_csv() {
    let place = mended();
    for by in ["code", "part", "unit", "line", "month"] {
        let json = place.json(&["faults", "stats", "--by", by, "--json"]);
        let csv = place
            .ptu(&["faults", "stats", "--by", by, "--csv"])
            .exits(0)
            .out;
        let mut lines = csv.lines();
        let heading = lines.next().expect("a heading");
        assert!(
            heading.starts_with("key,name,faults,not_closed,occurrences,share"),
            "{heading}"
        );
        assert_eq!(lines.count(), list(&json).len(), "{csv}");
        let table = place.ptu(&["faults", "stats", "--by", by]).exits(0).out;
        assert!(
            table.contains("MTBF") && table.contains("within 30 days"),
            "{table}"
        );
        let seen: f64 = list(&json)
            .iter()
            .map(|row| number(&row["occurrences"]))
            .sum();
        let all = place.json(&["db", "query", "SELECT count(*) FROM occurrences", "--json"]);
        assert_eq!(seen, number(&all["rows"][0][0]), "{by}");
    }
    let csv = place.ptu(&["faults", "list", "--csv"]).exits(0);
    assert!(
        csv.out.starts_with("id,") && csv.err.is_empty(),
        "{}",
        csv.all()
    );
    for form in ["--csv", "--json"] {
        let first = place.ptu(&["faults", "list", "--limit", "1", form]);
        first.exits(0).explains(&["only the first 1; see --limit"]);
    }
}

#[test]
fn csv_has_its_headings_without_rows_too_and_keeps_the_last_row_as_it_is() {
    let place = mended();
    let csv = |arguments: &[&str]| place.ptu(&[arguments, &["--csv"]].concat()).exits(0).out;
    for arguments in [
        &["faults", "list"][..],
        &["faults", "stats"],
        &["faults", "stats", "--by", "month"],
    ] {
        let some = csv(arguments);
        let none = csv(&[arguments, &["--when", "..2020"]].concat());
        assert_eq!(some.lines().next(), none.strip_suffix('\n'), "{some}");
    }
    for (sql, answer) in [
        ("SELECT 1 AS a, 2 AS a WHERE 1 = 0", "a,a_\n"),
        ("SELECT 1 AS a, 'x  ' AS b", "a,b\n1,x  \n"),
        (
            "SELECT 1 AS a UNION ALL SELECT NULL UNION ALL SELECT NULL",
            "a\n1\n\"\"\n\"\"\n",
        ),
    ] {
        assert_eq!(csv(&["db", "query", sql]), answer);
    }
    let sql = "SELECT 1 AS a WHERE 1 = 0";
    place.ptu(&["db", "query", sql, "--save", "none"]).exits(0);
    assert_eq!(csv(&["saved", "none"]), "a\n");
}

#[test]
fn a_trend_says_where_a_measurement_is_going() {
    let place = mended();
    let of_overspeed = [
        "faults",
        "trend",
        "eb_reaction",
        "--procedure",
        "atp/overspeed",
    ];
    let trend = place.json(&[&of_overspeed[..], &["--serial-no", "BAD-1", "--json"]].concat());
    let points = list(&trend["points"]).len() as f64;
    assert!(points >= 8.0, "{trend}");
    assert_eq!(number(&trend["process"]["n"]), points);
    // Its steps have limits of their own.
    assert!(
        trend["high"].is_null() && trend["capability"].is_null(),
        "{trend}"
    );
    let fleet = place.json(&[&of_overspeed[..], &["--json"]].concat());
    assert_eq!(number(&fleet["process"]["n"]), points);
    assert_eq!(fleet["process"]["mean"], trend["process"]["mean"]);
    assert_eq!(list(&fleet["units"]).len(), 1);
    let step = ["--step", text(&trend["steps"][0]["step"])];
    let of_step = [&of_overspeed[..], &step, &["--serial-no", "BAD-1"]].concat();
    let trend = place.json(&[&of_step[..], &["--json"]].concat());
    assert!(number(&trend["capability"]["cpk"]).is_finite(), "{trend}");
    let text = place.ptu(&[&of_step[..], &["--plot", "creep.html"]].concat());
    let text = text.exits(0).out;
    assert!(
        text.contains("control limits") && text.contains("Cpk"),
        "{text}"
    );
    assert!(place.read("creep.html").contains("<svg"));
    let since = place.json(
        &[
            &of_overspeed[..],
            &[
                "--serial-no",
                "BAD-1",
                "--since-repair",
                "eb_relay",
                "--json",
            ],
        ]
        .concat(),
    );
    assert!(number(&since["process"]["n"]) < points, "{since}");
}

/// A terminal shows the beginning of a long text; JSON and CSV have all of it.
#[test]
fn a_cell_of_any_length_is_answered() {
    let place = Place::new();
    place.recorded_run();
    let sql = "SELECT hex(zeroblob(40000)) AS zeros, 1 AS one, hex(zeroblob(40000)) AS more";
    let table = place.ptu(&["db", "query", sql]).exits(0).out;
    let row = table.lines().nth(1).expect("a row");
    assert!(
        row.contains("000…    1  000") && row.ends_with("0…"),
        "{row}"
    );
    assert!(row.len() < 10_000, "{}", row.len());
    let all = "0".repeat(80_000);
    let json = place.json(&["db", "query", sql, "--json"]);
    assert_eq!(json["rows"][0][0], all.as_str());
    let csv = place.ptu(&["db", "query", sql, "--csv"]).exits(0).out;
    assert_eq!(csv.lines().nth(1), Some(format!("{all},1,{all}").as_str()));
}

#[test]
fn the_views_answer_and_the_page_tells_of_them() {
    let place = mended();
    let page = place.ptu(&["db", "schema"]).exits(0).out;
    for view in page
        .lines()
        .filter_map(|line| line.strip_prefix("## ")?.split_once(':'))
    {
        let sql = format!("SELECT * FROM {} LIMIT 3", view.0);
        let answer = place.json(&["db", "query", &sql, "--json"]);
        assert!(list(&answer["columns"]).len() > 4, "{}: {answer}", view.0);
    }
    let relay = relay_fault(&place);
    let sql = format!(
        "SELECT last_at, name FROM faults WHERE id = '{}'",
        text(&relay["id"])
    );
    let answer = place.json(&["db", "query", &sql, "--json"]);
    assert_eq!(answer["rows"][0][0], relay["last_at"]);
    let csv = place
        .ptu(&["db", "query", "SELECT 1 AS a, 'x,y' AS b", "--csv"])
        .exits(0)
        .out;
    assert_eq!(csv, "a,b\n1,\"x,y\"\n");
}

/// Goal: no limit is told of a value that it does not hold for, and a step is asked for by its name. Method: a
/// measurement that several procedures and steps make.
#[test]
fn a_trend_is_of_one_step_where_one_is_asked_for() {
    let place = mended();
    let trend = |options: &[&str]| {
        let asked = [
            &[
                "faults",
                "trend",
                "eb_reaction",
                "--serial-no",
                "BAD-1",
                "--json",
            ],
            options,
        ];
        place.json(&asked.concat())
    };
    let all = trend(&[]);
    let steps = list(&all["steps"]);
    assert!(steps.len() > 1, "{all}");
    let limits: Vec<_> = steps.iter().map(|step| &step["high"]).collect();
    let differ = limits.iter().any(|high| *high != limits[0]);
    assert_eq!(all["high"].is_null(), differ, "{all}");
    let mut points = 0;
    for step in steps {
        let (procedure, name) = (text(&step["procedure"]), text(&step["step"]));
        let one = trend(&["--procedure", procedure, "--step", name]);
        assert_eq!(one["high"], step["high"], "{one}");
        assert!(
            list(&one["points"])
                .iter()
                .all(|point| point["high"] == step["high"])
        );
        points += list(&one["points"]).len();
    }
    assert_eq!(points, list(&all["points"]).len());
    let mistaken = [
        "faults",
        "trend",
        "eb_reaction",
        "--step",
        "code 55 alarm, FSB, EB",
    ];
    place.ptu(&mistaken).exits(2).explains(&["did you mean"]);
}

/// Of one cause months count what `--by cause` counts.
#[test]
fn months_of_one_cause_count_its_cases() {
    let place = mended();
    let all = place.json(&["faults", "stats", "--by", "cause", "--json"]);
    let part = text(&all[0]["key"]);
    let stats = |by: &str| {
        let asked = ["faults", "stats", "--by", by, "--cause", part, "--json"];
        place.json(&asked)
    };
    assert!(!list(&all).is_empty());
    let (cause, months) = (stats("cause"), stats("month"));
    let cases: f64 = list(&months)
        .iter()
        .map(|month| number(&month["faults"]))
        .sum();
    assert_eq!(cases, number(&cause[0]["faults"]));
    let shares: f64 = list(&months)
        .iter()
        .map(|month| number(&month["share"]))
        .sum();
    assert!((shares - 1.0).abs() < 1e-9, "{months}");
    let table = ["faults", "stats", "--by", "month", "--cause", part];
    assert!(place.ptu(&table).exits(0).out.contains("CASES"));
}

#[test]
fn questions_in_sql_have_statistics() {
    let place = mended();
    let sql = "SELECT median(value), percentile(value, 90), stddev(value), sqrt(4) FROM measurements \
               WHERE name = 'eb_reaction'";
    let answer = place.ptu(&["db", "query", sql, "--csv"]).exits(0).out;
    let values: Vec<f64> = answer
        .lines()
        .nth(1)
        .expect("a row")
        .split(',')
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    assert!(
        values[0] <= values[1] && values[2] >= 0.0 && values[3] == 2.0,
        "{answer}"
    );
}

#[test]
fn what_cannot_be_asked_is_named() {
    let place = mended();
    for (arguments, words) in [
        (
            &["list", "--when", "2026-13"][..],
            &["2026-13", "2026-03..2026-05"][..],
        ),
        (
            &["list", "--when", "2026-05..2026-03"],
            &["ends before it begins"],
        ),
        (&["stats", "--when", ".."], &["a beginning or an end"]),
        (&["stats", "--by", "colour"], &["colour", "part"]),
        (&["stats", "--back-within", "0"], &["0"]),
        (&["list", "--note", "\"*"], &["no word to search for"]),
        (&["list", "--state", "broken"], &["broken", "acknowledged"]),
        (&["list", "--serial-no", "BAD-2"], &["no unit \"BAD-2\""]),
        (
            &["list", "--serial-no", "bad1"],
            &["did you mean \"BAD-1\"?"],
        ),
        (&["list", "--limit", "0"], &["0", "1.."]),
        (&["stats", "--limit", "0"], &["0", "1.."]),
        (&["trend", "eb_reaction", "--limit", "0"], &["0", "1.."]),
        (&["list", "--severity", "huge"], &["huge", "critical"]),
        (&["list", "--when", "-30d"], &["\"-30d\" is no time"]),
        (&["stats", "--when", "-30d"], &["\"-30d\" is no time"]),
        (
            &["list", "--code", "check_failed,foo"],
            &["no fault \"foo\""],
        ),
        (
            &["trend", "eb_reaction", "--plot", "out.png"],
            &["out.png", ".html"],
        ),
        (
            &["trend", "eb_reaction", "--serial-no", "bad-1"],
            &["did you mean \"BAD-1\"?"],
        ),
        (
            &["trend", "eb_reaction", "--when", "2999-01"],
            &["in 2999-01-01 .. 2999-01-31", "recorded from 20"],
        ),
        (
            &["trend", "eb_reaction", "--procedure", "tcms/link"],
            &["measured by atp/overspeed"],
        ),
        (&["list", "--run", "latest", "--when", "x"], &["\"x\""]),
        (
            &[
                "trend",
                "eb_reaction",
                "--serial-no",
                "BAD-1",
                "--since-repair",
                "tra",
            ],
            &["no repair of tra", "BAD-1"],
        ),
        (
            &["trend", "eb_reaction", "--since-repair", "tra"],
            &["--serial-no"],
        ),
        (&["repair", "latest", "--part", " "], &["--part"]),
        (&["note", "latest", " "], &["says something"]),
        (&["list", "--json", "--csv"], &["--csv"]),
    ] {
        place
            .ptu(&[&["faults"], arguments].concat())
            .exits(2)
            .explains(words);
    }
    assert!(!place.path("out.png").exists());
}

/// Goal: a name that nothing has is refused alike by all lists; an empty answer does not say that there is nothing when a name was only written otherwise.
#[test]
fn a_name_that_nothing_has_is_told_with_the_one_that_is_near() {
    let place = mended();
    for (option, asked, said) in [
        (
            "--part",
            "eb_rely",
            "part \"eb_rely\" (did you mean \"eb_relay\"?)",
        ),
        ("--part", "EB_RELY", "(did you mean \"eb_relay\"?)"),
        ("--code", "4711", "no fault \"4711\" was ever recorded\n"),
        (
            "--line",
            "line99",
            "line \"line99\" (did you mean \"line8\"?)",
        ),
        ("--train-no", "99", "train \"99\" was ever recorded\n"),
        ("--train-no", "203", "(did you mean \"8203\"?)"),
        ("--procedure", "foo", "procedure \"foo\"\n"),
        (
            "--procedure",
            "overspeed",
            "(did you mean \"atp/overspeed\"?)",
        ),
        ("--part-serial-no", "S-4", "serial number \"S-4\" was ever"),
        ("--part-serial-no", "r17", "(did you mean \"R-17\"?)"),
        ("--serial-no", "bad-1", "(did you mean \"BAD-1\"?)"),
    ] {
        for verb in ["list", "stats"] {
            for format in [&[][..], &["--json"]] {
                let asked = [&["faults", verb, option, asked], format].concat();
                let hint = place.ptu(&asked).exits(2).err;
                assert!(hint.contains(said), "{asked:?}: {hint}");
            }
        }
    }
    for format in [&[][..], &["--json"]] {
        let asked = [&["runs", "list", "--serial-no", "bad-1"], format].concat();
        let runs = place.ptu(&asked).exits(2).err;
        assert!(runs.contains("did you mean \"BAD-1\"?"), "{runs}");
    }
    // What there is, and has had no fault, is a name that is known.
    for (option, asked) in [
        ("--state", "closed"),
        ("--part", "tra"),
        ("--code", "rollback"),
        ("--procedure", "twc/exchange"),
    ] {
        let said = place.ptu(&["faults", "list", option, asked]).exits(0).out;
        assert_eq!(said, "no such faults recorded\n", "{option} {asked}");
    }
}

#[test]
fn help_is_broken_where_the_terminal_ends() {
    const COLUMNS: usize = 60;
    let place = Place::new();
    let mut command = place.command(&["faults", "stats", "--help"]);
    let output = command.env("COLUMNS", COLUMNS.to_string()).output();
    let help = Said::from(output.expect("ptu starts")).exits(0).out;
    let lines: Vec<_> = help
        .lines()
        .take_while(|line| *line != "Examples:")
        .collect();
    assert!(lines.len() > 8, "{help}");
    for two in lines.windows(2).filter(|two| !two.contains(&"")) {
        let word = two[1].split(' ').next().unwrap_or_default();
        assert!(two[0].len() + 1 + word.len() > COLUMNS, "{two:?} in {help}");
    }
    assert!(
        help.contains("\n  ptu faults stats --by part --when 2026\n"),
        "{help}"
    );
}

#[test]
fn a_database_named_by_a_variable_is_no_option_that_has_to_be_given() {
    let place = Place::new();
    let wrong = place.ptu(&["db", "prune"]).exits(2);
    assert!(!wrong.err.contains("--db"), "{}", wrong.all());
    let output = place.command(&["runs", "list"]).env("PTU_DB", "").output();
    Said::from(output.expect("ptu starts"))
        .exits(2)
        .explains(&["PTU_DB is empty"]);
}
