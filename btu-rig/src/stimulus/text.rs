//! Texts of the values that stimuli carry.

use super::{OrderData, StationData, TachoCondition};

/// A number without the noise of binary fractions.
pub fn number(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    // Also turns -0 into 0.
    format!("{}", rounded + 0.0)
}

pub fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

pub fn direction(backward: bool) -> &'static str {
    if backward { "backward" } else { "forward" }
}

pub fn side(left: bool) -> &'static str {
    if left { "left" } else { "right" }
}

pub fn tacho_text(condition: TachoCondition) -> String {
    match condition {
        TachoCondition::Good => "in order".into(),
        TachoCondition::Dead => "without pulses".into(),
        TachoCondition::Noisy { per_s } => format!("with {} false pulses a second", number(per_s)),
        TachoCondition::Scaled { factor } => format!("with {} times the pulses", number(factor)),
        TachoCondition::Reversed => "with its direction reversed".into(),
    }
}

pub fn order_text(orders: &OrderData) -> String {
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

pub fn station_text(data: &StationData) -> String {
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
