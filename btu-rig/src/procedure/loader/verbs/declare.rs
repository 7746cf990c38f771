//! `procedure()` and `step()`.

use protocol::{Duration, LruId, lru};

use super::conditions::SOURCE;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::draft::{Declaration, ProcedureDraft, StepDraft};
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::procedure::origin::Origin;
use crate::procedure::plan::{Connection, Measure, OnFail, Procedure, Step};

/// More repetitions than this are a slip of the finger.
const MOST_REPETITIONS: i64 = 1000;

pub(super) static VERBS: &[Verb] = &[
    Verb {
        name: "procedure",
        params: &[
            needs("title", ParamType::Name),
            takes("title_ko", ParamType::Name),
            takes("needs", ParamType::Choice(&["harness", "ptu"])),
            takes("on_request", ParamType::Bool),
            takes("lacks", ParamType::Text),
            takes("suspect", ParamType::Name),
            takes("setup", ParamType::Actions),
            takes("cleanup", ParamType::Actions),
            SOURCE,
        ],
        make: |args| {
            let procedure = Procedure {
                id: String::new(),
                title: named(args, "title")?,
                title_ko: args.text("title_ko").map(str::to_owned),
                needs: match args.text("needs") {
                    Some("ptu") => Connection::Ptu,
                    _ => Connection::Btu,
                },
                on_request: args.flag("on_request", false),
                lacks: args.text("lacks").map(str::to_owned),
                suspect: suspect(args)?.flatten(),
                path: String::new(),
                sha256: String::new(),
                setup: args.actions("setup"),
                cleanup: args.actions("cleanup"),
                steps: Vec::new(),
                slots: 0,
            };
            let sources = args.sources();
            declare(Declaration::Procedure(ProcedureDraft {
                procedure,
                sources,
            }))
        },
    },
    Verb {
        name: "step",
        params: &[
            needs("name", ParamType::Name),
            takes("do", ParamType::Actions),
            takes("expect", ParamType::Expectations),
            takes("measure", ParamType::Measures),
            takes("provokes", ParamType::Events),
            takes("when", ParamType::Condition),
            takes("lacks", ParamType::Text),
            takes("repeat", ParamType::Int(1, MOST_REPETITIONS)),
            takes("on_fail", ParamType::Choice(&["continue", "stop"])),
            takes("continues", ParamType::Bool),
            takes("limit", ParamType::Amount(Dimension::Time)),
            takes("suspect", ParamType::Name),
            takes("note", ParamType::Text),
            SOURCE,
        ],
        make: step,
    },
];

fn declare(declaration: Declaration) -> Result<Item, String> {
    Ok(Item::Declaration(Box::new(declaration)))
}

fn step(args: &Args<'_>) -> Result<Item, String> {
    let (mut expectations, mut origin) = (Vec::new(), Origin::default());
    for item in args.flat("expect") {
        if let Item::Expectation(expectation, of_it) = item {
            expectations.push(expectation.clone());
            origin.join(of_it);
        }
    }
    let mut measures = Vec::new();
    for item in args.flat("measure") {
        if let Item::Measure(measure) = item {
            if measures.iter().any(|m: &Measure| m.name == measure.name) {
                return Err(format!("two measurements are called \"{}\"", measure.name));
            }
            measures.push(measure.as_ref().clone());
        }
    }
    let suspect = suspect(args)?;
    let step = Step {
        name: named(args, "name")?,
        line: 0,
        actions: args.actions("do"),
        expectations,
        origin,
        measures,
        provokes: args.events("provokes")?,
        when: args.condition("when").ok(),
        lacks: args.text("lacks").map(str::to_owned),
        repeat: args.given_int("repeat")?.unwrap_or(1),
        on_fail: match args.text("on_fail") {
            Some("stop") => OnFail::Stop,
            _ => OnFail::Continue,
        },
        continues: args.flag("continues", false),
        time_limit: Duration::ZERO,
        worst_case: Duration::ZERO,
        suspect: suspect.clone().flatten(),
        note: args.text("note").map(str::to_owned),
    };
    declare(Declaration::Step(StepDraft {
        step,
        limit: args.time("limit")?,
        says_suspect: suspect.is_some(),
        sources: args.sources(),
    }))
}

/// The part to suspect, if the call says which, or that there is none.
fn suspect(args: &Args<'_>) -> Result<Option<Option<LruId>>, String> {
    let read = |text| lru::from_shown(text).map_err(|error| format!("`suspect`: {error}"));
    args.text("suspect").map(read).transpose()
}

fn named(args: &Args<'_>, name: &str) -> Result<String, String> {
    match args.text(name).map(str::trim) {
        Some(text) if !text.is_empty() => Ok(text.to_owned()),
        _ => Err(format!("`{name}` is empty")),
    }
}
