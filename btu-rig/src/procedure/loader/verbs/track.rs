//! The TWC wayside and station data.

use protocol::line::{Line, Section};
use protocol::message::{DoorSide, RunningMode, TrainOrder};

use crate::procedure::loader::args::Args;
use crate::procedure::loader::param_type::ParamType;
use crate::procedure::loader::quantity::Dimension;
use crate::procedure::loader::verb::{Param, Verb, takes};
use crate::stimulus::WaysideCondition::{Corrupt, Good, Silent};
use crate::stimulus::{OrderData, StationData, Stimulus};

const NUMBER: ParamType = ParamType::Int(0, 65535);

/// Parameters of all verbs that send station data.
pub(super) const STATION: &[Param] = &[
    takes("section", ParamType::Section),
    takes("station", NUMBER),
    takes("next_station", NUMBER),
    takes("loop", NUMBER),
    takes("fixed_speed", ParamType::Amount(Dimension::Speed)),
    takes("running_mode", ParamType::Choice(RunningMode::LABELS)),
    takes("door_side", ParamType::Choice(DoorSide::LABELS)),
    takes("departure", ParamType::Bool),
    takes("train_number", NUMBER),
    takes("route", NUMBER),
];

/// Parameters of the wayside's orders.
const ORDERS: &[Param] = &[
    takes("order", ParamType::Choice(TrainOrder::LABELS)),
    takes("section", ParamType::Section),
    takes("length", ParamType::Amount(Dimension::Distance)),
    takes("destination", NUMBER),
    takes("train_number", NUMBER),
];
/// Longest section that orders can tell, m: the longest that a track database may have.
const LONGEST_M: f64 = 20_000.0;

pub(super) static VERBS: &[Verb] = &[
    stimulus!("twc.station", STATION, |args| Stimulus::Station(departure(
        args
    )?)),
    stimulus!("twc.at_departure", STATION, |args| Stimulus::Station(
        departure(args)?
    )),
    stimulus!("twc.at_arrival", STATION, |args| Stimulus::Station(
        arrival(args)?
    )),
    stimulus!("twc.orders", ORDERS, |args| Stimulus::Orders(Some(orders(
        args
    )?))),
    stimulus!("twc.no_orders", &[], |_| Stimulus::Orders(None)),
    stimulus!("twc.good", &[], |_| Stimulus::Wayside(Good)),
    stimulus!("twc.silent", &[], |_| Stimulus::Wayside(Silent)),
    stimulus!("twc.corrupt", &[], |_| Stimulus::Wayside(Corrupt)),
];

/// Station data of a departure; values that the script gives replace those of the section.
pub(super) fn departure(args: &Args<'_>) -> Result<StationData, String> {
    station(args, |section, _| StationData::at_departure(section))
}

/// Station data of an arrival; values that the script gives replace those of the section.
pub(super) fn arrival(args: &Args<'_>) -> Result<StationData, String> {
    station(args, |section, line| {
        StationData::at_arrival(section, line.station_after(section))
    })
}

fn station(args: &Args<'_>, of: fn(&Section, &Line) -> StationData) -> Result<StationData, String> {
    let line = &args.context.line;
    let section = match args.section("section") {
        Some(number) => line.section(number),
        None => line.sections.first(),
    };
    let section = section.ok_or("the line has no section")?;
    let mut data = of(section, line);
    let number = |name: &str, field: &mut u16| -> Result<(), String> {
        if args.get(name).is_some() {
            *field = args.int(name)?;
        }
        Ok(())
    };
    number("station", &mut data.station)?;
    number("next_station", &mut data.next_station)?;
    number("loop", &mut data.loop_id)?;
    number("train_number", &mut data.train_number)?;
    number("route", &mut data.route)?;
    if args.get("fixed_speed").is_some() {
        let kmh = args.amount("fixed_speed")?;
        if !(0.0..=254.0).contains(&kmh) {
            return Err("`fixed_speed` must be from 0 to 254 km/h".into());
        }
        data.fixed_speed_kmh = Some(kmh.round() as u8);
    }
    if let Some(mode) = args.text("running_mode").and_then(RunningMode::from_label) {
        data.running_mode = mode;
    }
    if let Some(side) = args.text("door_side").and_then(DoorSide::from_label) {
        data.door_side = side;
    }
    data.departure = args.flag("departure", data.departure);
    Ok(data)
}

/// Orders of the wayside: the length is the section's own, unless the script gives another.
fn orders(args: &Args<'_>) -> Result<OrderData, String> {
    let number = |name: &str| match args.get(name) {
        Some(_) => args.int(name),
        None => Ok(0),
    };
    let section = args
        .section("section")
        .and_then(|number| args.context.line.section(number));
    let length_m = args.amount_or("length", section.map_or(0.0, |section| section.length_m));
    if !(0.0..=LONGEST_M).contains(&length_m) {
        return Err(format!("`length` must be from 0 to {LONGEST_M} m"));
    }
    let order = args.text("order").and_then(TrainOrder::from_label);
    Ok(OrderData {
        destination: number("destination")?,
        train_number: number("train_number")?,
        ..OrderData::of_section(order.unwrap_or_default(), section, length_m)
    })
}
