//! The tester's session with the unit: arming and the TEST board. Every verb but `ptu.silent` waits
//! for the unit's answer.

use super::bench::{code_signal, marker, raw_signal, speed};
use super::track::{Place, STATION, station};
use super::{at_once, with_wait};
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension::{Acceleration, Frequency, Level, Speed};
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::stimulus::Stimulus;

macro_rules! request {
    ($name:literal, $stimulus:expr) => {
        Verb {
            name: $name,
            params: &[],
            make: |_| with_wait($stimulus, true),
        }
    };
}

pub(super) static VERBS: &[Verb] = &[
    request!("ptu.arm", Stimulus::PtuArm),
    request!("ptu.disarm", Stimulus::PtuDisarm),
    request!("ptu.release", Stimulus::PtuRelease),
    request!("ptu.clear_log", Stimulus::PtuClearLog),
    Verb {
        name: "ptu.silent",
        params: &[needs("on", ParamType::Bool)],
        make: |args| {
            at_once(Stimulus::PtuSilent {
                on: args.flag("on", true),
            })
        },
    },
    Verb {
        name: "ptu.code",
        params: &[
            needs("code", ParamType::Code),
            takes("level", ParamType::Amount(Level)),
        ],
        make: |args| test_code(code_signal(args)?),
    },
    Verb {
        name: "ptu.raw",
        params: &[
            takes("carrier", ParamType::Amount(Frequency)),
            needs("rate", ParamType::Amount(Frequency)),
            takes("level", ParamType::Amount(Level)),
        ],
        make: |args| test_code(raw_signal(args)?),
    },
    Verb {
        name: "ptu.speed",
        params: &[
            needs("to", ParamType::Amount(Speed)),
            takes("channels", ParamType::Ints),
            takes("backward", ParamType::Bool),
            takes("accel", ParamType::Amount(Acceleration)),
        ],
        make: test_speed,
    },
    Verb {
        name: "ptu.marker",
        params: &[needs("marker", ParamType::Int(1, 4))],
        make: |args| {
            let psm = marker(args, "marker")?;
            with_wait(Stimulus::PtuMarker { psm }, true)
        },
    },
    Verb {
        name: "ptu.twc",
        params: STATION,
        make: |args| with_wait(Stimulus::PtuTwc(station(args, Place::Departure)?), true),
    },
    Verb {
        name: "ptu.at_departure",
        params: STATION,
        make: |args| with_wait(Stimulus::PtuTwc(station(args, Place::Departure)?), true),
    },
    Verb {
        name: "ptu.at_arrival",
        params: STATION,
        make: |args| with_wait(Stimulus::PtuTwc(station(args, Place::Arrival)?), true),
    },
];

fn test_code((carrier_hz, rate_hz, level_mv): (f64, f64, f64)) -> Result<Item, String> {
    let stimulus = Stimulus::PtuCode {
        carrier_hz,
        rate_hz,
        level_mv,
    };
    with_wait(stimulus, true)
}

fn test_speed(args: &Args<'_>) -> Result<Item, String> {
    let mut channels = 0;
    for channel in args.flat("channels") {
        match channel {
            Item::Int(1) => channels |= 1,
            Item::Int(2) => channels |= 2,
            other => return Err(format!("`channels` are 1 and 2, found {}", other.found())),
        }
    }
    if args.get("channels").is_none() {
        channels = 3;
    }
    let accel_mps2 = args.amount_or("accel", 0.0);
    if accel_mps2 < 0.0 {
        return Err("`accel` must not be negative".into());
    }
    let stimulus = Stimulus::PtuSpeed {
        channels,
        backward: args.flag("backward", false),
        to: speed(args, "to")?,
        accel_mps2,
    };
    with_wait(stimulus, true)
}
