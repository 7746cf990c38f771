//! What a dictionary is worth for faults that it does not know, and for two at once, as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use ptu_runs::campaign::{Baseline, LeftOut, OtherFaults, PairFigures, Share, UnseenFigures};

use crate::shares::{percent, share_json};

/// Most pairs of parts, and most answers, that are listed.
const MOST_LISTED: usize = 20;

/// Figures with fault modes left out of the dictionary, and with parts left out.
pub fn left_out_json(left_out: &LeftOut) -> Value {
    let of = |figures: &UnseenFigures| {
        let mut json = figures_json(figures);
        let baselines = figures.baselines.map(|Baseline { first, wrong }| {
            json!({ "first": share_json(first), "wrong": share_json(wrong) })
        });
        json["baselines"] = json!(baselines);
        json
    };
    json!({ "modes": of(&left_out.modes), "parts": of(&left_out.parts) })
}

fn figures_json(figures: &UnseenFigures) -> Value {
    json!({
        "first": share_json(figures.first),
        "first_two": share_json(figures.first_two),
        "first_or_named": share_json(figures.first_or_named),
        "first_or_named_within": figures.first_or_named_within,
        "wrong_within": figures.wrong_within,
        "found": share_json(figures.found),
        "named_for_certain": share_json(figures.named_for_certain),
        "wrong": share_json(figures.wrong),
        "reliability": figures.reliability.map(share_json),
        "brier": figures.brier,
        "confused": figures.confused.iter().map(|(part, taken, runs)| {
            json!({ "part": part, "taken_for": taken, "runs": runs })
        }).collect::<Vec<_>>(),
        "wrong_answers": figures.wrong_answers.iter().map(|(fault, answer)| {
            json!({ "fault": fault, "answer": answer })
        }).collect::<Vec<_>>(),
    })
}

pub fn left_out_text(left_out: &LeftOut) -> String {
    let mut text = String::new();
    for (what, figures) in [
        (
            "fault modes that the dictionary does not know, of parts it knows",
            &left_out.modes,
        ),
        ("parts that the dictionary does not know", &left_out.parts),
    ] {
        let _ = writeln!(text, "\n{what}: {} runs detected", figures.first.all);
        figures_text(&mut text, figures);
        for (way, Baseline { first, wrong }) in ["five nearest neighbours", "naive Bayes"]
            .into_iter()
            .zip(figures.baselines)
        {
            let _ = writeln!(text, "  {way}, by verdicts and signs alone:");
            shares_text(
                &mut text,
                &[
                    ("right part first", first),
                    ("named for certain, a wrong one", wrong),
                ],
            );
        }
    }
    text
}

/// JSON of the figures for faults that act otherwise than the dictionary counted.
pub fn other_faults_json(faults: &OtherFaults) -> Value {
    let mut json = figures_json(&faults.figures);
    json["detected"] = share_json(faults.detected);
    json
}

/// Text of the figures for faults that act otherwise than the dictionary counted; `what` names these faults.
pub fn other_faults_text(what: &str, faults: &OtherFaults) -> String {
    let Share { of, all } = faults.detected;
    let mut text = format!("\n{what}: {of} of {all} runs detected\n");
    figures_text(&mut text, &faults.figures);
    text
}

/// JSON of the figures for two faults at once.
pub fn pairs_json(pairs: &PairFigures) -> Value {
    json!({
        "both": share_json(pairs.both),
        "one": share_json(pairs.one),
        "wrong": share_json(pairs.wrong),
        "not_both": pairs.not_both.iter().map(|(faults, answer)| {
            json!({ "faults": faults, "answer": answer })
        }).collect::<Vec<_>>(),
    })
}

pub fn pairs_text(pairs: &PairFigures) -> String {
    let mut text = format!("\ntwo faults at once: {} runs detected\n", pairs.both.all);
    shares_text(
        &mut text,
        &[
            ("both parts among the first three", pairs.both),
            ("at least one of them", pairs.one),
            ("named for certain, a sound one", pairs.wrong),
        ],
    );
    for (faults, answer) in pairs.not_both.iter().take(MOST_LISTED) {
        let _ = writeln!(text, "  {faults}: {answer}");
    }
    text
}

fn shares_text(text: &mut String, shares: &[(&str, Share)]) {
    for (what, Share { of, all }) in shares {
        let percent = percent(*of as f64, *all as f64);
        let _ = writeln!(text, "  {what:34} {percent:>6.1} %  ({of} of {all})");
    }
}

fn figures_text(text: &mut String, figures: &UnseenFigures) {
    let shares = [
        ("right part first", figures.first),
        ("among the first two", figures.first_two),
        ("right part first, or among few", figures.first_or_named),
        ("named for certain, the right one", figures.found),
        ("alone or among few", figures.named_for_certain),
        ("named for certain, a wrong one", figures.wrong),
    ];
    shares_text(text, &shares);
    if let (Some(first), Some(wrong)) = (figures.first_or_named_within, figures.wrong_within) {
        let [first, wrong] = [first, wrong]
            .map(|[low, high]| format!("{:.1} to {:.1} %", 100.0 * low, 100.0 * high));
        let _ = writeln!(
            text,
            "  95 % intervals, drawn by fault mode: first or among few {first}, wrong {wrong}"
        );
    }
    let curve = figures.reliability.iter().enumerate();
    let curve = curve.filter(|(_, share)| share.all > 0);
    let curve: Vec<_> = curve
        .map(|(class, Share { of, all })| {
            format!("{}-{} %: {of} of {all}", 10 * class, 10 * class + 10)
        })
        .collect();
    let _ = writeln!(
        text,
        "  probability of the first part, and how often it is right: {}",
        curve.join(", ")
    );
    let _ = writeln!(text, "  Brier score {:.3}", figures.brier);
    for (part, taken, runs) in figures.confused.iter().take(MOST_LISTED) {
        let _ = writeln!(text, "  {part} taken for {taken} in {runs}");
    }
    for (fault, answer) in figures.wrong_answers.iter().take(MOST_LISTED) {
        let _ = writeln!(text, "  {fault}: {answer}");
    }
}
