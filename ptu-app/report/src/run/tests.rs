//! Test sheets of stored runs without a trace, with incomplete or unusual content.

use std::collections::BTreeSet;

use fault_db::{
    Channel, ChannelKind, FaultRecord, Id, IdSource, MeasurementRecord, OpenOptions, RunEnd,
    RunRecord, RunWriter, ScriptRecord, StepRecord, Store, TraceData, UnitRecord, Verdict,
};

use protocol::display_text;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Trouble;

use super::page::font::FontMetrics;
use super::page::{self, HEIGHT, Item, WIDTH};
use super::{Sheet, html, pdf};
use crate::words::{Language, Words};

const HOSTILE: &str = "<script>alert(\"1\")</script>&'\u{1b}[31m\u{9b}2J\u{202e}";
const LIMIT_SOURCE: &str = "configuration overspeed.eb_delay_ms; default: two scans";

/// A store and the folder it is in.
pub(super) struct Stored {
    pub(super) store: Store,
    folder: tempfile::TempDir,
}

impl Stored {
    /// A scripts directory that holds no procedure and no data: sheets have no diagnosis.
    pub(super) fn no_scripts(&self) -> ScriptsDirectory {
        ScriptsDirectory::find(Some(self.folder.path())).expect("a folder")
    }
}

/// A store with one run of `steps` steps, every third failed with a fault and a trace.
pub(super) fn stored(steps: u32, ended: bool) -> (Stored, Id) {
    let mut next = 0u16;
    let ids = IdSource::new(move || {
        next = next.wrapping_add(1);
        let [high, low] = next.to_be_bytes();
        (
            u64::from(next),
            [high, low, high, low, high, low, high, low, high, low],
        )
    });
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("history.db");
    let store = Store::open(&file, OpenOptions::new(ids)).expect("a store");
    let mut writer = RunWriter::begin(&store, &run()).expect("a run");
    for index in 0..steps {
        let failed = index % 3 == 0;
        writer.step(step(index, failed)).expect("a step");
        if failed {
            let fault = writer.fault(&fault(index)).expect("a fault");
            writer
                .trace(&[fault.occurrence], &trace())
                .expect("a trace");
        }
    }
    let id = writer.id();
    let verdict = if steps > 0 {
        Verdict::Failed
    } else {
        Verdict::Error
    };
    if ended {
        let end = RunEnd {
            verdict,
            finished_at_us: 61_000_000,
            bench_time_us: 60_000_000,
            wall_time_us: 1_000_000,
        };
        writer.finish(&end).expect("an end");
    } else {
        writer.flush().expect("kept");
    }
    drop(writer);
    let stored = Stored { store, folder };
    (stored, id)
}

fn run() -> RunRecord {
    RunRecord {
        unit: UnitRecord {
            serial: HOSTILE.into(),
            kind: "atc".into(),
            config_name: "sg100".into(),
            ..UnitRecord::default()
        },
        line: "line8".into(),
        seed: 7,
        train: "8203".into(),
        operator: "홍길동".into(),
        source: "sim".into(),
        started_at_us: 1_000_000,
        app_version: "1.2.3".into(),
        scripts_sha256: "ab".repeat(32),
        unit_config_sha256: "cd".repeat(32),
        owner: "nobody".into(),
        scripts: vec![ScriptRecord {
            path: "atp/overspeed.star".into(),
            sha256: "ef".repeat(32),
        }],
        ..RunRecord::default()
    }
}

fn step(index: u32, failed: bool) -> StepRecord {
    let verdict = if failed {
        Verdict::Failed
    } else {
        Verdict::Passed
    };
    let long = "of a very long name ".repeat(index as usize % 9);
    let procedure = format!("atp/part_{}", index / 40);
    StepRecord {
        verdict,
        started_bench_us: i64::from(index) * 1_000_000,
        bench_time_us: 1_000_000,
        message: if failed {
            HOSTILE.repeat(4)
        } else {
            String::new()
        },
        script_line: Some(3),
        measurements: vec![MeasurementRecord {
            name: "eb_reaction".into(),
            value: Some(if failed { 640.0 } else { 340.0 }),
            unit: "ms".into(),
            low: None,
            high: Some(472.0),
            limit_source: Some(LIMIT_SOURCE.into()),
            verdict,
        }],
        ..StepRecord::passed(index, procedure, format!("step no {index} {long}"))
    }
}

fn fault(index: u32) -> FaultRecord {
    FaultRecord {
        code: 9000,
        code_name: "check_failed".into(),
        lru: "eb_relay".into(),
        severity: "major".into(),
        at_us: 2_000_000,
        bench_us: i64::from(index) * 1_000_000,
        step_index: Some(index),
        ..FaultRecord::default()
    }
}

fn trace() -> TraceData {
    let channel = |name: &str, kind| Channel {
        name: name.into(),
        unit: String::new(),
        kind,
    };
    TraceData {
        period_us: 50_000,
        trigger_row: Some(2),
        partial: true,
        channels: vec![
            channel("speed", ChannelKind::Number { lsb: 1.0 }),
            channel("eb", ChannelKind::Bit),
        ],
        columns: vec![vec![1.0, 2.0, 3.0, 4.0], vec![0.0, 0.0, 1.0, 1.0]],
        ..TraceData::default()
    }
}

fn sheet(stored: &Stored, id: Id) -> Sheet {
    Sheet::gather(&stored.store, &stored.no_scripts(), id).expect("a sheet")
}

fn laid_out(sheet: &Sheet, words: &Words) -> Vec<page::Page> {
    page::pages(sheet, words).expect("pages")
}

/// The texts of a page, each line ended.
pub(crate) fn words_of(page: &[Item]) -> String {
    let text = |item: &Item| match item {
        Item::Text(text) => Some(text.lines.clone()),
        _ => None,
    };
    let lines = page.iter().filter_map(text).flatten();
    lines.map(|(_, line)| line + " ").collect()
}

#[test]
fn hostile_text_in_the_database_is_plain_text_on_the_page() {
    let (store, id) = stored(4, true);
    let page = html(&sheet(&store, id), Language::English.words());
    assert!(!page.contains("<script") && page.contains("&lt;script&gt;"));
    let acts = |letter: char| display_text::is_unseen(letter) && letter != '\n';
    assert!(!page.contains(acts) && page.contains("\\x1b[31m\\x9b2J\\u{202e}"));
    for page in laid_out(&sheet(&store, id), Language::English.words()) {
        assert!(!words_of(&page).contains(display_text::is_unseen));
    }
    assert!(page.contains("472") && page.contains("640") && page.contains("Failed"));
    assert_eq!(
        page.matches("<figure").count(),
        4,
        "two plots of each trace"
    );
    let outside = ["http:", "https:", "src=", "<link", "@import", "url("];
    assert!(outside.iter().all(|word| !page.contains(word)));
}

#[test]
fn korean_sheets_are_korean_and_all_placeholders_are_filled() {
    let (store, id) = stored(4, true);
    let page = html(&sheet(&store, id), Language::Korean.words());
    for word in ["시험 성적서", "불합격", "홍길동", "하한", "lang=\"ko\""] {
        assert!(page.contains(word), "{word}");
    }
    assert!(!page.contains("{n}") && !page.contains("{parts}"));
}

/// Nothing is off a page, nothing is lost, and a table that goes on has its heading again.
#[test]
fn two_hundred_steps_stand_on_pages_with_headings() {
    let (store, id) = stored(200, true);
    let pages = laid_out(&sheet(&store, id), Language::English.words());
    let letters = FontMetrics::new().expect("the font");
    let mut said = String::new();
    for (number, page) in (1..).zip(&pages) {
        let words = words_of(page);
        assert!(words.contains(&format!("page {number} of {}", pages.len())));
        if words.contains("eb_reaction") {
            assert!(words.contains("Step, measurement"), "page {number}");
        }
        for item in page {
            let Item::Text(text) = item else {
                continue;
            };
            for (y, line) in &text.lines {
                let long = letters.width(line.trim_end(), text.size);
                let x = text.x
                    - if text.turned {
                        0.0
                    } else {
                        long * text.anchor.share()
                    };
                assert!(
                    (0.0..WIDTH).contains(&x) && (0.0..HEIGHT).contains(y),
                    "{item:?}"
                );
            }
        }
        said += &words;
    }
    for index in 0..200 {
        assert!(said.contains(&format!("step no {index}")), "{index}");
    }
    assert!(said.contains("more traces are in the database"));
}

/// Goal: no letter is lost on paper. Method: letters that the font lacks in names of who tested, of a step and of a fault over
/// its plot: each stands on the PDF's pages as its code, all that stands there has a glyph, and the pages with codes say what
/// they are; the HTML page has the letters.
#[test]
fn letters_that_the_font_lacks_stand_on_paper_as_codes() {
    let (store, id) = stored(4, true);
    let mut sheet = sheet(&store, id);
    sheet.run.run.operator = "田中 かず".into();
    sheet.run.steps[1].name = "門 開 🚪".into();
    sheet.traces[0].faults = vec!["電車".into()];
    let letters = FontMetrics::new().expect("the font");
    for words in Language::ALL.map(Language::words) {
        let pages = laid_out(&sheet, words);
        let pages: Vec<_> = pages.iter().map(|page| words_of(page)).collect();
        for page in &pages {
            assert!(!page.contains(|letter| letters.lacks(letter)), "{page}");
            let rest = page.replace(words.report.codes, "");
            assert_eq!(rest.contains("[U+"), rest != *page, "{page}");
        }
        let said = pages.concat();
        let lacking: BTreeSet<char> = "田中門開🚪電車".chars().collect();
        for letter in &lacking {
            let code = format!("[U+{:04x}]", u32::from(*letter));
            assert!(said.contains(&code), "no {letter} in {said}");
        }
        assert_eq!(pdf(&sheet, words).expect("a document").1, lacking);
        let page = html(&sheet, words);
        for name in ["田中 かず", "門 開 🚪", "電車"] {
            assert!(page.contains(name), "{name}");
        }
    }
}

#[test]
fn a_document_is_the_same_each_time_and_in_both_languages_a_pdf() {
    let (store, id) = stored(30, true);
    for language in Language::ALL {
        let make = || {
            let made = pdf(&sheet(&store, id), language.words());
            made.expect("a document").0
        };
        let document = make();
        assert!(document.starts_with(b"%PDF-"));
        assert_eq!(document, make());
    }
}

#[test]
fn a_trace_that_cannot_be_read_is_named_and_the_sheet_goes_on() {
    let (store, id) = stored(4, true);
    let mut sheet = sheet(&store, id);
    sheet.traces[0].samples = Err(Trouble::Told("it is gone".to_owned()));
    let page = html(&sheet, Language::English.words());
    assert!(page.contains("cannot be shown: it is gone"));
    assert_eq!(page.matches("<figure").count(), 2);
}

#[test]
fn a_limit_stands_with_the_number_of_its_source_which_is_listed_once_in_the_language_of_the_sheet()
{
    let (store, id) = stored(4, true);
    for (language, listed) in [
        (
            Language::English,
            "unit configuration overspeed.eb_delay_ms; bench default: two scans",
        ),
        (
            Language::Korean,
            "장치 구성 overspeed.eb_delay_ms; 시험기 기본값: two scans",
        ),
    ] {
        let page = html(&sheet(&store, id), language.words());
        assert_eq!(page.matches(listed).count(), 1, "{listed}");
    }
}
