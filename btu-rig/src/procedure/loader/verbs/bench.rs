//! Verbs for the bench's generators: antenna signal, tachometers, train model, markers, and time.

use protocol::Speed;

use super::{at_once, with_wait};
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::quantity::Dimension::{Acceleration, Distance, Frequency, Level};
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::procedure::plan::Action;
use crate::stimulus::{Stimulus, TachoCondition};

/// Acceleration of the generators if a script gives none, m/s².
const DEFAULT_ACCEL_MPS2: f64 = 3.0;
/// Top of the tachometer generators.
const TOP_KMH: f64 = 200.0;
/// Time for a prompt if a script gives none.
const PROMPT_TIME: protocol::Duration = protocol::Duration::from_ms(300_000);

pub(super) static VERBS: &[Verb] = &[
    Verb {
        name: "antenna.code",
        params: &[
            needs("code", ParamType::Code),
            takes("level", ParamType::Amount(Level)),
        ],
        make: |args| {
            let (carrier_hz, rate_hz, level_mv) = code_signal(args)?;
            at_once(Stimulus::Code {
                carrier_hz,
                rate_hz,
                level_mv,
            })
        },
    },
    Verb {
        name: "antenna.raw",
        params: &[
            takes("carrier", ParamType::Amount(Frequency)),
            needs("rate", ParamType::Amount(Frequency)),
            takes("level", ParamType::Amount(Level)),
        ],
        make: |args| {
            let (carrier_hz, rate_hz, level_mv) = raw_signal(args)?;
            at_once(Stimulus::Code {
                carrier_hz,
                rate_hz,
                level_mv,
            })
        },
    },
    Verb {
        name: "antenna.unmodulated",
        params: &[
            takes("carrier", ParamType::Amount(Frequency)),
            takes("level", ParamType::Amount(Level)),
        ],
        make: |args| {
            at_once(Stimulus::Code {
                carrier_hz: carrier(args),
                rate_hz: 0.0,
                level_mv: level(args)?,
            })
        },
    },
    Verb {
        name: "antenna.drift",
        params: &[
            takes("rate_per_s", ParamType::Amount(Frequency)),
            takes("level_per_s", ParamType::Amount(Level)),
        ],
        make: |args| {
            at_once(Stimulus::CodeDrift {
                rate_hz_per_s: args.amount_or("rate_per_s", 0.0),
                level_mv_per_s: args.amount_or("level_per_s", 0.0),
            })
        },
    },
    Verb {
        name: "antenna.along",
        params: &[needs("on", ParamType::Bool)],
        make: |args| {
            at_once(Stimulus::CodesAlong {
                on: args.flag("on", true),
            })
        },
    },
    Verb {
        name: "antenna.off",
        params: &[],
        make: |_| at_once(Stimulus::CodeOff),
    },
    Verb {
        name: "tacho.speed",
        params: &[
            needs("to", ParamType::Amount(Dimension::Speed)),
            takes("accel", ParamType::Amount(Acceleration)),
            takes("wait", ParamType::Bool),
        ],
        make: |args| motion(args, "accel", true),
    },
    Verb {
        name: "tacho.ramp",
        params: &[
            needs("to", ParamType::Amount(Dimension::Speed)),
            needs("rate", ParamType::Amount(Acceleration)),
            takes("wait", ParamType::Bool),
        ],
        make: |args| motion(args, "rate", false),
    },
    Verb {
        name: "tacho.travel",
        params: &[
            needs("distance", ParamType::Amount(Distance)),
            needs("speed", ParamType::Amount(Dimension::Speed)),
            takes("accel", ParamType::Amount(Acceleration)),
            takes("wait", ParamType::Bool),
        ],
        make: |args| {
            args.positive("speed")?;
            let stimulus = Stimulus::Travel {
                distance_m: args.positive("distance")?,
                speed: speed(args, "speed")?,
                accel_mps2: accel(args, "accel")?,
            };
            with_wait(stimulus, args.flag("wait", true))
        },
    },
    Verb {
        name: "tacho.forward",
        params: &[],
        make: |_| at_once(Stimulus::Direction { backward: false }),
    },
    Verb {
        name: "tacho.backward",
        params: &[],
        make: |_| at_once(Stimulus::Direction { backward: true }),
    },
    Verb {
        name: "tacho.channel",
        params: &[
            needs("channel", ParamType::Int(1, 2)),
            needs(
                "condition",
                ParamType::Choice(&["good", "dead", "noisy", "scaled"]),
            ),
            takes("per_s", ParamType::Number),
            takes("factor", ParamType::Number),
        ],
        make: channel,
    },
    Verb {
        name: "train.drive",
        params: &[needs("on", ParamType::Bool)],
        make: |args| {
            at_once(Stimulus::TrainDriven {
                on: args.flag("on", true),
            })
        },
    },
    Verb {
        name: "train.adhesion",
        params: &[takes("coefficient", ParamType::Number)],
        make: |args| {
            let coefficient = match args.get("coefficient") {
                Some(_) => Some(args.number("coefficient")?),
                None => None,
            };
            at_once(Stimulus::Adhesion { coefficient })
        },
    },
    Verb {
        name: "psm.pulse",
        params: &[needs("marker", ParamType::Int(1, 4))],
        make: |args| {
            at_once(Stimulus::Marker {
                psm: marker(args, "marker")?,
            })
        },
    },
    Verb {
        name: "psm.missing",
        params: &[needs("marker", ParamType::Int(1, 4))],
        make: |args| {
            at_once(Stimulus::MarkerMoved {
                psm: marker(args, "marker")?,
                by_m: None,
            })
        },
    },
    Verb {
        name: "psm.moved",
        params: &[
            needs("marker", ParamType::Int(1, 4)),
            needs("by", ParamType::Amount(Distance)),
        ],
        make: |args| {
            at_once(Stimulus::MarkerMoved {
                psm: marker(args, "marker")?,
                by_m: Some(args.amount("by")?),
            })
        },
    },
    Verb {
        name: "psm.along",
        params: &[takes("section", ParamType::Section)],
        make: |args| {
            at_once(Stimulus::MarkersAlong {
                section: args.section("section"),
            })
        },
    },
    Verb {
        name: "wait",
        params: &[needs("time", ParamType::Amount(Dimension::Time))],
        make: |args| {
            let span = args.time_or("time", protocol::Duration::ZERO)?;
            Ok(Item::Actions(vec![Action::Wait(span)]))
        },
    },
    Verb {
        name: "prompt",
        params: &[
            needs("text", ParamType::Text),
            takes("within", ParamType::Amount(Dimension::Time)),
        ],
        make: |args| {
            Ok(Item::Actions(vec![Action::Prompt {
                text: args.text("text").unwrap_or_default().to_owned(),
                within: args.time_or("within", PROMPT_TIME)?,
            }]))
        },
    },
    Verb {
        name: "code",
        params: &[needs("name", ParamType::Name)],
        make: |args| args.context.code(args.text("name").unwrap_or_default()),
    },
];

/// Carrier, code rate and level of a code of the table.
pub(super) fn code_signal(args: &Args<'_>) -> Result<(f64, f64, f64), String> {
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
        (Some(carrier), Some(rate)) => Ok((carrier, rate, level(args)?)),
        _ => Err("the code has no carrier or code rate".into()),
    }
}

/// Carrier, code rate and level as given.
pub(super) fn raw_signal(args: &Args<'_>) -> Result<(f64, f64, f64), String> {
    Ok((carrier(args), args.amount("rate")?, level(args)?))
}

fn carrier(args: &Args<'_>) -> f64 {
    let first = args.context.unit.codes.first();
    args.amount_or("carrier", first.map_or(0.0, |code| code.carrier_hz))
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

pub(super) fn marker(args: &Args<'_>, name: &str) -> Result<u8, String> {
    u8::try_from(args.int(name)?).map_err(|e| e.to_string())
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
        _ => TachoCondition::Good,
    };
    at_once(Stimulus::Tacho {
        channel: marker(args, "channel")?,
        condition,
    })
}
