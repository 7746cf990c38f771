//! The train's switches, what is cut out of it, and the gradient it stands on.

use super::at_once;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::stimulus::{CutOut, MAX_GRADIENT_PERMILLE, Stimulus, TrainSwitch};
use crate::train::MAX_CARS;

macro_rules! switch {
    ($name:literal, $switch:ident) => {
        Verb {
            name: $name,
            params: &[needs("on", ParamType::Bool)],
            make: |args| {
                at_once(Stimulus::Switch {
                    switch: TrainSwitch::$switch,
                    on: args.flag("on", true),
                })
            },
        }
    };
}

pub(super) static VERBS: &[Verb] = &[
    switch!("cab.other_active", OtherCab),
    switch!("cab.dead_man", DeadMan),
    switch!("cab.forced_release", ForcedRelease),
    Verb {
        name: "cab.emergency_button",
        params: &[
            needs("on", ParamType::Bool),
            takes("cab", ParamType::Int(1, 2)),
        ],
        make: |args| {
            let other = args.get("cab").is_some() && args.int("cab")? == 2;
            at_once(Stimulus::Switch {
                switch: if other {
                    TrainSwitch::Button2
                } else {
                    TrainSwitch::Button1
                },
                on: args.flag("on", true),
            })
        },
    },
    switch!("train.eb_cut_out", EbCutOut),
    switch!("train.main_reservoir_low", MainReservoirLow),
    switch!("train.security_brake", SecurityBrake),
    switch!("train.parking_brake", ParkingBrake),
    switch!("train.turn_back", TurnBack),
    switch!("train.regeneration", Regeneration),
    Verb {
        name: "train.brake_cut_out",
        params: CAR_SWITCH,
        make: |args| cut_out(args, CutOut::Brake),
    },
    Verb {
        name: "train.inverter_cut_out",
        params: CAR_SWITCH,
        make: |args| cut_out(args, CutOut::Inverter),
    },
    Verb {
        name: "train.gradient",
        params: &[takes("permille", ParamType::Number)],
        make: |args| {
            let given = args.get("permille").map(|_| args.number("permille"));
            let permille = given.transpose()?;
            if permille.is_some_and(|permille| permille.abs() > MAX_GRADIENT_PERMILLE) {
                return Err(format!(
                    "`permille` must be from -{MAX_GRADIENT_PERMILLE} to {MAX_GRADIENT_PERMILLE}"
                ));
            }
            at_once(Stimulus::Gradient { permille })
        },
    },
];

const CAR_SWITCH: &[crate::procedure::loader::verb::Param] = &[
    needs("car", ParamType::Int(1, MAX_CARS as i64)),
    needs("on", ParamType::Bool),
];

fn cut_out(args: &Args<'_>, what: CutOut) -> Result<Item, String> {
    at_once(Stimulus::CutOut {
        what,
        car: u8::try_from(args.int("car")?).map_err(|e| e.to_string())?,
        on: args.flag("on", true),
    })
}
