//! The train's switches, equipment that is cut out or fails, and the gradient under the train.

use crate::procedure::loader::args::Args;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::verb::{Param, Verb, needs, takes};
use crate::stimulus::{CarFailure, CutOut, MAX_GRADIENT_PERMILLE, Stimulus, TrainSwitch};
use crate::train::MAX_CARS;

/// A switch of the train.
macro_rules! train_switch {
    ($name:literal, $switch:ident) => {
        switch!($name, |on| Stimulus::Switch {
            switch: TrainSwitch::$switch,
            on,
        })
    };
}

/// Equipment of a car that fails.
macro_rules! failure {
    ($name:literal, $what:ident) => {
        stimulus!($name, CAR_SWITCH, |args| Stimulus::Failure {
            what: CarFailure::$what,
            car: args.int("car")?,
            on: args.flag("on", true),
        })
    };
}

pub(super) static VERBS: &[Verb] = &[
    train_switch!("cab.other_active", OtherCab),
    train_switch!("cab.dead_man", DeadMan),
    train_switch!("cab.forced_release", ForcedRelease),
    stimulus!(
        "cab.emergency_button",
        &[
            needs("on", ParamType::Bool),
            takes("cab", ParamType::Int(1, 2))
        ],
        |args| Stimulus::Switch {
            switch: match args.given_int("cab")? {
                Some(2) => TrainSwitch::Button2,
                _ => TrainSwitch::Button1,
            },
            on: args.flag("on", true),
        }
    ),
    train_switch!("train.eb_cut_out", EbCutOut),
    train_switch!("train.main_reservoir_low", MainReservoirLow),
    train_switch!("train.security_brake", SecurityBrake),
    train_switch!("train.parking_brake", ParkingBrake),
    train_switch!("train.turn_back", TurnBack),
    train_switch!("train.regeneration", Regeneration),
    stimulus!("train.brake_cut_out", CAR_SWITCH, |args| cut_out(
        args,
        CutOut::Brake
    )?),
    stimulus!("train.inverter_cut_out", CAR_SWITCH, |args| cut_out(
        args,
        CutOut::Inverter
    )?),
    failure!("train.inverter_silent", InverterSilent),
    failure!("train.brake_unit_silent", BrakeUnitSilent),
    failure!("train.cylinder_empty", CylinderEmpty),
    failure!("train.brake_stuck", BrakeStuck),
    stimulus!(
        "train.gradient",
        &[takes("permille", ParamType::Number)],
        |args| {
            let permille = args.optional_number("permille")?;
            if permille.is_some_and(|permille| permille.abs() > MAX_GRADIENT_PERMILLE) {
                return Err(format!(
                    "`permille` must be from -{MAX_GRADIENT_PERMILLE} to {MAX_GRADIENT_PERMILLE}"
                ));
            }
            Stimulus::Gradient { permille }
        }
    ),
];

const CAR_SWITCH: &[Param] = &[
    needs("car", ParamType::Int(1, MAX_CARS as i64)),
    needs("on", ParamType::Bool),
];

fn cut_out(args: &Args<'_>, what: CutOut) -> Result<Stimulus, String> {
    Ok(Stimulus::CutOut {
        what,
        car: args.int("car")?,
        on: args.flag("on", true),
    })
}
