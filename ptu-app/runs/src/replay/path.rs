//! The position of each signal on the path from the unit's inputs to the motion of the train.
//!
//! Two signals that deviate from what is expected within one report of the unit are listed in this order,
//! because each is sent at its own time.

/// Signals from the inputs of the unit over its decisions to its outputs, then TCMS, then the train.
const PATH: &str = include_str!("path.txt");

/// Rows within which the unit has reported everything once.
pub const REPORT_ROWS: usize = 2;

/// Left out of every comparison: the number of log entries says nothing that the events themselves, named
/// by name, do not; and what the unit's identity is compared with is the tester's, not the unit's.
pub const LEFT_OUT: [&str; 6] = [
    "events",
    "orders_answered",
    "identity_serial",
    "identity_software",
    "identity_config",
    "identity_line",
];

/// Signals that are listed when they deviate, but are never links of a chain: bulk of the train's equipment, and what
/// only follows from it.
const BESIDE: [&str; 7] = [
    "lamps",
    "train_accel",
    "train_jerk",
    "train_position",
    "to_stop",
    "twc_answers",
    "marker_count",
];

/// Signals that are the brake.
const BRAKES: [&str; 4] = ["eb", "fsb", "tcms_fsb", "eb_loop"];

fn names() -> impl Iterator<Item = &'static str> {
    PATH.lines().filter(|line| !line.starts_with('#'))
}

/// Place of the signal on the way from sensor to brake; a signal that the table does not name
/// belongs to the train, at the end.
pub fn place(signal: &str) -> usize {
    names()
        .position(|name| name == signal)
        .unwrap_or(usize::MAX)
}

/// Whether a deviation of the signal can be a link of a chain.
pub fn is_link(signal: &str) -> bool {
    let bulk = ["motor_", "air_"]
        .iter()
        .any(|kind| signal.starts_with(kind));
    !bulk && !BESIDE.contains(&signal)
}

/// The signal is a brake; a chain of deviations ends with one.
pub fn is_brake(signal: &str) -> bool {
    BRAKES.contains(&signal)
}

#[cfg(test)]
mod tests {
    use protocol::signal::{Origin, Signal};

    use super::*;

    #[test]
    fn every_signal_of_the_unit_has_a_position_on_the_path() {
        let others = LEFT_OUT.iter().chain(&BESIDE).chain(&BRAKES);
        for name in names().chain(others.copied()) {
            assert!(Signal::from_name(name).is_some(), "{name}");
        }
        for signal in Signal::ALL {
            let named =
                names().any(|name| name == signal.name()) || LEFT_OUT.contains(&signal.name());
            let of_unit = signal.definition().origin == Origin::Unit;
            assert!(named || !of_unit, "{}", signal.name());
        }
    }
}
