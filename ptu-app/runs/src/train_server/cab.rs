//! Orders of a person in the cab: one order a line, or a key of the desk with its value behind it.

use std::fmt;

use btu_rig::drive::code_in_antenna;
use btu_rig::stimulus::Stimulus;
use protocol::Speed;
use protocol::config::UnitConfig;
use protocol::message::ModeSwitch;

use super::keys::{self, on_or_off, stimulus, words};
use crate::aboard::MAX_PUSH_KMH;

/// Something done in the cab, on the track, or to the unit's supply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// A stimulus that procedures have, too.
    Do(Stimulus),
    /// The train is pushed up to a speed, backward below 0, and to rest at 0.
    Push(Speed),
    /// The unit's supply.
    Power(bool),
    Quit,
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Do(stimulus) => f.write_str(&words(stimulus)),
            Self::Push(Speed::ZERO) => f.write_str("the train is brought to rest"),
            Self::Push(speed) => write!(f, "the train is pushed up to {speed}"),
            Self::Power(true) => f.write_str("the unit's supply is on"),
            Self::Power(false) => f.write_str("the unit's supply is off"),
            Self::Quit => f.write_str("quit"),
        }
    }
}

/// Reads orders.
pub struct Cab {
    config: UnitConfig,
}

impl Cab {
    /// A reader of orders for a unit with this code table.
    pub fn new(config: &UnitConfig) -> Self {
        Self {
            config: config.clone(),
        }
    }

    /// Reads an order from a line.
    ///
    /// # Errors
    /// The line is no order; the text says what is wrong, and for an unknown word names the orders.
    pub fn order(&self, line: &str) -> Result<Order, String> {
        let mut parts = line.split_whitespace();
        let word = parts.next().unwrap_or_default();
        let value = parts.next();
        let wrong = |takes: &str| format!("\"{line}\": {word} takes {takes}");
        if parts.next().is_some() {
            return Err(format!("\"{line}\" is more than a word and a value"));
        }
        let on_off = || value.and_then(on_or_off).ok_or_else(|| wrong("on or off"));
        let alone = |order| value.is_none().then_some(order).ok_or(wrong("no value"));
        Ok(match word {
            "key" => Order::Do(Stimulus::MaintenanceKey { on: on_off()? }),
            "cab" => Order::Do(Stimulus::Hcr { on: on_off()? }),
            "power" => Order::Power(on_off()?),
            "mode" => {
                let mode = value.and_then(ModeSwitch::from_label);
                let modes = || wrong(&ModeSwitch::LABELS.join(", "));
                Order::Do(Stimulus::ModeSwitch(mode.ok_or_else(modes)?))
            }
            "doors" => match value {
                Some("open") => Order::Do(Stimulus::Doors { closed: false }),
                Some("closed") => Order::Do(Stimulus::Doors { closed: true }),
                _ => return Err(wrong("open or closed")),
            },
            "ack" => alone(Order::Do(Stimulus::Acknowledge))?,
            "start" => alone(Order::Do(Stimulus::Start))?,
            "stop" => alone(Order::Push(Speed::ZERO))?,
            "quit" => alone(Order::Quit)?,
            "move" => {
                let kmh = value.and_then(|value| value.parse().ok());
                let kmh = kmh.filter(|kmh: &f64| kmh.abs() <= MAX_PUSH_KMH);
                let kmh = kmh.ok_or_else(|| wrong(&format!("km/h up to {MAX_PUSH_KMH}")))?;
                Order::Push(Speed::from_kmh(kmh))
            }
            "code" => Order::Do(match value {
                Some("off") => Stimulus::CodeOff,
                name => name
                    .and_then(|name| code_in_antenna(&self.config, name))
                    .ok_or_else(|| wrong(&format!("{} or off", self.codes())))?,
            }),
            key => match stimulus(key, value) {
                Some(done) => Order::Do(done.map_err(wrong)?),
                None => return Err(format!("\"{line}\" is no order; {}", help())),
            },
        })
    }

    fn codes(&self) -> String {
        let names = self.config.codes.iter().map(|code| code.name.as_str());
        names.collect::<Vec<_>>().join(", ")
    }
}

pub fn help() -> String {
    format!(
        "orders, a line each: key on|off, mode {}, cab on|off, doors open|closed, ack, start, move KMH, stop, \
         code NAME|off, power on|off, quit; and keys with their value, as lever B7: {}",
        ModeSwitch::LABELS.join("|"),
        keys::names().collect::<Vec<_>>().join(", ")
    )
}
