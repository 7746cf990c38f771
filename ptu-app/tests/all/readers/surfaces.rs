//! A small reader for each surface.

use std::collections::BTreeMap;

use btu_rig::procedure::Outside;
use ptu_report::run::page::{Item, Page};
use ptu_report::words::Language;
use quick_junit::{NonSuccessKind, Report, TestCaseStatus};
use serde_json::Value;

use super::seen;
use crate::common::told::{
    Told, candidates, conclusion, count, fact, id, marks, measured, numbers, results, sorted,
    turn_in, turn_of, turned, verdict,
};
use crate::common::{list, number, text};

/// Cells of a row, which are two spaces apart.
pub fn columns(row: &str) -> Vec<String> {
    let cells = row.split("  ").map(str::trim);
    cells
        .filter(|cell| !cell.is_empty())
        .map(str::to_owned)
        .collect()
}

/// `N` or `N of M` steps, in Korean `N/M`.
pub fn short(text: &str) -> Told {
    let both = text.split_once(" of ").or(text.split_once('/'));
    let (run, planned) = both.unwrap_or((text, text));
    vec![fact("run", run), fact("planned", planned)]
}

/// Whether a record of this kind is a step.
fn is_step(kind: &str) -> bool {
    ["step", "attempt", "again"].contains(&kind)
}

/// The kind of a result as far as a name tells it.
pub fn turn_kind(kind: &str) -> &str {
    ["attempt", "again"]
        .into_iter()
        .find(|of| *of == kind)
        .unwrap_or("step")
}

/// Turns of a record; one outside steps has none.
fn turn_of_keys(of: &Value, kind: &str) -> String {
    let [turn, turns] = ["turn", "turns"].map(|key| of[key].as_u64().unwrap_or(1));
    turn_of(turn, turns, kind)
}

/// Beginning of a lost link's row.
const LOST: &str = "link lost at step ";

/// The table at the end of a run.
pub fn console(table: &str, language: Language) -> Told {
    let words = language.words();
    let (common, terminal) = (&words.common, &words.terminal);
    let all = [
        common.procedure,
        common.verdict,
        terminal.repeated_step,
        terminal.skipped_steps,
        common.fault,
    ];
    let all = all.map(str::to_uppercase);
    let [procedure, verdicts, repeated, _, faults_of] = all.each_ref();
    // In English a verdict is told by its name.
    let label = |said: &str| {
        language.choose([
            said.to_owned(),
            verdict(said, language).unwrap_or(said).to_owned(),
        ])
    };
    let of_run = format!("{} ", common.run);
    let mut recorded = 0;
    let (mut told, mut here, mut lost) = (Vec::new(), None, String::new());
    let (mut bad, mut parts, mut passed, mut outside) = (Vec::new(), Vec::new(), None, 0);
    let (mut turns, mut in_vain) = (Vec::new(), Vec::new());
    for line in table.lines() {
        let cells = columns(line);
        let mut heads = all.iter();
        if let Some(head) = heads.find(|head| line.starts_with(&format!("{head}  "))) {
            here = Some(head);
        } else if cells.is_empty() {
            here = None;
        } else if here == Some(procedure) {
            let count = |place: usize| cells[place].parse::<u32>().expect("a number");
            recorded += count(2);
            *passed.get_or_insert(0) += count(3);
        } else if here == Some(verdicts) {
            let name = cells[1].split_once(": ").map_or("", |(_, name)| name);
            turns.extend(turned(&marks(name, 's'), &turn_in(name)));
            bad.extend(marks(name, 's'));
            let mut places = Outside::ALL.iter();
            outside += usize::from(places.any(|place| {
                language.choose([place.name() == name, common.outside(*place) == name])
            }));
            let why = cells.get(2).filter(|why| why.starts_with(LOST));
            lost = why.cloned().unwrap_or(lost);
        } else if here == Some(repeated) {
            let name = cells[0].split_once(": ").map_or("", |(_, name)| name);
            in_vain.extend(turned(&marks(name, 's'), &turn_in(name)));
        } else if here == Some(faults_of) {
            parts.push(format!("{}={}", cells[2], cells[4]));
        } else if let Some(said) = line.strip_prefix(&of_run)
            && let of = columns(said)
            && of.len() > 2
        {
            let (counts, came) = of[2].split_once(": ").expect("a verdict");
            let (steps, faults) = counts.split_once(", ").expect("steps and faults");
            let number = |text: &str| text.trim_matches(|c: char| !c.is_ascii_digit()).to_owned();
            told.extend(short(&number(steps)));
            let [faults, came] = [number(faults), label(came)];
            told.extend([id(&of[0]), fact("faults", faults), fact("verdict", came)]);
        } else if let Some((state, said)) = line.split_once(": ")
            && let Some(counts) = count(said, language)
        {
            told.push(fact("verdict", label(state)));
            told.extend(counts);
        }
    }
    told.extend(passed.map(|passed| fact("passed", passed)));
    told.extend(passed.map(|_| fact("with a result", recorded)));
    if language == Language::English {
        told.push(fact("link en", lost));
    }
    // The quiet one names no fault.
    if passed.is_some() {
        told.push(sorted("parts", parts));
    }
    told.extend([
        sorted("attempts in vain", in_vain),
        sorted("steps that did not pass", bad),
        sorted("turns that did not pass", turns),
        fact("outside", outside),
    ]);
    told
}

/// Numbers of an object: `key=fact`, each behind a comma.
fn keys(of: &Value, names: &str) -> Told {
    let names = names.split(',').filter_map(|name| name.split_once('='));
    names.map(|(key, name)| fact(name, &of[key])).collect()
}

pub fn summary(run: &Value) -> Told {
    let names = "step_count=planned,steps_run=run,steps_passed=passed,steps_failed=failed,steps_error=error,\
        steps_not_passed=not passed,steps_not_run=not run,step_attempts=attempts,outside_steps=outside,fault_count=faults";
    let mut told = keys(run, names);
    let state = run["verdict"].as_str().unwrap_or(text(&run["state"]));
    told.extend([fact("verdict", state), id(text(&run["id"]))]);
    told
}

pub fn json(run: &Value) -> Told {
    let mut told = summary(&run["run"]);
    told.extend(keys(
        &run["coverage"],
        "steps=planned,run=run,passed=passed,need_bench=need the bench",
    ));
    let on_bench = list(&run["coverage"]["on_bench"]).iter().map(text);
    let on_bench: Vec<_> = on_bench.collect();
    told.push(fact("folders on the bench", on_bench.join(", ")));
    let steps = list(&run["steps"]);
    told.extend(results(steps.iter().map(|step| {
        let [name, verdict, why] = ["name", "verdict", "message"].map(|key| text(&step[key]));
        let turn = turn_of_keys(step, turn_kind(text(&step["kind"])));
        (is_step(text(&step["kind"])), name, verdict, why, turn)
    })));
    let values = steps.iter().flat_map(|step| list(&step["measurements"]));
    told.extend(measured(values.map(|one| {
        let numbers = ["value", "low", "high"].map(|key| one[key].as_f64());
        (text(&one["name"]).to_owned(), numbers)
    })));
    told.push(sorted("parts", seen(list(&run["faults"]).iter())));
    told
}

pub fn stream(lines: &[String]) -> Told {
    let read = |line: &String| serde_json::from_str(line).expect("JSON");
    let lines: Vec<Value> = lines.iter().map(read).collect();
    let mut told = results(lines.iter().filter_map(|line| {
        let name = match text(&line["event"]) {
            "step_finished" => text(&line["name"]),
            "outside_step" => text(&line["place"]),
            _ => return None,
        };
        let [verdict, why] = ["verdict", "message"].map(|key| text(&line[key]));
        let kind = match [&line["again"], &line["repeated"]].map(|key| *key == true) {
            [true, _] => "again",
            [_, true] => "attempt",
            _ => "step",
        };
        let turn = turn_of_keys(line, kind);
        Some((line["event"] == "step_finished", name, verdict, why, turn))
    }));
    let mut parts: BTreeMap<&str, u32> = BTreeMap::new();
    let faults = lines.iter().filter(|line| line["event"] == "fault");
    for part in faults.map(|line| line["part"].as_str().unwrap_or("-")) {
        *parts.entry(part).or_default() += 1;
    }
    let parts = parts.iter().map(|(part, seen)| format!("{part}={seen}"));
    told.push(sorted("parts", parts));
    for last in lines.iter().filter(|line| line["event"] == "run_finished") {
        let names = "steps=planned,run_steps=run,passed=passed,failed=failed,error=error,not_run=not run,\
            attempts=attempts,outside=outside";
        told.extend(keys(last, names));
        let verdict = fact("verdict", text(&last["verdict"]));
        told.extend([verdict, id(text(&last["run"]))]);
    }
    told
}

pub fn table_of_values(csv: &str) -> Told {
    let rows: Vec<_> = csv.lines().skip(1).map(csv_cells).collect();
    let mut steps: BTreeMap<u32, &[String]> = BTreeMap::new();
    for row in &rows {
        steps.insert(row[4].parse().expect("a place"), row);
    }
    let all = steps.values();
    let mut told = results(all.map(|row| {
        let [turn, turns] = [17, 18].map(|place: usize| row[place].parse().expect("a number"));
        let turn = turn_of(turn, turns, turn_kind(&row[6]));
        (is_step(&row[6]), &*row[5], &*row[7], &*row[9], turn)
    }));
    let values = rows.iter().filter(|row| !row[10].is_empty());
    told.extend(measured(values.map(|row| {
        let numbers = [11, 13, 14].map(|place: usize| row[place].parse::<f64>().ok());
        (row[10].clone(), numbers)
    })));
    told.extend(rows.first().map(|row| id(&row[0])));
    told
}

/// Cells of a line (RFC 4180).
fn csv_cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                cells.last_mut().expect("one").push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            letter => cells.last_mut().expect("one").push(letter),
        }
    }
    cells
}

pub fn junit(xml: &str) -> Told {
    // XML 1.0 cannot have these, and some parsers pass over them.
    assert!(!xml.contains(['\u{fffe}', '\u{ffff}', '\u{1b}']));
    let report = Report::deserialize_from_str(xml).expect("JUnit XML");
    let name = report.name.as_ref().expect("a name").as_str();
    let said = name.strip_prefix("ptu run ").expect("a run");
    let (run, said) = said.split_once(": ").expect("a count");
    let mut told = count(said, Language::English).unwrap_or_else(|| panic!("no count: {said}"));
    let (mut outside, mut counts, mut bad, mut values) = (0, [0; 3], Vec::new(), Vec::new());
    let (mut lost, mut in_vain) = ("", Vec::new());
    let suites = report.test_suites.iter();
    for case in suites.flat_map(|suite| &suite.test_cases) {
        let tried = case.properties.iter();
        for tried in tried.filter(|property| property.name.as_str() == "attempt") {
            in_vain.extend(turned(&marks(&tried.value, 's'), &turn_in(&tried.value)));
        }
        let mut properties = case.properties.iter();
        let kind = properties.find(|property| property.name.as_str() == "kind");
        let is_step = kind.is_some_and(|kind| is_step(kind.value.as_str()));
        let (place, reruns) = match &case.status {
            TestCaseStatus::Success { .. } => (Some(0), Vec::new()),
            TestCaseStatus::Skipped { .. } => (None, Vec::new()),
            TestCaseStatus::NonSuccess {
                kind,
                reruns,
                message,
                ..
            } => {
                let message = message.as_ref().map(|message| message.as_str());
                lost = message.filter(|why| why.starts_with(LOST)).unwrap_or(lost);
                assert!(message.is_some(), "{:?} says not why", case.name);
                let failed = *kind == NonSuccessKind::Failure;
                (Some(if failed { 1 } else { 2 }), reruns.runs.clone())
            }
        };
        match (is_step, place) {
            (true, Some(place)) => counts[place] += 1,
            (true, None) => {}
            // Where nothing says why a run did not pass, a case of its own does.
            (false, _) => outside += usize::from(kind.is_some()),
        }
        let tried = reruns.iter().filter_map(|rerun| rerun.ty.as_ref());
        let again = tried.filter(|kind| kind.as_str() != "not tested").count();
        let times = usize::from(place > Some(0)) + again;
        let all = marks(&case.name, 's').into_iter();
        bad.extend(all.flat_map(|mark| vec![mark; times]));
        let lines = case.system_out.iter().flat_map(|out| out.as_str().lines());
        for (name, value) in lines.filter_map(|line| line.split_once(" = ")) {
            let value = value.split(' ').next().and_then(|value| value.parse().ok());
            values.push((name.to_owned(), [value, None, None]));
        }
    }
    told.extend(numbers("passed|failed|error", counts));
    // The measurement has no limits.
    told.extend(measured(values.into_iter()).into_iter().take(1));
    told.extend([
        id(run),
        fact("outside", outside),
        fact("link en", lost),
        sorted("attempts in vain", in_vain),
        sorted("steps that did not pass", bad),
    ]);
    told
}

/// The texts of a page, in their order.
pub fn texts(page: &str) -> Vec<String> {
    let body = page.split_once("</style>").map_or(page, |(_, body)| body);
    let pictures = body
        .split("<svg")
        .map(|part| part.split_once("</svg>").map_or(part, |(_, after)| after));
    let texts = pictures
        .flat_map(|part| part.split('<'))
        .map(|part| part.split_once('>').map_or(part, |(_, text)| text));
    let read = |text: &str| {
        let text = text.trim().replace("&lt;", "<").replace("&gt;", ">");
        text.replace("&quot;", "\"").replace("&amp;", "&")
    };
    texts.map(read).filter(|text| !text.is_empty()).collect()
}

pub fn printed_texts(page: &Page) -> Vec<String> {
    let text = |item: &Item| match item {
        Item::Text(text) => {
            let lines = text.lines.iter().map(|(_, line)| line.as_str());
            Some(lines.collect::<String>().trim().to_owned())
        }
        _ => None,
    };
    let texts = page.iter().filter_map(text);
    texts.filter(|text| !text.is_empty()).collect()
}

/// A diagnosis as text: the count, the conclusion, and what may be the cause.
pub fn diagnosed(text: &str) -> Told {
    let mut lines = text.lines();
    let first = lines.next().and_then(|line| line.strip_prefix("run "));
    let of = columns(first.expect("a run"));
    let said: Vec<_> = of[2].split(", ").collect();
    let mut told = short(said[0].trim_end_matches(" steps"));
    told.extend([
        id(&of[0]),
        fact("not passed", said[1].trim_end_matches(" not passed")),
        fact("faults", said[2].trim_end_matches(" faults")),
    ]);
    let said = lines.nth(1).unwrap_or_default();
    told.extend(conclusion(said, Language::English));
    let rows = lines.filter_map(|line| {
        let (share, rest) = line.trim_start().split_once(" %  ")?;
        share.parse::<f64>().ok()?;
        Some((rest.split("  (").next()?.to_owned(), share.to_owned()))
    });
    told.extend(candidates(rows.collect()));
    told
}

/// All faults of each part: their shares add up to the part's.
pub fn in_full(text: &str) -> Told {
    let (mut told, mut sums): (Told, Vec<(String, f64)>) = (Vec::new(), Vec::new());
    for line in text.lines().skip(3) {
        let of_fault = line.trim_start().strip_prefix("of these ");
        let Some((share, rest)) = of_fault.unwrap_or(line).trim_start().split_once(" %  ") else {
            continue;
        };
        let Ok(share) = share.parse::<f64>() else {
            continue;
        };
        match (of_fault, sums.last_mut()) {
            (Some(_), Some((_, left))) => *left -= share,
            _ => {
                told.push(fact(format!("share of {rest}"), format!("{share:.1}")));
                sums.push((rest.to_owned(), share));
            }
        }
    }
    let parts = sums
        .iter()
        .filter(|(part, _)| part != "no fault" && !part.starts_with("both "));
    let wrong = parts
        .filter(|(_, left)| left.abs() > 0.5)
        .map(|(part, _)| part.clone());
    told.push(sorted("parts whose faults do not add up", wrong));
    told
}

pub fn diagnosed_json(answer: &Value) -> Told {
    let mut told = vec![
        id(text(&answer["run"])),
        fact("conclusion en", text(&answer["conclusion"])),
        fact("conclusion ko", text(&answer["conclusion_ko"])),
    ];
    for part in list(&answer["parts"]) {
        let share = format!("{:.1}", 100.0 * number(&part["probability"]));
        told.push(fact(format!("share of {}", text(&part["part"])), share));
    }
    let none = format!("{:.1}", 100.0 * number(&answer["no_fault"]));
    told.push(fact("share of no fault", none));
    told
}
