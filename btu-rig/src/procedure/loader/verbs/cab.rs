//! Cab desk, doors and TCMS's link; for the train's switches see `consist`.

use protocol::message::ModeSwitch;

use super::at_once;
use crate::lever::Lever;
use crate::procedure::loader::args::Args;
use crate::procedure::loader::item::Item;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::verb::{Verb, needs, takes};
use crate::stimulus::{Stimulus, TcmsCondition};

macro_rules! plain {
    ($name:literal, $stimulus:expr) => {
        Verb {
            name: $name,
            params: &[],
            make: |_| at_once($stimulus),
        }
    };
}

macro_rules! switch {
    ($name:literal, $stimulus:ident) => {
        Verb {
            name: $name,
            params: &[needs("on", ParamType::Bool)],
            make: |args| {
                at_once(Stimulus::$stimulus {
                    on: args.flag("on", true),
                })
            },
        }
    };
}

pub(super) static VERBS: &[Verb] = &[
    plain!("door.close", Stimulus::Doors { closed: true }),
    plain!("door.open", Stimulus::Doors { closed: false }),
    switch!("cab.active", Hcr),
    switch!("cab.key", MaintenanceKey),
    Verb {
        name: "cab.mode",
        params: &[needs("mode", ParamType::Choice(ModeSwitch::LABELS))],
        make: |args| {
            let mode = args.text("mode").and_then(ModeSwitch::from_label);
            at_once(Stimulus::ModeSwitch(mode.ok_or("no such mode")?))
        },
    },
    Verb {
        name: "cab.controller",
        params: &[needs("notch", ParamType::Number)],
        make: controller,
    },
    Verb {
        name: "cab.volts",
        params: &[takes("volts", ParamType::Number)],
        make: |args| {
            let volts = args
                .get("volts")
                .map(|_| args.number("volts"))
                .transpose()?;
            if volts.is_some_and(|volts| !(0.0..=10.0).contains(&volts)) {
                return Err("`volts` must be from 0 to 10".into());
            }
            at_once(Stimulus::ControllerVolts { volts })
        },
    },
    Verb {
        name: "cab.contacts",
        params: &[
            takes("power", ParamType::Bool),
            takes("brake", ParamType::Bool),
        ],
        make: |args| {
            let given = args.get("power").is_some() || args.get("brake").is_some();
            let contacts = (args.flag("power", false), args.flag("brake", false));
            at_once(Stimulus::ControllerContacts {
                contacts: given.then_some(contacts),
            })
        },
    },
    plain!("cab.forward", Stimulus::Reverser { position: 1 }),
    plain!("cab.neutral", Stimulus::Reverser { position: 0 }),
    plain!("cab.backward", Stimulus::Reverser { position: -1 }),
    plain!("cab.acknowledge", Stimulus::Acknowledge),
    plain!("cab.start", Stimulus::Start),
    plain!("tcms.good", Stimulus::Tcms(TcmsCondition::Good)),
    plain!("tcms.silent", Stimulus::Tcms(TcmsCondition::Silent)),
    plain!("tcms.stale", Stimulus::Tcms(TcmsCondition::Stale)),
    switch!("tcms.ato_enable", AtoEnable),
    Verb {
        name: "tcms.passengers",
        params: &[needs("passengers", ParamType::Amount(Dimension::Mass))],
        make: |args| {
            let passengers_kg = args.amount("passengers")?;
            if !(0.0..=200_000.0).contains(&passengers_kg) {
                return Err("`passengers` must be from 0 to 200000 kg".into());
            }
            at_once(Stimulus::Load { passengers_kg })
        },
    },
];

fn controller(args: &Args<'_>) -> Result<Item, String> {
    let notch = args.number("notch")?;
    let lever = Lever::from_number(notch).ok_or_else(|| {
        format!("`notch` {notch} is none of -8 (emergency), -7 to -1, 0, 0.5, 1 to 4")
    })?;
    at_once(Stimulus::Controller { lever })
}
