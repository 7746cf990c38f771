//! Texts of a surface about a run, read as people read them: sentences, and the texts of a sheet in their order.

use std::collections::BTreeMap;

use ptu_report::coverage_text;
use ptu_report::words::Language;
use ptu_runs::bench_worker::{Progress, outside_place};

/// Facts of a run by their names, as texts.
#[derive(Default)]
pub struct Facts {
    pub of: String,
    pub known: BTreeMap<String, String>,
}

/// Facts that a surface tells, by their names.
pub type Told = Vec<(String, String)>;

/// Compares what surfaces tell with the facts of a run. A fact that the run itself does not know is taken from the first surface.
#[derive(Default)]
pub struct Monitor {
    held: usize,
    wrong: BTreeMap<String, (usize, String)>,
}

impl Monitor {
    pub fn hold(&mut self, facts: &mut Facts, surface: &str, told: Told) {
        for (fact, value) in told {
            self.held += 1;
            let known = facts
                .known
                .entry(fact.clone())
                .or_insert_with(|| value.clone());
            if *known != value {
                let first = format!("{}: {value:?} and not {known:?}", facts.of);
                let place = format!("{surface}, {fact}");
                self.wrong.entry(place).or_insert((0, first)).0 += 1;
            }
        }
    }

    /// Fails if anything was wrong, or too little was read.
    pub fn finish(self, least: usize) {
        let (wrong, held) = (self.wrong, self.held);
        assert!(
            wrong.is_empty(),
            "of {held} facts these are told otherwise, so often, first of: {wrong:#?}"
        );
        assert!(held > least, "only {held} facts were held");
    }
}

pub fn fact(name: impl Into<String>, value: impl ToString) -> (String, String) {
    (name.into(), value.to_string())
}

pub fn sorted(name: &str, all: impl IntoIterator<Item = String>) -> (String, String) {
    let mut all: Vec<_> = all.into_iter().collect();
    all.sort();
    fact(name, all.join(" "))
}

/// The run by the end of its number, as tables have it.
pub fn id(of: &str) -> (String, String) {
    fact("id", &of[of.len().saturating_sub(8)..])
}

/// Numbers by the names of their facts, which stand in one text.
pub fn numbers(names: &str, numbers: impl IntoIterator<Item = impl ToString>) -> Told {
    let names = names.split('|').zip(numbers);
    names.map(|(name, number)| fact(name, number)).collect()
}

/// Number of the repetition and kind of the result, if the result does not count; empty where the step is
/// run once.
pub fn turn_of(turn: u64, turns: u64, kind: &str) -> String {
    let kind = match kind {
        "step" => "",
        kind => &format!(" {kind}"),
    };
    match turns {
        1 => kind.to_owned(),
        _ => format!(" {turn}/{turns}{kind}"),
    }
}

/// Repetition and kind of a result, from its name.
pub fn turn_in(name: &str) -> String {
    let kinds = [
        (" (repeated)", "again"),
        (" (반복)", "again"),
        (" (attempt)", "attempt"),
        (" (시도)", "attempt"),
    ];
    let mut kinds = kinds.into_iter();
    let kind = kinds.find_map(|(end, kind)| Some((name.strip_suffix(end)?, kind)));
    let (name, kind) = kind.unwrap_or((name, "step"));
    let inside = name
        .strip_suffix(')')
        .and_then(|name| name.rsplit_once(" ("));
    let numbers = inside.and_then(|(_, inside)| inside.split_once('/'));
    let [turn, turns] = numbers.map_or([1, 1], |(turn, turns)| {
        [turn, turns].map(|number| number.parse().unwrap_or(1))
    });
    turn_of(turn, turns, kind)
}

/// Marks with their turn, if there is more than one.
pub fn turned(marks: &[String], turn: &str) -> Vec<String> {
    let marks = marks.iter().filter(|_| !turn.is_empty());
    marks.map(|mark| mark.clone() + turn).collect()
}

/// Summary of records of results: for each whether it is a step's, its name, its verdict, the reason, and its
/// turn.
pub fn results<'a>(all: impl Iterator<Item = (bool, &'a str, &'a str, &'a str, String)>) -> Told {
    let (mut attempts, mut outside, mut bad, mut link) = (0, 0, Vec::new(), None);
    let (mut turns, mut in_vain) = (Vec::new(), Vec::new());
    for (is_step, name, verdict, why, turn) in all {
        let is_bad = !["passed", "skipped"].contains(&verdict);
        attempts += usize::from(is_step && verdict != "skipped");
        outside += usize::from(!is_step && is_bad);
        let marks = marks(name, 's');
        if is_step && turn.ends_with("attempt") {
            in_vain.extend(turned(&marks, &turn));
        }
        if is_step && is_bad {
            turns.extend(turned(&marks, &turn));
            bad.extend(marks);
        }
        link = link.or(Some(why).filter(|why| why.starts_with("link lost at step ")));
    }
    vec![
        fact("attempts", attempts),
        fact("outside", outside),
        sorted("steps that did not pass", bad),
        sorted("turns that did not pass", turns),
        sorted("attempts in vain", in_vain),
        fact("link en", link.unwrap_or_default()),
    ]
}

/// The marks in a text: this letter and four digits.
pub fn marks(text: &str, letter: char) -> Vec<String> {
    let places = text.match_indices(letter).map(|(at, _)| at);
    let marks = places.filter_map(|at| text.get(at..at + 5));
    let is_mark = |mark: &&str| mark[1..].bytes().all(|byte| byte.is_ascii_digit());
    marks.filter(is_mark).map(str::to_owned).collect()
}

/// A measurement by its mark: its value with how far it may be off, and its limits.
pub fn value_and_limits(
    mark: &str,
    value: Option<f64>,
    off: Option<f64>,
    limits: [Option<f64>; 2],
) -> (String, String) {
    let said = |number: f64| number.to_string();
    let value = value.map_or("-".to_owned(), said);
    let off = off.map_or_else(String::new, |off| format!("±{off}"));
    let limits: Vec<_> = limits.into_iter().flatten().map(said).collect();
    (
        format!("{mark}={value}{off}"),
        format!("{mark}={}", limits.join(",")),
    )
}

/// Value and limits of each measurement; an uncertainty follows its value.
pub fn measured(all: impl Iterator<Item = (String, [Option<f64>; 3])>) -> Told {
    let mut known: Vec<(String, [Option<f64>; 3], Option<f64>)> = Vec::new();
    for (name, [value, low, high]) in all {
        match (&marks(&name, 'm')[..], known.last_mut()) {
            (_, Some((_, of, off))) if name.ends_with(", uncertainty") => *off = of[0].and(value),
            ([mark], _) => known.push((mark.clone(), [value, low, high], None)),
            _ => {}
        }
    }
    let said = known
        .into_iter()
        .map(|(mark, [value, low, high], off)| value_and_limits(&mark, value, off, [low, high]));
    let (values, limits): (Vec<_>, Vec<_>) = said.unzip();
    vec![sorted("values", values), sorted("limits", limits)]
}

/// The number before a word, or behind it.
fn before<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let head = &text[..text.find(word)?];
    let digits = head.trim_end_matches(|c: char| c.is_ascii_digit());
    Some(&head[digits.len()..]).filter(|number| !number.is_empty())
}

fn behind<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let tail = &text[text.find(word)? + word.len()..];
    let end = tail.find(|c: char| !c.is_ascii_digit());
    Some(&tail[..end.unwrap_or(tail.len())])
}

/// Texts behind the numbers of a sentence that counts a run, in each language.
const SAID: [&str; 2] = [
    " steps run| did not pass| not run| attempts| need the bench harness",
    "개 수행|개 미합격|개 미실행|회|개는 시험대 하네스 필요",
];

/// The count of a run in a sentence; none if it is no such sentence.
pub fn count(text: &str, language: Language) -> Option<Told> {
    let first = &text[..text.find(|c: char| !c.is_ascii_digit())?];
    let said = SAID[language as usize].split('|');
    let said: Vec<_> = said.map(|word| before(text, word)).collect();
    let [part, bad, left, attempts, bench] = said[..] else {
        return None;
    };
    let bad_of_all = before(text, " steps did not pass");
    let nothing = ["No steps were run", "수행된 단계가 없습니다"];
    let (planned, run, bad) = match language {
        _ if nothing.iter().any(|none| text.starts_with(none)) => ("0", "0", None),
        _ if first.is_empty() => return None,
        Language::English if bad_of_all.is_some() => (bad_of_all?, bad_of_all?, Some(first)),
        Language::English => (before(text, " steps")?, first, bad),
        Language::Korean => (before(text, "개 단계")?, part.unwrap_or(first), bad),
    };
    let outside =
        ["outside steps: ", "단계 외 미합격: "].map(|word| behind(text, word))[language as usize];
    let left = left.unwrap_or(if run == "0" { planned } else { "0" });
    let [bad, outside, bench] = [bad, outside, bench].map(|number| number.unwrap_or("0"));
    let tried = attempts.unwrap_or(run);
    let counted = [planned, run, bad, left, tried, outside, bench];
    let names = "planned|run|not passed|not run|attempts|outside|need the bench";
    let mut told = numbers(names, counted);
    let on_bench = ["the bench harness: ", "하네스 필요: "].map(|word| text.split_once(word));
    let on_bench = on_bench[language as usize].map_or("", |(_, folders)| folders);
    told.push(fact("folders on the bench", on_bench));
    told.push(fact(format!("sentence {}", language.code()), text));
    Some(told)
}

/// A verdict or a state in words.
pub fn verdict(text: &str, language: Language) -> Option<&'static str> {
    const LABELS: &str = "passed|failed|error|skipped|inconclusive|aborted|interrupted";
    const ALL: [&str; 2] = [
        "passed|failed|could not be tested|not run|inconclusive|aborted|interrupted",
        "합격|불합격|판정 불가|미실행|판정 보류|중단|미완료",
    ];
    let said = text.to_lowercase();
    let mut words = ALL[language as usize].split('|');
    LABELS.split('|').nth(words.position(|word| said == word)?)
}

/// The part whose identifier a text is, or has in parentheses at its end.
fn part(text: &str) -> &str {
    let open = text.strip_suffix(')');
    let inside = open.and_then(|text| text.rsplit_once('('));
    inside.map_or(text, |(_, id)| id)
}

/// The shares of parts that a conclusion tells, as in "replace the EB relay (eb_relay, 99.6 %)".
pub fn conclusion(text: &str, language: Language) -> Told {
    let open = text.split('(').skip(1);
    let inside = open.filter_map(|rest| rest.split_once(')'));
    let shares = inside.filter_map(|(inside, _)| inside.strip_suffix(" %")?.split_once(", "));
    let shares = shares.map(|(part, share)| fact(format!("share of {part}"), share));
    let checks = language.choose([
        before(text, " of ").filter(|_| text.contains(" checks were made")),
        before(text, "개 수행").filter(|_| text.contains("점검 ")),
    ]);
    let checks = checks.map(|made| fact("checks made", made));
    let said = fact(format!("conclusion {}", language.code()), text);
    shares.chain([said]).chain(checks).collect()
}

/// Rows of what may be the cause, each with its share in percent: the likeliest stands first.
pub fn candidates(rows: Vec<(String, String)>) -> Told {
    let shares = rows.iter().filter_map(|(_, share)| share.parse().ok());
    let shares: Vec<f64> = shares.collect();
    let falls = shares.windows(2).all(|pair| pair[0] >= pair[1]) && !shares.contains(&0.0);
    let order = (!rows.is_empty()).then(|| fact("candidates stand in their order", falls));
    let rows = rows.into_iter();
    let shares = rows.map(|(part, share)| fact(format!("share of {part}"), share));
    shares.chain(order).collect()
}

/// Headings of a sheet's sections.
fn section(text: &str) -> Option<&'static str> {
    const ALL: [&str; 2] = [
        "Verdicts|What did not pass|Faults|Diagnosis|Run|All steps|Scripts|Signatures",
        "판정 요약|미합격 항목|고장|진단|시험 개요|전체 단계|스크립트|서명",
    ];
    let place = |all: &&str| all.split('|').position(|word| text == word);
    ALL[0].split('|').nth(ALL.iter().find_map(place)?)
}

/// A sheet: its texts in the order in which they stand.
pub fn sheet(texts: &[String], language: Language) -> Told {
    let (mut told, mut here) = (Vec::new(), "");
    let (mut counted, mut bad, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    let (mut turns, mut in_vain) = (Vec::new(), Vec::new());
    let (mut values, mut limits, mut seen) = (Vec::new(), Vec::new(), Vec::new());
    let (mut passed, mut recorded, mut lost) = (None, 0, "");
    let at = |place: usize| texts.get(place).map_or("", |text| text.as_str());
    for (place, text) in texts.iter().enumerate() {
        here = section(text).unwrap_or(here);
        let next = at(place + 1);
        if let (Some(said), Some(counts)) = (verdict(text, language), count(next, language)) {
            told.push(fact("verdict", said));
            told.extend(counts);
        }
        let link = ["link lost at step ", "번째에서 연결 끊김"][language as usize];
        match here {
            "Verdicts" if text.parse::<u32>().is_ok() => counted.push(text.clone()),
            "What did not pass" if text.contains(link) => lost = text,
            "What did not pass" => bad.extend(marks(text, 's')),
            // Code and name, part, severity, how often.
            "Faults" if before(text, " ") == text.split(' ').next() => {
                seen.push(format!("{}={}", part(next), at(place + 3)));
            }
            "Diagnosis" if ["Conclusion", "결론"].contains(&text.as_str()) => {
                told.extend(conclusion(next, language));
            }
            "Diagnosis" if text.ends_with(" %") && text.len() < 8 => {
                let share = text.trim_end_matches(" %");
                rows.push((part(next).to_owned(), share.to_owned()));
            }
            "Run" if ["Run number", "시험 번호"].contains(&text.as_str()) => {
                told.push(id(next))
            }
            "All steps" => {
                let mut behind = texts[place + 1..].iter().take(3);
                let came_to = behind.find_map(|text| verdict(text, language));
                let turn = turn_in(text);
                let all = turned(&marks(text, 's'), &turn);
                match came_to {
                    Some(_) if turn.ends_with("attempt") => in_vain.extend(all),
                    None | Some("passed" | "skipped") => {}
                    Some(_) => turns.extend(all),
                }
                let (of, passes) = [(" of ", " passed"), ("개 중 ", "개 합격")][language as usize];
                let counted = text
                    .strip_suffix(passes)
                    .and_then(|said| said.split_once(of));
                let counted = counted.map(|pair| <[&str; 2]>::from(pair).map(str::parse::<u32>));
                if let Some([Ok(one), Ok(other)]) = counted {
                    let of = [one, other];
                    *passed.get_or_insert(0) += of[language as usize];
                    recorded += of[1 - language as usize];
                }
                for mark in marks(text, 'm') {
                    let value = match ["no value", "값 없음"].contains(&next) {
                        true => "-".to_owned(),
                        false => next.replace(" ± ", "±"),
                    };
                    values.push(format!("{mark}={value}"));
                    let row = texts[place + 2..].iter();
                    let row = row.take_while(|text| verdict(text, language).is_none());
                    let numbers = row.filter(|text| text.parse::<f64>().is_ok()).cloned();
                    limits.push(format!("{mark}={}", numbers.collect::<Vec<_>>().join(",")));
                }
            }
            _ => {}
        }
    }
    // A run with nothing outside its steps has no column for it.
    let none = (counted.len() == 4).then(|| "0".to_owned());
    counted.extend(none);
    told.extend(numbers("passed|failed|error|not run|outside", counted));
    told.extend(passed.map(|passed| fact("passed", passed)));
    told.extend(passed.map(|_| fact("with a result", recorded)));
    told.extend(candidates(rows));
    told.push(fact(format!("link {}", language.code()), lost));
    told.push(sorted("steps that did not pass", bad));
    told.push(sorted("turns that did not pass", turns));
    told.push(sorted("attempts in vain", in_vain));
    told.extend([sorted("values", values), sorted("limits", limits)]);
    told.push(sorted("parts", seen));
    told
}

/// Texts of the window that led the run.
pub fn live(run: &Progress, language: Language) -> Told {
    let (counts, words) = (run.counts(), language.words());
    let all = run.procedures.iter().flat_map(|of| &of.results);
    let all: Vec<_> = all
        .map(|result| (result, result.findings.to_string()))
        .collect();
    let mut told = results(all.iter().map(|(result, why)| {
        let is_step = outside_place(result).is_none();
        let turn = turn_in(&language.words().result(result));
        (
            is_step,
            &*result.name,
            result.verdict.label(),
            why.as_str(),
            turn,
        )
    }));
    let [run_steps, not_run] = [counts.run(), counts.not_run()];
    told.extend(numbers(
        "planned|run|not run",
        [counts.planned, run_steps, not_run],
    ));
    let came_to = [counts.passed, counts.failed, counts.error];
    told.extend(numbers("passed|failed|error", came_to));
    told.extend(numbers(
        "attempts|outside",
        [counts.attempts, counts.outside],
    ));
    let said = coverage_text(&run.coverage(), words);
    let said = said.and_then(|said| count(&said, language));
    told.extend(said.into_iter().flatten());
    told
}
