//! Text of a stimulus.

use std::fmt;

use super::describe::number;
use crate::stimulus::{CutOut, OrderData, StationData, Stimulus, TachoCondition};

impl fmt::Display for Stimulus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&stimulus_text(self))
    }
}

/// Each stimulus in words; long because it is a table.
pub(super) fn stimulus_text(stimulus: &Stimulus) -> String {
    let on_off = |on: bool| if on { "on" } else { "off" };
    let direction = |backward: bool| if backward { "backward" } else { "forward" };
    match *stimulus {
        Stimulus::Code {
            carrier_hz,
            rate_hz,
            level_mv,
        } => format!("antenna signal {carrier_hz} Hz, code rate {rate_hz} Hz, {level_mv} mV"),
        Stimulus::Crosstalk { level_mv: 0.0, .. } => "no code of a neighbouring track".into(),
        Stimulus::Crosstalk {
            carrier_hz,
            rate_hz,
            level_mv,
        } => format!(
            "code of a neighbouring track {carrier_hz} Hz, code rate {rate_hz} Hz, {} mV",
            number(level_mv)
        ),
        Stimulus::CodeDrift {
            rate_hz_per_s,
            level_mv_per_s,
        } => format!("antenna signal drifts {rate_hz_per_s} Hz/s, {level_mv_per_s} mV/s"),
        Stimulus::CodeOff => "antenna signal off".into(),
        Stimulus::Speed { to, accel_mps2 } => {
            format!("speed to {to} at {} m/s²", number(accel_mps2))
        }
        Stimulus::Travel {
            distance_m, speed, ..
        } => format!("travel {} m at {speed}", number(distance_m)),
        Stimulus::Direction { backward } => format!("wheels turn {}", direction(backward)),
        Stimulus::Tacho { channel, condition } => {
            format!("tachometer {channel} {}", tacho_text(condition))
        }
        Stimulus::CodesAlong { on } => format!("speed codes along the way {}", on_off(on)),
        Stimulus::TrainDriven { on } => format!("train model {}", on_off(on)),
        Stimulus::Adhesion {
            coefficient: Some(coefficient),
        } => format!("adhesion {}", number(coefficient)),
        Stimulus::Adhesion { coefficient: None } => "adhesion as always".into(),
        Stimulus::Marker { psm } => format!("pulse of marker PSM{psm}"),
        Stimulus::MarkerMoved { psm, by_m: None } => format!("PSM{psm} is missing"),
        Stimulus::MarkerMoved {
            psm,
            by_m: Some(by_m),
        } => format!("PSM{psm} lies {} m beyond its place", number(by_m)),
        Stimulus::MarkersAlong { section: Some(n) } => {
            format!("markers of section {n} along the way")
        }
        Stimulus::MarkersAlong { section: None } => "no markers along the way".into(),
        Stimulus::Station(data) => format!("wayside sends {}", station_text(&data)),
        Stimulus::Orders(Some(orders)) => format!("wayside orders {}", order_text(&orders)),
        Stimulus::Orders(None) => "wayside gives no orders".into(),
        Stimulus::WheelDiameter { diameter_mm } => {
            format!("wheel diameter {} mm keyed in", number(diameter_mm))
        }
        Stimulus::TrainNumber { number } => format!("train number {number} keyed in"),
        Stimulus::Wayside(condition) => format!("TWC wayside {condition:?}").to_lowercase(),
        Stimulus::SideDoors { left, state } => {
            let side = if left { "left" } else { "right" };
            format!("doors on the {side} {}", state.label())
        }
        Stimulus::Doors { closed } => format!("doors {}", if closed { "closed" } else { "open" }),
        Stimulus::DoorsFollow { on } => format!("doors follow the unit: {}", on_off(on)),
        Stimulus::DoorObstacle { left, times } => {
            let side = if left { "left" } else { "right" };
            format!("obstacle in the doors on the {side} for {times} closings")
        }
        Stimulus::DoorLine { line, on } => {
            let says = on.map_or("as the doors have it", |on| {
                if on { "energised" } else { "dead" }
            });
            format!("door line {}: {says}", line.label())
        }
        Stimulus::Hcr { on } => format!("cab active (HCR) {}", on_off(on)),
        Stimulus::MaintenanceKey { on } => format!("maintenance key {}", on_off(on)),
        Stimulus::ModeSwitch(mode) => format!("mode switch to {}", mode.label()),
        Stimulus::Controller { lever } => format!("master controller to {lever}"),
        Stimulus::ControllerVolts { volts: Some(volts) } => {
            format!("master controller gives {} V", number(volts))
        }
        Stimulus::ControllerVolts { volts: None } => "master controller's own voltage".into(),
        Stimulus::ControllerContacts {
            contacts: Some((power, brake)),
        } => format!(
            "master controller contacts P {}, B {}",
            on_off(power),
            on_off(brake)
        ),
        Stimulus::ControllerContacts { contacts: None } => {
            "master controller's own contacts".into()
        }
        Stimulus::Switch { switch, on } => format!("{} {}", switch.label(), on_off(on)),
        Stimulus::CutOut { what, car, on } => {
            let part = match what {
                CutOut::Brake => "brake",
                CutOut::Inverter => "inverter",
            };
            format!("{part} of car {car} cut {}", if on { "out" } else { "in" })
        }
        Stimulus::Failure { what, car, on } => {
            format!("{} on car {car}: {}", what.label(), on_off(on))
        }
        Stimulus::Gradient {
            permille: Some(permille),
        } => format!("gradient {} ‰", number(permille)),
        Stimulus::Gradient { permille: None } => "gradient as always".into(),
        Stimulus::Reverser { position } => format!("reverser to {position}"),
        Stimulus::Acknowledge => "press acknowledge".into(),
        Stimulus::Start => "press ATO start".into(),
        Stimulus::Tcms(condition) => format!("TCMS link {condition:?}").to_lowercase(),
        Stimulus::AtoEnable { on } => format!("TCMS permits ATO: {}", on_off(on)),
        Stimulus::Load { passengers_kg } => format!("load {passengers_kg} kg"),
        Stimulus::PtuArm => "arm the unit".into(),
        Stimulus::PtuAskToArm => "ask the unit to arm".into(),
        Stimulus::PtuDisarm => "disarm the unit".into(),
        Stimulus::PtuSilent { on } => format!("tester silent: {}", on_off(on)),
        Stimulus::PtuCode {
            carrier_hz,
            rate_hz,
            level_mv,
        } => format!("test code {carrier_hz} Hz, code rate {rate_hz} Hz, {level_mv} mV"),
        Stimulus::PtuSpeed {
            channels,
            backward,
            to,
            ..
        } => {
            let inputs = ["none", "1", "2", "1 and 2"][usize::from(channels & 3)];
            format!("test speed {to} {} on input {inputs}", direction(backward))
        }
        Stimulus::PtuMarker { psm } => format!("pulse of test marker PSM{psm}"),
        Stimulus::PtuTwc(data) => format!("test TWC frame {}", station_text(&data)),
        Stimulus::PtuRelease => "take test signals away".into(),
        Stimulus::PtuSelfTest => "let the unit test itself".into(),
        Stimulus::PtuClearLog => "clear the event log".into(),
    }
}

fn tacho_text(condition: TachoCondition) -> String {
    match condition {
        TachoCondition::Good => "in order".into(),
        TachoCondition::Dead => "without pulses".into(),
        TachoCondition::Noisy { per_s } => format!("with {} false pulses a second", number(per_s)),
        TachoCondition::Scaled { factor } => format!("with {} times the pulses", number(factor)),
        TachoCondition::Reversed => "with its direction reversed".into(),
    }
}

fn order_text(orders: &OrderData) -> String {
    let length = match orders.section {
        0 => String::new(),
        section => format!(
            ", section {section} is {} m long",
            number(f64::from(orders.length_dm) / 10.0)
        ),
    };
    format!(
        "{}, destination {}{length}, {}",
        orders.order.label(),
        orders.destination,
        train_text(orders.train_number)
    )
}

fn train_text(number: u16) -> String {
    match number {
        0 => "this train".to_owned(),
        other => format!("train {other}"),
    }
}

fn station_text(data: &StationData) -> String {
    let speed = data
        .fixed_speed_kmh
        .map_or(String::new(), |v| format!(", fixed speed {v} km/h"));
    let train = train_text(data.train_number);
    format!(
        "section {}, station {}, next {}, loop {}, {}, doors {}, departure {}, {train}{speed}",
        data.section,
        data.station,
        data.next_station,
        data.loop_id,
        data.running_mode.label(),
        data.door_side.label(),
        if data.departure { "given" } else { "not given" },
    )
}
