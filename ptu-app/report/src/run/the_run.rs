//! The run on its sheet: tester, unit, bench and times, seal and signature.

use super::Sheet;
use super::block::{Block, sentence};
use super::code::Code;
use crate::words::{Words, fill};
use ptu_runs::clock::local_zoned;
use ptu_runs::run::{Evidence, InstrumentEvidence};

/// The run: tester, unit, bench and times.
pub fn the_run(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let (run, report) = (&sheet.run.run, &words.report);
    let seconds =
        |us: Option<i64>| us.map_or("–".into(), |us| format!("{:.1} s", us as f64 / 1e6));
    let operator = match run.operator.trim() {
        "" => report.nobody,
        name => name,
    };
    let train = match run.train.trim() {
        "" => "–",
        train => train,
    };
    let evidence = run.evidence.as_deref().and_then(Evidence::of);
    let evidence = evidence.as_ref();
    let continued = (run.continues).map(|earlier| (report.continues, earlier.to_string()));
    let facts = [
        (report.run_id, run.id.to_string()),
        (report.unit_serial, run.unit_serial.clone()),
        (report.unit_kind, run.unit_kind.clone()),
        (report.unit_config, run.unit_config_name.clone()),
        ("SHA-256", run.unit_config_sha256.clone()),
        (words.common.line, run.line.clone()),
        (words.common.train_no, train.to_owned()),
        (report.source, run.source.clone()),
        (report.seed, run.seed.to_string()),
        (report.tester, operator.to_owned()),
        (report.started, local_zoned(run.started_at_us)),
        (
            report.finished,
            run.finished_at_us.map_or("–".into(), local_zoned),
        ),
        (report.bench_time, seconds(run.bench_time_us)),
        (report.wall_time, seconds(run.wall_time_us)),
        (report.program, format!("ptu {}", run.app_version)),
        (report.scripts_hash, run.scripts_sha256.clone()),
        (report.clock, clock(evidence, words)),
        (report.instruments, instruments(evidence, words)),
        (
            report.decision_rule,
            decision_rule(evidence, words).to_owned(),
        ),
        (report.seal, seal(sheet, words)),
        (report.signed_by, signed_by(sheet, words)),
    ];
    let code = Code::of(&sheet.run).map(|code| Block::Code(code.into(), report.scanned.into()));
    let facts = facts.into_iter().chain(continued);
    let facts = facts.map(|(name, value)| (sentence(name), value));
    [
        Block::Heading(report.the_run.into()),
        Block::Facts(facts.collect()),
    ]
    .into_iter()
    .chain(code)
    .collect()
}

/// The seal of the run, by which a printed sheet can be checked against the database.
fn seal(sheet: &Sheet, words: &Words) -> String {
    let report = &words.report;
    let Some(seal) = &sheet.run.seal else {
        return "–".into();
    };
    let (digits, file) = (seal.short(), seal.file.short());
    let place: [(&str, &dyn std::fmt::Display); 3] =
        [("digits", &digits), ("n", &seal.entry), ("file", &file)];
    let said = fill(report.seal_of, &place);
    match seal.found {
        None => said,
        Some(_) => format!("{said} ({})", report.seal_found),
    }
}

/// Accuracy of the computer's clock, as text.
fn clock(evidence: Option<&Evidence>, words: &Words) -> String {
    let report = &words.report;
    let clock = evidence.map(|evidence| &evidence.clock);
    match clock.map(|clock| (clock.synchronised, clock.uncertainty_ms)) {
        Some((Some(true), ms)) => {
            let ms = ms.unwrap_or_default();
            fill(report.clock_set, &[("ms", &ms)])
        }
        Some((Some(false), _)) => report.clock_not_set.into(),
        Some((None, _)) | None => report.clock_not_known.into(),
    }
}

/// Rule by which a value is held against its limits.
fn decision_rule(evidence: Option<&Evidence>, words: &Words) -> &'static str {
    match evidence.is_some_and(|evidence| evidence.guard_banded) {
        true => words.report.rule_guard_band,
        false => words.report.rule_simple,
    }
}

/// Instruments that measured, and whether their calibration was valid.
fn instruments(evidence: Option<&Evidence>, words: &Words) -> String {
    let report = &words.report;
    let used = evidence.map_or(&[][..], |evidence| &evidence.instruments);
    let one = |used: &InstrumentEvidence| {
        let of = &used.of;
        let day = |day: &Option<String>| day.clone().unwrap_or_else(|| "–".to_owned());
        let (calibrated, due) = (day(&of.calibrated), day(&of.due));
        let place: [(&str, &dyn std::fmt::Display); 4] = [
            ("kind", &of.kind),
            ("serial", &of.serial_no),
            ("day", &calibrated),
            ("due", &due),
        ];
        match used.is_calibrated {
            true => fill(report.instrument, &place),
            false => fill(report.instrument_over, &place),
        }
    };
    match used.is_empty() {
        true => report.no_instruments.into(),
        false => used.iter().map(one).collect::<Vec<_>>().join("; "),
    }
}

/// Signature of the run: who, key and time, to be compared with what `ptu verify` says.
fn signed_by(sheet: &Sheet, words: &Words) -> String {
    let report = &words.report;
    let Some(signed) = &sheet.run.signature else {
        return report.unsigned.into();
    };
    let (key, at) = (signed.short_key(), local_zoned(signed.at_us));
    let place: [(&str, &dyn std::fmt::Display); 3] =
        [("who", &signed.who), ("key", &key), ("at", &at)];
    fill(report.signed, &place)
}
