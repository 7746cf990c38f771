//! Cab desk, doors and TCMS's link; for the train's switches see `consist`.

use protocol::message::ModeSwitch;

use crate::lever::Lever;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::verb::{Param, Verb, needs, takes};
use crate::stimulus::{DoorLine, DoorState, Stimulus, TcmsCondition};

/// Sides of a train.
const SIDES: &[&str] = &["left", "right"];
const SIDE: &[Param] = &[takes("side", ParamType::Choice(SIDES))];

pub(super) static VERBS: &[Verb] = &[
    stimulus!("door.close", SIDE, |args| doors(args, DoorState::Locked)),
    stimulus!("door.open", SIDE, |args| doors(args, DoorState::Open)),
    stimulus!(
        "door.unlock",
        &[needs("side", ParamType::Choice(SIDES))],
        |args| doors(args, DoorState::Unlocked)
    ),
    switch!("door.automatic", |on| Stimulus::DoorsFollow { on }),
    stimulus!(
        "door.obstacle",
        &[
            needs("side", ParamType::Choice(SIDES)),
            needs("times", ParamType::Int(0, 255))
        ],
        |args| Stimulus::DoorObstacle {
            left: args.text("side") == Some("left"),
            times: args.int("times")?,
        }
    ),
    stimulus!(
        "door.line",
        &[
            needs("line", ParamType::Choice(DoorLine::LABELS)),
            takes("on", ParamType::Bool)
        ],
        |args| {
            let line = args.text("line").and_then(DoorLine::from_label);
            Stimulus::DoorLine {
                line: line.ok_or("no such line")?,
                on: args.get("on").map(|_| args.flag("on", false)),
            }
        }
    ),
    switch!("cab.active", |on| Stimulus::Hcr { on }),
    switch!("cab.key", |on| Stimulus::MaintenanceKey { on }),
    stimulus!(
        "cab.wheel_diameter",
        &[takes("diameter", ParamType::Amount(Dimension::Distance))],
        |args| Stimulus::WheelDiameter {
            diameter_mm: 1000.0 * args.amount_or("diameter", 0.0),
        }
    ),
    stimulus!(
        "cab.train_number",
        &[needs("number", ParamType::Int(0, 65535))],
        |args| {
            let number = args.int("number")?;
            Stimulus::TrainNumber { number }
        }
    ),
    stimulus!(
        "cab.mode",
        &[needs("mode", ParamType::Choice(ModeSwitch::LABELS))],
        |args| {
            let mode = args.text("mode").and_then(ModeSwitch::from_label);
            Stimulus::ModeSwitch(mode.ok_or("no such mode")?)
        }
    ),
    stimulus!(
        "cab.controller",
        &[needs("notch", ParamType::Number)],
        |args| controller(args)?
    ),
    stimulus!("cab.volts", &[takes("volts", ParamType::Number)], |args| {
        let volts = args.optional_number("volts")?;
        if volts.is_some_and(|volts| !(0.0..=10.0).contains(&volts)) {
            return Err("`volts` must be from 0 to 10".into());
        }
        Stimulus::ControllerVolts { volts }
    }),
    stimulus!(
        "cab.contacts",
        &[
            takes("power", ParamType::Bool),
            takes("brake", ParamType::Bool)
        ],
        |args| {
            let given = args.get("power").is_some() || args.get("brake").is_some();
            let contacts = (args.flag("power", false), args.flag("brake", false));
            Stimulus::ControllerContacts {
                contacts: given.then_some(contacts),
            }
        }
    ),
    stimulus!("cab.forward", &[], |_| Stimulus::Reverser { position: 1 }),
    stimulus!("cab.neutral", &[], |_| Stimulus::Reverser { position: 0 }),
    stimulus!("cab.backward", &[], |_| Stimulus::Reverser { position: -1 }),
    stimulus!("cab.acknowledge", &[], |_| Stimulus::Acknowledge),
    stimulus!("cab.start", &[], |_| Stimulus::Start),
    stimulus!("tcms.good", &[], |_| Stimulus::Tcms(TcmsCondition::Good)),
    stimulus!("tcms.silent", &[], |_| Stimulus::Tcms(
        TcmsCondition::Silent
    )),
    stimulus!("tcms.stale", &[], |_| Stimulus::Tcms(TcmsCondition::Stale)),
    switch!("tcms.ato_enable", |on| Stimulus::AtoEnable { on }),
    stimulus!(
        "tcms.passengers",
        &[needs("passengers", ParamType::Amount(Dimension::Mass))],
        |args| {
            let passengers_kg = args.amount("passengers")?;
            if !(0.0..=200_000.0).contains(&passengers_kg) {
                return Err("`passengers` must be from 0 to 200000 kg".into());
            }
            Stimulus::Load { passengers_kg }
        }
    ),
];

/// Doors of one side or, without one, all.
fn doors(args: &Args<'_>, state: DoorState) -> Stimulus {
    match args.text("side") {
        Some(side) => Stimulus::SideDoors {
            left: side == "left",
            state,
        },
        None => Stimulus::Doors {
            closed: state == DoorState::Locked,
        },
    }
}

fn controller(args: &Args<'_>) -> Result<Stimulus, String> {
    let notch = args.number("notch")?;
    let lever = Lever::from_number(notch).ok_or_else(|| {
        format!("`notch` {notch} is none of -8 (emergency), -7 to -1, 0, 0.5, 1 to 4")
    })?;
    Ok(Stimulus::Controller { lever })
}
