//! Verbs for the bench's generators: antenna signal, tachometers, train model, markers, and time.

use protocol::Speed;

use super::{at_once, with_wait};
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::quantity::Dimension::{Acceleration, Distance, Frequency, Level};
use crate::procedure::loader::verb::{Param, Verb, needs, takes};
use crate::procedure::plan::Action;
use crate::stimulus::{CodeSignal, Stimulus, TachoCondition};

/// Acceleration of the generators if a script gives none, m/s².
const DEFAULT_ACCEL_MPS2: f64 = 3.0;
/// Greatest speed of the tachometer generators, km/h.
const TOP_KMH: f64 = 200.0;
/// Time for a prompt if a script gives none.
const PROMPT_TIME: protocol::Duration = protocol::Duration::from_ms(300_000);

const ACCEL: Param = takes("accel", ParamType::Amount(Acceleration));
const CARRIER: Param = takes("carrier", ParamType::Amount(Frequency));
const TO: Param = needs("to", ParamType::Amount(Dimension::Speed));
const WAIT: Param = takes("wait", ParamType::Bool);
const LEVEL: Param = takes("level", ParamType::Amount(Level));
pub(super) const MARKER: Param = needs("marker", ParamType::Int(1, 4));
/// Parameters of [`code_signal`].
pub(super) const CODE: &[Param] = &[needs("code", ParamType::Code), LEVEL];
/// Parameters of [`raw_signal`].
pub(super) const RAW_SIGNAL: &[Param] =
    &[CARRIER, needs("rate", ParamType::Amount(Frequency)), LEVEL];

pub(super) static VERBS: &[Verb] = &[
    stimulus!("antenna.code", CODE, |args| Stimulus::Code(code_signal(
        args
    )?)),
    stimulus!("antenna.raw", RAW_SIGNAL, |args| Stimulus::Code(
        raw_signal(args)?
    )),
    stimulus!("antenna.unmodulated", &[CARRIER, LEVEL], |args| {
        Stimulus::Code(signal(args, 0.0)?)
    }),
    stimulus!(
        "antenna.drift",
        &[
            takes("rate_per_s", ParamType::Amount(Frequency)),
            takes("level_per_s", ParamType::Amount(Level))
        ],
        |args| Stimulus::CodeDrift {
            rate_hz_per_s: args.amount_or("rate_per_s", 0.0),
            level_mv_per_s: args.amount_or("level_per_s", 0.0)
        }
    ),
    stimulus!(
        "antenna.crosstalk",
        &[takes("code", ParamType::Code), LEVEL],
        |args| Stimulus::Crosstalk(match args.get("code") {
            Some(_) => code_signal(args)?,
            None => CodeSignal::default(),
        })
    ),
    switch!("antenna.along", |on| Stimulus::CodesAlong { on }),
    stimulus!("antenna.off", &[], |_| Stimulus::CodeOff),
    verb!("tacho.speed", &[TO, ACCEL, WAIT], |args| motion(
        args, "accel", true
    )),
    verb!(
        "tacho.ramp",
        &[TO, needs("rate", ParamType::Amount(Acceleration)), WAIT],
        |args| motion(args, "rate", false)
    ),
    verb!(
        "tacho.travel",
        &[
            needs("distance", ParamType::Amount(Distance)),
            needs("speed", ParamType::Amount(Dimension::Speed)),
            ACCEL,
            WAIT
        ],
        travel
    ),
    stimulus!("tacho.forward", &[], |_| Stimulus::Direction {
        backward: false
    }),
    stimulus!("tacho.backward", &[], |_| Stimulus::Direction {
        backward: true
    }),
    verb!(
        "tacho.channel",
        &[
            needs("channel", ParamType::Int(1, 2)),
            needs(
                "condition",
                ParamType::Choice(&["good", "dead", "noisy", "scaled", "reversed"])
            ),
            takes("per_s", ParamType::Number),
            takes("factor", ParamType::Number),
        ],
        channel
    ),
    switch!("train.drive", |on| Stimulus::TrainDriven { on }),
    stimulus!(
        "train.adhesion",
        &[takes("coefficient", ParamType::Number)],
        |args| Stimulus::Adhesion {
            coefficient: args.optional_number("coefficient")?
        }
    ),
    stimulus!("psm.pulse", &[MARKER], |args| Stimulus::Marker {
        psm: marker(args)?
    }),
    stimulus!("psm.missing", &[MARKER], |args| Stimulus::MarkerMoved {
        psm: marker(args)?,
        by_m: None
    }),
    stimulus!(
        "psm.moved",
        &[MARKER, needs("by", ParamType::Amount(Distance))],
        |args| Stimulus::MarkerMoved {
            psm: marker(args)?,
            by_m: Some(args.amount("by")?)
        }
    ),
    stimulus!(
        "psm.along",
        &[takes("section", ParamType::Section)],
        |args| Stimulus::MarkersAlong {
            section: args.section("section")
        }
    ),
    verb!(
        "wait",
        &[needs("time", ParamType::Amount(Dimension::Time))],
        |args| {
            let span = args.time_or("time", protocol::Duration::ZERO)?;
            Ok(Item::Actions(vec![Action::Wait(span)]))
        }
    ),
    verb!(
        "prompt",
        &[
            needs("text", ParamType::Text),
            takes("within", ParamType::Amount(Dimension::Time))
        ],
        |args| {
            Ok(Item::Actions(vec![Action::Prompt {
                text: args.text("text").unwrap_or_default().to_owned(),
                within: args.time_or("within", PROMPT_TIME)?,
            }]))
        }
    ),
    verb!(
        "on_bench",
        &[needs("actions", ParamType::Actions)],
        |args| only_where(args, Action::OnBench)
    ),
    verb!(
        "on_train",
        &[needs("actions", ParamType::Actions)],
        |args| only_where(args, Action::OnTrain)
    ),
    verb!("code", &[needs("name", ParamType::Name)], |args| args
        .context
        .code(args.text("name").unwrap_or_default())),
];

/// Actions done only with or only without the bench harness.
fn only_where(args: &Args<'_>, wrap: fn(Box<Action>) -> Action) -> Result<Item, String> {
    let actions = args.actions("actions");
    let nested = |action: &Action| matches!(action, Action::OnBench(_) | Action::OnTrain(_));
    if actions.iter().any(nested) {
        return Err("`on_bench` and `on_train` cannot stand in each other".into());
    }
    let wrapped = actions.into_iter().map(|action| wrap(Box::new(action)));
    Ok(Item::Actions(wrapped.collect()))
}

/// Signal of a code of the table.
pub(super) fn code_signal(args: &Args<'_>) -> Result<CodeSignal, String> {
    let by_name;
    let record = match args.get("code") {
        Some(Item::Record(record)) => record,
        Some(Item::Text(name)) => {
            by_name = args.context.code(name)?;
            match &by_name {
                Item::Record(record) => record,
                _ => return Err("the code table has no such code".into()),
            }
        }
        _ => return Err("needs a code".into()),
    };
    let field = |name| record.get(name).and_then(Item::number);
    match (field("carrier_hz"), field("rate_hz")) {
        (Some(carrier), Some(rate)) => Ok(CodeSignal::new(carrier, rate, level(args)?)),
        _ => Err("the code has no carrier or code rate".into()),
    }
}

/// Signal of a carrier and a code rate as given.
pub(super) fn raw_signal(args: &Args<'_>) -> Result<CodeSignal, String> {
    signal(args, args.amount("rate")?)
}

fn signal(args: &Args<'_>, rate_hz: f64) -> Result<CodeSignal, String> {
    let first = args.context.unit.codes.first();
    let carrier_hz = args.amount_or("carrier", first.map_or(0.0, |code| code.carrier_hz));
    Ok(CodeSignal::new(carrier_hz, rate_hz, level(args)?))
}

fn level(args: &Args<'_>) -> Result<f64, String> {
    let level = args.amount_or("level", args.context.unit.receiver.level_nominal_mv);
    if level >= 0.0 {
        Ok(level)
    } else {
        Err("`level` must not be negative".into())
    }
}

pub(super) fn speed(args: &Args<'_>, name: &str) -> Result<Speed, String> {
    let kmh = args.amount(name)?;
    if (0.0..=TOP_KMH).contains(&kmh) {
        Ok(Speed::from_kmh(kmh))
    } else {
        Err(format!("`{name}` must be from 0 to {TOP_KMH} km/h"))
    }
}

pub(super) fn marker(args: &Args<'_>) -> Result<u8, String> {
    args.int("marker")
}

fn accel(args: &Args<'_>, name: &str) -> Result<f64, String> {
    match args.get(name) {
        None => Ok(DEFAULT_ACCEL_MPS2),
        // Slower than this a ramp takes hours.
        Some(_) if args.amount(name)? >= 0.001 => args.amount(name),
        Some(_) => Err(format!("`{name}` must be at least 0.001 m/s²")),
    }
}

fn motion(args: &Args<'_>, rate: &str, wait: bool) -> Result<Item, String> {
    let stimulus = Stimulus::Speed {
        to: speed(args, "to")?,
        accel_mps2: accel(args, rate)?,
    };
    with_wait(stimulus, args.flag("wait", wait))
}

fn travel(args: &Args<'_>) -> Result<Item, String> {
    args.positive("speed")?;
    let stimulus = Stimulus::Travel {
        distance_m: args.positive("distance")?,
        speed: speed(args, "speed")?,
        accel_mps2: accel(args, "accel")?,
    };
    with_wait(stimulus, args.flag("wait", true))
}

fn channel(args: &Args<'_>) -> Result<Item, String> {
    let word = args.text("condition").unwrap_or_default();
    let only = |name: &str, with: &str| match args.get(name) {
        Some(_) if word != with => Err(format!("`{name}` goes with \"{with}\" only")),
        _ => Ok(()),
    };
    only("per_s", "noisy")?;
    only("factor", "scaled")?;
    let condition = match word {
        "dead" => TachoCondition::Dead,
        "noisy" => TachoCondition::Noisy {
            per_s: args.number("per_s")?,
        },
        "scaled" => TachoCondition::Scaled {
            factor: args.number("factor")?,
        },
        "reversed" => TachoCondition::Reversed,
        _ => TachoCondition::Good,
    };
    at_once(Stimulus::Tacho {
        channel: args.int("channel")?,
        condition,
    })
}
