//! The tester's session with the unit: arming and the TEST board. Every verb but `ptu.silent` waits
//! for the unit's answer.

use super::bench::{CODE, MARKER, RAW_SIGNAL, code_signal, marker, raw_signal, speed};
use super::track::{STATION, arrival, departure};
use super::with_wait;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension::{Acceleration, Speed};
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::stimulus::Stimulus;

/// A verb that asks the unit for something and waits for its answer.
macro_rules! request {
    ($name:literal, $params:expr, |$args:pat_param| $stimulus:expr) => {
        verb!($name, $params, |$args| with_wait($stimulus, true))
    };
}

pub(super) static VERBS: &[Verb] = &[
    request!("ptu.arm", &[], |_| Stimulus::PtuArm),
    request!("ptu.ask_to_arm", &[], |_| Stimulus::PtuAskToArm),
    request!("ptu.disarm", &[], |_| Stimulus::PtuDisarm),
    request!("ptu.release", &[], |_| Stimulus::PtuRelease),
    request!("ptu.self_test", &[], |_| Stimulus::PtuSelfTest),
    request!("ptu.clear_log", &[], |_| Stimulus::PtuClearLog),
    switch!("ptu.silent", |on| Stimulus::PtuSilent { on }),
    request!("ptu.code", CODE, |args| Stimulus::PtuCode(code_signal(
        args
    )?)),
    request!("ptu.raw", RAW_SIGNAL, |args| Stimulus::PtuCode(raw_signal(
        args
    )?)),
    request!(
        "ptu.speed",
        &[
            needs("to", ParamType::Amount(Speed)),
            takes("channels", ParamType::Ints),
            takes("backward", ParamType::Bool),
            takes("accel", ParamType::Amount(Acceleration)),
        ],
        |args| test_speed(args)?
    ),
    request!("ptu.marker", &[MARKER], |args| Stimulus::PtuMarker {
        psm: marker(args)?
    }),
    request!("ptu.twc", STATION, |args| Stimulus::PtuTwc(departure(
        args
    )?)),
    request!("ptu.at_departure", STATION, |args| Stimulus::PtuTwc(
        departure(args)?
    )),
    request!("ptu.at_arrival", STATION, |args| Stimulus::PtuTwc(arrival(
        args
    )?)),
];

fn test_speed(args: &Args<'_>) -> Result<Stimulus, String> {
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
    Ok(Stimulus::PtuSpeed {
        channels,
        backward: args.flag("backward", false),
        to: speed(args, "to")?,
        accel_mps2,
    })
}
